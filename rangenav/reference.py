"""The reference implementation of the cascaded observer, in numpy and body axes: slow, readable, and a second witness.

The splitting is the kernel's, the coordinates are others. Here the transition is 𝒜's exponential turned by exp(−ω h), P
is in body axes, and the input matrices of the noise are written out; the kernel works in the gyro-integrated frame and
never turns P.
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav import attitude, riccati, so3
from rangenav.cascade import Estimate, ObserverConfig, Start, checked_start, ranges_at_imu_rate
from rangenav.model import GRAVITY, POSITION, STATES, VELOCITY, XI, ModelForm
from rangenav.sensors import Measurements, check


def observe(measurements: Measurements, start: Start, setting: ObserverConfig) -> Estimate:
    """Run both observers over a record; same arguments, result and errors as `cascade.observe`."""
    z, start = check(measurements), checked_start(start)
    observer = _Observer(setting, symmetric=ranges_at_imu_rate(z, setting.sensors))
    x, P, R = start.state.copy(), np.diag(setting.gains.riccati.p0.diagonal()), start.rotation.copy()
    mag = np.where(np.isnan(z.mag[0]), R.T @ np.asarray(setting.world.magnetic), z.mag[0])
    pending = _due_at_start(z, x, observer)
    j = int(np.searchsorted(z.range_time, z.time[0], side="right"))
    s, chosen = attitude.MISALIGNED, setting.gains.attitude
    rows, innovation = [(x, P, R, attitude.gain(chosen, s))], np.full((len(z.range), 2), np.nan)
    for k in range(1, len(z.time)):
        gravity = x[GRAVITY]
        if pending is not None:
            x, P = riccati.correct(x, P, *pending)
            pending = None
        t0, t1, reached, turned = z.time[k - 1], z.time[k], 0.0, np.eye(3)
        gyro, accel = (z.gyro[k - 1], z.gyro[k]), (z.accel[k - 1], z.accel[k])
        while j < len(z.range_time) and z.range_time[j] <= t1:
            fraction = 1.0 if z.range_time[j] == t1 else (z.range_time[j] - t0) / (t1 - t0)
            if fraction > reached:
                x, P, turned = observer.propagate(x, P, turned, gyro, accel, reached, fraction, t1 - t0)
                reached = fraction
            y, variance = observer.output(z.range[j]), observer.variance(x)
            if observer.symmetric and fraction == 1.0:
                variance *= 2
                pending = (y, variance)
            innovation[j] = y - x[0], P[0, 0] + observer.variance(x)
            x, P = riccati.correct(x, P, y, variance)
            j += 1
        if reached < 1.0:
            x, P, turned = observer.propagate(x, P, turned, gyro, accel, reached, 1.0, t1 - t0)
        if observer.matched:
            x, P = riccati.remind(x, P, t1 - t0)
        new_mag = turned.T @ mag if np.isnan(z.mag[k]).any() else z.mag[k]
        R, s = attitude.step(
            R, s, gyro, (mag, new_mag), (gravity, x[GRAVITY]), t1 - t0, gains=chosen, world=setting.world
        )
        mag = new_mag
        rows.append((x, P, R, attitude.gain(chosen, s)))
    return _estimate(z, rows, innovation)


class _Observer:
    """The configuration unpacked once; the methods depend on it and on their arguments only."""

    def __init__(self, setting: ObserverConfig, *, symmetric: bool) -> None:
        gains, sensors = setting.gains, setting.sensors
        self.matched = gains.mode == "noise-matched"
        self.symmetric = symmetric and not self.matched
        self.gravity_norm = float(np.linalg.norm(setting.world.gravity))
        self.form: ModelForm = setting.form
        self.v = np.full(STATES, riccati.V_RANGE[0]) if self.matched else gains.riccati.v.diagonal()
        self.constant_variance = sensors.range_rate / gains.riccati.q
        self.sigma = sensors.sigma.range
        self.accel_density = sensors.sigma.accel**2 / sensors.imu_rate
        self.gyro_density = sensors.sigma.gyro**2 / sensors.imu_rate

    def output(self, distance: float) -> float:
        """y = ½d², less the bias ½σ² when noise-matched."""
        return (distance**2 - (self.sigma**2 if self.matched else 0.0)) / 2

    def variance(self, x: Float[Array, "13"]) -> float:
        """Variance of one y (m⁴)."""
        if not self.matched:
            return self.constant_variance
        return max(2 * x[0], 0.0) * self.sigma**2 + self.sigma**4 / 2

    def noise(self, x: Float[Array, "13"]) -> Float[Array, "13 13"]:
        """Process-noise density V."""
        V = np.diag(self.v)
        if self.matched:
            accel, gyro = np.zeros((STATES, 3)), np.zeros((STATES, 3))
            accel[1], accel[2], accel[3] = x[POSITION], 2 * x[VELOCITY], 3 * x[GRAVITY]
            accel[VELOCITY] = np.eye(3)
            for block in (POSITION, VELOCITY, GRAVITY):
                gyro[block] = so3.hat(x[block])
            V = V + self.accel_density * accel @ accel.T + self.gyro_density * gyro @ gyro.T
        return V

    def propagate(
        self, x: Array, P: Array, turned: Array, gyro: tuple, accel: tuple, begin: float, end: float, interval: float
    ) -> tuple[Array, Array, Array]:
        """x̂ and P from one fraction of the interval to another, and the turn since the interval's start."""
        h, middle = (end - begin) * interval, (begin + end) / 2
        rate = gyro[0] + middle * (gyro[1] - gyro[0])
        turn = so3.exp(h * rate)
        first, last = (accel[0] + fraction * (accel[1] - accel[0]) for fraction in (begin, end))
        mean = (first + turn @ last) / 2
        P = P + self.noise(x) * (h / 2)
        x, P = riccati.predict(x, P, rate, mean, h, gravity_norm=self.gravity_norm, form=self.form)
        P = P + self.noise(x) * (h / 2)
        return x, P, turned @ turn


def _due_at_start(z: Measurements, x: Array, observer: _Observer) -> tuple[float, float] | None:
    at_start = z.range_time == z.time[0]
    if not at_start.any():
        return None
    return observer.output(z.range[at_start][-1]), observer.variance(x) * (2 if observer.symmetric else 1)


def _estimate(z: Measurements, rows: list, innovation: Array) -> Estimate:
    states, covariances, rotations, k1 = (np.array(part) for part in zip(*rows, strict=True))
    blocks = [covariances[:, block, block] for block in (POSITION, VELOCITY, GRAVITY)]
    return Estimate(
        time=z.time,
        state=states,
        covariance=np.stack(blocks, axis=1),
        xi_variance=np.diagonal(covariances[:, XI, XI], axis1=-2, axis2=-1),
        rotation=rotations,
        k1=k1,
        innovation=innovation,
    )
