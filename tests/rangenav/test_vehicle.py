"""Vehicles: which limit a motion breaks, when, and that margin is kept."""

import math

import msgspec
import numpy as np
import pytest

from rangenav import motion, preset, vehicle
from rangenav.motion import World
from rangenav.signals import Flown, Multisine, Tone
from rangenav.vehicle import CATALOGUE, CRAZYFLIE, FIVE_INCH, FREE, HAND_HELD, Vehicle


def simulated(p, turning=None):
    return motion.simulate(
        p.path,
        turning or p.angular_velocity,
        world=p.world,
        initial_rotation=p.initial_rotation,
        duration=p.duration,
        rate=p.sensors.imu_rate,
    )


def circling(w, radius=1.0):
    """A horizontal circle: everything about it is known in closed form."""
    tones = (
        Tone(axis="x", amplitude=radius, frequency=w, phase=math.pi / 2),
        Tone(axis="y", amplitude=radius, frequency=w),
    )
    world = World(anchor=(0.0, 0.0, 1.5))
    path = Multisine(tones=tones, offset=(0.0, 0.0, -2.0))
    moved = motion.simulate(path, Flown(), world=world, initial_rotation=(0, 0, 0), duration=10.0, rate=100.0)
    return moved, world


@pytest.mark.parametrize(("w", "radius"), [(2.0, 1.0), (3.0, 0.5)])
def test_demands_of_a_circle_are_those_of_the_textbook(w, radius):
    moved, world = circling(w, radius)
    asked = vehicle.demands(moved, world=world)
    centripetal = radius * w**2
    for computed, expected in [
        (asked.speed, radius * w),
        (asked.acceleration, centripetal),
        (asked.jerk, radius * w**3),
        (asked.snap, radius * w**4),
        (asked.thrust_to_weight, math.hypot(1, centripetal / 9.81)),
        (asked.tilt, math.atan2(centripetal, 9.81)),
        (asked.height, 2.0),  # z points down
        (asked.anchor_distance, math.hypot(radius, 3.5)),
    ]:
        np.testing.assert_allclose(computed, expected, rtol=1e-9)


def test_demands_agree_with_the_limits_of_a_motion():
    p = preset.load("paper-slow")
    moved = simulated(p)
    limits, asked = motion.limits(moved, world=p.world), vehicle.demands(moved, world=p.world)
    for name in ("speed", "acceleration", "jerk", "snap", "body_rate"):
        assert getattr(limits, name) == pytest.approx(float(getattr(asked, name).max()), rel=1e-12)
    assert limits.thrust_to_weight == pytest.approx(float(asked.thrust_to_weight.max()), rel=1e-12)
    assert limits.anchor_distance_min == pytest.approx(float(asked.anchor_distance.min()), rel=1e-12)


def test_a_free_vehicle_breaks_nothing_and_the_papers_path_breaks_all_that_fly():
    p = preset.load("paper")
    moved = simulated(p)
    assert vehicle.broken(moved, FREE, world=p.world) == ()
    for flying in (CRAZYFLIE, FIVE_INCH):
        limits = {one.limit for one in vehicle.broken(moved, flying, world=p.world)}
        assert {"thrust_to_weight", "tilt"} <= limits


def test_thrust_keeps_35_percent_in_hand():
    """One limit stands where 1.35 times the thrust needed is what the vehicle has."""
    needed = math.hypot(1, 4 / 9.81)
    moved, world = circling(2.0)
    enough, little = (Vehicle(name="v", thrust_to_weight=needed * 1.35 * share) for share in (1.001, 0.999))
    assert vehicle.broken(moved, enough, world=world) == ()
    (breaks,) = vehicle.broken(moved, little, world=world)
    assert breaks.reached == pytest.approx(needed)
    assert "35% kept in hand" in breaks.summary
    assert breaks.where.all()


