"""The complementary filter: direction of its correction, speed of its decay, equilibria, order of its steps."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from rangenav import attitude, preset, so3
from rangenav.attitude import AttitudeGains, Schedule
from rangenav.motion import World
from rangenav.signals import Flown
from tests.support.refusals import exactly

EPS = np.finfo(float).eps
WORLD = World()
GAINS = AttitudeGains()
SPIN = preset.load("paper").angular_velocity
assert not isinstance(SPIN, Flown)
START = so3.exp(np.array([0.0, np.pi / 2, 0.0]))

vectors = st.tuples(*[st.floats(-2, 2)] * 3).map(np.array)
gains = st.builds(AttitudeGains, k1=st.floats(0.1, 20), rho1=st.floats(0.05, 5), rho2=st.floats(0.001, 0.1))


def body(rotation, vector):
    return rotation.T @ np.asarray(vector)


def filtered(error, h, steps, *, chosen=GAINS, world=WORLD, spin: Callable[[np.ndarray], np.ndarray] = SPIN):
    """R̃ after each step of a filter that starts with R̃ = error, with exact measurements of a vehicle that turns."""
    R, estimate, misaligned, result = START, error.T @ START, attitude.MISALIGNED, [error]
    for k in range(steps):
        time = np.array([k * h, (k + 0.5) * h, (k + 1) * h])
        gyro = spin(time)
        R_next = R @ so3.exp(h * gyro[1])  # the vehicle itself: turning by the mean rate of the step is all it does
        ends = (R, R_next)
        estimate, misaligned = attitude.step(
            estimate,
            misaligned,
            (gyro[1], gyro[1]),
            (body(ends[0], world.magnetic), body(ends[1], world.magnetic)),
            (body(ends[0], world.gravity), body(ends[1], world.gravity)),
            h,
            gains=chosen,
            world=world,
        )
        R = R_next
        result.append(R @ estimate.T)
    return np.array(result)


def misalignment(error, M):
    """tr(M(I − R̃)): zero at R̃ = I only, the function that proves the filter's stability."""
    return float(np.trace(M @ (np.eye(3) - error)))


@settings(max_examples=50)
@given(vectors, gains)
def test_the_correction_turns_the_estimate_towards_the_truth(w, chosen):
    error = so3.exp(w)
    M = attitude.decay_matrix(chosen, WORLD)
    estimate = error.T @ START
    sigma = attitude.innovation(
        estimate, body(START, WORLD.magnetic), body(START, WORLD.gravity), gains=chosen, world=WORLD
    )
    # R̂ → R̂ exp(ε σ): the derivative of tr(M(I − R̃)) at ε = 0 is −|σ|²
    epsilon = 1e-5 / (1 + np.linalg.norm(sigma))
    moved = [START @ (estimate @ so3.exp(sign * epsilon * sigma)).T for sign in (-1, 1)]
    slope = (misalignment(moved[1], M) - misalignment(moved[0], M)) / (2 * epsilon)
    expected = -float(sigma @ sigma)
    # rounding of values up to tr M over ε, and the truncation of ε²
    assert slope == pytest.approx(expected, rel=1e-6, abs=1e-9 * np.trace(M) * (1 + np.linalg.norm(sigma)))


def test_a_small_error_about_any_axis_shrinks_in_the_next_step():
    for axis in np.vstack([np.eye(3), -np.eye(3), [[0.6, 0.0, 0.8]]]):
        errors = so3.angle(filtered(so3.exp(0.1 * axis), 0.005, 20))
        assert np.all(np.diff(errors) < 0)


