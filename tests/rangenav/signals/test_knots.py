"""Knots and what lies between them, all derivatives at once, and closed curves against scipy's own."""

import itertools
import math

import numpy as np
import pytest
from scipy.interpolate import make_interp_spline

from rangenav.signals import Formula, MinimumSnap, Multisine, Sum, Tone, Waypoints, knots, piecewise
from tests.support.signal_examples import EXAMPLES, LOOP, MINIMUM_SNAP, MINIMUM_SNAP_LOOP, POLYNOMIALS, WAYPOINTS, timed

examples = pytest.mark.parametrize("signal", EXAMPLES.values(), ids=EXAMPLES)
HIGHEST = 11
"""Beyond the degree of every piece."""


@examples
@pytest.mark.parametrize("highest", [1, 4, HIGHEST])
def test_all_derivatives_at_once_are_those_one_by_one(signal, highest):
    """Horner's scheme from other coefficients: some hundred roundings of what the largest of its terms is."""
    t = np.linspace(-1.0, 25.0, 5001)  # more than one chunk, before the first knot, after the last, round a period
    if isinstance(signal, Formula):
        t = np.linspace(0.0, 25.0, 101)
    every = signal.jet(t, highest)
    assert every.shape == (highest + 1, len(t), 3)
    for order in range(highest + 1):
        alone = signal(t, order)
        np.testing.assert_allclose(every[order], alone, rtol=1e-9, atol=1e-11 * np.abs(alone).max())


@pytest.mark.parametrize("curve", [WAYPOINTS, LOOP, MINIMUM_SNAP, MINIMUM_SNAP_LOOP, POLYNOMIALS])
def test_between_neighbouring_knots_a_curve_is_one_polynomial_and_across_them_it_is_not(curve):
    """A fit of the curve's degree to its snap is exact on each stretch; across a knot there is a kink or a jump."""
    edges = np.concatenate([[-3.0], knots.knots(curve, -3.0, 30.0), [30.0]])
    assert (np.diff(edges) > 0).all()
    degree = knots.degree(curve)

    def misfit(first: float, last: float) -> float:
        u = np.linspace(-1, 1, 31)[1:-1]
        place = curve(first + (u + 1) / 2 * (last - first), 4)
        fitted = np.polynomial.chebyshev.chebfit(u, place, degree - 4)
        return float(np.abs(np.polynomial.chebyshev.chebval(u, fitted).T - place).max())

    largest = np.abs(curve(np.linspace(-3, 30, 3001), 4)).max()
    assert max(misfit(a, b) for a, b in itertools.pairwise(edges)) < 1e-11 * largest
    inside = [k for k in range(1, len(edges) - 1) if edges[k] < 25.0]
    assert sum(misfit(edges[k - 1], edges[k + 1]) > 1e-9 * largest for k in inside) > 0.9 * len(inside)


@pytest.mark.parametrize("curve", [LOOP, MINIMUM_SNAP_LOOP])
def test_knots_repeat_with_the_period(curve):
    once = knots.knots(curve, 20.0, 20.0 + curve.period)
    again = knots.knots(curve, 20.0 + 5 * curve.period, 20.0 + 6 * curve.period)
    np.testing.assert_allclose(again, once + 5 * curve.period, rtol=1e-14)
    assert len(once) in (len(curve.points), len(curve.points) - 1)
    np.testing.assert_allclose(
        np.sort(np.mod(once, curve.period)), np.sort(np.mod([p.time for p in curve.points], curve.period)), atol=1e-12
    )


def test_a_sum_has_the_knots_of_both_parts_and_those_they_share_once():
    shared = Waypoints(points=(*timed(count=4, end=WAYPOINTS.points[2].time), WAYPOINTS.points[4]))
    both = knots.knots(Sum(base=WAYPOINTS, wiggle=shared), -1.0, 20.0)
    expected = {p.time for p in WAYPOINTS.points} | {p.time for p in shared.points}
    np.testing.assert_allclose(both, sorted(expected), atol=1e-11)
    tones = Multisine(tones=(Tone(axis="x", amplitude=1.0, frequency=3.0),))
    mixed = Sum(base=WAYPOINTS, wiggle=tones)
    np.testing.assert_array_equal(knots.knots(mixed, 0.5, 9.0), knots.knots(WAYPOINTS, 0.5, 9.0))
    assert knots.smooth_bandwidth(mixed, 10.0) == 3.0
    assert knots.smooth_bandwidth(WAYPOINTS, 10.0) == 0.0
    assert not knots.has_pieces(tones)
    assert knots.has_pieces(mixed)


@examples
@pytest.mark.parametrize(("first", "length"), [(0.0, 7.3), (3.21, 40.0), (-5.0, 4.9)])
def test_no_stretch_has_more_knots_than_were_promised(signal, first, length):
    assert len(knots.knots(signal, first, first + length)) <= knots.most(signal, length)


@examples
@pytest.mark.parametrize("order", [4, 5])
def test_a_bound_between_knots_holds_on_each_piece_and_not_only_for_all(signal, order):
    if math.isinf(signal.bound(order)) and not knots.has_pieces(signal):
        pytest.skip("nothing bounds this formula")
    t = np.linspace(0.0, 30.0, 4001)
    bounds = knots.bounds_between(signal, order, t)
    sizes = np.linalg.norm(signal(t, order), axis=1)
    assert (sizes <= bounds * (1 + 1e-9) + 1e-12 * sizes.max()).all()
    if np.isfinite(signal.bound(order)):
        assert bounds.max() <= signal.bound(order) * (1 + 1e-9)


@pytest.mark.parametrize("family", [Waypoints, MinimumSnap])
@pytest.mark.parametrize("count", [2, 3, 5, 8, 12, 13, 200])
def test_a_closed_curve_is_scipys_periodic_spline(family, count):
    """The same spline by another system of equations; scipy's loses the more digits the fewer points there are."""
    points = timed(seed=count, count=count, end=float(count))
    curve = family(points=points, period=count + 0.7)
    time = np.array([*(p.time for p in points), points[0].time + curve.period])
    value = np.array([*(p.value for p in points), points[0].value])
    witness = make_interp_spline(time, value, k=family.degree, bc_type="periodic")
    t = np.linspace(0.0, 3 * curve.period, 1001)
    for order in range(family.degree):
        expected = witness(t, nu=order)
        scale = np.abs(expected).max() + 1e-9  # two points and back: a straight there and back has no fifth derivative
        np.testing.assert_allclose(curve(t, order), expected, atol=1e-8 * scale)
    steps = piecewise.jumps(curve.piecewise(), range(family.degree))
    for order in range(family.degree):  # Cᵏ everywhere, the seam included
        size = piecewise.hull(curve.piecewise(), order)
        assert np.abs(steps[:, order]).max() < 1e-9 * size + 1e-9
