"""Settings: compared by value, and converted into the preset that is computed."""

import math

import msgspec
import numpy as np
import pytest

from explorer.model.settings import Printed, Settings, effective
from rangenav import preset
from tests.support.refusals import exactly

PAPER = preset.load("paper")
SWITCHES = Printed.__struct_fields__
PRINTED_POSITION, PRINTED_VELOCITY = (1.0, 0.0, 0.0), (-0.0125, 2.5, -4.33)
"""As the paper prints them (m, m/s)."""


def test_settings_of_equal_choices_are_equal_and_hash_alike():
    first, second = (Settings(preset=preset.load("circle"), printed=Printed(model=True)) for _ in range(2))
    assert first == second
    assert hash(first) == hash(second)
    assert first != Settings(preset=preset.load("circle"))


def test_settings_cannot_be_changed_in_place():
    name = "time_scale"  # not written as an assignment, which the type checker refuses before it can be tried
    with pytest.raises(AttributeError):
        setattr(Settings(preset=PAPER), name, 2.0)


def test_without_further_choices_the_preset_is_computed_as_it_is():
    assert effective(Settings(preset=PAPER)) == PAPER


def test_nothing_printed_is_followed_by_default():
    assert not any(getattr(Printed(), name) for name in SWITCHES)


@pytest.mark.parametrize("name", [name for name in SWITCHES if name != "initial_values"])
def test_switches_about_computations_leave_the_inputs_alone(name):
    assert effective(Settings(preset=PAPER, printed=Printed(**{name: True}))) == PAPER


def test_the_time_scale_slows_the_path_and_nothing_else():
    slow = effective(Settings(preset=PAPER, time_scale=4.0))
    assert slow.path == preset.load("paper-slow").path
    assert msgspec.structs.replace(slow, path=PAPER.path) == PAPER
    t = np.linspace(0, 5, 50)
    np.testing.assert_allclose(slow.path(4 * t), PAPER.path(t), atol=1e-14)


def test_the_printed_initial_values_drift_61_m_away_from_the_formula_in_20_s():
    drifting = effective(Settings(preset=PAPER, printed=Printed(initial_values=True)))
    start, end = np.array(0.0), np.array(20.0)
    np.testing.assert_allclose(drifting.path(start), PRINTED_POSITION, atol=1e-15)
    np.testing.assert_allclose(drifting.path(start, 1), PRINTED_VELOCITY, atol=1e-14)
    assert round(float(np.linalg.norm(drifting.path(end) - PAPER.path(end)))) == 61
    # from the third derivative on nothing has changed, so the excitation is the same and only the place is not
    t = np.linspace(0, 20, 50)
    for order in (2, 3, 4):
        np.testing.assert_array_equal(drifting.path(t, order), PAPER.path(t, order))
    assert msgspec.structs.replace(drifting, path=PAPER.path) == PAPER


def test_printed_initial_values_hold_at_any_time_scale():
    both = effective(Settings(preset=PAPER, time_scale=2.0, printed=Printed(initial_values=True)))
    np.testing.assert_allclose(both.path(np.array(0.0), 1), PRINTED_VELOCITY, atol=1e-14)


@pytest.mark.parametrize(
    ("scale", "sentence"),
    [
        (0.0, "time_scale must lie between 0.1 and 10, got 0"),
        (-1.0, "time_scale must lie between 0.1 and 10, got -1"),
        (11.0, "time_scale must lie between 0.1 and 10, got 11"),
        (math.nan, "time_scale must be a finite number, got nan"),
    ],
)
def test_a_time_scale_outside_its_limits_is_refused_in_one_sentence(scale, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        Settings(preset=PAPER, time_scale=scale)


def test_a_time_scale_too_fast_for_the_imu_is_refused_in_one_sentence():
    sensors = msgspec.structs.replace(PAPER.sensors, imu_rate=40.0, mag_rate=40.0)
    fast = Settings(preset=msgspec.structs.replace(PAPER, sensors=sensors), time_scale=0.1)
    with pytest.raises(ValueError, match=r"^path: 160 rad/s is faster than the IMU can sample \(126 rad/s\)$"):
        effective(fast)
