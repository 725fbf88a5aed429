"""μ bounded between grid points: against closed forms, sums by hand, dense grids, and snap that jumps."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from rangenav.observability import derivative_bounds
from rangenav.observability.derivative_bounds import UnboundedDerivativeError
from rangenav.observability.excitation_bound import excitation_bounds
from rangenav.signals import (
    Formula,
    MinimumSnap,
    Multisine,
    Piece,
    Polynomials,
    Signal,
    Sum,
    Tone,
    Waypoint,
    Waypoints,
)
from rangenav.signals.multisine import LETTERS
from tests.support.signal_examples import BLIND, EXAMPLES, LOOP, MINIMUM_SNAP, MULTISINE, PERIODIC_FORMULA, WAYPOINTS

pytestmark = pytest.mark.slow


TIGHT = 0.95
"""The grid is refined until about 1% is given away, and refining moves the least window and its direction a little."""


def excitation(path: Multisine, start: float, window: float) -> np.ndarray:
    """∫p⁗p⁗ᵀ of a Multisine in closed form: ∫ sin(us + a) sin(vs + b) ds is elementary. No quadrature, no grid."""
    W = np.zeros((3, 3))

    def primitive(u: float, a: float, s: float) -> float:
        """∫ cos(us + a) ds"""
        return math.cos(a) * s if u == 0 else math.sin(u * s + a) / u

    for one in path.tones:
        for other in path.tones:
            size = one.amplitude * one.frequency**4 * other.amplitude * other.frequency**4 / 2
            less, more = one.frequency - other.frequency, one.frequency + other.frequency
            end = start + window
            total = primitive(less, one.phase - other.phase, end) - primitive(less, one.phase - other.phase, start)
            total -= primitive(more, one.phase + other.phase, end) - primitive(more, one.phase + other.phase, start)
            W["xyz".index(one.axis), "xyz".index(other.axis)] += size * total
    return W


def least(path: Multisine, start: np.ndarray, window: float) -> np.ndarray:
    return np.array([np.linalg.eigvalsh(excitation(path, float(t), window))[0] for t in start])


FREQUENCIES = (0.5, 1.0, 1.5, 2.0, 3.0, 4.5, 6.0)
tones = st.builds(
    Tone,
    axis=st.sampled_from(["x", "y", "z"]),
    amplitude=st.floats(0.1, 2.0),
    frequency=st.sampled_from(FREQUENCIES),
    phase=st.floats(-3.0, 3.0),
)
sines = st.builds(Multisine, tones=st.lists(tones, min_size=3, max_size=6).map(tuple))


three = st.tuples(*[st.floats(0.1, 2.0)] * 3, *[st.floats(-3.0, 3.0)] * 3, st.permutations(FREQUENCIES))
"""Sizes, phases and different frequencies of one tone an axis."""


@settings(max_examples=40)
@given(sines, st.floats(0.7, 9.0))
def test_no_window_of_any_sines_lies_outside_the_bounds(path: Multisine, window: float):
    """The closed form at many starts, none of them on the grid: never below the lower bound, never above the upper."""
    period = path.period
    assume(period)
    assert period is not None
    bounds = excitation_bounds(path, window, period)
    dense = least(path, np.linspace(0, 2 * period, 301) + 0.137, window)
    slack = 1e-12 * float(np.trace(excitation(path, 0.0, window)))  # of the closed form itself
    assert bounds.lower <= dense.min() + slack
    assert dense.max() <= bounds.upper_everywhere + slack
    there = least(path, np.array([bounds.at]), window)[0]
    assert abs(there - bounds.least) <= bounds.floor + slack
    assert there <= bounds.upper + slack


@settings(max_examples=15)
@given(three, st.floats(0.55, 2.0))
def test_the_lower_bound_gives_away_little(numbers: tuple, turns: float):
    """On windows that hold half a turn of the slowest tone; on shorter ones λ_min is a difference of large numbers."""
    sizes, phases, frequencies = numbers[:3], numbers[3:6], numbers[6][:3]
    made = zip(LETTERS, sizes, frequencies, phases, strict=True)
    path = Multisine(tones=tuple(Tone(axis=a, amplitude=size, frequency=w, phase=f) for a, size, w, f in made))
    bounds = excitation_bounds(path, turns * 2 * math.pi / min(frequencies), path.period or 0.0)
    if bounds.least > 1e4 * bounds.floor:
        assert TIGHT * bounds.least <= bounds.lower <= bounds.least


def test_whole_turns_of_three_frequencies_excite_as_computed_by_hand():
    """Over 2π sines of whole frequencies are orthogonal: W = diag(½ · 2π · A²w⁸), the same for every start."""
    path = Multisine(
        tones=(
            Tone(axis="x", amplitude=0.5, frequency=2.0),
            Tone(axis="y", amplitude=1.0, frequency=1.0, phase=1.0),
            Tone(axis="z", amplitude=0.25, frequency=3.0, phase=-2.0),
        )
    )
    exact = math.pi * 1.0**2 * 1.0**8  # y has least: 0.25·256 and 0.0625·6561 are more
    bounds = excitation_bounds(path, 2 * math.pi, 2 * math.pi)
    assert TIGHT * exact <= bounds.lower <= exact <= bounds.upper
    assert bounds.least == pytest.approx(exact, rel=1e-9)
    np.testing.assert_allclose(bounds.direction, [0, 1, 0], atol=1e-9)


def in_turn(snap: float) -> Polynomials:
    """One second of constant snap along x, then along y, then along z, and again: every derivative jumps."""
    quartic = (0.0, 0.0, 0.0, 0.0, snap / 24, 0.0, 0.0, 0.0)
    pieces = (Piece(duration=1.0, x=quartic), Piece(duration=1.0, y=quartic), Piece(duration=1.0, z=quartic))
    return Polynomials(pieces=pieces, ends="repeat")


@pytest.mark.parametrize(
    ("window", "seconds"), [(2.0, 0.0), (2.25, 0.25), (2.5, 0.5), (3.0, 1.0), (5.0, 1.0), (5.5, 1.5)]
)
def test_snap_that_jumps_is_excited_as_computed_by_hand(window: float, seconds: float):
    """A window of δ misses 3 − δ seconds (modulo 3) of what may be one axis alone; that axis is left so many seconds.

    For δ = 2 it happens at single moments only, which a grid that does not know the knots passes by.
    """
    bounds = excitation_bounds(in_turn(6.0), window, 3.0)
    assert bounds.least == pytest.approx(36.0 * seconds, abs=1e-8)
    assert bounds.lower == pytest.approx(36.0 * seconds, abs=1e-8)
    assert bounds.lower <= 36.0 * seconds <= bounds.upper


def dense(path: Signal, window: float, end: float, knots: np.ndarray) -> np.ndarray:
    """λ_min at many starts, each integrated by itself: between its own knots, on panels of a tenth of a second."""
    node, weight = np.polynomial.legendre.leggauss(12)
    values = []
    for t in np.union1d(np.linspace(0, end, 150), np.clip(np.concatenate([knots, knots - window]), 0, end)):
        edge = np.union1d(
            np.arange(t, t + window, 0.1), np.append(knots[(knots > t) & (knots < t + window)], t + window)
        )
        length = np.diff(edge)
        time = (edge[:-1, None] + length[:, None] * (node + 1) / 2).ravel()
        snap = path(time, 4) * np.sqrt((length[:, None] * weight / 2).ravel())[:, None]
        values.append(np.linalg.svd(snap, compute_uv=False)[-1] ** 2)
    return np.array(values)


@pytest.mark.parametrize("name", [name for name in EXAMPLES if name not in BLIND])
@pytest.mark.parametrize("window", [3.0, 4.5])
def test_every_family_is_bounded_below_and_above_its_dense_windows(name: str, window: float):
    path = EXAMPLES[name]
    end = path.period or 6.0
    bounds = excitation_bounds(path, window, end)
    exact = dense(path, window, end, derivative_bounds.knots_until(path, end + window))
    assert bounds.lower <= exact.min() * (1 + 1e-9)
    assert bounds.lower >= 0.95 * exact.min()
    assert exact.max() <= bounds.upper_everywhere
    assert bounds.least <= exact.min() * 1.02


def test_a_formula_is_bounded_as_the_sines_it_spells():
    sines = Multisine(
        tones=(
            Tone(axis="x", amplitude=1.0, frequency=1.0),
            Tone(axis="y", amplitude=0.5, frequency=2.0),
            Tone(axis="z", amplitude=0.3, frequency=3.0),
        )
    )
    spelt = Formula(x="sin(t)", y="0.5*sin(2*t)", z="0.3*sin(3*t)")
    one, other = excitation_bounds(sines, 4.0, 2 * math.pi), excitation_bounds(spelt, 4.0, 2 * math.pi)
    assert other.lower == pytest.approx(one.lower, rel=0.02)
    assert other.least == pytest.approx(one.least, rel=0.01)


def test_a_path_that_ends_is_not_excited_while_it_holds_still():
    last = WAYPOINTS.points[-1].time
    bounds = excitation_bounds(WAYPOINTS, 2.0, last + 1.0)
    assert bounds.lower == 0.0
    assert bounds.least <= bounds.floor  # rounding of what came before
    assert bounds.at > last - 0.5  # within the floor the first window counts


def test_a_plane_has_a_bound_for_every_window_however_long_the_flight():
    """n·p⁗ is nothing for all time: no grid is asked."""
    tilted = np.array([0.0, math.sqrt(3) / 2, 0.5])
    tones = [Tone(axis="x", amplitude=1.0, frequency=20.0, phase=1.0)]
    tones += [
        Tone(axis="y", amplitude=-0.5, frequency=30.0),
        Tone(axis="z", amplitude=math.sqrt(3) / 2, frequency=30.0),
    ]
    bounds = excitation_bounds(Multisine(tones=tuple(tones)), 6.0, 2 * math.pi / 10)
    np.testing.assert_allclose(np.abs(bounds.direction @ tilted), 1.0, atol=1e-9)
    assert bounds.lower == 0.0
    assert bounds.upper_everywhere < 1e-9


def test_what_cannot_be_bounded_is_said_and_not_guessed():
    with pytest.raises(UnboundedDerivativeError, match="nothing is known to bound"):
        excitation_bounds(
            Formula(x="t**4.5", y="sin(t)", z="cos(t)"), 2.0, 10.0
        )  # at t = 0 its fifth derivative is infinite
    fast = Multisine(tones=(Tone(axis="x", amplitude=1e-6, frequency=600.0),))
    with pytest.raises(UnboundedDerivativeError, match="too much work"):
        excitation_bounds(fast, 100.0, 1000.0)
    short = Piece(duration=1e-3, x=(0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    with pytest.raises(UnboundedDerivativeError, match="knots"):
        excitation_bounds(Polynomials(pieces=(short,), ends="repeat"), 10.0, 100.0)


@pytest.mark.parametrize(
    "signal", [MULTISINE, WAYPOINTS, LOOP, MINIMUM_SNAP, PERIODIC_FORMULA, Sum(base=LOOP, wiggle=PERIODIC_FORMULA)]
)
def test_an_envelope_lies_above_every_derivative_between_its_knots(signal: Signal):
    edges = derivative_bounds.stretches(signal, 14.0)
    sizes = signal.derivative_bounds(edges, range(4, 9))
    rng = np.random.default_rng(5)
    for row, order in enumerate(range(4, 9)):
        for _ in range(20):
            time = edges[:-1] + rng.uniform(1e-6, 1 - 1e-6, len(edges) - 1) * np.diff(edges)
            assert (np.linalg.norm(signal(time, order), axis=-1) <= sizes[row] * (1 + 1e-9)).all()


def test_knots_repeat_and_those_of_both_parts_of_a_sum_count():
    points = tuple(Waypoint(time=0.5 + k, value=(float(k), 0.0, k % 2)) for k in range(3))
    loop, once = Waypoints(points=points, period=3.0), MinimumSnap(points=points)
    np.testing.assert_allclose(derivative_bounds.knots_until(loop, 5.0), [0.5, 1.5, 2.5, 3.5, 4.5])
    np.testing.assert_allclose(derivative_bounds.knots_until(once, 5.0), [0.5, 1.5, 2.5])
    both = Sum(base=loop, wiggle=MinimumSnap(points=(points[0], Waypoint(time=0.75, value=(0.0, 0.0, 0.0)))))
    np.testing.assert_allclose(derivative_bounds.knots_until(both, 2.0), [0.5, 0.75, 1.5])
    assert len(derivative_bounds.knots_until(MULTISINE, 5.0)) == 0
