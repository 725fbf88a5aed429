"""The attitude of a multirotor: thrust along the specific force, rates that are the derivatives of what they turn."""

import math
from collections.abc import Callable

import msgspec
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rangenav import motion, preset, record
from rangenav.analysis import analyse
from rangenav.motion import World
from rangenav.signals import Flown, Formula, Multisine, Tone, multirotor
from tests.support.signal_examples import EXAMPLES, WAYPOINTS

DOWN, UP = (0.0, 0.0, 9.81), (0.0, 0.0, -9.81)
GENTLE = Multisine(
    tones=(
        Tone(axis="x", amplitude=1.0, frequency=2.0),
        Tone(axis="y", amplitude=0.8, frequency=3.0, phase=1.0),
        Tone(axis="z", amplitude=0.3, frequency=4.0, phase=2.0),
    )
)
YAW = Flown(yaw="0.7*sin(1.3*t) + t/3")
gravities = pytest.mark.parametrize("gravity", [DOWN, UP])
both = pytest.mark.parametrize("judged", [multirotor.attitude, multirotor.refuse_undefined])
"""What has no attitude is refused by the attitude itself and, before a run, by a check of what it needs."""


@gravities
def test_a_hover_is_upright_and_still_whichever_way_z_points(gravity):
    body = multirotor.attitude(Flown(), Multisine(offset=(1.0, 2.0, 3.0)), gravity, np.linspace(0, 5, 11))
    np.testing.assert_allclose(body.rotation, np.broadcast_to(np.eye(3), (11, 3, 3)), atol=1e-15)
    np.testing.assert_array_equal(body.angular_velocity, 0.0)


@gravities
def test_yaw_turns_a_hover_about_the_vertical(gravity):
    t = np.linspace(0, 5, 11)
    body = multirotor.attitude(YAW, Multisine(), gravity, t)
    angle = 0.7 * np.sin(1.3 * t) + t / 3
    rotation = Rotation.from_euler("z", angle[:, None]).as_matrix()
    np.testing.assert_allclose(body.rotation, rotation, atol=1e-14)
    np.testing.assert_allclose(body.angular_velocity[:, 2], 0.91 * np.cos(1.3 * t) + 1 / 3, atol=1e-14)
    np.testing.assert_allclose(body.angular_acceleration[:, 2], -1.183 * np.sin(1.3 * t), atol=1e-14)


@gravities
@pytest.mark.parametrize("path", [GENTLE, EXAMPLES["formula"], WAYPOINTS])
def test_the_accelerometer_of_a_flown_body_feels_thrust_along_its_axis_alone(gravity, path):
    world = World(gravity=gravity, magnetic=(1.0, 0.0, 0.0))
    moved = motion.simulate(path, YAW, world=world, initial_rotation=(1.0, 0.0, 0.0), duration=6.0, rate=100.0)
    np.testing.assert_allclose(moved.apparent_acceleration[:, :2], 0, atol=1e-12)
    assert np.all(moved.apparent_acceleration[:, 2] * -np.sign(gravity[2]) > 0)
    unit = np.einsum("nij,nik->njk", moved.rotation, moved.rotation)
    np.testing.assert_allclose(unit, np.broadcast_to(np.eye(3), unit.shape), atol=1e-13)
    np.testing.assert_allclose(np.linalg.det(moved.rotation), 1, atol=1e-13)


@gravities
def test_angular_velocity_and_acceleration_are_the_derivatives_of_attitude(gravity):
    t = np.linspace(0, 6, 301)
    h = 1e-4
    before, body, after = (multirotor.attitude(YAW, GENTLE, gravity, t + shift) for shift in (-h, 0.0, h))
    turned = Rotation.from_matrix(np.einsum("nji,njk->nik", before.rotation, after.rotation)).as_rotvec()
    scale = np.linalg.norm(body.angular_acceleration, axis=1).max()
    # the mean rate over ±h differs by h²/6 of its second derivative, about ten times the first
    np.testing.assert_allclose(body.angular_velocity, turned / (2 * h), atol=2 * h**2 * 10 * scale + 1e-11 / h)
    difference = (after.angular_velocity - before.angular_velocity) / (2 * h)
    np.testing.assert_allclose(body.angular_acceleration, difference, atol=1e-5 * scale)


def test_integrating_the_rates_gives_the_attitude():
    t = motion.time_grid(6.0, 400.0)
    body = multirotor.attitude(YAW, GENTLE, DOWN, t)
    gauss = [
        multirotor.attitude(YAW, GENTLE, DOWN, t[:-1] + share / 400).angular_velocity for share in (0.2113, 0.7887)
    ]
    rotation = Rotation.from_matrix(body.rotation[0])
    for first, second in zip(*gauss, strict=True):
        rotation = rotation * Rotation.from_rotvec((first + second) / 800)
    error = (rotation.inv() * Rotation.from_matrix(body.rotation[-1])).magnitude()
    assert error < 1e-5  # order two on 2400 steps


@both
def test_a_free_fall_has_no_attitude_and_says_when(judged: Callable):
    falling = Formula(z="9.81*t**2/2")
    with pytest.raises(ValueError, match=r"flown: at t = 0 s the path falls freely \(specific force 0 m/s²\)"):
        judged(Flown(), falling, DOWN, np.linspace(0, 1, 5))
    passing = Formula(z="-4.905*cos(t)*2")  # its acceleration reaches gravity where cos t = 1
    with pytest.raises(ValueError, match=r"at t = 6.28 s the path falls freely"):
        judged(Flown(), passing, DOWN, np.linspace(3, 9, 6001))


@both
def test_thrust_straight_down_has_no_yaw_and_says_when(judged: Callable):
    diving = Formula(z="10*t**2")  # z is down: faster than falling
    with pytest.raises(ValueError, match="flown: at t = 0 s the thrust points straight down"):
        judged(Flown(), diving, DOWN, np.linspace(0, 1, 5))


@both
def test_a_yaw_that_is_no_formula_is_refused_at_its_column(judged: Callable):
    with pytest.raises(ValueError, match=r"yaw: sine is not known: did you mean sin\? \(column 3\)"):
        Flown(yaw="2*sine(t)")
    with pytest.raises(ValueError, match=r"1/t is not finite at t = 0 s"):
        judged(Flown(yaw="1/t"), GENTLE, DOWN, np.linspace(0, 1, 5))


def test_a_flown_preset_is_observed_and_its_gramian_does_not_care():
    soft = preset.load("soft")
    flying = msgspec.structs.replace(soft, angular_velocity=YAW)
    assert analyse(flying) is analyse(soft)
    run = record.run(flying)
    assert run.summary.steady_position < 0.5
    assert math.isfinite(run.summary.steady_attitude_deg)
    truth = run.truth.motion
    np.testing.assert_allclose(truth.apparent_acceleration[:, :2], 0, atol=1e-12)
