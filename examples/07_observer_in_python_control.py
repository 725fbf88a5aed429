"""
The observer in python-control
==============================

The observer of the paper, in continuous time, is a ``NonlinearIOSystem`` of python-control. Connect the observer with a
model of your own, simulate the two, or linearise them.
"""

# %%
# The model of this example is a vehicle whose attitude and position are known functions of time. Its outputs are the
# sensor measurements, without noise.
from typing import Any

import control
import numpy as np

from rangenav import cascade, control_system, model, preset, so3

chosen = preset.load("paper-slow")
gravity, magnetic = np.asarray(chosen.world.gravity), np.asarray(chosen.world.magnetic)
turning = np.array([0.0, 0.0, 0.3])  # rad/s, about the body's z axis


def measured(t, x, u, params):
    """Gyro, accel, mag and range of the vehicle at time t."""
    rotation, position = so3.exp(turning * t), chosen.path(np.array(t))
    accel = rotation.T @ (chosen.path(np.array(t), 2) - gravity)
    return np.concatenate([turning, accel, rotation.T @ magnetic, [np.linalg.norm(position)]])


vehicle = control.NonlinearIOSystem(None, measured, inputs=0, outputs=control_system.INPUTS, name="vehicle")

# %%
# The observer has the preset's gains. Connect each of its inputs to the output of the vehicle with the same name.
config = cascade.ObserverConfig(world=chosen.world, sensors=chosen.sensors, gains=chosen.gains)
observer = control_system.system(config)
both = control.interconnect(
    [vehicle, observer],
    connections=[[f"observer.{name}", f"vehicle.{name}"] for name in control_system.INPUTS],
    outlist=[f"observer.{name}" for name in control_system.OUTPUTS],
)

# %%
# The observer starts from x̂ = 0 and from an attitude that is 60° off. The truth is known, so the error is known.
start = cascade.Start(state=np.zeros(13), rotation=so3.exp(np.array([0.0, np.pi / 3, 0.0])))
begin: Any = control_system.initial_state(start, config)
time = np.linspace(0.0, 6.0, 13)
response = control.input_output_response(both, time, 0, begin, solve_ivp_kwargs={"method": "LSODA", "rtol": 1e-6})
for k in range(0, len(time), 2):
    rotation = so3.exp(turning * time[k])
    truth = rotation.T @ chosen.path(time[k : k + 1])[0]
    apart = np.linalg.norm(response.outputs[model.POSITION, k] - truth)
    estimate = response.outputs[13:, k].reshape(3, 3)
    angle = np.degrees(so3.angle(rotation @ estimate.T))
    print(f"{time[k]:.0f} s: position {apart:7.3f} m off, attitude {angle:5.1f}° off")
