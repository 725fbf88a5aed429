"""One step of the cascade (state, covariance, attitude, outputs), compared with a numpy loop, an ODE and GTSAM's EKF.

The record follows the paper's path, with gyro, accel, mag and range at 200 Hz; the gains are constant. The cascade is
timed as `cascade.observe` on a record, with its checks and the allocation of its results. The name of a program that
computes less says so; none computes more.
"""

import dataclasses
from collections.abc import Callable
from functools import partial

import msgspec
import numpy as np
import paper_ode
from timing import Target, alternate, missing, report, versions

from rangenav import cascade, model, motion, preset, reference, sensors

RATE, SHORT, LONG = 200.0, 10.0, 100.0
ROUNDS, SHORT_REPEATS, FAST_REPEATS = 5, 20, 3
MAX_SINGLE = 5.0
"""µs of one `cascade.step` from Python, with its checks."""
MAX_MICROSECONDS, NUMPY_RATIO, ODE_RATIO, EKF_RATIO = 0.6, 120.0, 500.0, 20.0
SINGLE_STEPS = 500
MAX_EACH, TOGETHER = 0.25, 8
"""µs of one run and step, and the runs, with constant gains side by side."""

RANGENAV, RANGENAV_LONG = f"compiled cascade, {SHORT:g} s record", f"compiled cascade, {LONG:g} s record"
SINGLE = "compiled cascade, one sample at a time from Python"
SEEDS, GAINS = f"{TOGETHER} seeds side by side, one run", f"{TOGETHER} gains on one record, one run"
NUMPY = "the same scheme as a numpy loop (rangenav.reference)"
ODE = "the paper's ODE, solve_ivp DOP853, rtol 1e-8"
EKF = "GTSAM NavStateImuEKF: {}"
INVARIANT = "GTSAM InvariantEKFNavState: imu, range, mag"


class Record:
    """A record of the paper's path of the given duration, and how the observers start on it."""

    def __init__(self, duration: float) -> None:
        self.preset = p = msgspec.structs.replace(preset.load("paper"), duration=duration)
        self.truth = motion.simulate(
            p.path,
            p.angular_velocity,
            world=p.world,
            initial_rotation=p.initial_rotation,
            duration=duration,
            rate=RATE,
        )
        self.observer_config = cascade.ObserverConfig(world=p.world, sensors=p.sensors, gains=p.gains)
        first = model.true_state(self.truth, world=p.world)[0]
        self.start = cascade.start(p.guess, state=first, rotation=self.truth.rotation[0], world=p.world)
        self.measurements = self.measured()
        self.steps = len(self.truth.time) - 1

    def measured(self, noise: sensors.Noise | None = None, *, seed: int | None = None) -> sensors.Measurements:
        """What sensors with this noise record, by default with the preset's noise and seed."""
        p = self.preset
        noisy = p.sensors if noise is None else msgspec.structs.replace(p.sensors, noise=noise)
        rng = np.random.default_rng(p.seed if seed is None else seed)
        return sensors.measure(self.truth, path=p.path, world=p.world, sensors=noisy, rng=rng)

    def by(self, observe: Callable[..., object]) -> Callable[[], object]:
        """The call that observes this record."""
        return lambda: observe(self.measurements, self.start, self.observer_config)


def main() -> None:
    """Measure, compare, print."""
    short, long = Record(SHORT), Record(LONG)
    calls: dict[str, tuple[Callable[[], object], int]] = {
        RANGENAV: (short.by(cascade.observe), SHORT_REPEATS),
        RANGENAV_LONG: (long.by(cascade.observe), FAST_REPEATS),
        SINGLE: (_single(short), SHORT_REPEATS),
        SEEDS: (_seeds(short), SHORT_REPEATS),
        GAINS: (_gains(short), SHORT_REPEATS),
        NUMPY: (short.by(reference.observe), 1),
        ODE: (lambda: _integrated(short), 1),
    }
    steps = dict.fromkeys(calls, short.steps) | {
        RANGENAV_LONG: long.steps,
        SINGLE: SINGLE_STEPS,
        SEEDS: TOGETHER * short.steps,
        GAINS: TOGETHER * short.steps,
    }
    notes = [f"noise-free, the compiled observer ends {_apart(short):.1e} from the ODE (largest entry of x̂)"]
    absent = missing("gtsam")
    if absent:
        notes.append(absent)
    else:
        peers = _gtsam(short)
        calls |= {name: (call, FAST_REPEATS) for name, call in peers.items()}
        steps |= dict.fromkeys(peers, short.steps)
        notes.append(
            "GTSAM's filters start at the truth; range and mag rows are computed in Python, and so is the increment of "
            "InvariantEKFNavState, which has no IMU: see gtsam_ekf.py"
        )
    microseconds = {name: 1e6 * value / steps[name] for name, value in alternate(calls, ROUNDS).items()}
    report(
        "observer",
        title=f"One cascade step, the paper's path at {RATE:g} Hz",
        columns=("", "µs per step", "× rangenav"),
        rows=[(name, f"{value:.3g}", f"{value / microseconds[RANGENAV]:.3g}") for name, value in microseconds.items()],
        targets=_targets(microseconds),
        notes=notes,
        figures={"microseconds_per_step": microseconds, "versions": versions("numpy", "numba", "scipy", "gtsam")},
    )


