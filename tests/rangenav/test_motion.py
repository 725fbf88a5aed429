"""The truth against integrated equations of motion: DOP853 for the attitude, dead reckoning for the whole plant."""

import math

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

from rangenav import motion, preset, so3
from rangenav.motion import World
from rangenav.signals import Flown, Multisine, Tone

EPS = np.finfo(float).eps
PAPER = preset.load("paper")
TUMBLE = Multisine(
    tones=(
        Tone(axis="x", amplitude=3.0, frequency=2.0, phase=1.0),
        Tone(axis="y", amplitude=2.0, frequency=3.0, phase=0.2),
        Tone(axis="z", amplitude=4.0, frequency=1.0),
    ),
    offset=(0.5, 0.0, -0.3),
)
"""Several turns a second about axes that move: nothing commutes."""
START = np.array([0.3, -1.2, 0.8])

vectors = st.tuples(*[st.floats(-5, 5)] * 3).map(np.array)


def simulated(p, rate=200.0, duration=None):
    return motion.simulate(
        p.path,
        p.angular_velocity,
        world=p.world,
        initial_rotation=p.initial_rotation,
        duration=duration or p.duration,
        rate=rate,
    )


def integrated_rotation(angular_velocity, start, duration):
    """Ṙ = R [ω]x as nine plain equations, which know nothing of the group."""

    def rate(t, r):
        return (r.reshape(3, 3) @ so3.hat(angular_velocity(np.array(t)))).ravel()

    solution = solve_ivp(rate, (0, duration), start.ravel(), method="DOP853", rtol=1e-13, atol=1e-13)
    return solution.y[:, -1].reshape(3, 3)


def test_attitude_converges_with_order_four_to_the_integrated_equation():
    duration, start = 4.0, so3.exp(START)
    truth = integrated_rotation(TUMBLE, start, duration)
    steps = np.array([40, 80, 160, 320])
    last = [motion.integrate(TUMBLE, start, np.linspace(0, duration, n + 1))[-1] for n in steps]
    errors = np.array([so3.angle(truth.T @ R) for R in last])
    slope = -np.polyfit(np.log(steps), np.log(errors), 1)[0]
    assert slope >= 3.9
    assert errors[-1] < 1e-6  # so the regression is about small errors


def test_attitude_turns_exactly_at_constant_angular_velocity():
    spin = Multisine(offset=(0.4, -1.1, 2.0))
    time = np.linspace(0, 10, 101)
    R = motion.integrate(spin, so3.exp(START), time)
    expected = Rotation.from_rotvec(START) * Rotation.from_rotvec(time[:, None] * np.array(spin.offset))
    # 100 products of rotations, each rounded to a few eps
    np.testing.assert_allclose(R, expected.as_matrix(), atol=100 * 4 * EPS)


def test_attitude_stays_a_rotation_over_a_long_record():
    R = motion.integrate(TUMBLE, so3.exp(START), motion.time_grid(600.0, 100.0))
    drift = np.abs(np.swapaxes(R, -1, -2) @ R - np.eye(3)).max()
    assert drift < 60_000 * 4 * EPS / 10  # far from even the linear worst case of 60 000 rounded products
    np.testing.assert_allclose(np.linalg.det(R), 1, atol=1e-11)


@given(st.integers(1, 40), st.integers(0, 2**32 - 1))
def test_cumulative_products_by_doubling_are_those_one_after_another(count, seed):
    factors = so3.exp(np.random.default_rng(seed).normal(size=(count, 3)))
    one_by_one, product = [], np.eye(3)
    for factor in factors:
        product = product @ factor
        one_by_one.append(product)
    np.testing.assert_allclose(motion.cumulative_product(factors), one_by_one, atol=count * 4 * EPS)


def test_the_path_obeys_the_equation_of_motion_with_what_an_accelerometer_feels():
    truth, g = simulated(PAPER), np.asarray(PAPER.world.gravity)
    felt = np.einsum("nij,nj->ni", truth.rotation, truth.apparent_acceleration)
    # v̇ = g + R a; R is orthogonal to 1e-13 and the acceleration reaches 150 m/s²
    np.testing.assert_allclose(g + felt, truth.acceleration, atol=150 * 1e-13)


