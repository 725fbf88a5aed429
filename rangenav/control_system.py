"""The observer in continuous time (paper, eq. 8–9) as a python-control `NonlinearIOSystem`, to connect with others.

    ẋ̂ = 𝒜(ω, a) x̂ + b(a) + K (½d² − x̂₁),  K = P𝒞ᵀq,   Ṗ = 𝒜P + P𝒜ᵀ − K𝒞P + V,   Ṙ̂ = R̂ [ω + k1 σ]x

Inputs are what the vehicle measures: gyro ω (rad/s), accel a (m/s²), mag m_y and range d (m), ten numbers. Outputs are
x̂ (13, body axes) and R̂ (9, row by row). `cascade.observe` is the same observer in discrete time: on a record the two
agree to the order h² of its steps. Gains are constant here: noise-matched gains and the schedule of k1 are defined for
samples only.
"""

from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav import attitude, model, so3
from rangenav.arguments import instance
from rangenav.cascade import ObserverConfig, Start, checked_start
from rangenav.inputs import require
from rangenav.model import GRAVITY, STATES

if TYPE_CHECKING:
    from control import NonlinearIOSystem

ESTIMATE = slice(0, STATES)
COVARIANCE = slice(STATES, STATES + STATES**2)
ROTATION = slice(STATES + STATES**2, STATES + STATES**2 + 9)
"""Where x̂, P and R̂ stand among the 191 states of the system."""
GYRO, ACCEL, MAG, RANGE = slice(0, 3), slice(3, 6), slice(6, 9), 9
"""Where the measurements stand among its inputs."""
INPUTS = [f"{name}[{axis}]" for name in ("gyro", "accel", "mag") for axis in range(3)] + ["range"]
OUTPUTS = [f"state[{k}]" for k in range(STATES)] + [f"rotation[{i},{j}]" for i in range(3) for j in range(3)]


def system(config: ObserverConfig, *, name: str = "observer") -> "NonlinearIOSystem":
    """The observer with these gains; its signals are called as in INPUTS and OUTPUTS.

    Simulate it from `initial_state` with `control.input_output_response`, or connect it with `control.interconnect`.
    Raises ValueError for noise-matched gains and for a schedule of k1.
    """
    import control

    instance("config", config, ObserverConfig, called="cascade.ObserverConfig")
    gains = config.gains
    require(gains.mode == "constant", "the observer in continuous time has constant gains, got noise-matched")
    require(gains.attitude.schedule is None, "the observer in continuous time has a constant k1, got a schedule")

    def update(t: float, states: Array, inputs: Array, params: dict) -> Array:
        return derivative(states, inputs, config)

    def output(t: float, states: Array, inputs: Array, params: dict) -> Array:
        return np.concatenate([states[ESTIMATE], states[ROTATION]])

    return control.NonlinearIOSystem(update, output, inputs=INPUTS, outputs=OUTPUTS, states=ROTATION.stop, name=name)


def initial_state(start: Start, config: ObserverConfig) -> Float[Array, "191"]:
    """x̂(0), the gains' P(0) and R̂(0) as the system's state. Raises ValueError for a start of the wrong shape."""
    start = checked_start(start)
    covariance = np.diag(config.gains.riccati.p0.diagonal())
    return np.concatenate([start.state, covariance.ravel(), start.rotation.ravel()])


def derivative(states: Float[Array, "191"], inputs: Float[Array, "10"], config: ObserverConfig) -> Float[Array, "191"]:
    """The right-hand side of the equations above, for one state and the measurements at that time."""
    x, R = states[ESTIMATE], states[ROTATION].reshape(3, 3)
    P = states[COVARIANCE].reshape(STATES, STATES)
    gyro, gains, world = inputs[GYRO], config.gains, config.world
    A, b = model.dynamics(gyro, inputs[ACCEL], gravity_norm=float(np.linalg.norm(world.gravity)), form=config.form)
    K = P[:, 0] * gains.riccati.q
    sigma = attitude.innovation(R, inputs[MAG], x[GRAVITY], gains=gains.attitude, world=world)
    x_rate = A @ x + b + K * (inputs[RANGE] ** 2 / 2 - x[0])
    P_rate = A @ P + P @ A.T - np.outer(K, P[0]) + np.diag(gains.riccati.v.diagonal())
    R_rate = R @ so3.hat(gyro + gains.attitude.k1 * sigma)
    return np.concatenate([x_rate, P_rate.ravel(), R_rate.ravel()])
