"""Pictures in notebooks, with words for those who cannot see them."""

from __future__ import annotations

import base64
import io
from dataclasses import dataclass
from html import escape

from matplotlib.figure import Figure
from PIL import Image

SCREEN, COLOURS = 90, 128
"""Dots per inch and colours of a picture in a notebook: few, so that it may be kept with its source."""


@dataclass(frozen=True, repr=False)
class Described:
    """A figure that a notebook shows with alternative text.

    It is HTML with the picture inside, since Jupyter, nbconvert and Sphinx all keep the text of that, and of no image
    alone; where pictures cannot be shown, the words stand in their place.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
    words : str
        What is to be seen in it: its axes, what is drawn, and what that says.

    Examples
    --------
    >>> import susp_ss as ss
    >>> from susp_ss import plots
    >>> plots.Described(plots.mode_shapes(ss.QuarterCar()), "Two modes: the body moves in one, the wheel in the other.")
    Two modes: the body moves in one, the wheel in the other.
    """

    figure: Figure
    words: str

    def __repr__(self) -> str:
        return self.words

    def _repr_html_(self) -> str:
        buffer = io.BytesIO()
        self.figure.savefig(buffer, format="png", dpi=SCREEN, bbox_inches="tight")
        picture = Image.open(buffer).convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE)
        picture.save(small := io.BytesIO(), format="png", optimize=True)
        data = base64.b64encode(small.getvalue()).decode("ascii")
        return f'<img alt="{escape(self.words)}" src="data:image/png;base64,{data}">'
