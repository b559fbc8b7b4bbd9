"""A picture in a notebook: the words of those who cannot see it, and the picture itself."""

import base64
import html.parser
import io
import itertools

import numpy as np
from matplotlib.image import imread
from PIL import Image, ImageSequence

import susp_ss as ss
from susp_ss import plots

WORDS = 'Two modes, "body" & <wheel>.'


class Images(html.parser.HTMLParser):
    """The attributes of each image of a text."""

    def __init__(self, text):
        super().__init__()
        self.found = []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.found += [dict(attributes)] if tag == "img" else []


def test_a_described_picture():
    figure = plots.mode_shapes(ss.QuarterCar())
    shown = plots.Described(figure, WORDS)
    assert repr(shown) == WORDS
    (image,) = Images(shown._repr_html_()).found
    assert image["alt"] == WORDS
    kind, _, data = image["src"].partition(",")
    assert kind == "data:image/png;base64"
    picture = imread(io.BytesIO(base64.b64decode(data, validate=True)), format="png")
    assert picture[..., :3].std() > 0.02
    assert abs(picture.shape[1] - 90 * figure.get_figwidth()) < 40


def test_a_described_picture_that_moves():
    car = ss.QuarterCar()
    over = ss.simulate(car, ss.obstacle("bump"), speed=5.0, positions=True).isel(time=slice(900, 1100))
    (image,) = Images(plots.Described(plots.ride_animation(car, over), WORDS)._repr_html_()).found
    kind, _, data = image["src"].partition(",")
    assert (image["alt"], kind) == (WORDS, "data:image/gif;base64")
    with Image.open(io.BytesIO(base64.b64decode(data, validate=True))) as picture:
        frames = [np.array(frame.convert("RGB"), dtype=float) for frame in ImageSequence.Iterator(picture)]
    assert len(frames) == 5
    assert all(np.abs(one - next_one).max() > 100 for one, next_one in itertools.pairwise(frames))
