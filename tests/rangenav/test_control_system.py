"""The observer as a system of python-control gives what `cascade.observe` gives, and connects with other systems."""

# pyright: reportArgumentType=false
# python-control infers from the defaults 0.0 of its arguments that arrays are not allowed there.

import control
import numpy as np
import pytest
from msgspec.structs import replace

from rangenav import cascade, control_system
from rangenav.attitude import SCHEDULED
from rangenav.cascade import Start
from rangenav.gains import Gains
from rangenav.model import STATES
from rangenav.riccati import Blocks, RiccatiGains
from tests.support import records
from tests.support.refusals import exactly

pytestmark = pytest.mark.slow


SOFT = Gains(
    riccati=RiccatiGains(
        q=10.0,
        v=Blocks(xi=0.1, position=0.01, velocity=0.1, gravity=0.01),
        p0=Blocks(xi=10.0, position=10.0, velocity=10.0, gravity=10.0),
    )
)
START = Start(state=np.zeros(STATES), rotation=np.eye(3))
TIGHT = {"rtol": 1e-8, "atol": 1e-10}


def measured(scene: records.Scene) -> np.ndarray:
    """What drives the system: one row for each input, one column for each sample; every range on an IMU stamp."""
    z = scene.measurements
    np.testing.assert_array_equal(z.range_time, z.time)
    return np.column_stack([z.gyro, z.accel, z.mag, z.range]).T


def test_its_response_is_what_observe_gives_to_the_order_of_its_steps():
    """python-control interpolates the inputs linearly between samples, an error of order h² like the observer's own."""
    scene = records.scene("paper-slow", duration=1.0, imu_rate=800.0, range_rate=800.0, noise=records.SILENT)
    config = scene.setting(SOFT)
    response = control.input_output_response(
        control_system.system(config),
        scene.measurements.time,
        measured(scene),
        control_system.initial_state(START, config),
        solve_ivp_kwargs=TIGHT,
    )
    estimate = cascade.observe(scene.measurements, START, config)
    scale = np.abs(estimate.state).max(axis=0)
    states, rotations = response.outputs[:STATES].T, response.outputs[STATES:].T.reshape(-1, 3, 3)
    assert (np.abs(states - estimate.state).max(axis=0) / scale).max() < 1e-3
    assert np.abs(rotations - estimate.rotation).max() < 1e-3


def test_it_connects_with_a_system_that_makes_its_measurements():
    """Hovering level 2 m from the anchor, ĝ right: with the true range and accel −g the estimate stays at the truth."""
    scene = records.scene("paper-slow", duration=1.0)
    config = scene.setting(SOFT)
    gravity, magnetic = np.asarray(config.world.gravity), np.asarray(config.world.magnetic)
    still = np.concatenate([np.zeros(3), -gravity, magnetic, [2.0]])
    vehicle = control.NonlinearIOSystem(
        None, lambda t, x, u, params: still, inputs=0, outputs=control_system.INPUTS, name="vehicle"
    )
    both = control.interconnect(
        [vehicle, control_system.system(config)],
        connections=[[f"observer.{name}", f"vehicle.{name}"] for name in control_system.INPUTS],
        outlist=[f"observer.{name}" for name in control_system.OUTPUTS],
    )
    truth = np.concatenate([[2.0, 0, 2 * gravity[2], 0], [0, 0, 2.0], np.zeros(3), gravity])
    time = np.linspace(0, 0.5, 6)
    begin = control_system.initial_state(Start(state=truth, rotation=np.eye(3)), config)
    response = control.input_output_response(both, time, 0, begin, solve_ivp_kwargs=TIGHT)
    np.testing.assert_allclose(response.outputs[:STATES].T, np.tile(truth, (6, 1)), atol=1e-6)


@pytest.mark.parametrize(
    ("gains", "sentence"),
    [
        (Gains(mode="noise-matched"), "the observer in continuous time has constant gains, got noise-matched"),
        (replace(Gains(), attitude=SCHEDULED), "the observer in continuous time has a constant k1, got a schedule"),
    ],
)
def test_what_is_defined_for_samples_only_is_refused(gains, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        control_system.system(records.scene("paper-slow", duration=1.0).setting(gains))
