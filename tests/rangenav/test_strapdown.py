"""The nine-state problem's bookkeeping: ranges given to samples, records run backwards, tracks lifted to 13 states."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from rangenav import baselines, cascade, model, strapdown
from rangenav.motion import World
from rangenav.sensors import Measurements
from rangenav.strapdown import Track
from tests.support import records

WORLD = World(anchor=(0.5, -1.0, 2.0))


def one_state(position: np.ndarray, velocity: np.ndarray, rotation: np.ndarray) -> np.ndarray:
    """The 13-state of one pose, written out."""
    p, v, g = position - np.array(WORLD.anchor), velocity, np.array(WORLD.gravity)
    xi = [p @ p / 2, p @ v, v @ v + p @ g, 3 * v @ g]
    return np.concatenate([xi, rotation.T @ p, rotation.T @ v, rotation.T @ g])


def test_lifted_covariances_are_the_derivatives_of_the_lift():
    """First-order covariances against central differences of the 13-state in all nine errors."""
    rng = np.random.default_rng(4)
    position, velocity = rng.normal(size=3), rng.normal(size=3)
    rotation, root = Rotation.random(None, rng).as_matrix(), rng.normal(size=(9, 9))
    track = Track(
        time=np.array([0.0]),
        position=position[None],
        velocity=velocity[None],
        rotation=rotation[None],
        covariance=(root @ root.T)[None],
        innovation=np.zeros((0, 2)),
    )
    step, jacobian = 1e-6, np.empty((13, 9))
    for i in range(9):
        moved = []
        for x in (step * np.eye(9)[i], -step * np.eye(9)[i]):
            turned = Rotation.from_rotvec(x[6:]).as_matrix() @ rotation
            moved.append(one_state(position + x[:3], velocity + x[3:6], turned))
        jacobian[:, i] = (moved[0] - moved[1]) / (2 * step)
    expected = jacobian @ root @ root.T @ jacobian.T
    empty = Measurements(
        time=np.zeros(1),
        gyro=np.zeros((1, 3)),
        accel=np.zeros((1, 3)),
        mag=np.zeros((1, 3)),
        range_time=np.zeros(0),
        range=np.zeros(0),
    )
    estimate = strapdown.lifted(track, empty, WORLD)
    np.testing.assert_allclose(estimate.state[0], one_state(position, velocity, rotation), rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(estimate.xi_variance[0], np.diag(expected)[:4], rtol=1e-7)
    for number, block in enumerate((model.POSITION, model.VELOCITY, model.GRAVITY)):
        np.testing.assert_allclose(estimate.covariance[0, number], expected[block, block], rtol=1e-7, atol=1e-7)


def test_lifted_truth_is_the_true_state_and_its_innovations_are_those_of_half_the_square():
    scene = records.scene("lissajous", duration=2.0)
    z, moved, world = scene.measurements, scene.truth.motion, scene.preset.world
    expected = np.linalg.norm(moved.position - np.array(world.anchor), axis=-1)  # ranges come at every IMU sample
    track = Track(
        time=z.time,
        position=moved.position,
        velocity=moved.velocity,
        rotation=moved.rotation,
        covariance=np.zeros((len(z.time), 9, 9)),
        innovation=np.stack([z.range - expected, np.full_like(expected, 0.01)], axis=-1),
    )
    estimate = strapdown.lifted(track, z, world)
    np.testing.assert_allclose(estimate.state, scene.truth.state, atol=1e-11)
    np.testing.assert_allclose(estimate.innovation[:, 0], (z.range**2 - expected**2) / 2, atol=1e-13)
    np.testing.assert_allclose(estimate.innovation[:, 1], expected**2 * 0.01, rtol=1e-12)
    np.testing.assert_allclose(estimate.position(world), moved.position, atol=1e-12)


def test_a_record_run_backwards_from_its_end_comes_to_its_start():
    """Without noise and without ranges: dead reckoning there and back differs by the integration's h² only."""
    scene = records.scene("lissajous", duration=5.0, noise=records.SILENT)
    z, moved = scene.measurements, scene.truth.motion
    z = records.without_ranges(z, np.ones(len(z.range), dtype=bool))
    blind = dataclasses.replace(z, mag=np.full_like(z.mag, np.nan))
    end = (moved.position[-1], -moved.velocity[-1], moved.rotation[-1])
    back = baselines.filtered(strapdown.reversed_record(blind), end, np.eye(9), scene.setting())
    track = strapdown.reversed_track(back)
    np.testing.assert_array_equal(track.time, z.time)
    np.testing.assert_allclose(track.position, moved.position, atol=2e-3)
    np.testing.assert_allclose(track.velocity, moved.velocity, atol=2e-3)
    np.testing.assert_allclose(track.rotation, moved.rotation, atol=1e-6)


def test_reversing_twice_changes_nothing():
    scene = records.scene("soft", duration=1.0, range_rate=33.0)
    twice = strapdown.reversed_record(strapdown.reversed_record(scene.measurements))
    track = baselines.ekf(scene.measurements, scene.start, scene.setting())
    again = strapdown.reversed_track(strapdown.reversed_track(track))
    for one, other in ((twice, scene.measurements), (again, track)):
        for field in dataclasses.fields(one):
            np.testing.assert_array_equal(getattr(one, field.name), getattr(other, field.name), err_msg=field.name)


@given(st.lists(st.floats(-1.0, 3.0, allow_subnormal=False), max_size=30, unique=True))
def test_every_range_within_the_record_is_given_to_the_next_sample(stamps: list[float]):
    time = np.arange(9) / 4.0
    z = Measurements(
        time=time,
        gyro=np.zeros((9, 3)),
        accel=np.zeros((9, 3)),
        mag=np.zeros((9, 3)),
        range_time=np.sort(np.array(stamps, dtype=float)),
        range=np.zeros(len(stamps)),
    )
    attached = strapdown.attach(z)
    within = [stamp for stamp in sorted(stamps) if 0 <= stamp <= 2]
    assert list(z.range_time[attached.kept]) == within
    for stamp, sample, back in zip(within, attached.sample, attached.back, strict=True):
        assert time[sample] - back == pytest.approx(stamp, abs=1e-15)
        assert time[sample] >= stamp
        assert sample == 0 or time[sample - 1] < stamp


def test_the_axes_across_the_magnetic_direction_span_its_plane():
    for magnetic in ((1.0, 0.0, 0.0), (0.0, 0.6, 0.8), (1 / np.sqrt(3),) * 3):
        setting = dataclasses.replace(records.scene("soft", duration=1.0).setting(), world=World(magnetic=magnetic))
        known = strapdown.parameters(setting)
        np.testing.assert_allclose(np.cross(known.across1, known.across2), magnetic, atol=1e-15)
        np.testing.assert_allclose(np.linalg.norm([known.across1, known.across2], axis=-1), 1, atol=1e-15)


def test_sensors_said_to_be_without_noise_are_taken_as_nearly_so():
    scene = records.scene("soft", duration=1.0, noise=records.SILENT)
    known = strapdown.parameters(scene.setting())
    assert known.range_variance == 1e-6
    assert known.accel_density == 1e-6 / 200
    estimate = cascade.observe(scene.measurements, scene.start, scene.setting())
    assert np.isfinite(estimate.state).all()
