"""The worst window's accuracy, and whether a flight speaks of all later rounds of a loop."""

import math

import pytest

from rangenav import verdict
from rangenav.motion import World
from rangenav.observability.worst_accuracy import WorstAccuracy, worst_accuracy
from rangenav.observability.worst_excitation import EVERY, FLIGHT
from rangenav.signals import Multisine, Tone
from rangenav.signals.multisine import LETTERS

LOOP = Multisine(
    tones=tuple(Tone(axis=LETTERS[k], amplitude=1.0, frequency=math.pi / 2 * (k + 1), phase=0.4 * k) for k in range(3))
)
"""A round takes 4 s."""


def of(path: Multisine, *, duration: float = 12.0, window: float = 6.0, rate: float = 10.0) -> WorstAccuracy:
    return worst_accuracy(path, World(), duration, window, sigma=0.1, rate=rate)


def test_a_loop_with_a_whole_number_of_ranges_is_the_same_in_every_round():
    assert (of(LOOP).starts, of(LOOP).reason) == (EVERY, None)
    later = of(LOOP, duration=24.0)
    assert later.windows.bound == pytest.approx(of(LOOP).windows.bound, rel=1e-5)


def test_other_loops_and_flights_speak_of_the_flight_alone_and_say_why():
    uneven = of(LOOP, rate=10.1)
    assert (uneven.starts, uneven.reason) == (
        FLIGHT,
        "a loop of 4 s holds 40.4 ranges, so in later rounds they fall at other phases",
    )
    assert of(LOOP, duration=9.0).starts == FLIGHT  # its windows start in 3 s of the 4
    drifting = Multisine(tones=LOOP.tones, drift=(1.0, 0.0, 0.0))
    assert "drifts" in str(of(drifting).reason)
    assert of(drifting).starts == FLIGHT


def test_later_rounds_of_an_uneven_loop_may_be_worse():
    """So the claim of every t would be false of it."""
    assert of(LOOP, duration=60.0, rate=4.1).windows.sigma > 1.0001 * of(LOOP, rate=4.1).windows.sigma


@pytest.mark.parametrize("rate", [0.1, 0.3, 0.7, 1.0, 1.9])
def test_windows_of_hardly_any_ranges_determine_nothing(rate: float):
    found = of(LOOP, rate=rate)
    assert found.windows.bound == math.inf
    assert found.windows.ranges <= 12
    assert math.isnan(found.lifted_end.position)
    said = verdict.judge(13, found.lifted_end.position, 1.0).reason
    assert said.startswith("for these ranges: ")


def test_what_is_said_at_the_worst_window_is_its_bound():
    found = of(LOOP)
    assert found.lifted_end.position == pytest.approx(found.windows.sigma, rel=1e-6)
    assert found.lifted_end.position <= found.windows.bound * (1 + 1e-9)
    assert found.nonlinear_end.position < found.lifted_end.position