def _targets(microseconds: dict[str, float]) -> list[Target]:
    """The bounds; the EKF is judged with the sensors that the cascade uses."""
    steps = [
        Target(name=name, value=microseconds[name], bound=MAX_MICROSECONDS, at_least=False, unit=" µs")
        for name in (RANGENAV, RANGENAV_LONG)
    ]
    steps.append(Target(name=SINGLE, value=microseconds[SINGLE], bound=MAX_SINGLE, at_least=False, unit=" µs"))
    steps += [
        Target(name=name, value=microseconds[name], bound=MAX_EACH, at_least=False, unit=" µs")
        for name in (SEEDS, GAINS)
    ]
    bounds = {NUMPY: NUMPY_RATIO, ODE: ODE_RATIO, EKF.format("imu, range, mag"): EKF_RATIO}
    ratios = [
        Target(
            name=f"{name} / rangenav",
            value=microseconds[name] / microseconds[RANGENAV],
            bound=bound,
            at_least=True,
            unit="×",
        )
        for name, bound in bounds.items()
        if name in microseconds
    ]
    return steps + ratios


def _single(record: Record) -> Callable[[], None]:
    """`SINGLE_STEPS` steps from Python, one sample at a time, copies of the state included."""
    z = record.measurements
    samples = [
        cascade.Sample(z.time[k], z.gyro[k], z.accel[k], z.mag[k], z.range_time[k : k + 1], z.range[k : k + 1])
        for k in range(SINGLE_STEPS + 1)
    ]

    def run() -> None:
        state = cascade.begin(samples[0], record.start, record.observer_config, symmetric=True)
        for sample in samples[1:]:
            state = cascade.step(state, sample)

    return run


def _seeds(record: Record) -> Callable[[], object]:
    """The observer on records that differ in their noise."""
    p = record.preset
    each = [record.measured(seed=p.seed + k) for k in range(TOGETHER)]
    return partial(cascade.observe_each, each, [record.start] * TOGETHER, [record.observer_config] * TOGETHER)


def _gains(record: Record) -> Callable[[], object]:
    """Observers with other gains on one record."""
    gains, replace = record.preset.gains, msgspec.structs.replace
    each = [replace(gains, riccati=replace(gains.riccati, q=gains.riccati.q / 2.0**k)) for k in range(TOGETHER)]
    settings = [dataclasses.replace(record.observer_config, gains=one) for one in each]
    return partial(cascade.observe_each, [record.measurements] * TOGETHER, [record.start] * TOGETHER, settings)


def _integrated(record: Record) -> np.ndarray:
    """The paper's equations at every IMU stamp."""
    truth, start = record.truth, record.start
    return paper_ode.solve(record.preset, start.state, start.rotation, truth.rotation[0], truth.time)


def _apart(record: Record) -> float:
    """Largest difference of the final x̂ from the ODE without noise: both computed the same task."""
    quiet = record.measured(sensors.Noise(gyro=0.0, accel=0.0, mag=0.0, range=0.0))
    compiled = cascade.observe(quiet, record.start, record.observer_config).state[-1]
    return float(np.max(np.abs(compiled - _integrated(record)[-1, : model.STATES])))


def _gtsam(record: Record) -> dict[str, Callable[[], object]]:
    """NavStateImuEKF with the IMU alone, and with the other sensors added one by one."""
    import gtsam_ekf

    p, truth = record.preset, record.truth
    first = gtsam_ekf.start(truth.rotation[0], truth.position[0], truth.velocity[0])
    runs = {EKF.format(use): partial(gtsam_ekf.run, p, record.measurements, first, use=use) for use in gtsam_ekf.USES}
    return {**runs, INVARIANT: partial(gtsam_ekf.run_invariant, p, record.measurements, first)}


if __name__ == "__main__":
    main()
