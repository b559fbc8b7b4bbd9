"""Pictures in notebooks, with words for those who cannot see them."""

from __future__ import annotations

import base64
import io
from dataclasses import dataclass
from html import escape
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from matplotlib.figure import Figure
from PIL import Image, ImageSequence

if TYPE_CHECKING:
    from matplotlib.animation import FuncAnimation

SCREEN, COLOURS = 90, 128
"""Dots per inch and colours of a picture in a notebook: few, so that it may be kept with its source."""

MOVING, FEW = 100, 16
"""The same of a moving one, which has many pictures."""


@dataclass(frozen=True, repr=False)
class Described:
    """A figure, or one that moves, that a notebook shows with alternative text.

    It is HTML with the picture inside, since Jupyter, nbconvert and Sphinx all keep the text of that, and of no image
    alone; where pictures cannot be shown, the words stand in their place.

    Parameters
    ----------
    figure : matplotlib.figure.Figure or matplotlib.animation.FuncAnimation
    words : str
        What is to be seen in it: its axes, what is drawn, and what that says.

    Examples
    --------
    >>> import susp_ss as ss
    >>> from susp_ss import plots
    >>> plots.Described(plots.mode_shapes(ss.QuarterCar()), "Two modes: the body moves in one, the wheel in the other.")
    Two modes: the body moves in one, the wheel in the other.
    """

    figure: Figure | FuncAnimation
    words: str

    def __repr__(self) -> str:
        return self.words

    def _repr_html_(self) -> str:
        kind, picture = (
            ("png", _still(self.figure)) if isinstance(self.figure, Figure) else ("gif", _moving(self.figure))
        )
        data = base64.b64encode(picture).decode("ascii")
        return f'<img alt="{escape(self.words)}" src="data:image/{kind};base64,{data}">'


def _still(figure: Figure) -> bytes:
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=SCREEN, bbox_inches="tight")
    picture = Image.open(buffer).convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE)
    picture.save(small := io.BytesIO(), format="png", optimize=True)
    return small.getvalue()


def _moving(animation: FuncAnimation) -> bytes:
    with TemporaryDirectory() as folder:
        animation.save(path := Path(folder, "moving.gif"), writer="pillow", dpi=MOVING)
        with Image.open(path) as moving:
            pace = moving.info["duration"]
            first, *others = [
                frame.convert("RGB").quantize(FEW, dither=Image.Dither.NONE) for frame in ImageSequence.Iterator(moving)
            ]
    first.save(small := io.BytesIO(), format="gif", save_all=True, append_images=others, duration=pace, loop=0)
    return small.getvalue()
