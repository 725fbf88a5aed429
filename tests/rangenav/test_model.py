"""The lifted model against sympy, finite differences along a motion, expm, control's obsv and an integrated Φ."""

import control
import numpy as np
import pytest
import scipy.linalg
import sympy
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from rangenav import model, motion, preset, so3
from rangenav.model import GRAVITY, POSITION, STATES, VELOCITY, XI
from rangenav.observability import rows
from rangenav.signals import Flown

EPS = np.finfo(float).eps
G = 9.81
BLOCKS = (POSITION, VELOCITY, GRAVITY)
P = preset.load("paper-slow")

vectors = st.tuples(*[st.floats(-5, 5)] * 3).map(np.array)
steps = st.floats(-0.5, 0.5)


def turn(rotation):
    """blkdiag(I4, R, R, R), from body axes to axes fixed in inertia."""
    return scipy.linalg.block_diag(np.eye(4), rotation, rotation, rotation)


def vector_symbols(letter):
    return sympy.Matrix(sympy.symbols(f"{letter}0:3"))


def sympy_rates():
    """ẋ(p, v, g, a) of the lifted state from ṗ = v, v̇ = g + a_I alone, by the chain rule, all in one frame."""
    p, v, g, a = (vector_symbols(letter) for letter in "pvga")
    xi = sympy.Matrix([p.dot(p) / 2, p.dot(v), v.dot(v) + p.dot(g), 3 * v.dot(g)])
    xi_rate = xi.jacobian(p) * v + xi.jacobian(v) * (g + a)
    return sympy.lambdify((p, v, g, a), sympy.Matrix([xi_rate, v, g + a, sympy.zeros(3, 1)]), "numpy")


RATES = sympy_rates()


@given(vectors, vectors, vectors, vectors)
def test_the_lifted_dynamics_are_the_chain_rule_applied_to_newton(p, v, g, a):
    A, b = model.dynamics(np.zeros(3), a, gravity_norm=float(np.linalg.norm(g)))
    witness = RATES(p, v, g, a)[:, 0].astype(float)
    np.testing.assert_allclose(A @ model.lift(p, v, g) + b, witness, atol=1000 * EPS)  # sums of products up to 225


@given(vectors, vectors, vectors, vectors, vectors)
def test_in_body_axes_every_vector_also_turns_backwards_and_the_scalars_do_not_notice(p, v, g, a, w):
    A, b = model.dynamics(w, a, gravity_norm=float(np.linalg.norm(g)))
    witness = RATES(p, v, g, a)[:, 0].astype(float)
    for block, vector in zip(BLOCKS, (p, v, g), strict=True):
        witness[block] -= np.cross(w, vector)
    np.testing.assert_allclose(A @ model.lift(p, v, g) + b, witness, atol=2000 * EPS)


def test_the_true_state_obeys_the_model_along_a_turning_motion():
    rate = 2000.0
    truth = motion.simulate(
        P.path, P.angular_velocity, world=P.world, initial_rotation=P.initial_rotation, duration=5.0, rate=rate
    )
    x = model.true_state(truth, world=P.world)
    for k in range(1, len(x) - 1, 997):
        A, b = model.dynamics(truth.angular_velocity[k], truth.apparent_acceleration[k], gravity_norm=G)
        difference = (x[k + 1] - x[k - 1]) * (rate / 2)
        # central difference: (5 rad/s · ½ ms)²/6 of rates up to 300; ξ̇4 is the largest
        np.testing.assert_allclose(A @ x[k] + b, difference, atol=3e-4)


def test_the_true_state_is_relative_to_the_anchor_and_its_first_entry_is_half_the_squared_range():
    p = preset.load("lissajous")
    truth = motion.simulate(
        p.path, p.angular_velocity, world=p.world, initial_rotation=p.initial_rotation, duration=5.0, rate=100.0
    )
    x = model.true_state(truth, world=p.world)
    distance = np.linalg.norm(truth.position - np.asarray(p.world.anchor), axis=-1)
    np.testing.assert_allclose(x[:, 0], distance**2 / 2, rtol=1e-13)
    np.testing.assert_allclose(motion.to_inertial(truth.rotation, x[:, VELOCITY]), truth.velocity, atol=1e-13)
    np.testing.assert_allclose(np.linalg.norm(x[:, GRAVITY], axis=-1), G, rtol=1e-13)


