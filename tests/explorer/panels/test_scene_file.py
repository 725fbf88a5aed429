"""An animation has the moments that were asked for, and its file repeats them at the pace of the flight."""

import io

import numpy as np
import pytest
from PIL import Image

from explorer.model.compute import compute
from explorer.model.settings import Printed, Settings
from explorer.panels import scene_file
from rangenav import preset
from tests.support.pictures import picture


@pytest.mark.parametrize(
    ("begin", "seconds", "count", "last"), [(0.0, 4.0, 41, 4.0), (9.5, 4.0, 6, 10.0), (10.0, 4.0, 1, 10.0)]
)
def test_an_animation_begins_at_the_playhead_and_ends_with_the_flight(
    begin: float, seconds: float, count: int, last: float
):
    times = scene_file.moments(begin, seconds, duration=10.0)
    assert (len(times), times[0]) == (count, begin)
    assert times[-1] == pytest.approx(last)


def test_a_file_repeats_the_pictures_at_the_pace_of_the_flight():
    frames = [np.full((20, 30, 3), 250, dtype=np.uint8) for _ in range(3)]
    for k, frame in enumerate(frames):
        frame[5:10, 5 * k : 5 * k + 5] = (213, 94, 0)
    animation = Image.open(io.BytesIO(scene_file.gif(frames)))
    assert (animation.n_frames, animation.size) == (3, (30, 20))  # type: ignore[attr-defined]
    assert animation.info["loop"] == 0
    for k in range(3):
        animation.seek(k)
        assert animation.info["duration"] == 1000 / scene_file.RATE
        shown = np.asarray(animation.convert("RGB"), dtype=int)
        assert np.abs(shown - frames[k]).max() < 40


def test_a_picture_says_below_itself_what_it_shows():
    frame = np.zeros((60, 400, 4), dtype=np.uint8)
    printed = compute(Settings(preset=preset.load("circle"), printed=Printed(excitation=True)))
    words = scene_file.caption(printed, 1.5)
    assert "t = 1.50 s, as printed in the paper: printed signal φ" in words
    assert "Verdict (as derived): blind, 11 of 13 quantities determined" in words
    assert "as derived. Verdict" in scene_file.caption(picture("circle"), 1.5)
    read = np.asarray(Image.open(io.BytesIO(scene_file.png(frame, words))))
    assert read.shape[1] == 400
    np.testing.assert_array_equal(read[:60], frame)
    strip = read[60:]
    assert (strip[..., 3] == 255).all()
    assert strip[..., :3].min() < 50  # ink
    assert (strip[:, -3:, :3] == 255).all()  # no word is cut


def test_a_picture_keeps_its_transparent_background():
    frame = np.zeros((4, 6, 4), dtype=np.uint8)
    frame[1, 2] = (0, 114, 178, 255)
    read = np.asarray(Image.open(io.BytesIO(scene_file.png(frame))))
    np.testing.assert_array_equal(read, frame)
