"""Gains in two languages: switching changes nothing, and each physical word means what the observer does with it."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import asdict, replace

from rangenav import attitude, physical_gains, preset, so3
from rangenav.attitude import K1_RANGE, RHO_RANGE, SCHEDULED, AttitudeGains, Schedule
from rangenav.gains import Gains
from rangenav.kernels import riccati as kernel
from rangenav.motion import World
from rangenav.physical_gains import Typical
from rangenav.riccati import P0_RANGE, Q_RANGE, V_RANGE, Blocks, RiccatiGains
from rangenav.sensors import Noise, Sensors
from tests.support.refusals import exactly

pytestmark = pytest.mark.slow


WORLD = World()
SENSORS = Sensors()
AT = Typical(distance=1.2, speed=2.0)


def within(limits):
    """Anywhere in a range, its ends and its decades alike."""
    low, high = np.log(limits)
    return st.sampled_from(limits) | st.floats(low, high).map(lambda x: float(np.clip(np.exp(x), *limits)))


def blocks(limits):
    return st.builds(Blocks, **dict.fromkeys(Blocks.__struct_fields__, within(limits)))


every_gain = st.builds(
    Gains,
    mode=st.sampled_from(["constant", "noise-matched"]),
    riccati=st.builds(RiccatiGains, q=within(Q_RANGE), v=blocks(V_RANGE), p0=blocks(P0_RANGE)),
    attitude=st.builds(
        AttitudeGains,
        k1=within(K1_RANGE),
        rho1=within(RHO_RANGE),
        rho2=within(RHO_RANGE),
        schedule=st.none() | st.just(Schedule(steady=K1_RANGE[0])),
    ),
)
states = st.builds(Typical, distance=st.floats(1e-3, 1e5), speed=st.floats(0, 1e4))
worlds = st.builds(
    World,
    gravity=st.sampled_from([(0.0, 0.0, 9.81), (0.0, 0.0, -1.62), (3.0, -4.0, 999.0)]),
    magnetic=st.floats(0.01, math.pi - 0.01).map(lambda a: (math.sin(a), 0.0, math.cos(a))),
)
sensors = st.builds(Sensors, imu_rate=st.floats(1, 1e4), mag_rate=st.just(1.0), range_rate=st.floats(1, 1e4))


def numbers(gains: Gains) -> np.ndarray:
    r, a = gains.riccati, gains.attitude
    return np.array([r.q, *asdict(r.v).values(), *asdict(r.p0).values(), a.k1, a.rho1, a.rho2])


@given(every_gain, states, worlds, sensors)
def test_to_physical_and_back_changes_no_gain_whatever_the_state_the_world_and_the_rates(gains, at, world, rates):
    chosen = physical_gains.to_physical(gains, at, world=world, sensors=rates)
    back = physical_gains.to_paper(chosen, at, world=world, sensors=rates)
    np.testing.assert_allclose(numbers(back), numbers(gains), rtol=1e-13)  # a dozen roundings of 2e-16 on the way
    assert (back.mode, back.attitude.schedule) == (gains.mode, gains.attitude.schedule)
    np.testing.assert_array_equal(back.attitude.rho1, gains.attitude.rho1)


@given(every_gain)
def test_switching_to_and_fro_many_times_does_not_wander(gains):
    now = gains
    for _ in range(20):
        now = physical_gains.to_paper(
            physical_gains.to_physical(now, AT, world=WORLD, sensors=SENSORS), AT, world=WORLD, sensors=SENSORS
        )
    np.testing.assert_allclose(numbers(now), numbers(gains), rtol=1e-12)


@given(every_gain, states, worlds, sensors)
def test_gains_that_nobody_changed_in_words_are_kept_to_the_last_bit(gains, at, world, rates):
    words = physical_gains.to_physical(gains, at, world=world, sensors=rates)
    paper_gains = physical_gains.to_paper(words, at, world=world, sensors=rates)
    assert physical_gains.keep_known(paper_gains, [Gains(), gains], at, world=world, sensors=rates) == gains


@given(every_gain, st.floats(0.5, 0.9))
def test_a_changed_word_changes_its_gain_and_no_bit_of_the_others(gains, share):
    words = physical_gains.to_physical(gains, AT, world=WORLD, sensors=SENSORS)
    fewer = replace(words, attitude_time=words.attitude_time / share)  # k1 falls
    if gains.attitude.k1 * share < K1_RANGE[0] * 1.01 or gains.attitude.schedule is not None:
        return
    paper_gains = physical_gains.to_paper(fewer, AT, world=WORLD, sensors=SENSORS)
    kept = physical_gains.keep_known(paper_gains, [gains], AT, world=WORLD, sensors=SENSORS)
    assert kept == replace(gains, attitude=replace(gains.attitude, k1=paper_gains.attitude.k1))
    assert paper_gains.attitude.k1 == pytest.approx(gains.attitude.k1 * share, rel=1e-12)


@pytest.mark.parametrize("size", [1e31, 1e-31, 1e200])
def test_no_word_overflows(size):
    for name in ("range_sigma", "gyro_sigma", "velocity_box", "gravity_weight"):
        with pytest.raises(ValueError, match=f"{name} must lie between 1e-30 and 1e\\+30"):
            chosen(**{name: size})


def test_range_noise_is_the_variance_of_half_the_squared_range():
    """Drawn: y = ½(d + η)² of a million ranges at the typical distance."""
    sigma, rng = 0.3, np.random.default_rng(0)
    y = (AT.distance + sigma * rng.standard_normal(1_000_000)) ** 2 / 2
    gains = physical_gains.to_paper(chosen(range_sigma=sigma), AT, world=WORLD, sensors=SENSORS)
    assert SENSORS.range_rate / gains.riccati.q == pytest.approx(y.var(), rel=0.01)


def test_imu_noise_is_what_the_noise_matched_observer_adds_at_the_typical_state():
    """The trace of each block of its V, over turns of the three vectors; factors of one add nothing to it."""
    noise = Noise(gyro=0.02, accel=0.3)
    sensors = replace(SENSORS, noise=noise)
    gains = physical_gains.to_paper(
        chosen(accel_sigma=0.3, gyro_sigma=0.02, position_factor=1.0, velocity_factor=1.0),
        AT,
        world=WORLD,
        sensors=sensors,
    )
    densities = (0.3**2 / sensors.imu_rate, 0.02**2 / sensors.imu_rate)
    rng, computed = np.random.default_rng(1), []
    for _ in range(3):
        turns = so3.exp(rng.standard_normal((3, 3)))
        vectors = np.array([AT.distance, AT.speed, 9.81])[:, None] * turns[:, :, 0]
        V = np.zeros(169)
        kernel.add_imu_noise(V, np.concatenate([np.zeros(4), *vectors]), *densities, 1.0)
        computed.append(np.diag(V.reshape(13, 13)))
    for V in computed:
        np.testing.assert_allclose(V[0:4].mean(), gains.riccati.v.xi, rtol=1e-9)
        np.testing.assert_allclose(V[4:7].mean(), gains.riccati.v.position, rtol=1e-9)
        np.testing.assert_allclose(V[7:10].mean(), gains.riccati.v.velocity, rtol=1e-9)
        np.testing.assert_allclose(V[10:13].mean(), gains.riccati.v.gravity, rtol=1e-9)


def test_the_prior_is_the_variance_of_a_state_anywhere_in_the_boxes():
    rng, half = np.random.default_rng(2), (2.0, 1.5, 3.0)
    p, v, g = (rng.uniform(-b, b, (400_000, 3)) for b in half)
    xi = [
        np.sum(p * p, axis=1) / 2,
        np.sum(p * v, axis=1),
        np.sum(v * v + p * g, axis=1),
        3 * np.sum(v * g, axis=1),
    ]
    words = chosen(position_box=half[0], velocity_box=half[1], gravity_box=half[2], xi_factor=1.0)
    p0 = physical_gains.to_paper(words, AT, world=WORLD, sensors=SENSORS).riccati.p0
    assert p0.position == pytest.approx(p.var(), rel=0.01)
    assert p0.velocity == pytest.approx(v.var(), rel=0.01)
    assert p0.gravity == pytest.approx(g.var(), rel=0.01)
    assert p0.xi == pytest.approx(np.mean([np.var(one) for one in xi]), rel=0.02)


@given(every_gain, worlds)
def test_the_attitude_time_is_the_slowest_time_constant(gains, world):
    words = physical_gains.to_physical(gains, AT, world=world, sensors=SENSORS)
    upper = replace(gains.attitude, schedule=None)
    # eigvalsh knows the small eigenvalue to rounding of the large one
    M = np.linalg.eigvalsh(attitude.decay_matrix(upper, world))
    tolerance = 1e-10 + 1e-14 * M[2] / M[1]
    if tolerance < 1e-3:
        assert words.attitude_time == pytest.approx(attitude.time_constants(upper, world)[0], rel=tolerance)


def test_doubling_the_attitude_time_halves_k1_and_nothing_else():
    words = physical_gains.to_physical(Gains(), AT, world=WORLD, sensors=SENSORS)
    slower = replace(words, attitude_time=2 * words.attitude_time)
    paper_gains = numbers(physical_gains.to_paper(slower, AT, world=WORLD, sensors=SENSORS)) / numbers(Gains())
    np.testing.assert_allclose(paper_gains, [*[1] * 9, 0.5, 1, 1], rtol=1e-13)


def test_the_defaults_in_physical_words_are_of_the_size_of_the_default_noise():
    p = preset.load("paper-slow")
    at = physical_gains.typical(p.path, p.world, p.duration)
    words = physical_gains.to_physical(p.gains, at, world=p.world, sensors=p.sensors)
    assert 0.05 < words.range_sigma < 0.2
    assert 0.01 < words.accel_sigma < 0.1
    assert 0.005 < words.gyro_sigma < 0.05
    assert words.position_box == pytest.approx(10 * math.sqrt(3))
    assert words.gravity_weight == pytest.approx(0.01 * 9.81**2)


def test_a_typical_state_is_the_root_mean_square_of_the_path_and_never_at_the_anchor():
    p = preset.load("circle")
    at = physical_gains.typical(p.path, p.world, p.duration)
    time = np.linspace(0, p.duration, 5000)
    distance = np.linalg.norm(p.path(time) - np.asarray(p.world.anchor), axis=1)
    assert at.distance == pytest.approx(np.sqrt(np.mean(distance**2)), rel=1e-2)
    assert at.speed == pytest.approx(np.sqrt(np.mean(np.sum(p.path(time, 1) ** 2, axis=1))), rel=1e-2)
    hover = preset.load("hover")
    there = replace(hover.world, anchor=tuple(hover.path(np.array([0.0]))[0].tolist()))
    assert physical_gains.typical(hover.path, there, 20.0) == Typical(distance=0.1, speed=0.0)


def chosen(**changes):
    return replace(physical_gains.to_physical(Gains(), AT, world=WORLD, sensors=SENSORS), **changes)


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"range_sigma": 500.0}, "range_sigma asks for q = 1.59998e-09, which must lie between 0.001 and 100000"),
        ({"accel_sigma": 100.0}, "accel_sigma asks for v.xi = 11044.6, which must lie between 1e-06 and 100"),
        (
            {"gyro_sigma": 100.0},
            "gyro_sigma with position_factor asks for v.position = 320.787, which must lie between 1e-06 and 100",
        ),
        ({"attitude_time": 1e6}, "attitude_time asks for k1 = 3.48125e-06, which must lie between 0.001 and 1000"),
        (
            {"gravity_box": 1e3},
            "xi_factor with the boxes asks for p0.xi = 2.77794e+07, which must lie between 0.001 and 10000",
        ),
    ],
)
def test_words_that_ask_for_a_gain_outside_its_range_are_refused_by_their_name(changes, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        physical_gains.to_paper(chosen(**changes), AT, world=WORLD, sensors=SENSORS)


@pytest.mark.parametrize(
    ("field", "value", "sentence"),
    [
        ("range_sigma", 0.0, "range_sigma must be positive, got 0"),
        ("attitude_time", -1.0, "attitude_time must be positive, got -1"),
        ("velocity_box", math.nan, "velocity_box must be a finite number, got nan"),
    ],
)
def test_words_that_mean_nothing_are_refused_in_one_sentence(field, value, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        chosen(**{field: value})


def test_a_raw_weight_on_gravity_is_called_stiff_at_thirty_milliseconds_and_the_default_is_not():
    raw = AttitudeGains(rho2=1.0)
    assert attitude.stiffness(raw, WORLD, imu_rate=1 / 0.03, mag_rate=1 / 0.03) == (
        "The attitude filter is stiff: 389/s times the IMU's 30 ms is 12, above 1; lower k1 or rho2, or sample faster."
    )
    for calm in (AttitudeGains(), SCHEDULED):
        assert attitude.stiffness(calm, WORLD, imu_rate=200.0, mag_rate=200.0) is None


def test_a_slow_magnetometer_is_held_against_its_own_gain():
    said = attitude.stiffness(AttitudeGains(k1=40.0, rho2=0.001), WORLD, imu_rate=200.0, mag_rate=20.0)
    assert said is not None
    assert "40/s times the magnetometer's 50 ms is 2, above 1; lower k1 or rho1" in said


def test_the_rate_that_is_called_fastest_is_the_fastest_time_constants():
    gains = AttitudeGains(k1=30.0, rho2=0.07)
    fastest = 1 / attitude.time_constants(gains, WORLD)[-1]
    assert attitude.stiffness(gains, WORLD, imu_rate=fastest * 1.01, mag_rate=fastest) is None
    assert attitude.stiffness(gains, WORLD, imu_rate=fastest * 0.99, mag_rate=fastest) is not None