@given(vectors, vectors, vectors, vectors)
def test_the_four_scalars_are_the_same_in_every_frame(p, v, g, r):
    R = so3.exp(r)
    lifted, turned = model.lift(p, v, g), model.lift(R @ p, R @ v, R @ g)
    np.testing.assert_allclose(turned[XI], lifted[XI], atol=2000 * EPS)
    np.testing.assert_allclose(turned, turn(R) @ lifted, atol=2000 * EPS)


@given(vectors, vectors, st.floats(0.1, 100))
def test_the_printed_model_lacks_exactly_twice_the_squared_gravity_in_one_input(w, a, g):
    A, b = model.dynamics(w, a, gravity_norm=g)
    A_printed, b_printed = model.dynamics(w, a, gravity_norm=g, form="printed")
    np.testing.assert_array_equal(A_printed, A)
    expected = np.zeros(STATES)
    expected[3] = 2 * g**2
    np.testing.assert_allclose(b - b_printed, expected, rtol=4 * EPS)


@given(vectors)
def test_without_turning_the_model_is_nilpotent_of_index_five(a):
    A, _ = model.dynamics(np.zeros(3), a, gravity_norm=G)
    np.testing.assert_array_equal(np.linalg.matrix_power(A, model.NILPOTENCY), 0)
    # the chain g → v → p → ξ2 → ξ1 has four links; ξ4 → ξ3 → ξ2 → ξ1 keeps A³ ≠ 0 even in free fall
    assert np.any(np.linalg.matrix_power(A, 4)) == np.any(a)
    assert np.any(np.linalg.matrix_power(A, 3))


@given(vectors, steps, st.sampled_from(["derived", "printed"]))
def test_the_transition_is_the_matrix_exponential(a, h, form):
    A, b = model.dynamics(np.zeros(3), a, gravity_norm=G, form=form)
    augmented = scipy.linalg.expm(np.block([[A * h, (b * h)[:, None]], [np.zeros((1, STATES + 1))]]))
    phi, integral = model.transition(a, h, gravity_norm=G, form=form)
    np.testing.assert_allclose(phi, augmented[:STATES, :STATES], atol=1e-13)  # entries up to 15
    np.testing.assert_allclose(integral, augmented[:STATES, STATES], atol=1e-12)  # and up to 150


@given(vectors, steps, steps)
def test_two_steps_are_one_of_their_sum(a, first, second):
    phi1, integral1 = model.transition(a, first, gravity_norm=G)
    phi2, integral2 = model.transition(a, second, gravity_norm=G)
    phi, integral = model.transition(a, first + second, gravity_norm=G)
    np.testing.assert_allclose(phi2 @ phi1, phi, atol=1e-13)
    np.testing.assert_allclose(phi2 @ integral1 + integral2, integral, atol=1e-12)


@given(vectors, vectors, vectors)
def test_turning_the_axes_with_the_gyro_removes_the_angular_velocity_from_the_model(w, a, r):
    """T = blkdiag(I4, R, R, R), Ṙ = R[ω]x: T𝒜(ω, a)Tᵀ + ṪTᵀ = 𝒜(0, Ra) and T b(a) = b(Ra)."""
    R = so3.exp(r)
    T, T_rate = turn(R), turn(R @ so3.hat(w))
    T_rate[:4, :4] = 0
    A, b = model.dynamics(w, a, gravity_norm=G)
    A_turned, b_turned = model.dynamics(np.zeros(3), R @ a, gravity_norm=G)
    np.testing.assert_allclose(T @ A @ T.T + T_rate @ T.T, A_turned, atol=500 * EPS)
    np.testing.assert_allclose(T @ b, b_turned, atol=500 * EPS)


FROZEN = [
    pytest.param([0.3, -0.5, 0.7], [2.0, 1.0, -9.0], 11, id="generic"),
    pytest.param([1.0, 2.0, 0.0], [-2.0, 1.0, 5.0], 10, id="acceleration across the axis of turning"),
    pytest.param([0.5, -1.0, 1.5], [-1.0, 2.0, -3.0], 5, id="acceleration along the axis of turning"),
    pytest.param([0.0, 0.0, 0.0], [2.0, 1.0, -9.0], 5, id="no turning, as in turned axes"),
    pytest.param([0.3, -0.5, 0.7], [0.0, 0.0, 0.0], 4, id="free fall"),
]