def test_dead_reckoning_with_the_true_gyro_and_accelerometer_retraces_the_path():
    """ṗ = v, v̇ = g + R a, Ṙ = R [ω]x integrated from the first state: the plant the path was said to come from."""
    truth, g = simulated(PAPER, rate=1000.0, duration=2.0), np.asarray(PAPER.world.gravity)
    gyro, accel = (CubicSpline(truth.time, z) for z in (truth.angular_velocity, truth.apparent_acceleration))

    def rate(t, x):
        R = x[6:].reshape(3, 3)
        return np.concatenate([x[3:6], g + R @ accel(t), (R @ so3.hat(gyro(t))).ravel()])

    x0 = np.concatenate([truth.position[0], truth.velocity[0], truth.rotation[0].ravel()])
    x = solve_ivp(rate, (0, 2.0), x0, method="DOP853", rtol=1e-11, atol=1e-11, max_step=0.01).y[:, -1]
    # the spline's error is (16 rad/s · 1 ms)⁴/384 of 150 m/s², integrated twice over 2 s
    np.testing.assert_allclose(x[:3], truth.position[-1], atol=1e-7)
    np.testing.assert_allclose(x[3:6], truth.velocity[-1], atol=1e-7)
    np.testing.assert_allclose(x[6:].reshape(3, 3), truth.rotation[-1], atol=1e-8)


@pytest.mark.parametrize(
    ("signal", "derivative"),
    [
        ("position", "velocity"),
        ("velocity", "acceleration"),
        ("acceleration", "jerk"),
        ("jerk", "snap"),
        ("angular_velocity", "angular_acceleration"),
    ],
)
def test_each_signal_is_the_rate_of_the_one_before(signal, derivative):
    truth = simulated(PAPER, rate=2000.0, duration=2.0)
    h = truth.time[1]
    values, rates = getattr(truth, signal), getattr(truth, derivative)
    difference = (values[2:] - values[:-2]) / (2 * h)
    # central difference: (16 rad/s · ½ ms)²/6 of the largest rate
    np.testing.assert_allclose(difference, rates[1:-1], atol=1.1e-5 * np.abs(rates).max())


def test_the_initial_rotation_is_the_exponential_of_its_vector():
    truth = simulated(PAPER, duration=1.0)
    np.testing.assert_allclose(
        truth.rotation[0], Rotation.from_rotvec(PAPER.initial_rotation).as_matrix(), atol=2 * EPS
    )


def test_dragging_the_path_does_not_integrate_the_attitude_again():
    moved = msgspec.structs.replace(PAPER, path=Multisine(offset=(1.0, 0.0, 0.0)))
    assert simulated(PAPER).rotation is simulated(moved).rotation
    with pytest.raises(ValueError, match="read-only"):
        simulated(PAPER).rotation[0] = 0.0  # shared, so nobody may write


@given(st.floats(0.5, 100), st.floats(5, 1000))
def test_the_time_grid_starts_at_zero_steps_by_the_rate_and_ends_within_the_duration(duration, rate):
    time = motion.time_grid(duration, rate)
    assert time[0] == 0
    np.testing.assert_array_equal(time, np.arange(len(time)) / rate)
    assert time[-1] <= duration * (1 + 1e-9)
    assert time[-1] + 1 / rate > duration * (1 - 1e-9)


@pytest.mark.parametrize(("duration", "rate", "count"), [(20, 200, 4001), (0.29, 100, 30), (0.7, 10, 8), (1.1, 30, 34)])
def test_the_time_grid_includes_an_end_that_rounding_hides(duration, rate, count):
    assert len(motion.time_grid(float(duration), float(rate))) == count


def test_the_papers_path_asks_for_14_9_times_its_weight_and_1_8_when_slowed_four_times():
    """MATH: "needs 14.9 times the weight in thrust; slowed four times 1.8"; figures rounded as there."""
    for name, ratio in (("paper", 14.9), ("paper-slow", 1.8)):
        p = preset.load(name)
        limits = motion.limits(simulated(p), world=p.world).thrust_to_weight
        assert isinstance(p.path, Multisine)
        t = np.linspace(0, 2 * math.pi / p.path.tones[0].frequency, 20_001)
        dense = np.linalg.norm(p.path(t, 2) - np.asarray(p.world.gravity), axis=-1).max() / 9.81
        assert round(limits, 1) == ratio
        assert limits == pytest.approx(dense, rel=2e-3)  # 200 Hz samples come within (16·5ms/2)²/2 of the peak