@pytest.mark.parametrize("chosen", [GAINS, AttitudeGains(k1=2.0, rho1=0.5, rho2=0.02)], ids=["default", "other"])
def test_small_errors_decay_with_the_eigenvalues_of_k1_tr_m_minus_m(chosen):
    _, axes = np.linalg.eigh(attitude.decay_matrix(chosen, WORLD))
    constants = attitude.time_constants(chosen, WORLD)[
        ::-1
    ]  # eigenvalue λ of M decays with tr M − λ: largest λ slowest
    measured = []
    for axis in axes.T:
        h, steps = 1e-3, 300
        error = so3.log(filtered(so3.exp(1e-4 * axis), h, steps, chosen=chosen))
        time = np.arange(steps + 1) * h
        measured.append(-1 / np.polyfit(time, np.log(np.linalg.norm(error, axis=-1)), 1)[0])
        # the error stays on its axis, because that is an eigenvector
        assert np.abs(error[-1] - (error[-1] @ axis) * axis).max() < 1e-3 * np.linalg.norm(error[-1])
    # Heun's own error is (h/T)²/6 per T, and the error of 1e-4 rad is linear to 1e-8
    np.testing.assert_allclose(measured, constants, rtol=1e-4)


def test_the_printed_error_equation_is_slower_by_the_factor_two():
    derived = attitude.time_constants(GAINS, WORLD)
    np.testing.assert_array_equal(attitude.time_constants(GAINS, WORLD, "printed"), 2 * derived)


@given(gains)
def test_time_constants_come_slowest_first_and_follow_from_the_angle_between_m_and_g(chosen):
    """M has rank two: with α = ρ1, β = ρ2|g|² and angle 45°, its eigenvalues are 0 and (α + β ± √(α² + β²))/2."""
    a, b = chosen.rho1, chosen.rho2 * 9.81**2
    root = math.hypot(a, b)
    eigenvalues = np.array([(a + b + root) / 2, (a + b - root) / 2, 0.0])
    expected = 1 / (chosen.k1 * (a + b - eigenvalues))
    np.testing.assert_allclose(attitude.time_constants(chosen, WORLD), expected, rtol=1e-11)
    assert np.all(np.diff(expected) <= 0)


def test_orthogonal_m_and_g_decay_with_their_own_weights():
    world = World(magnetic=(1.0, 0.0, 0.0))
    chosen = AttitudeGains(k1=2.0, rho1=1.0, rho2=0.05)
    rates = 2.0 * np.array([1.0, 0.05 * 9.81**2, 1.0 + 0.05 * 9.81**2])
    np.testing.assert_allclose(attitude.time_constants(chosen, world), 1 / np.sort(rates), rtol=1e-12)


@given(gains)
def test_the_undesired_equilibria_are_half_turns_about_the_eigenvectors_of_m(chosen):
    M = attitude.decay_matrix(chosen, WORLD)
    for error in attitude.equilibria(chosen, WORLD):
        np.testing.assert_allclose(error.T @ error, np.eye(3), atol=10 * EPS)
        assert np.linalg.det(error) == pytest.approx(1, abs=10 * EPS)
        assert so3.angle(error) == pytest.approx(np.pi, abs=10 * EPS)
        axis = so3.log(error) / np.pi
        np.testing.assert_allclose(M @ axis, (axis @ M @ axis) * axis, atol=100 * EPS * np.trace(M))


@given(gains)
def test_at_an_equilibrium_the_correction_vanishes(chosen):
    for error in [np.eye(3), *attitude.equilibria(chosen, WORLD)]:
        sigma = attitude.innovation(
            error.T @ START, body(START, WORLD.magnetic), body(START, WORLD.gravity), gains=chosen, world=WORLD
        )
        np.testing.assert_allclose(sigma, 0, atol=100 * EPS * (chosen.rho1 + chosen.rho2 * 9.81**2))


@given(gains)
def test_the_printed_equilibria_are_reflections_and_no_rotations(chosen):
    printed = attitude.equilibria(chosen, WORLD, "printed")
    np.testing.assert_allclose(np.linalg.det(printed), -1, atol=10 * EPS)
    np.testing.assert_array_equal(printed, -attitude.equilibria(chosen, WORLD))