def frozen_observability_matrix(w, a):
    A, _ = model.dynamics(np.array(w), np.array(a), gravity_norm=G)
    return A, control.obsv(A, np.eye(1, STATES))


@pytest.mark.parametrize(("w", "a", "rank"), FROZEN)
def test_a_frozen_moment_is_never_observable(w, a, rank):
    """Ranks of the pair (𝒜(t₀), 𝒞) that mislead: only variation in time makes the system observable."""
    _, matrix = frozen_observability_matrix(w, a)
    largest = np.abs(matrix).max(axis=1, keepdims=True)
    singular = np.linalg.svd(matrix / np.where(largest > 0, largest, 1.0), compute_uv=False)
    assert np.sum(singular > 1e-12 * singular[0]) == rank
    assert singular[rank - 1] > 1e-6 * singular[0]  # a clear gap: the rank is no accident of the tolerance


@pytest.mark.parametrize(("w", "a", "rank"), FROZEN)
def test_the_frozen_ranks_are_those_of_exact_arithmetic(w, a, rank):
    A, _ = frozen_observability_matrix(w, a)
    exact = sympy.Matrix(A).applyfunc(lambda entry: sympy.Rational(str(entry)))
    row, stacked = sympy.eye(STATES)[0, :], []
    for _ in range(STATES):
        stacked.append(row)
        row = row * exact
    assert sympy.Matrix.vstack(*stacked).rank() == rank


@pytest.fixture(scope="module")
def integrated_output_rows():
    """Φ̇ = 𝒜(ω, a)Φ and Ṙ = R[ω]x in body axes from t = 1.3 s, by DOP853: (τ, 𝒞Φ(s,t) turned to inertial axes)."""
    t, g, turning = 1.3, np.asarray(P.world.gravity), P.angular_velocity
    assert not isinstance(turning, Flown)
    tau = np.linspace(0, 3, 13)
    R0 = so3.exp(np.array([0.4, -0.8, 1.1]))

    def rate(s, z):
        R, phi = z[:9].reshape(3, 3), z[9:].reshape(STATES, STATES)
        now = np.array(s)
        w = 3 * turning(now)  # faster turning than the preset's: the rows must not care
        A, _ = model.dynamics(w, R.T @ (P.path(now, 2) - g), gravity_norm=G)
        return np.concatenate([(R @ so3.hat(w)).ravel(), (A @ phi).ravel()])

    z0 = np.concatenate([R0.ravel(), np.eye(STATES).ravel()])
    z = solve_ivp(rate, (t, t + 3), z0, method="DOP853", t_eval=t + tau, rtol=1e-12, atol=1e-12).y
    return t, tau, z[9 : 9 + STATES].T @ turn(R0).T


def test_the_closed_form_row_is_the_first_row_of_the_integrated_transition_turned(integrated_output_rows):
    t, tau, integrated = integrated_output_rows
    closed = rows.lifted(P.path, P.world.gravity, np.array([t]), tau)[0]
    # entries reach 200; the integration keeps ten figures
    np.testing.assert_allclose(closed, integrated, atol=1e-8)


def test_moving_the_anchor_changes_the_range_as_the_row_times_the_change_of_state_says():
    """y(s) = 𝒞Φ(s,t) x(t) + ∫𝒞Φ b: the integral knows no anchor, so only the first part tells two of them apart."""
    t, tau, anchor = np.array(0.7), np.linspace(0, 4, 9), np.array([0.5, -1.0, 2.0])
    g = np.asarray(P.world.gravity)
    row = rows.lifted(P.path, P.world.gravity, t[None], tau)[0]
    change = model.lift(P.path(t) - anchor, P.path(t, 1), g) - model.lift(P.path(t), P.path(t, 1), g)
    half_squares = [np.sum((P.path(t + tau) - origin) ** 2, axis=-1) / 2 for origin in (anchor, np.zeros(3))]
    np.testing.assert_allclose(row @ change, half_squares[0] - half_squares[1], atol=1e-11)  # terms up to 600
