"""What may help where no change of a motion was found: each way out is a valid page that differs in one thing."""

import msgspec
import numpy as np
import pytest

from explorer.model.settings import Settings
from explorer.model.ways_out import below, ways_out
from rangenav import preset
from rangenav.repair import CannotRepairError

HOVER = Settings(origin="hover", preset=preset.load("hover"))


def test_a_window_that_was_certified_is_offered_with_its_own_length():
    refused = CannotRepairError("no change", ways=("window", "anchor"), window=7.0)
    first, second = ways_out(HOVER, "tones", refused)
    assert first.label == "set δ to 7 s"
    assert first.settings.preset.requirement.window == 7.0
    assert first.settings.preset.world == HOVER.preset.world
    assert second.settings.preset.requirement == HOVER.preset.requirement


def test_the_anchors_new_place_lies_below_the_path_and_clear_of_it():
    p = preset.load("lissajous")
    place = np.array(below(p))
    points = p.path(np.linspace(0.0, p.duration, 1000))
    down = np.asarray(p.world.gravity) / np.linalg.norm(p.world.gravity)
    assert (place @ down > (points @ down).max() + 0.9).all()
    assert np.linalg.norm(points - place, axis=1).min() > 0.9


@pytest.mark.parametrize(("ways", "label"), [(("repair",), "make it observable"), (("tones",), "add tones instead")])
def test_what_a_refusal_advises_is_offered(ways, label):
    assert label in [way.label for way in ways_out(HOVER, "amplitude", CannotRepairError("no", ways=ways))]


def test_a_window_longer_than_a_flight_that_does_not_repeat_is_not_offered():
    line = msgspec.structs.replace(HOVER, preset=preset.load("minimum-snap"))
    refused = CannotRepairError("no change", ways=("window",), window=10 * line.preset.duration)
    assert ways_out(line, "tones", refused) == ()
