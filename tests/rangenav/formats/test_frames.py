"""Changes of frame undo themselves, on vectors and quaternions; what is flown upright is the same flight."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from rangenav import motion, preset, record
from rangenav.axes import upright
from rangenav.formats import exported_run, frames
from rangenav.signals import Flown
from tests.support.signal_examples import EXAMPLES

pytestmark = pytest.mark.slow


CHANGES = {"z-up": frames.Z_UP_Z_DOWN, "ned": frames.NED_ENU, "frd": frames.FRD_FLU}
SEEDS = st.integers(0, 2**32 - 1)


def drawn(seed, count=5):
    """Random vectors and unit quaternions (wxyz) with w ≥ 0."""
    rng = np.random.default_rng(seed)
    q = rng.standard_normal((count, 4))
    q /= np.linalg.norm(q, axis=-1, keepdims=True)
    return rng.standard_normal((count, 3)), np.where(q[:, :1] < 0, -q, q)


def test_the_three_changes_are_what_their_names_say():
    v = np.array([1.0, 2.0, 3.0])
    assert frames.vector(frames.Z_UP_Z_DOWN, v).tolist() == [1.0, -2.0, -3.0]
    assert frames.vector(frames.NED_ENU, v).tolist() == [2.0, 1.0, -3.0]
    assert frames.vector(frames.FRD_FLU, v).tolist() == [1.0, -2.0, -3.0]


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
@given(seed=SEEDS)
def test_every_change_undoes_itself_on_vectors_and_quaternions(change, seed):
    v, q = drawn(seed)
    assert np.linalg.det(change) == pytest.approx(1.0)  # a rotation: right-handed frames stay right-handed
    np.testing.assert_array_equal(frames.vector(change, frames.vector(change, v)), v)
    for turned in (frames.inertial, frames.body):
        np.testing.assert_allclose(turned(change, turned(change, q)), q, atol=1e-12)  # two conversions to a matrix


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
@given(seed=SEEDS)
def test_a_body_vector_points_the_same_way_before_and_after(change, seed):
    v, q = drawn(seed)
    here = np.einsum("nij,nj->ni", frames.to_rotation(q), v)
    there = np.einsum("nij,nj->ni", frames.to_rotation(frames.inertial(change, q)), v)
    np.testing.assert_allclose(there, frames.vector(change, here), atol=1e-12)
    turned = np.einsum("nij,nj->ni", frames.to_rotation(frames.body(change, q)), frames.vector(change, v))
    np.testing.assert_allclose(turned, here, atol=1e-12)


def test_quaternions_are_scipys_with_the_scalar_first_and_do_not_jump_in_sign():
    angle = np.linspace(0, 4 * np.pi, 200)
    rotation = Rotation.from_rotvec(angle[:, None] * np.array([0.0, 0.6, 0.8]))
    q = frames.continuous(frames.from_rotation(rotation.as_matrix()))
    np.testing.assert_allclose(frames.to_rotation(q), rotation.as_matrix(), atol=1e-12)
    np.testing.assert_allclose(q[:, 0], np.cos(angle / 2), atol=1e-12)
    assert np.abs(np.diff(q, axis=0)).max() < 0.04  # a jump would be 2


def test_an_unknown_attitude_stays_unknown():
    q = np.array([[1.0, 0.0, 0.0, 0.0], [np.nan] * 4])
    rotation = frames.to_rotation(q)
    np.testing.assert_array_equal(rotation[0], np.eye(3))
    assert np.isnan(rotation[1]).all()


@pytest.mark.parametrize("name", ["paper-slow", "soft", "helix"])
def test_a_run_turned_over_feels_and_measures_the_same(name):
    """What the body feels is the truth's own accelerometer in the other axes: R'ᵀ(p̈' − g')."""
    p = preset.load(name)
    down, up = exported_run.run_of(p), exported_run.upright_run(p)
    assert (down.frame, up.frame) == ("z-down", "z-up")
    assert up.gravity == (0.0, 0.0, -9.81)
    felt = motion.apparent(up.rotation, up.acceleration, gravity=np.array(up.gravity))
    truth = record.simulated(record.truth_inputs(p)).motion.apparent_acceleration
    np.testing.assert_allclose(frames.vector(frames.FRD_FLU, felt), truth, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(up.accel, axis=-1), np.linalg.norm(down.accel, axis=-1), rtol=1e-15)
    distance = np.linalg.norm(up.position - np.array(up.anchor), axis=-1)
    np.testing.assert_allclose(distance, np.linalg.norm(down.position - np.array(down.anchor), axis=-1), atol=1e-12)


@pytest.mark.parametrize("turning", ["own", "flown"])
@pytest.mark.parametrize("kind", ["multisine", "formula", "polynomials"])
def test_a_preset_turned_over_is_the_same_flight(kind, turning):
    """The preset's inputs are turned, its truth recomputed: it must be the old truth in the other axes."""
    soft = preset.load("soft")
    changes = {"path": EXAMPLES[kind], "duration": 10.0, "requirement": preset.Requirement(window=4.0)}
    if turning == "flown":
        changes["angular_velocity"] = Flown(yaw="sin(t) + 0.3")
    p = preset.msgspec.structs.replace(soft, **changes)
    old = record.simulated(record.truth_inputs(p)).motion
    new = record.simulated(record.truth_inputs(upright(p))).motion
    F = frames.Z_UP_Z_DOWN
    np.testing.assert_allclose(new.position, old.position @ F, atol=1e-12)
    np.testing.assert_allclose(new.snap, old.snap @ F, atol=1e-9)
    np.testing.assert_allclose(new.rotation, F @ old.rotation @ F, atol=1e-9)
    np.testing.assert_allclose(new.angular_velocity, old.angular_velocity @ F, atol=1e-9)
    np.testing.assert_allclose(new.apparent_acceleration, old.apparent_acceleration @ F, atol=1e-9)


def test_a_preset_that_is_upright_already_stays_what_it_is():
    p = upright(preset.load("soft"))
    assert upright(p) == p


def test_gravity_beside_z_is_refused_where_z_must_point_up():
    p = preset.load("soft")
    world = preset.msgspec.structs.replace(p.world, gravity=(1.0, 0.0, 9.7))
    with pytest.raises(ValueError, match="gravity must lie along z"):
        upright(preset.msgspec.structs.replace(p, world=world))


def test_what_is_read_only_can_be_converted():
    """Arrays of results are read-only, and scipy's rotations of old versions refuse those."""
    rotation = np.eye(3)[None]
    rotation.flags.writeable = False
    np.testing.assert_array_equal(frames.from_rotation(rotation), [[1.0, 0.0, 0.0, 0.0]])
