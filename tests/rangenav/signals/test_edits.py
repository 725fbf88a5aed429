"""Edits of whole signals: every one is the map it says, on every family and every derivative."""

import math

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from rangenav import signals
from rangenav.signals import Multisine, Sum
from tests.support.signal_examples import EXAMPLES, MULTISINE, WAYPOINTS, keeps_its_family

pytestmark = pytest.mark.slow


T = np.linspace(0, 12, 301)
ABOUT = (0.5, -1.0, 2.0)
TURN = Rotation.from_rotvec([0.3, -1.1, 0.7]).as_matrix()
names = pytest.mark.parametrize("name", EXAMPLES)


def agree(computed, expected, order, *, t=T):
    """Same derivative, to a rounding of its size."""
    values = computed(t, order)
    np.testing.assert_allclose(values, expected, atol=1e-9 * (1 + np.abs(expected).max()))


def mapped(signal, matrix, order):
    """What a map about a point does to the derivative."""
    about = np.asarray(ABOUT) if order == 0 else np.zeros(3)
    return about + (signal(T, order) - about) @ matrix.T


@names
@pytest.mark.parametrize("order", range(5))
def test_scaling_rotating_and_mirroring_map_every_derivative(name, order):
    signal = EXAMPLES[name]
    mirror = np.diag([1.0, 1.0, 1.0]) - 2 * np.outer([1, 2, 2], [1, 2, 2]) / 9
    agree(signals.scaled(signal, -1.5, about=ABOUT), mapped(signal, -1.5 * np.eye(3), order), order)
    agree(signals.rotated(signal, TURN, about=ABOUT), mapped(signal, TURN, order), order)
    agree(signals.mirrored(signal, (1.0, 2.0, 2.0), about=ABOUT), mapped(signal, mirror, order), order)


@names
def test_edits_keep_the_family_and_mirroring_twice_gives_it_back(name):
    signal = EXAMPLES[name]
    twice = signals.mirrored(signals.mirrored(signal, (0.0, 0.0, 1.0), about=ABOUT), (0.0, 0.0, 3.0), about=ABOUT)
    for edited in (twice, signals.rotated(signal, TURN, about=ABOUT), signals.slowed(signal, 2.0)):
        assert type(edited) is type(signal) or not keeps_its_family(signal)
    agree(twice, signal(T), 0)


@names
@pytest.mark.parametrize("order", range(5))
def test_slowing_runs_the_same_geometry(name, order):
    signal = EXAMPLES[name]
    inside = T[(T > 0.01) & (T < 11.9)]  # next to a last knot a rounding may fall on its other side
    agree(signals.slowed(signal, 2.5), signal(inside, order) / 2.5**order, order, t=inside * 2.5)


@names
def test_slowing_slows_bandwidth_and_period(name):
    signal, slow = EXAMPLES[name], signals.slowed(EXAMPLES[name], 2.0)
    until = signal.bandwidth_until(10.0)
    assert slow.bandwidth_until(20.0) == pytest.approx(until / 2, rel=1e-9)
    if signal.period:
        assert slow.period == pytest.approx(2 * signal.period)


@names
def test_with_start_sets_position_and_velocity_and_keeps_what_bends(name):
    position, velocity = (1.0, -2.0, 0.5), (0.25, 0.5, -1.0)
    begun = signals.with_start(EXAMPLES[name], position=position, velocity=velocity)
    zero = np.zeros(())
    np.testing.assert_allclose(begun(zero), position, atol=1e-12)
    np.testing.assert_allclose(begun(zero, 1), velocity, atol=1e-12)
    for order in (2, 4):
        agree(begun, EXAMPLES[name](T, order), order)


def test_a_start_of_what_cannot_drift_makes_a_sum_once():
    once = signals.with_start(WAYPOINTS, position=(0.0, 0.0, 0.0), velocity=(1.0, 0.0, 0.0))
    again = signals.with_start(once, position=(1.0, 1.0, 1.0), velocity=(0.0, 0.0, 0.0))
    assert isinstance(again, Sum)
    assert again.base == WAYPOINTS


@names
def test_centring_puts_the_middle_of_the_box_on_the_point(name):
    moved = signals.centred(EXAMPLES[name], ABOUT, duration=10.0)
    places = moved(np.linspace(0, 10.0, 2001))
    np.testing.assert_allclose((places.min(axis=0) + places.max(axis=0)) / 2, ABOUT, atol=1e-9)


def test_a_mirror_along_an_axis_keeps_the_tones_as_they_were_entered():
    mirrored = signals.mirrored(MULTISINE, (1.0, 0.0, 0.0), about=(0.0, 0.0, 0.0))
    assert isinstance(mirrored, Multisine)
    assert [tone.phase for tone in mirrored.tones] == [tone.phase for tone in MULTISINE.tones]
    assert [tone.amplitude for tone in mirrored.tones] == [-1.0, 0.3, -0.4]


@given(st.integers(0, 2**32 - 1), st.integers(1, 30))
def test_turning_again_and_again_does_not_multiply_the_tones(seed, turns):
    path = MULTISINE
    for matrix in Rotation.random(turns, np.random.default_rng(seed)).as_matrix():
        path = signals.rotated(path, matrix, about=(0.0, 0.0, 0.0))
    assert isinstance(path, Multisine)
    assert len(path.tones) <= 9


@pytest.mark.parametrize("factor", [0.0, math.nan, math.inf])
def test_scaling_by_nothing_is_refused(factor):
    with pytest.raises(ValueError, match="the factor must be a number other than 0"):
        signals.scaled(MULTISINE, factor, about=ABOUT)
    with pytest.raises(ValueError, match="normal must not be zero"):
        signals.mirrored(MULTISINE, (0.0, 0.0, 0.0), about=ABOUT)


@names
def test_what_was_edited_is_still_a_value(name):
    edited = signals.rotated(EXAMPLES[name], TURN, about=ABOUT)
    assert edited == msgspec.convert(msgspec.to_builtins(edited), type=signals.Signal)
    assert hash(edited) == hash(msgspec.convert(msgspec.to_builtins(edited), type=signals.Signal))
