"""The extended Kalman filter against a readable transcription, its consistency near the truth, its failures."""

import dataclasses

import numpy as np
import pytest
from msgspec.structs import replace
from scipy.spatial.transform import Rotation

from rangenav import baselines, cascade, strapdown
from rangenav.cascade import Start
from rangenav.gains import Gains
from rangenav.riccati import Blocks
from rangenav.sensors import Measurements
from tests.support import nine_states, records

NEAR = np.eye(9) * 0.01


def truth_start(scene: records.Scene) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    motion = scene.truth.motion
    return motion.position[0], motion.velocity[0], motion.rotation[0]


def transcribed(z: Measurements, start: tuple, P: np.ndarray, setting: cascade.ObserverConfig) -> tuple:
    """All corrections of a sample at once, in Joseph's form, with the magnetometer's three rows in full."""
    g, _, anchor = nine_states.axes(setting)
    p, v, R = start
    p, a, rows, innovations = p - anchor, np.zeros(3), [], []
    for k in range(len(z.time)):
        if k > 0:
            h, a = z.time[k] - z.time[k - 1], nine_states.push(z, k - 1, R)
            p, v, R = p + h * v + h**2 / 2 * (g + a), v + h * (g + a), R @ nine_states.turn(z, k - 1)
            G, phi = nine_states.noise_input(h), nine_states.transition(a, h)
            noise = nine_states.intensity(setting.sensors.noise, setting.sensors.imu_rate, h)
            P = phi @ P @ phi.T + G @ np.diag(noise) @ G.T
        residual, H, variance = nine_states.outputs(z, k, p, v, R, a, setting)
        if len(residual):
            S = H @ P @ H.T + np.diag(variance)
            K = np.linalg.solve(S, H @ P).T
            kept = np.eye(9) - K @ H
            P = kept @ P @ kept.T + K @ np.diag(variance) @ K.T
            x = K @ residual
            p, v, R = p + x[:3], v + x[3:6], Rotation.from_rotvec(x[6:]).as_matrix() @ R
            if len(nine_states.ranges_at(z, k)):
                innovations.append((residual[0], S[0, 0]))
        rows.append((p + anchor, v, R, P))
    return (*(np.array(part) for part in zip(*rows, strict=True)), np.array(innovations))


@pytest.mark.parametrize(("range_rate", "mag_rate"), [(200.0, 200.0), (50.0, 200.0), (333.0, 57.0), (7.0, 11.0)])
def test_the_kernel_is_the_filter_of_the_textbook(range_rate: float, mag_rate: float):
    """Sequential scalar corrections and two rows of the magnetometer against all at once: rounding apart."""
    scene = records.scene("lissajous", duration=4.0, range_rate=range_rate, mag_rate=mag_rate)
    z, setting = scene.measurements, scene.setting()
    track = baselines.filtered(z, truth_start(scene), NEAR, setting)
    position, velocity, rotation, covariance, innovations = transcribed(z, truth_start(scene), NEAR, setting)
    np.testing.assert_allclose(track.position, position, atol=1e-8)
    np.testing.assert_allclose(track.velocity, velocity, atol=1e-8)
    np.testing.assert_allclose(track.rotation, rotation, atol=1e-8)
    np.testing.assert_allclose(track.covariance, covariance, atol=1e-8 * covariance.max())
    if range_rate <= 200:  # with several ranges in an interval the kernel's innovations know the ones before
        np.testing.assert_allclose(track.innovation, innovations, atol=1e-8)


@pytest.mark.parametrize("name", ["paper", "lissajous"])
def test_near_the_truth_its_covariance_is_its_error(name: str):
    """Mean eᵀP⁻¹e/9 over ten seeds; errors within a record are correlated, so it is 1 within a third."""
    ratios, innovations = [], []
    for seed in range(10):
        scene = records.scene(name, duration=20.0, seed=seed)
        motion = scene.truth.motion
        track = baselines.filtered(scene.measurements, truth_start(scene), NEAR, scene.setting())
        turned = Rotation.from_matrix(motion.rotation @ np.swapaxes(track.rotation, -1, -2))
        error = np.hstack([motion.position - track.position, motion.velocity - track.velocity, turned.as_rotvec()])
        weighted = np.linalg.solve(track.covariance, error[..., None])[..., 0]
        ratios.append(np.mean(np.sum(error * weighted, axis=-1)) / 9)
        innovations.append(np.mean(track.innovation[:, 0] ** 2 / track.innovation[:, 1]))
    assert np.mean(ratios) == pytest.approx(1, abs=0.33)
    assert np.mean(innovations) == pytest.approx(1, abs=0.03)  # 40 000 of them: a standard deviation of .007


