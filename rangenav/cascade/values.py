"""What the cascaded observer is given and what it gives: configuration, start, one sample, its state, its estimate."""

from collections.abc import Sequence
from functools import cache
from types import ModuleType
from typing import Literal, NamedTuple

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray as Array

from rangenav import model
from rangenav.acquisition import PHASES
from rangenav.gains import Gains
from rangenav.kernels.layout import ACQUISITION_AT, PHASE, TIME_AT, Arrays, views
from rangenav.motion import World, to_inertial
from rangenav.results import result
from rangenav.sensors import Sensors


@result
class ObserverConfig:
    """What the observer knows beforehand: world, gains, the model's form, and the sensors' rates and noise."""

    world: World
    sensors: Sensors
    gains: Gains
    form: model.ModelForm = "derived"


@result
class Start:
    """An initial estimate."""

    state: Float[Array, "13"]
    """x̂(0), the 13-state of `model`, body axes."""
    rotation: Float[Array, "3 3"]
    """R̂(0), from body to inertial axes."""


@result
class Estimate:
    """What the observers estimate of a record, time first."""

    time: Float[Array, "n"]
    """s, the IMU's clock."""
    state: Float[Array, "n 13"]
    """x̂, the 13-state of `model`, body axes."""
    covariance: Float[Array, "n 3 3 3"]
    """Position, velocity and gravity blocks of P, body axes."""
    xi_variance: Float[Array, "n 4"]
    """The first four diagonal entries of P, of ξ1…ξ4."""
    rotation: Float[Array, "n 3 3"]
    """R̂, from body to inertial axes."""
    innovation: Float[Array, "m 2"]
    """y − ŷ (m²) and its variance P₁₁ + R (m⁴), one row for each range; NaN for a range before the first step."""
    k1: Float[Array, "n"] | None = None
    """1/s, the attitude gain in force, constant without a schedule; None for an estimator without this gain."""
    phase: Int[Array, "n"] | None = None
    """Which gains are in force, a place in `acquisition.PHASES`; None for an estimator without phases."""
    mag: Float[Array, "n 3"] | None = None
    """The magnetometer's vectors, turned by the gyro where it gave none; None for an estimator that keeps none."""

    @property
    def std(self) -> Float[Array, "n 13"]:
        """Square roots of P's diagonal in body axes; NaN where P has diverged."""
        vectors = np.diagonal(self.covariance, axis1=-2, axis2=-1).reshape(len(self.time), 9)
        with np.errstate(invalid="ignore"):
            return np.sqrt(np.concatenate([self.xi_variance, vectors], axis=-1))

    def position(self, world: World) -> Float[Array, "n 3"]:
        """p̂_I = p_anchor + R̂ p̂_B (m, inertial axes)."""
        return np.asarray(world.anchor) + to_inertial(self.rotation, self.state[:, model.POSITION])


class Sample(NamedTuple):
    """One IMU sample, with the ranges that came since the sample before it; body axes. Lists will do for arrays."""

    time: float
    """s"""
    gyro: Float[Array, "3"] | Sequence[float]
    """rad/s"""
    accel: Float[Array, "3"] | Sequence[float]
    """m/s², apparent acceleration (specific force) Rᵀ(p̈ − g)."""
    mag: Float[Array, "3"] | Sequence[float]
    """Unit vector; three NaN if the magnetometer gave no sample."""
    range_time: Float[Array, "r"] | Sequence[float]
    """s, increasing, after the time of the sample before and not after the time of this one; empty without ranges."""
    range: Float[Array, "r"] | Sequence[float]
    """m"""


@result
class State:
    """The observer between two samples, made by `begin` and `step`. Treat it as a value: `step` returns a new one."""

    packed: Float[Array, "k"]
    """All numbers that change, one after the other, in turned axes; read them through `state`, `std`, `rotation`."""
    packed_parameters: Float[Array, "p"]
    """The configuration in the kernel's terms."""

    @property
    def time(self) -> float:
        """s, of the last sample."""
        return float(self.packed[TIME_AT])

    @property
    def arrays(self) -> Arrays:
        """The parts of `packed`, as views of it."""
        return views(self.packed)

    @property
    def state(self) -> Float[Array, "13"]:
        """x̂, body axes."""
        return self._read()[0]

    @property
    def std(self) -> Float[Array, "13"]:
        """Square roots of P's diagonal, body axes, in the units of the state."""
        _, xi_variance, covariance = self._read()
        return np.sqrt(np.concatenate([xi_variance, np.diagonal(covariance, axis1=-2, axis2=-1).ravel()]))

    @property
    def rotation(self) -> Float[Array, "3 3"]:
        """R̂, from body to inertial axes."""
        return self.arrays.rotation

    @property
    def k1(self) -> float:
        """1/s, the attitude gain in force."""
        return kernel().k1(self.packed, self.packed_parameters)

    @property
    def phase(self) -> Literal["constant", "collecting", "matched", "lost"]:
        """Which gains are in force; see `acquisition.PHASES`."""
        return PHASES[int(self.packed[ACQUISITION_AT + PHASE])]

    def _read(self) -> tuple[Array, Array, Array]:
        states, xi_variance, covariances = np.empty((1, model.STATES)), np.empty((1, 4)), np.empty((1, 3, 3, 3))
        kernel().read(self.packed, 0, states, xi_variance, covariances)
        return states[0], xi_variance[0], covariances[0]


@cache
def attitude_kernel() -> ModuleType:
    """Likewise."""
    from rangenav.kernels import attitude as kernel

    return kernel


@cache
def sample_kernel() -> ModuleType:
    """Likewise."""
    from rangenav.kernels import one_sample as kernel

    return kernel


@cache
def lanes_kernel() -> ModuleType:
    """Likewise."""
    from rangenav.kernels import lanes as kernel

    return kernel


@cache
def kernel() -> ModuleType:
    """The compiled kernels, imported where they are used: numba alone takes as long to import as everything else."""
    from rangenav.kernels import cascade as kernel

    return kernel
