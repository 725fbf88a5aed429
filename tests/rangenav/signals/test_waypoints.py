"""Waypoints and minimum snap: through the points, at rest at the ends, least among all; edits give new values."""

import math
import re
import time

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rangenav import preset
from rangenav.signals import MinimumSnap, Waypoint, Waypoints, piecewise, polynomials, waypoints
from tests.support.signal_examples import LOOP, MINIMUM_SNAP, MINIMUM_SNAP_LOOP, WAYPOINTS, timed

families = pytest.mark.parametrize("curve", [WAYPOINTS, LOOP, MINIMUM_SNAP, MINIMUM_SNAP_LOOP])
gaps = st.lists(st.floats(0.3, 3), min_size=1, max_size=12)


@families
def test_a_curve_passes_its_points_at_their_times(curve):
    for point in curve.points:
        np.testing.assert_allclose(curve(np.array(point.time)), point.value, atol=1e-12)
    if curve.period is not None:
        first = curve.points[0]
        for turns in (-1, 1, 3):
            np.testing.assert_allclose(curve(np.array(first.time + turns * curve.period)), first.value, atol=1e-11)


@given(gaps, st.integers(0, 2**32 - 1), st.sampled_from([Waypoints, MinimumSnap]), st.booleans())
def test_any_number_of_points_from_two_on_will_do(gaps, seed, family, closed):
    rng = np.random.default_rng(seed)
    at = np.concatenate([[0.0], np.cumsum(gaps)])
    points = tuple(Waypoint(time=float(t), value=tuple(rng.normal(size=3).tolist())) for t in at)
    curve = family(points=points, period=float(at[-1] + 1) if closed else None)
    assert np.abs(curve(at) - [point.value for point in points]).max() < 1e-8


@pytest.mark.parametrize(("curve", "order"), [(WAYPOINTS, 4), (MINIMUM_SNAP, 3)])
def test_an_open_curve_starts_and_ends_at_rest_and_holds(curve, order):
    first, last = curve.points[0], curve.points[-1]
    for k in range(1, order + 1):
        scale = np.linalg.norm(curve(np.linspace(0, 12, 500), k), axis=1).max()
        for point in (first, last):
            assert np.linalg.norm(curve(np.array(point.time), k)) < 1e-9 * scale
    outside = np.array([-1.0, first.time - 1e-6, last.time + 1e-6, 1e4])
    values = np.array([first.value, first.value, last.value, last.value])
    np.testing.assert_allclose(curve(outside), values, atol=1e-12)
    for k in range(1, 6):
        np.testing.assert_array_equal(curve(outside, k), 0.0)


@pytest.mark.parametrize(("family", "least"), [(Waypoints, 5), (MinimumSnap, 4)])
def test_with_free_ends_the_curve_is_in_motion_at_its_ends_and_its_energy_is_less_still(family, least):
    """The natural end conditions, and the energy of the curve that is at rest at its ends as the witness."""
    points = WAYPOINTS.points
    free, rest = family(points=points, free_ends=True), family(points=points)
    for point in points:
        np.testing.assert_allclose(free(np.array(point.time)), point.value, atol=1e-9)
    ends = np.array([points[0].time, points[-1].time - 1e-9])
    assert np.linalg.norm(free(ends, 1), axis=-1).min() > 0.1
    t = np.linspace(points[0].time, points[-1].time, 20_001)
    for order in range(least, 2 * least - 1):
        assert np.abs(free(ends, order)).max() < 1e-6 * np.abs(free(t, order)).max()
    energy = [float(np.sum(curve(t, least) ** 2)) for curve in (free, rest)]
    assert energy[0] < energy[1]
    with pytest.raises(ValueError, match="a curve with a period has no free ends"):
        family(points=points, period=100.0, free_ends=True)


@pytest.mark.parametrize(("curve", "order"), [(WAYPOINTS, 5), (MINIMUM_SNAP, 4)])
def test_the_curve_has_the_least_energy_of_its_derivative_among_those_through_the_points(curve, order):
    """Any bump that keeps points and ends adds energy: the integral of the square, to second order and no first."""
    pieces = curve.piecewise()
    middle = (pieces.knots[2] + pieces.knots[3]) / 2
    half = (pieces.knots[3] - pieces.knots[2]) / 2
    u, weight = np.polynomial.legendre.leggauss(40)
    bump = np.polynomial.Polynomial([1, 0, -1]) ** order  # vanishes with order − 1 derivatives at both knots
    added, there = bump.deriv(order)(u), curve(middle + half * u, order)[:, 0]
    cross, size = np.sum(weight * added * there), np.sum(weight * np.abs(added * there))
    assert abs(cross) < 1e-10 * size


