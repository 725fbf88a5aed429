"""pybounds' observability of sliding windows, with JAX, for the same 13-state lifted model.

The program follows pybounds' documentation. A `JaxSimulator` is made from f(x, u) and h(x, u); it integrates by
Runge–Kutta 4 and holds each input over a sample, here the input at the sample's middle. A
`JaxSlidingEmpiricalObservabilityMatrix` follows the trajectory, and a `SlidingFisherObservability` its windows. Every
call compiles again, because the class makes a new jitted function each time. That is most of the time of a call: the
compiled Jacobians take about 12 ms, but no public name gives access to them.
"""

# pyright: reportMissingImports=false
# Only the extra `bench` installs jax and pybounds: this module is imported where they are, and checked everywhere.

import warnings

import jax.numpy as jnp
import numpy as np
from pybounds import JaxSimulator, JaxSlidingEmpiricalObservabilityMatrix, SlidingFisherObservability

from rangenav import model, motion
from rangenav.preset import Preset

STATES = ["xi1", "xi2", "xi3", "xi4", "px", "py", "pz", "vx", "vy", "vz", "gx", "gy", "gz"]
INPUTS = ["wx", "wy", "wz", "ax", "ay", "az"]


class Peer:
    """A trajectory sampled at `rate` (Hz), and pybounds' simulator of the lifted model."""

    def __init__(self, preset: Preset, *, windows: int, samples: int, rate: float) -> None:
        truth = motion.simulate(
            preset.path,
            preset.angular_velocity,
            world=preset.world,
            initial_rotation=preset.initial_rotation,
            duration=(windows + samples - 1) / rate,
            rate=2 * rate,
        )
        self.time, self.samples = truth.time[:-1:2], samples
        self.state = model.true_state(truth, world=preset.world)[:-1:2]
        middle = slice(1, None, 2)
        self.input = np.concatenate([truth.angular_velocity[middle], truth.apparent_acceleration[middle]], axis=1)
        gravity_square = float(np.dot(preset.world.gravity, preset.world.gravity))
        self.simulator = JaxSimulator(_dynamics(gravity_square), _output, 1 / rate, STATES, INPUTS, ["y"])

    def gramians(self) -> np.ndarray:
        """(windows, 13, 13): OᵀO of every window over its number of samples, which tends to (1/δ)∫."""
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            sliding = JaxSlidingEmpiricalObservabilityMatrix(
                self.simulator, self.time, self.state, self.input, w=self.samples
            )
            fisher = SlidingFisherObservability(sliding.O_df_sliding, R=1.0, time=sliding.O_time)
        return np.stack([window.F.to_numpy() for window in fisher.FO]) / self.samples


def _dynamics(gravity_square: float):
    def rate(x, u):
        omega, a, p, v, g = u[:3], u[3:], x[4:7], x[7:10], x[10:13]
        xi = jnp.stack([x[1], x[2] + a @ p, x[3] + 2 * a @ v, 3 * a @ g + 3 * gravity_square])
        turning = [-jnp.cross(omega, p) + v, -jnp.cross(omega, v) + g + a, -jnp.cross(omega, g)]
        return jnp.concatenate([xi, *turning])

    return rate


def _output(x, u):
    return x[:1]
