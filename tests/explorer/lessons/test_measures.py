"""The numbers of lessons, against a witness of their own."""

import math

import msgspec
import numpy as np
import pytest

from explorer.lessons import State, measures
from explorer.lessons.course import OURS
from explorer.lessons.reading import read
from explorer.model.settings import Settings
from rangenav import preset, record
from rangenav.preset import Preset
from rangenav.signals import Multisine, Tone

SLOW = msgspec.structs.replace(preset.load("paper-slow"), duration=10.0)
CIRCLE = preset.load("circle")


def _state(chosen: Preset, **more: object) -> State:
    return State(settings=Settings(preset=chosen), **more)  # type: ignore[arg-type]


def test_the_worst_of_seeds_is_the_worst_of_five_runs_by_hand():
    errors = [record.run_seed(SLOW, seed).errors.position for seed in range(SLOW.seed, SLOW.seed + 5)]
    steady = max(math.sqrt(np.mean(e[3 * len(e) // 4 :] ** 2)) for e in errors)
    assert measures.worst_of_seeds(SLOW) == pytest.approx((steady, max(e.max() for e in errors)))


def test_the_attitude_filter_corrects_the_gyro_by_its_bias():
    detective = read(OURS / "09-detective")
    assert measures.correction(detective.cases[0]) == pytest.approx(0.1, rel=0.1)
    assert measures.correction(detective.start) < 0.002


def test_height_and_range_swing_as_far_as_the_tone_says():
    tones = (Tone(axis="z", amplitude=0.2, frequency=3.0),)
    path = Multisine(tones=tones, offset=(0.0, 0.0, 1.0))
    p = msgspec.structs.replace(CIRCLE, path=path, world=msgspec.structs.replace(CIRCLE.world, anchor=(0.0, 0.0, 0.0)))
    assert measures.swing(p) == pytest.approx(0.2, rel=1e-3)
    assert measures.range_swing(p) == pytest.approx(0.2, rel=1e-3)
    assert measures.anchor_distance(p) == pytest.approx(0.8, rel=1e-3)


def test_a_start_nearer_to_a_half_turn_takes_longer(monkeypatch: pytest.MonkeyPatch):
    """By ln 10 times the time constant with which it leaves."""
    long = msgspec.structs.replace(SLOW, duration=20.0)
    near = measures.slowest_start(long)
    measures.slowest_start.cache_clear()
    monkeypatch.setattr(measures, "NEAR_HALF_TURN", math.pi - 0.1)
    far = measures.slowest_start(long)
    measures.slowest_start.cache_clear()
    assert math.isfinite(near)
    assert far < near


def test_a_planar_motion_has_no_excitation_and_its_file_neither():
    flat = msgspec.structs.replace(preset.load("figure-eight"), duration=20.0)
    assert measures.mu(flat) == 0.0
    assert measures.file_mu(_state(flat)) is None


def test_a_broken_file_is_refused():
    with pytest.raises(ValueError, match="the exported file"):
        measures.file_mu(_state(CIRCLE, exported=("polynomial", b"duration\n1,2")))