def test_limits_are_the_extremes_of_the_path_found_on_a_dense_grid():
    p = preset.load("lissajous")
    limits = motion.limits(simulated(p), world=p.world)
    t = np.linspace(0, p.duration, 200_001)
    for name, order in (("speed", 1), ("acceleration", 2), ("jerk", 3), ("snap", 4)):
        # between samples a sine of 4.5 rad/s at 200 Hz hides (4.5·2.5ms)²/2
        assert getattr(limits, name) == pytest.approx(np.linalg.norm(p.path(t, order), axis=-1).max(), rel=1e-4)
    assert not isinstance(p.angular_velocity, Flown)
    assert limits.body_rate == pytest.approx(np.linalg.norm(p.angular_velocity(t), axis=-1).max(), rel=1e-4)
    distance = np.linalg.norm(p.path(t) - np.asarray(p.world.anchor), axis=-1).min()
    assert limits.anchor_distance_min == pytest.approx(distance, rel=1e-3)


@given(vectors, vectors)
def test_to_body_and_to_inertial_undo_each_other_and_are_the_transpose_and_the_rotation(r, u):
    R = so3.exp(r)
    np.testing.assert_allclose(motion.to_inertial(R, u), R @ u, atol=10 * EPS)
    np.testing.assert_allclose(motion.to_body(R, u), R.T @ u, atol=10 * EPS)
    np.testing.assert_allclose(motion.to_inertial(R, motion.to_body(R, u)), u, atol=50 * EPS)


def test_a_vehicle_in_free_fall_feels_nothing_and_one_at_rest_feels_its_weight():
    R = so3.exp(START)
    g = np.array([0.0, 0.0, 9.81])
    np.testing.assert_array_equal(motion.apparent(R, g, gravity=g), np.zeros(3))
    np.testing.assert_allclose(motion.apparent(R, np.zeros(3), gravity=g), -R.T @ g, atol=20 * EPS)


@pytest.mark.parametrize(
    ("fields", "sentence"),
    [
        ({"magnetic": (0.0, 0.0, 1.0)}, "magnetic and gravity must not be collinear"),
        ({"magnetic": (0.0, 0.0, -1.0)}, "magnetic and gravity must not be collinear"),
        ({"magnetic": (math.sin(5e-4), 0.0, math.cos(5e-4))}, "magnetic and gravity must not be collinear"),
        ({"gravity": (-6.0, 0.0, -6.0)}, "magnetic and gravity must not be collinear"),
        ({"magnetic": (1.0, 0.0, 1.0)}, "magnetic must be a unit vector, got length 1.41421"),
        ({"magnetic": (0.0, 0.0, 0.0)}, "magnetic must be a unit vector, got length 0"),
        ({"magnetic": (1.0 + 2e-3, 0.0, 0.0)}, "magnetic must be a unit vector, got length 1.002"),
        ({"gravity": (0.0, 0.0, 0.0)}, "gravity must have a length between 0 and 1000 m/s², got 0"),
        ({"gravity": (0.0, 0.0, 1e4)}, "gravity must have a length between 0 and 1000 m/s², got 10000"),
        ({"gravity": (0.0, 1e300, 1e300)}, "gravity must have a length between 0 and 1000 m/s², got 1.41421e"),
        ({"magnetic": (1e300, 0.0, 1e300)}, "magnetic must be a unit vector, got length 1.41421e"),
        ({"anchor": (1e300, 1e300, 1e300)}, "anchor must lie within 100 km of the origin"),
        ({"gravity": (math.nan, 0.0, 1.0)}, "gravity must be a finite number, got nan"),
        ({"anchor": (1e5, 1.0, 0.0)}, "anchor must lie within 100 km of the origin"),
        ({"anchor": (0.0, math.inf, 0.0)}, "anchor must be a finite number, got inf"),
    ],
)
def test_a_world_that_cannot_be_is_refused_in_one_sentence(fields, sentence):
    with pytest.raises(ValueError, match="^" + sentence.replace("(", r"\(")):
        World(**fields)


def test_a_direction_in_five_digits_is_made_a_unit_vector_with_a_word_and_one_in_full_is_left_as_it_is():
    with pytest.warns(motion.DirectionWarning, match=r"magnetic has the length 1\.000005: it is used as a unit vector"):
        world = World(magnetic=(0.70711, 0.0, 0.70711))
    assert math.hypot(*world.magnetic) == pytest.approx(1.0, abs=1e-15)
    full = (0.7071067811865476, 0.0, 0.7071067811865476)
    assert world.magnetic == pytest.approx(full, abs=1e-15)
    assert World(magnetic=(0.7071068, 0.0, 0.7071068)).magnetic == (0.7071068, 0.0, 0.7071068)


def test_a_world_barely_tilted_from_collinear_is_allowed():
    World(magnetic=(math.sin(2e-3), 0.0, math.cos(2e-3)))
    World(gravity=(0.0, 0.0, -9.81), magnetic=(1.0, 0.0, 0.0))