def test_where_a_limit_breaks_and_when_it_is_worst_are_told():
    path = Multisine(tones=(Tone(axis="x", amplitude=2.0, frequency=math.pi / 2),))
    moved = motion.simulate(path, Multisine(), world=World(), initial_rotation=(0, 0, 0), duration=4.0, rate=100.0)
    slow = Vehicle(name="slow", speed=2.0, anchor_distance_min=0.5)
    breaks = {one.limit: one for one in vehicle.broken(moved, slow, world=World())}
    assert set(breaks) == {"speed", "anchor_distance_min"}
    assert breaks["speed"].reached == pytest.approx(math.pi)
    assert breaks["speed"].at in (0.0, 2.0, 4.0)
    np.testing.assert_array_equal(breaks["speed"].where, np.abs(np.cos(math.pi / 2 * moved.time)) * math.pi > 2)
    assert breaks["anchor_distance_min"].at in (0.0, 2.0, 4.0)
    assert breaks["speed"].summary == f"speed 3.14 m/s at t = {breaks['speed'].at:.2f} s, above the most allowed, 2"


def test_floor_and_ceiling_follow_gravity():
    for gravity, offset in (((0.0, 0.0, 9.81), (0.0, 0.0, -2.0)), ((0.0, 0.0, -9.81), (0.0, 0.0, 2.0))):
        world = World(gravity=gravity, magnetic=(1.0, 0.0, 0.0))
        still = motion.simulate(
            Multisine(offset=offset), Multisine(), world=world, initial_rotation=(0, 0, 0), duration=1.0, rate=50.0
        )
        inside = Vehicle(name="v", height_min=0.0, height_max=2.5)
        low = Vehicle(name="v", height_max=1.5)
        assert vehicle.broken(still, inside, world=world) == ()
        assert [one.limit for one in vehicle.broken(still, low, world=world)] == ["height_max"]


def test_uses_say_how_far_every_limit_is_used():
    moved, world = circling(2.0)
    used = {use.name: use for use in vehicle.uses(moved, CRAZYFLIE, world=world)}
    assert used["speed"].share == pytest.approx(2.0 / 8.3)
    assert used["thrust"].share == pytest.approx(math.hypot(1, 4 / 9.81) * 1.35 / 1.95)
    assert used["tilt"].reached == pytest.approx(math.degrees(math.atan(4 / 9.81)))
    assert used["least distance to the anchor"].share == pytest.approx(0.1 / math.hypot(1, 3.5))
    limits = {one.limit for one in vehicle.broken(moved, CRAZYFLIE, world=world)}
    assert used["thrust"].broken == ("thrust_to_weight" in limits)
    free = vehicle.uses(moved, FREE, world=world)
    assert all(use.allowed is None and use.share == 0.0 and not use.broken for use in free)
    assert not any("height" in use.name for use in free)


def test_a_preset_holds_its_vehicle_and_old_files_mean_a_free_one():
    soft = preset.load("soft")
    assert soft.vehicle == FREE
    assert "[vehicle]" not in preset.dumps(soft)
    for chosen in CATALOGUE:
        p = msgspec.structs.replace(soft, vehicle=chosen)
        assert preset.loads(preset.dumps(p), source="round trip") == p


@pytest.mark.parametrize(
    ("fields", "sentence"),
    [
        ({"name": ""}, "name must have 1 to 40 characters, got 0"),
        ({"name": "v", "speed": 0.0}, "speed must be positive, got 0"),
        ({"name": "v", "tilt": -1.0}, "tilt must be positive, got -1"),
        ({"name": "v", "jerk": math.nan}, "jerk must be a finite number, got nan"),
        ({"name": "v", "height_min": 2.0, "height_max": 1.0}, "height_min must be below height_max"),
    ],
)
def test_a_vehicle_that_cannot_be_is_refused(fields, sentence):
    with pytest.raises(ValueError, match=sentence):
        Vehicle(**fields)


def test_the_catalogue_names_four():
    assert [one.name for one in CATALOGUE] == ["free", "hand-held", "Crazyflie 2.1", "5-inch quad"]
    assert HAND_HELD.thrust_to_weight is None
