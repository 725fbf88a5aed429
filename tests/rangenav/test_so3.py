"""Rotations against scipy's Rotation, the matrix exponential, and 40-digit arithmetic where series take over."""

import mpmath
import numpy as np
import pytest
import scipy.linalg
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from rangenav import so3

EPS = np.finfo(float).eps
UNITS = ((1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.6, 0.0, -0.8), (2 / 3, -1 / 3, 2 / 3), (-0.36, 0.48, 0.8))
BOTH_SIDES_OF_THE_SERIES = tuple(so3.SMALL_ANGLE * f for f in (1e-6, 0.1, 0.5, 0.9, 0.999999, 1.000001, 1.1, 2.0, 10.0))

vectors = st.tuples(*[st.floats(-10, 10)] * 3).map(np.array)
turns = vectors.filter(lambda w: np.linalg.norm(w) < 3.1)


def exact(unit, angle):
    """Rodrigues' formula for a double-precision vector angle·unit, evaluated with 40 digits and then rounded."""
    with mpmath.workdps(40):
        w = [mpmath.mpf(float(angle * u)) for u in unit]
        theta = mpmath.sqrt(sum(c * c for c in w))
        W = mpmath.matrix([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])
        a, b = mpmath.sin(theta) / theta, (1 - mpmath.cos(theta)) / theta**2
        R = mpmath.eye(3) + a * W + b * W * W
        return np.array(w, dtype=float), np.array(R.tolist(), dtype=float)


@given(vectors, vectors)
def test_hat_is_the_cross_product_and_vee_undoes_it(w, u):
    np.testing.assert_allclose(so3.hat(w) @ u, np.cross(w, u), atol=200 * EPS)  # products up to 100, rounded or fused
    np.testing.assert_array_equal(so3.vee(so3.hat(w)), w)


@given(vectors, st.lists(st.floats(-5, 5), min_size=9, max_size=9))
def test_vee_of_any_matrix_is_the_vector_of_its_skew_part(w, entries):
    symmetric = np.reshape(entries, (3, 3))
    symmetric = symmetric + symmetric.T
    # one rounding when the parts are added and one when they are told apart, of numbers up to 30
    np.testing.assert_allclose(so3.vee(so3.hat(w) + symmetric), w, atol=30 * 2 * EPS)


@given(vectors)
def test_exp_is_scipys_rotation_from_the_same_vector(w):
    # sin and cos of the angle θ inherit the error θ·eps of |w|
    np.testing.assert_allclose(so3.exp(w), Rotation.from_rotvec(w).as_matrix(), atol=4 * EPS * (1 + np.linalg.norm(w)))


@given(vectors)
def test_exp_is_the_matrix_exponential_of_hat(w):
    # Padé with squaring loses a few units per squaring, and norms up to 17 take five
    np.testing.assert_allclose(so3.exp(w), scipy.linalg.expm(so3.hat(w)), atol=1e-13)


@given(vectors)
def test_exp_is_orthogonal_with_determinant_one(w):
    R = so3.exp(w)
    np.testing.assert_allclose(R.T @ R, np.eye(3), atol=8 * EPS)
    assert np.linalg.det(R) == pytest.approx(1, abs=8 * EPS)


@pytest.mark.parametrize("angle", BOTH_SIDES_OF_THE_SERIES)
@pytest.mark.parametrize("unit", UNITS)
def test_exp_keeps_machine_precision_on_both_sides_of_the_series(unit, angle):
    w, R = exact(unit, angle)
    computed = so3.exp(w)
    np.testing.assert_allclose(computed, R, rtol=0, atol=2 * EPS)  # two roundings of entries near one
    np.testing.assert_allclose(
        so3.vee(computed), so3.vee(R), rtol=0, atol=4 * EPS * angle
    )  # and relative for the small part


