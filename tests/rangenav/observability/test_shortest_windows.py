"""The shortest windows that give an accuracy, against the ranges of single windows, one by one."""

import math

import msgspec
import numpy as np
import pytest

from rangenav import analysis, preset
from rangenav.observability import accuracy
from rangenav.observability.shortest_windows import PRECISION
from rangenav.preset import Preset
from rangenav.signals import Multisine, Tone

pytestmark = pytest.mark.slow


def sigma(p: Preset, start: float, length: float) -> float:
    """The predicted σ at the end of one window from the ranges that lie in it."""
    rate = p.sensors.range_rate
    first, last = math.ceil(start * rate - 1e-9), math.floor((start + length) * rate + 1e-9)
    ranged = {"first": first, "last": last, "rate": rate, "sigma": p.sensors.sigma.range}
    return accuracy.of_held(p.path, p.world, start, length, **ranged).lifted_end.position


def few_ranges(name: str) -> Preset:
    p = preset.load(name)
    return msgspec.structs.replace(p, sensors=msgspec.structs.replace(p.sensors, range_rate=5.0))


@pytest.mark.parametrize("p", [preset.load("paper-slow"), preset.load("soft"), few_ranges("lissajous")])
def test_every_window_of_the_length_is_accurate_enough_and_shorter_ones_are_not(p: Preset):
    shortest, needed = analysis.shortest(p), p.requirement.position_sigma
    assert shortest.every is not None
    assert shortest.from_start is not None
    length, shorter = shortest.every, 0.99 * shortest.every / PRECISION
    starts = np.linspace(0, p.duration - length, 120).tolist()
    assert max(sigma(p, start, length) for start in starts) <= needed
    assert max(sigma(p, start, shorter) for start in starts) > needed
    assert sigma(p, 0.0, shortest.from_start) <= needed < sigma(p, 0.0, 0.99 * shortest.from_start / PRECISION)
    assert shortest.from_start <= shortest.every


@pytest.mark.parametrize("name", ["paper-slow", "soft"])
def test_the_length_says_the_same_as_the_verdict_on_the_window_of_the_preset(name: str):
    p = preset.load(name)
    for window in (0.9, 1.2):
        judged = preset.with_window(p, window * p.requirement.window, source=name)
        shortest = analysis.shortest(judged).every
        observable = analysis.analyse(judged).verdict.word == "observable"
        assert observable == (shortest is not None and shortest <= PRECISION * judged.requirement.window)


def test_ranges_that_fall_on_one_place_of_the_loop_are_never_enough():
    """At 1 Hz all three tones repeat from range to range, so no flight is long enough, whatever its rank."""
    turn = 2 * math.pi
    tones = (
        Tone(axis="x", amplitude=1.0, frequency=turn),
        Tone(axis="y", amplitude=1.0, frequency=2 * turn),
        Tone(axis="z", amplitude=1.0, frequency=3 * turn),
    )
    soft = preset.load("soft")
    sensors = msgspec.structs.replace(soft.sensors, range_rate=1.0)
    p = msgspec.structs.replace(soft, path=Multisine(tones=tones), duration=40.0, sensors=sensors)
    assert analysis.how_long(p).full_rank[0] is not None
    assert analysis.shortest(p).from_start is analysis.shortest(p).every is None