def test_without_noise_it_stays_within_a_millimetre_of_the_truth():
    scene = records.scene("paper", duration=10.0, imu_rate=1000.0, range_rate=1000.0, noise=records.SILENT)
    track = baselines.filtered(scene.measurements, truth_start(scene), NEAR * 1e-6, scene.setting())
    assert np.abs(track.position - scene.truth.motion.position).max() < 1e-3


def test_started_as_the_cascade_it_uses_the_same_uncertainty():
    """p0 of position and velocity; p0 of gravity as a tilt. The anchor is where p̂ = 0 means."""
    scene = records.scene("soft", duration=1.0)
    gains = replace(
        Gains(), riccati=replace(Gains().riccati, p0=Blocks(xi=1.0, position=4.0, velocity=9.0, gravity=2.0))
    )
    silent = records.without_ranges(scene.measurements, np.ones(len(scene.measurements.range), dtype=bool))
    silent = dataclasses.replace(silent, mag=np.full_like(silent.mag, np.nan))
    start = Start(state=np.zeros(13), rotation=np.diag([1.0, -1.0, -1.0]))
    track = baselines.ekf(silent, start, scene.setting(gains))
    np.testing.assert_allclose(np.diag(track.covariance[0]), np.repeat([4.0, 9.0, 2 / 9.81**2], 3), rtol=1e-12)
    np.testing.assert_allclose(track.position[0], scene.preset.world.anchor)
    np.testing.assert_array_equal(track.rotation[0], start.rotation)


def test_at_the_anchor_a_range_corrects_nothing_and_nothing_is_nan():
    scene = records.scene("soft", duration=1.0)
    track = baselines.ekf(scene.measurements, scene.start, scene.setting())
    assert not scene.start.state.any()
    np.testing.assert_array_equal(track.position[0], scene.preset.world.anchor)
    assert np.isfinite(track.position).all()
    assert np.isfinite(track.covariance).all()


def test_from_nothing_it_may_settle_in_a_wrong_place_and_be_sure_of_it():
    """What the cascade is for: soft, x̂ = 0, seed 1: a metre off after 20 s with a σ of 7 cm; the cascade is right."""
    scene = records.scene("soft", duration=20.0, range_rate=50.0, seed=1)
    track = baselines.ekf(scene.measurements, scene.start, scene.setting())
    off = np.linalg.norm(track.position[-1] - scene.truth.motion.position[-1])
    assert off > 0.5
    assert np.sqrt(np.trace(track.covariance[-1, :3, :3])) < 0.1
    assert scene.errors(scene.observe()).position[-1] < 0.5


def test_ranges_outside_the_imu_record_are_left_alone():
    scene = records.scene("lissajous", duration=2.0)
    z = scene.measurements
    early, late = z.time[0] - 0.5, z.time[-1] + 0.5
    more = dataclasses.replace(
        z,
        range_time=np.concatenate([[early], z.range_time, [late]]),
        range=np.concatenate([[99.0], z.range, [99.0]]),
    )
    one, other = (baselines.filtered(record, truth_start(scene), NEAR, scene.setting()) for record in (z, more))
    np.testing.assert_array_equal(one.position, other.position)
    assert np.isnan(other.innovation[[0, -1]]).all()
    np.testing.assert_array_equal(one.innovation, other.innovation[1:-1])


def test_bad_records_get_a_sentence(monkeypatch: pytest.MonkeyPatch):
    scene = records.scene("lissajous", duration=2.0)
    monkeypatch.setattr(strapdown, "MAX_SAMPLES", 100)
    with pytest.raises(ValueError, match="at most 100 IMU samples here, got 401"):
        baselines.ekf(scene.measurements, scene.start, scene.setting())
    broken = dataclasses.replace(scene.measurements, gyro=np.full_like(scene.measurements.gyro, np.nan))
    with pytest.raises(ValueError, match="gyro must be finite: broken at sample 0"):
        baselines.ekf(broken, scene.start, scene.setting())
