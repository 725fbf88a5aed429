"""Piecewise polynomials: one-sided at knots, jumps reported, files that others wrote read as they are."""

import math
import re

import msgspec
import numpy as np
import pytest

from rangenav import preset
from rangenav.analysis import analyse
from rangenav.signals import Piece, Polynomials, polynomials, slowed
from tests.support.signal_examples import POLYNOMIALS, polynomial_file

STEP = Polynomials(
    pieces=(
        Piece(duration=1.0, x=(0, 1, 0, 0, 0, 0, 0, 0), yaw=(0.5, 0, 0, 0, 0, 0, 0, 0)),
        Piece(duration=2.0, x=(1.25, 1, 0, 0, 0, 0, 0, 0), y=(0, 0.5, 0, 0, 0, 0, 0, 0)),
        Piece(duration=0.5, x=(3.25, 1, 0, 0, 0, 0, 0, 0), y=(1, 0.5, 0.25, 0, 0, 0, 0, 0)),
    )
)


def test_values_are_those_of_the_polynomial_in_local_time():
    rng = np.random.default_rng(0)
    table = rng.normal(size=(4, 3, 8))
    length = rng.uniform(0.5, 2, 4)
    pieces = tuple(
        Piece(duration=float(h), x=tuple(x.tolist()), y=tuple(y.tolist()), z=tuple(z.tolist()))
        for h, (x, y, z) in zip(length, table, strict=True)
    )
    signal, start = Polynomials(pieces=pieces), 0.0
    for h, axes in zip(length, table, strict=True):
        t = np.linspace(start, start + h, 9)[:-1]
        for order in range(9):
            for k, coefficients in enumerate(axes):
                witness = np.polynomial.Polynomial(coefficients).deriv(order)(t - start) if order else None
                witness = np.polynomial.Polynomial(coefficients)(t - start) if witness is None else witness
                np.testing.assert_allclose(signal(t, order)[:, k], witness, rtol=1e-9, atol=1e-9 * math.factorial(8))
        start += h


def test_at_a_knot_the_piece_that_begins_there_is_meant_and_at_the_end_the_last():
    at = np.array([1.0, 3.0, 3.5])
    np.testing.assert_array_equal(STEP(at)[:, 0], [1.25, 3.25, 3.75])
    np.testing.assert_array_equal(STEP(at, 1)[:, 1], [0.5, 0.5, 0.75])
    np.testing.assert_array_equal(STEP(np.array([-1.0, 4.0]), 1), 0.0)
    np.testing.assert_array_equal(STEP(np.array([-1.0, 4.0]))[:, 0], [0.0, 3.75])


def test_jumps_are_reported_at_every_knot_and_the_worst_named():
    computed = polynomials.jumps(STEP)
    np.testing.assert_array_equal(computed.time, [0, 1, 3, 3.5])
    np.testing.assert_allclose(computed.step[1, 0], [0.25, 0, 0])
    np.testing.assert_allclose(computed.step[1, 1], [0, 0.5, 0])
    np.testing.assert_allclose(computed.step[2, 2], [0, 0.5, 0])
    assert polynomials.complaints(STEP) == (
        "position jumps by 0.25 m along x at t = 1.00 s",
        "acceleration jumps by 0.5 m/s² along y at t = 3.00 s",
    )
    assert polynomials.complaints(msgspec.structs.replace(STEP, ends="repeat"))[0].endswith("at t = 0.00 s")
    assert STEP.bound(1) == math.inf
    assert STEP.bound(0) == pytest.approx(math.hypot(3.75, 1.3125), rel=1e-9)


def test_repeating_the_seam_counts_as_a_knot():
    again = msgspec.structs.replace(STEP, ends="repeat")
    np.testing.assert_allclose(polynomials.jumps(again).step[[0, -1], 0], [[-3.75, -1.3125, 0]] * 2)
    np.testing.assert_allclose(again(np.array([3.5 + 1.2, 7.0 + 1.2])), again(np.array([1.2, 1.2])), atol=1e-12)
    assert again.period == 3.5


def test_a_smooth_one_has_nothing_to_complain_of():
    assert polynomials.complaints(POLYNOMIALS) == ()
    inside = polynomials.jumps(POLYNOMIALS).step[1:-1]
    assert np.abs(inside).max() < 1e-9


def test_slowing_keeps_the_shape_and_the_yaw():
    slow = slowed(STEP, 2.0)
    assert isinstance(slow, Polynomials)
    np.testing.assert_allclose(slow(np.array([1.0, 5.0, 6.9])), STEP(np.array([0.5, 2.5, 3.45])))
    assert slow.pieces[0].yaw == STEP.pieces[0].yaw


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"pieces": ()}, "1 to 2000 pieces make a path, got 0"),
        ({"pieces": STEP.pieces * 700}, "1 to 2000 pieces make a path, got 2100"),
        ({"pieces": (Piece(duration=9e3), Piece(duration=9e3))}, "must last 10000 s at most, got 18000 s"),
        ({"pieces": (Piece(duration=1e4, x=(0, 0, 0, 0, 0, 0, 0, 1)),)}, "the pieces may reach out to 1e+28"),
    ],
)
def test_what_is_no_path_is_refused_in_a_sentence(change, sentence):
    with pytest.raises(ValueError, match=re.escape(sentence)):
        Polynomials(**change)


@pytest.mark.parametrize("duration", [0.0, -1.0, 1e6, math.nan])
def test_durations_of_nothing_or_of_days_are_refused(duration):
    with pytest.raises(ValueError, match="duration must"):
        Piece(duration=duration)


def _analysed(path, duration, window):
    soft = preset.load("soft")
    requirement = msgspec.structs.replace(soft.requirement, window=window)
    return analyse(msgspec.structs.replace(soft, path=path, duration=duration, requirement=requirement))


def test_the_figure_eight_of_crazyswarm2_is_smooth_planar_and_blind():
    path = polynomial_file("cs2_figure8.csv")
    assert len(path.pieces) == 10
    assert polynomials.complaints(path) == ()
    assert polynomials.jumps(path).time[-1] == pytest.approx(7.28, abs=0.01)
    analysed = _analysed(path, 7.28, 5.0)
    assert analysed.mu == 0.0
    assert analysed.rank == 11
    assert any("nothing excites z" in direction.summary for direction in analysed.directions)


def test_the_jump_in_a_file_shipped_with_crazyswarm2_is_named():
    path = polynomial_file("cs2_multi_traj0.csv")
    assert len(path.pieces) == 32
    first, *rest = polynomials.complaints(path)
    assert first.startswith("position jumps by 0.29 m along x at t = 0.96 s")
    assert len(rest) == 2


def test_the_gentle_flight_of_crazyswarm_is_smooth():
    path = polynomial_file("cs1_seq1_19.csv")
    assert polynomials.complaints(path) == ()
    assert np.linalg.norm(path(np.linspace(0, 19, 4000), 4), axis=1).max() <= 2.1
    p = msgspec.structs.replace(preset.load("soft"), path=path, duration=19.0)
    assert preset.loads(preset.dumps(p), source="round trip") == p
