"""Errors of an estimate: lengths against numpy, angles against scipy's rotations, at both ends too."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rangenav import errors
from tests.support import records


def test_norms_are_lengths_of_the_differences_of_the_three_vectors():
    rng = np.random.default_rng(0)
    state, truth = rng.standard_normal((2, 50, 13)) * 10
    norms = errors.norms(state, truth)
    for block in range(3):
        part = slice(4 + 3 * block, 7 + 3 * block)
        np.testing.assert_allclose(norms[block], np.linalg.norm(state[:, part] - truth[:, part], axis=1), rtol=1e-14)


@pytest.mark.parametrize("size", [0.0, 1e-12, 1e-6, 1.0, 3.0, np.pi - 1e-6, np.pi - 1e-12, np.pi])
def test_angles_are_those_of_the_rotation_in_between_from_nothing_to_a_half_turn(size):
    """scipy's magnitude is 2 atan2 of a quaternion: another way, as exact at both ends."""
    rng = np.random.default_rng(1)
    axis = rng.standard_normal((3, 7, 3))
    between = Rotation.from_rotvec((size * axis / np.linalg.norm(axis, axis=-1, keepdims=True)).reshape(-1, 3))
    truth = Rotation.random(7, rng)
    repeated = Rotation.concatenate([truth] * 3)
    computed = (between.inv() * repeated).as_matrix().reshape(3, 7, 3, 3)
    angles = errors.angles(computed, truth.as_matrix())
    expected = (repeated * (between.inv() * repeated).inv()).magnitude().reshape(3, 7)
    np.testing.assert_allclose(angles, expected, atol=2e-15 * 4)  # matrices hold an angle to some rounding of one
    np.testing.assert_allclose(angles, size, atol=1e-14)


def test_the_errors_of_a_run_are_those_of_its_state_and_attitude():
    scene = records.scene("paper-slow", duration=1.0)
    estimate = scene.observe()
    run_errors = scene.errors(estimate)
    np.testing.assert_array_equal(
        [run_errors.position, run_errors.velocity, run_errors.gravity], errors.norms(estimate.state, scene.truth.state)
    )
    turned = Rotation.from_matrix(scene.truth.motion.rotation @ np.swapaxes(estimate.rotation, -1, -2))
    np.testing.assert_allclose(run_errors.attitude, turned.magnitude(), atol=1e-14)


def test_what_is_not_a_number_stays_so():
    state = np.zeros((2, 13))
    state[1, 5] = np.nan
    norms = errors.norms(state, np.ones((2, 13)))
    assert np.isfinite(norms[:, 0]).all()
    assert np.isnan(norms[0, 1])
    rotation = np.tile(np.eye(3), (2, 1, 1))
    broken = rotation.copy()
    broken[1, 0, 0] = np.nan
    angles = errors.angles(broken[None], rotation)
    assert angles[0, 0] == 0
    assert np.isnan(angles[0, 1])