def test_minimum_snap_is_the_solution_of_the_quadratic_programme():
    """Independent witness: eight free coefficients per piece, continuity as constraints, one dense KKT system."""
    curve = MinimumSnap(points=timed(seed=5, count=4, end=3.0))
    at = np.array([point.time for point in curve.points])
    value = np.array([point.value for point in curve.points])[:, 0]
    length = np.diff(at)
    rows, right = [], []

    def derivative(order, tau):
        return np.array([math.perm(j, order) * tau ** (j - order) if j >= order else 0.0 for j in range(8)])

    def row(entries):
        full = np.zeros(8 * len(length))
        for piece, values in entries:
            full[8 * piece : 8 * piece + 8] += values
        return full

    for m, h in enumerate(length):
        rows += [row([(m, derivative(0, 0.0))]), row([(m, derivative(0, h))])]
        right += [value[m], value[m + 1]]
        for order in (1, 2, 3):
            if m == 0:
                rows.append(row([(0, derivative(order, 0.0))]))
            if m == len(length) - 1:
                rows.append(row([(m, derivative(order, h))]))
            else:
                rows.append(row([(m, derivative(order, h)), (m + 1, -derivative(order, 0.0))]))
            right += [0.0] * (1 + (m == 0))
    nodes, weight = np.polynomial.legendre.leggauss(8)
    H = np.zeros((8 * len(length), 8 * len(length)))
    for m, h in enumerate(length):
        for x, w in zip(nodes, weight, strict=True):
            snap = derivative(4, (x + 1) / 2 * h)
            H[8 * m : 8 * m + 8, 8 * m : 8 * m + 8] += w * h / 2 * np.outer(snap, snap)
    C, d = np.array(rows), np.array(right)
    system = np.block([[2 * H, C.T], [C, np.zeros((len(d), len(d)))]])
    solution = np.linalg.lstsq(system, np.concatenate([np.zeros(len(H)), d]), rcond=None)[0][: len(H)].reshape(-1, 8)
    np.testing.assert_allclose(curve.piecewise().tables[0][:, :, 0].T, solution, atol=1e-7)


REFUSALS = [
    ((0.0,), None, "2 to 2000 waypoints make a path, got 1"),
    ((), None, "2 to 2000 waypoints make a path, got 0"),
    (tuple(range(3000)), None, "2 to 2000 waypoints make a path, got 3000"),
    ((0.0, 1.0, 1.0, 2.0), None, "waypoint 3 at 1 s must come at least 0.001 s after waypoint 2 at 1 s"),
    ((0.0, 2.0, 1.0), None, "waypoint 3 at 1 s must come at least 0.001 s after waypoint 2 at 2 s"),
    ((0.0, 1.0, 2.0), 2.0, "period must exceed the 2 s from the first waypoint to the last, got 2 s"),
    ((0.0, 1.0, 2.0), -5.0, "period must lie between 0 and 10000 s, got -5"),
    ((0.0, 2e4), None, "time must lie between 0 and 10000 s, got 20000"),
    ((-1.0, 2.0), None, "time must lie between 0 and 10000 s, got -1"),
]


@pytest.mark.parametrize("family", [Waypoints, MinimumSnap])
@pytest.mark.parametrize(("times", "period", "sentence"), REFUSALS)
def test_times_that_make_no_path_are_refused_by_number(family, times, period, sentence):
    with pytest.raises(ValueError, match=re.escape(sentence)):
        family(points=tuple(Waypoint(time=float(t), value=(float(t), 0.0, 1.0)) for t in times), period=period)


def test_hopelessly_uneven_times_are_refused_and_not_drawn():
    times = (0.0, 1e-3, 2e-3, 5000.0, 5000.001, 10000.0)
    points = tuple(Waypoint(time=t, value=(float(k % 2), 1.0, 0.0)) for k, t in enumerate(times))
    with pytest.raises(ValueError, match="their times are too uneven"):
        Waypoints(points=points)