@pytest.mark.parametrize("which", [0, 1, 2])
def test_undesired_equilibria_are_left_slowly_but_left(which):
    """Almost global: 0.01 rad away from a half turn the filter lingers, and still ends at the truth."""
    error = attitude.equilibria(GAINS, WORLD)[which] @ so3.exp(np.array([0.006, -0.004, 0.007]))
    angles = so3.angle(filtered(error, 0.02, 800))
    assert angles[5] > 2.9  # a tenth of a second later hardly anything has happened
    assert angles[-1] < 1e-3


PLAN = Schedule(steady=0.3, halfway=0.2, memory=0.4)
"""Changes k1 much and fast, so that an error in its law would show."""


@pytest.mark.parametrize("chosen", [GAINS, AttitudeGains(k1=8.0, schedule=PLAN)], ids=["constant", "scheduled"])
def test_steps_converge_with_order_two_to_the_integrated_filter(chosen):
    """Against Ṙ̂ = R̂ [ω + k1σ]x, ṡ = (c − s)/memory by DOP853, with a vehicle that turns by a known rotation."""
    axis_rate = np.array([0.7, -1.1, 0.4])
    start_estimate = so3.exp(np.array([0.5, 1.0, -0.7]))

    def truth(t):
        return START @ so3.exp(axis_rate * t)

    def measured(t):
        R = truth(t)
        return body(R, WORLD.magnetic), body(R, WORLD.gravity)

    def rate(t, r):
        estimate, s, plan = r[:9].reshape(3, 3), r[9], chosen.schedule or PLAN
        (m, g), M = measured(t), attitude.decay_matrix(chosen, WORLD)
        expected = estimate.T @ np.asarray(WORLD.magnetic), estimate.T @ np.asarray(WORLD.gravity)
        sigma = chosen.rho1 * np.cross(m, expected[0]) + chosen.rho2 * np.cross(g, expected[1])
        # exact vectors: the disagreement is tr(M(I − R̃))/tr M
        disagreement = misalignment(truth(t) @ estimate.T, M) / np.trace(M)
        high = s**2 / (s**2 + plan.halfway**2)
        k1 = chosen.k1 if chosen.schedule is None else chosen.k1**high * plan.steady ** (1 - high)
        return np.append((estimate @ so3.hat(axis_rate + k1 * sigma)).ravel(), (disagreement - s) / plan.memory)

    first = np.append(start_estimate.ravel(), attitude.MISALIGNED)
    witness = solve_ivp(rate, (0, 0.8), first, method="DOP853", rtol=1e-12, atol=1e-12)
    exact = witness.y[:9, -1].reshape(3, 3)
    counts, errors = np.array([40, 80, 160, 320]), []
    for count in counts:
        estimate, s, h = start_estimate, attitude.MISALIGNED, 0.8 / count
        for k in range(count):
            (m0, g0), (m1, g1) = measured(k * h), measured((k + 1) * h)
            estimate, s = attitude.step(
                estimate, s, (axis_rate, axis_rate), (m0, m1), (g0, g1), h, gains=chosen, world=WORLD
            )
        errors.append(float(so3.angle(exact.T @ estimate)))
    assert -np.polyfit(np.log(counts), np.log(errors), 1)[0] >= 1.9
    assert errors[-1] < 1e-4


@given(vectors, gains)
def test_exact_vectors_disagree_by_the_function_that_proves_stability(w, chosen):
    """c = tr(M(I − R̃))/tr M: zero at the truth only, and not at the half turns at which σ vanishes."""
    M = attitude.decay_matrix(chosen, WORLD)
    for error in (so3.exp(w), np.eye(3), *attitude.equilibria(chosen, WORLD)):
        seen = attitude.disagreement(
            error.T @ START, body(START, WORLD.magnetic), body(START, WORLD.gravity), gains=chosen, world=WORLD
        )
        assert seen == pytest.approx(misalignment(error, M) / np.trace(M), abs=100 * EPS)


