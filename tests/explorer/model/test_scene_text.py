"""The text of the 3-D picture says what the picture shows, with the numbers of the run."""

import re

import numpy as np
import pytest

from explorer.model import scene_text
from rangenav.model import POSITION
from tests.support.pictures import astronomic, picture

pytestmark = pytest.mark.slow

NUMBER = r"(-?[\d.]+(?:e-?\d+)?)"
PLACE = rf"vehicle is at \({NUMBER}, {NUMBER}, {NUMBER}\) m, {NUMBER} m from the anchor"


@pytest.mark.parametrize("moment", [0.0, 12.4])
def test_it_says_where_the_vehicle_is_and_how_far_the_estimate_is_off(moment: float) -> None:
    shown = picture("paper-slow")
    text, k = scene_text.spoken(shown, moment), int(np.argmin(np.abs(shown.motion.time - moment)))
    found = re.search(PLACE, text)
    assert found is not None, text
    x, y, z, away = (float(number) for number in found.groups())
    assert [x, y, z] == pytest.approx(shown.motion.position[k], abs=0.006)
    assert away == pytest.approx(np.linalg.norm(shown.motion.position[k]), rel=0.01)  # the anchor is the origin
    off = re.search(rf"off by {NUMBER} m and {NUMBER}°; its own σ is {NUMBER} m", text)
    assert off is not None, text
    body = shown.motion.rotation[k].T @ shown.motion.position[k]
    assert float(off[1]) == pytest.approx(np.linalg.norm(shown.estimate.state[k, POSITION] - body), rel=0.01)
    assert float(off[3]) ** 2 == pytest.approx(np.trace(shown.estimate.covariance[k, 0]), rel=0.02)
    assert text.startswith("Verdict: observable, ")


def test_a_blind_motion_names_its_directions_and_an_estimate_that_is_no_number_is_none() -> None:
    assert "position and velocity along z cannot be told" in scene_text.written(picture("circle"), 0.0)
    lost = astronomic("hover")
    assert "There is no estimate." in scene_text.spoken(lost, lost.preset.duration)