@pytest.mark.parametrize("angle", BOTH_SIDES_OF_THE_SERIES)
@pytest.mark.parametrize("unit", UNITS)
def test_log_keeps_machine_precision_on_both_sides_of_the_series(unit, angle):
    w, R = exact(unit, angle)
    np.testing.assert_allclose(
        so3.log(R), w, rtol=0, atol=4 * EPS * angle
    )  # R is rounded once, the quotient a few times


@pytest.mark.parametrize("short", [0.2, 0.1 + 1e-9, 0.1 - 1e-9, 1e-2, 1e-5, 1e-8, 1e-12, 0.0])
@pytest.mark.parametrize("unit", UNITS)
def test_log_keeps_machine_precision_up_to_half_a_turn(unit, short):
    w, R = exact(unit, np.pi - short)
    computed = so3.log(R)
    if short < 1e-7:  # the sign of the axis is then written in entries of the size of rounding
        computed = computed * np.sign(computed @ w)
    # entries of R carry eps; the switch at π − 0.1 is where the fading skew part has lost a factor of ten
    np.testing.assert_allclose(computed, w, rtol=0, atol=20 * np.pi * EPS)


@given(turns)
def test_log_undoes_exp_and_both_agree_with_scipy(w):
    R = so3.exp(w)
    # 1/sin θ amplifies rounding up to the switch at π − 0.1 tenfold
    np.testing.assert_allclose(so3.log(R), w, atol=40 * EPS)
    np.testing.assert_allclose(so3.log(R), Rotation.from_matrix(R).as_rotvec(), atol=80 * EPS)


@given(vectors)
def test_exp_undoes_log_whatever_the_number_of_whole_turns(w):
    R = so3.exp(w)
    r = so3.log(R)
    assert np.linalg.norm(r) <= np.pi + 4 * EPS
    np.testing.assert_allclose(so3.exp(r), R, atol=80 * EPS)


@given(vectors, vectors)
def test_rotating_the_axis_is_conjugating_the_rotation(w, r):
    R = so3.exp(r)
    np.testing.assert_allclose(so3.exp(R @ w), R @ so3.exp(w) @ R.T, atol=1e-13)  # six products of errors |w| eps


@pytest.mark.parametrize("angle", [1e-12, 1e-7, 1e-3, 1.0, 3.0])
@pytest.mark.parametrize("unit", UNITS)
def test_angle_is_accurate_where_the_arc_cosine_of_the_trace_is_not(unit, angle):
    _, R = exact(unit, angle)
    assert so3.angle(R) == pytest.approx(angle, rel=8 * EPS)


@pytest.mark.parametrize("short", [1e-12, 1e-7, 1e-3])
def test_angle_is_accurate_at_half_a_turn(short):
    _, R = exact(UNITS[3], np.pi - short)
    assert np.pi - so3.angle(R) == pytest.approx(short, abs=4 * EPS)  # π itself is only known to eps


@given(turns)
def test_angle_is_the_length_of_the_logarithm(w):
    assume(np.linalg.norm(w) > 1e-9)
    assert so3.angle(so3.exp(w)) == pytest.approx(np.linalg.norm(w), rel=20 * EPS)


def test_stacks_of_any_shape_are_handled_entry_by_entry():
    w = np.random.default_rng(0).normal(size=(2, 4, 3)) * np.array([1e-3, 1.0, 2.0, 1e-9])[:, None]
    R = so3.exp(w)
    assert R.shape == (2, 4, 3, 3)
    for i in np.ndindex(2, 4):
        np.testing.assert_array_equal(R[i], so3.exp(w[i]))
        np.testing.assert_array_equal(so3.log(R)[i], so3.log(R[i]))
        np.testing.assert_array_equal(so3.angle(R)[i], so3.angle(R[i]))


def test_no_rotation_is_exactly_the_identity():
    np.testing.assert_array_equal(so3.exp(np.zeros(3)), np.eye(3))
    np.testing.assert_array_equal(so3.log(np.eye(3)), np.zeros(3))