@given(st.tuples(*[st.floats(-1e6, 1e6)] * 3).map(np.array), gains)
def test_however_wrong_gravity_is_the_disagreement_stays_between_zero_and_two(gravity, chosen):
    seen = attitude.disagreement(START, body(START, WORLD.magnetic), gravity, gains=chosen, world=WORLD)
    assert -10 * EPS <= seen <= 2


@given(st.lists(st.floats(0, 2), min_size=2, max_size=2).map(sorted), st.floats(1, 1000), st.floats(0.001, 1))
def test_a_scheduled_gain_rises_with_misalignment_from_its_lower_to_its_upper_end(misaligned, high, low):
    chosen = AttitudeGains(k1=high, schedule=Schedule(steady=low, halfway=0.05))
    less, more = (attitude.gain(chosen, s) for s in misaligned)
    assert low <= less <= more * (1 + 4 * EPS) <= high * (1 + 8 * EPS)
    assert attitude.gain(chosen, 0.0) == low
    assert attitude.gain(chosen, 0.05) == pytest.approx(math.sqrt(low * high), rel=1e-12)


def test_time_constants_under_a_schedule_are_those_of_its_lower_end():
    constant = attitude.time_constants(AttitudeGains(k1=0.5), WORLD)
    np.testing.assert_array_equal(
        attitude.time_constants(AttitudeGains(schedule=Schedule(steady=0.5)), WORLD), constant
    )


def test_a_raw_weight_of_one_on_gravity_is_stiff_at_thirty_milliseconds_and_the_normalised_one_is_not():
    """ρ2 = 1 multiplies |g|² ≈ 96: the fastest rate is 380 per second, eleven times what a 30 ms step can follow."""
    raw, normalised = AttitudeGains(rho2=1.0), AttitudeGains(rho2=1 / 9.81**2)
    h, steps = 0.03, 167
    assert h / attitude.time_constants(raw, WORLD)[-1] > 10
    assert h / attitude.time_constants(normalised, WORLD)[-1] < 0.3
    error = so3.exp(np.array([0.0, 1.0, 0.3]))
    assert np.degrees(so3.angle(filtered(error, h, steps, chosen=normalised))[-1]) < 0.1
    tail = np.degrees(so3.angle(filtered(error, h, steps, chosen=raw))[-30:])
    assert tail.max() > 5  # never settles below 5°


def test_the_estimate_stays_a_rotation():
    last = filtered(so3.exp(np.array([1.0, -2.0, 0.5])), 0.005, 500)[-1]
    np.testing.assert_allclose(last.T @ last, np.eye(3), atol=500 * 4 * EPS)


@pytest.mark.parametrize(
    ("fields", "sentence"),
    [
        ({"k1": 0.0}, "k1 must lie between 0.001 and 1000, got 0"),
        ({"k1": -4.0}, "k1 must lie between 0.001 and 1000, got -4"),
        ({"rho1": 1e-7}, "rho1 must lie between 1e-06 and 1000, got 1e-07"),
        ({"rho2": 1e4}, "rho2 must lie between 1e-06 and 1000, got 10000"),
        ({"rho2": math.nan}, "rho2 must be a finite number, got nan"),
        ({"schedule": Schedule(steady=4.5)}, "schedule.steady must not exceed k1 (4), got 4.5"),
    ],
)
def test_gains_outside_their_limits_are_refused_in_one_sentence(fields, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        AttitudeGains(**fields)


@pytest.mark.parametrize(
    ("fields", "sentence"),
    [
        ({"steady": 0.0}, "steady must lie between 0.001 and 1000, got 0"),
        ({"halfway": 2.0}, "halfway must lie between 0.0001 and 1, got 2"),
        ({"memory": 1e-4}, "memory must lie between 0.001 and 100 s, got 0.0001"),
        ({"memory": math.inf}, "memory must be a finite number, got inf"),
    ],
)
def test_a_schedule_outside_its_limits_is_refused_in_one_sentence(fields, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        Schedule(**fields)
