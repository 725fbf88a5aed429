"""The error of the observer without noise: its transition, its contraction, its Floquet multipliers."""

from dataclasses import replace

import control
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace as changed
from scipy.integrate import solve_ivp

from rangenav import error_dynamics, model, preset, record
from rangenav.error_dynamics import ErrorDynamics
from rangenav.gains import Gains
from rangenav.riccati import Blocks, RiccatiGains
from tests.support import records
from tests.support.refusals import exactly


def along(scene: records.Scene, gains: Gains | None = None, window: float = 1.0) -> ErrorDynamics:
    return error_dynamics.along(
        scene.truth.motion,
        scene.measurements,
        scene.setting(gains),
        window=window,
        error=scene.start.state - scene.truth.state[0],
    )


@pytest.mark.parametrize(("range_rate", "mag_rate"), [(200.0, 200.0), (30.0, 50.0)])
def test_without_noise_the_observer_makes_the_error_that_its_dynamics_say(range_rate: float, mag_rate: float):
    """The two differ by the order h² with which the observer follows the inputs; h = 5 ms."""
    scene = records.scene("paper-slow", duration=6.0, range_rate=range_rate, mag_rate=mag_rate, noise=records.SILENT)
    dynamics, seen = along(scene), scene.errors(scene.observe()).position
    at_moments = np.interp(dynamics.time, scene.truth.motion.time, seen)
    np.testing.assert_allclose(dynamics.position, at_moments, atol=3e-3 * seen.max())


def test_the_transition_is_that_of_the_equations_in_continuous_time():
    """scipy integrates Ṗ and ė in body axes; ranges at 2 kHz come within the order h of them."""
    scene = records.scene("paper", duration=0.5, imu_rate=2000.0, range_rate=2000.0, noise=records.SILENT)
    motion, gains = scene.truth.motion, scene.preset.gains.riccati
    gravity_norm = float(np.linalg.norm(scene.preset.world.gravity))
    V = np.diag(gains.v.diagonal())

    def rates(t: float, flat: np.ndarray) -> np.ndarray:
        gyro = [np.interp(t, motion.time, column) for column in motion.angular_velocity.T]
        accel = [np.interp(t, motion.time, column) for column in motion.apparent_acceleration.T]
        A, _ = model.dynamics(np.array(gyro), np.array(accel), gravity_norm=gravity_norm)
        P, e = flat[:169].reshape(13, 13), flat[169:]
        gain = gains.q * P[:, 0]
        return np.concatenate([(A @ P + P @ A.T - np.outer(gain, P[0]) + V).ravel(), A @ e - gain * e[0]])

    error = scene.start.state - scene.truth.state[0]
    start = np.concatenate([np.diag(gains.p0.diagonal()).ravel(), error])
    end = solve_ivp(rates, (0.0, 0.5), start, method="LSODA", rtol=1e-8, atol=1e-10).y[:, -1]
    dynamics = along(scene, window=0.25)
    expected = np.linalg.norm(end[169:][model.POSITION])
    assert dynamics.position[-1] == pytest.approx(expected, rel=0.02)
    A, _ = model.dynamics(motion.angular_velocity[-1], motion.apparent_acceleration[-1], gravity_norm=gravity_norm)
    closed = A - gains.q * np.outer(end[:169].reshape(13, 13)[:, 0], np.eye(13)[0])
    poles = np.sort_complex(np.asarray(control.poles(control.StateSpace(closed, V, V, V))))
    np.testing.assert_allclose(np.sort_complex(dynamics.eigenvalues[-1]), poles, atol=0.03 * np.abs(poles).max())


@settings(max_examples=15)
@given(
    q=st.floats(1e-3, 1e5),
    v=st.floats(1e-6, 1e2),
    p0=st.floats(1e-3, 1e4),
    window=st.floats(0.1, 2.0),
    name=st.sampled_from(["paper-slow", "hover", "circle"]),
)
def test_no_error_grows_in_the_metric_of_the_covariance(q: float, v: float, p0: float, window: float, name: str):
    """eᵀP⁻¹e never grows, on blind motions too: with V > 0 it falls. The rounding of P is 1e-14 of its own size."""
    riccati = RiccatiGains(
        q=q,
        v=Blocks(xi=v, position=v, velocity=v, gravity=v),
        p0=Blocks(xi=p0, position=p0, velocity=p0, gravity=p0),
    )
    scene = records.scene(name, duration=2.0, imu_rate=100.0, range_rate=50.0)
    dynamics = along(scene, Gains(riccati=riccati), window=window)
    assert (dynamics.contraction <= 1 + 1e-6).all()
    assert (np.diff(dynamics.contraction, axis=1) <= 0).all()


def test_the_multipliers_are_the_factors_of_an_error_from_one_period_to_the_next():
    """Late in a long flight the error along the slowest direction shrinks by |λ₁| each period, whatever it was."""
    p = preset.load("lissajous")
    multipliers, reason = error_dynamics.multipliers(p.path, p.world, p.sensors, p.gains)
    assert multipliers is not None
    assert p.path.period is not None
    assert reason == ""
    scene = records.scene("lissajous", duration=20 * p.path.period, noise=records.SILENT)
    dynamics = along(scene)
    periods = dynamics.time / p.path.period
    late = periods > 6  # before, P has not become periodic
    rate = np.polyfit(periods[late], np.log(dynamics.position[late]), 1)[0]
    # λ₁ is complex, so the length also swings; over the 14 periods the swing leaves a few percent of the slope
    assert rate == pytest.approx(np.log(abs(multipliers[0])), rel=0.05)
    slowest = error_dynamics.time_constant(multipliers, p.path.period)
    assert slowest == pytest.approx(-p.path.period / np.log(abs(multipliers).max()))


@pytest.mark.parametrize("name", ["hover", "circle", "figure-eight"])
def test_where_an_error_does_not_fade_there_are_no_multipliers_and_the_reason_says_so(name: str):
    p = preset.load(name)
    multipliers, reason = error_dynamics.multipliers(p.path, p.world, p.sensors, Gains())
    assert multipliers is None
    assert reason == "P does not become periodic: on this motion some error does not fade"


def test_a_run_knows_the_dynamics_of_its_own_error():
    run = record.run(preset.load("paper"))
    dynamics = error_dynamics.of(run.preset)
    assert dynamics.settle_s == pytest.approx(run.summary.settle_position_s, abs=0.2)  # noise is small beside 0.3 m
    assert dynamics.start[-1] + dynamics.window == pytest.approx(run.preset.duration, abs=0.2)
    assert len(dynamics.start) == len(dynamics.contraction)


def test_noise_matched_gains_and_windows_beyond_the_flight_are_refused():
    scene = records.scene("paper-slow", duration=1.0, imu_rate=50.0, range_rate=50.0)
    with pytest.raises(ValueError, match=exactly("error dynamics need constant gains, got noise-matched")):
        along(scene, changed(Gains(), mode="noise-matched"))
    with pytest.raises(ValueError, match=exactly("window must lie in (0, 1] s, got 1.5")):
        along(scene, window=1.5)


def test_a_turned_body_changes_no_contraction():
    """V and P(0) are isotropic in each block, so attitude and angular velocity do not matter."""
    scene = records.scene("paper-slow", duration=2.0, imu_rate=100.0, range_rate=50.0)
    motion = scene.truth.motion
    still = replace(
        motion, angular_velocity=0 * motion.angular_velocity, rotation=np.tile(np.eye(3), (len(motion.time), 1, 1))
    )
    unturned = replace(scene, truth=replace(scene.truth, motion=still))
    np.testing.assert_array_equal(along(scene).contraction, along(unturned).contraction)