def test_coincident_points_are_allowed_and_a_curve_through_one_place_stands_still():
    twice = Waypoints(points=(*timed(count=2, end=1.0), Waypoint(time=2.0, value=timed(count=2, end=1.0)[1].value)))
    assert np.isfinite(twice(np.linspace(0, 2, 50), 4)).all()
    still = Waypoints(points=tuple(Waypoint(time=float(k), value=(1.0, 2.0, 3.0)) for k in range(3)))
    np.testing.assert_array_equal(still(np.linspace(0, 3, 20), 1), 0.0)


def test_two_thousand_waypoints_are_fitted_in_a_fraction_of_a_second():
    began = time.process_time()
    many = Waypoints(points=timed(seed=9, count=2000, end=600.0))
    many(np.linspace(0, 600, 4000), 4)
    assert time.process_time() - began < 1.0


def test_moving_retiming_adding_and_deleting_give_new_values():
    moved = waypoints.move(WAYPOINTS, 2, (9.0, 8.0, 7.0))
    assert moved.points[2].value == (9.0, 8.0, 7.0)
    assert moved.points[:2] + moved.points[3:] == WAYPOINTS.points[:2] + WAYPOINTS.points[3:]
    later = waypoints.retime(MINIMUM_SNAP, 1, MINIMUM_SNAP.points[1].time + 0.1)
    assert type(later) is MinimumSnap
    assert later.points[1].time == MINIMUM_SNAP.points[1].time + 0.1
    more = waypoints.add(WAYPOINTS, Waypoint(time=0.1, value=(0.0, 0.0, 0.0)))
    assert [point.time for point in more.points] == sorted(point.time for point in more.points)
    assert waypoints.delete(more, 1) == WAYPOINTS
    with pytest.raises(ValueError, match=r"waypoint 3 at .* s must come at least 0.001 s after waypoint 2 at 100 s"):
        waypoints.retime(WAYPOINTS, 1, 100.0)
    with pytest.raises(ValueError, match="2 to 2000 waypoints make a path, got 1"):
        waypoints.delete(Waypoints(points=timed(count=2)), 0)


@families
def test_a_waypoint_inserted_between_two_lies_on_the_curve(curve):
    for index in range(len(curve.points)):
        more = waypoints.insert(curve, index)
        assert len(more.points) == len(curve.points) + 1
        new = more.points[index + 1]
        assert new.time > curve.points[index].time
        np.testing.assert_allclose(curve(np.array(new.time)), new.value, atol=1e-12)
        before, after = curve(np.linspace(0, 11, 300)), more(np.linspace(0, 11, 300))
        if index + 1 < len(curve.points) or curve.period is not None:
            assert np.abs(before - after).max() < 0.75 * np.ptp(before)  # a spline through one of its points stays near


def test_hulls_enclose_and_are_not_much_too_large():
    pieces = LOOP.piecewise()
    for order in range(6):
        sampled = np.linalg.norm(LOOP(np.linspace(0, 12, 20001), order), axis=1).max()
        assert sampled <= piecewise.hull(pieces, order) < 4 * sampled


def test_minimum_snap_as_polynomials_is_the_same_curve():
    late = MinimumSnap(points=timed(seed=6, begin=0.7))
    for curve in (MINIMUM_SNAP, MINIMUM_SNAP_LOOP, late):
        same = polynomials.from_minimum_snap(curve)
        t = np.linspace(0, 25, 1234)
        for order in range(5):
            scale = 1 + np.abs(curve(t, order)).max()
            np.testing.assert_allclose(same(t, order), curve(t, order), atol=1e-9 * scale)
    with pytest.raises(ValueError, match=r"a curve must begin at t = 0, not at 0.5 s"):
        polynomials.from_minimum_snap(MinimumSnap(points=timed(seed=6, begin=0.5), period=20.0))


def test_waypoints_nearer_than_the_imu_samples_are_refused_with_the_rate():
    near = waypoints.add(WAYPOINTS, Waypoint(time=WAYPOINTS.points[1].time + 2e-3, value=WAYPOINTS.points[1].value))
    with pytest.raises(ValueError, match=r"path: .* is faster than the IMU can sample"):
        msgspec.structs.replace(preset.load("soft"), path=near)
