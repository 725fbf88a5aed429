"""The whole cascade step (state, covariance, attitude, outputs) beside a plain numpy loop, scipy's ODE and GTSAM's EKF.

The paper's path, gyro, accel, mag and range all at 200 Hz, plain constant gains. Ours is `cascade.observe` on a record,
checks and allocation of the results included. The peers do less where it says so; nothing is asked of them that we do
not do ourselves.
"""

from collections.abc import Callable

import msgspec
import numpy as np
from timing import Target, median_seconds, missing, report, versions

from rangenav import cascade, model, motion, plain, preset, sensors

RATE, SHORT, LONG = 200.0, 10.0, 100.0
RUNS, SLOW_RUNS = 51, 3
MOST_MICROSECONDS, NUMPY_RATIO, ODE_RATIO, EKF_RATIO = 1.0, 120.0, 500.0, 20.0
SINGLE_STEPS = 500


class Record:
    """A record of the paper's path of the given duration, and how the observers start on it."""

    def __init__(self, duration: float) -> None:
        self.preset = msgspec.structs.replace(preset.load("paper"), duration=duration)
        p = self.preset
        self.truth = motion.simulate(
            p.path,
            p.angular_velocity,
            world=p.world,
            initial_rotation=p.initial_rotation,
            duration=duration,
            rate=RATE,
        )
        rng = np.random.default_rng(p.seed)
        self.measurements = sensors.measure(self.truth, path=p.path, world=p.world, sensors=p.sensors, rng=rng)
        self.setting = cascade.Setting(world=p.world, sensors=p.sensors, gains=p.gains)
        first = model.true_state(self.truth, world=p.world)[0]
        self.start = cascade.start(p.guess, state=first, rotation=self.truth.rotation[0], world=p.world)
        self.steps = len(self.truth.time) - 1

    def microseconds(self, observe: Callable[..., object], runs: int) -> float:
        """Median time of one step."""
        return 1e6 * median_seconds(lambda: observe(self.measurements, self.start, self.setting), runs) / self.steps


def main() -> None:
    """Measure, compare, print."""
    short, long = Record(SHORT), Record(LONG)
    ours, ours_long = short.microseconds(cascade.observe, RUNS), long.microseconds(cascade.observe, RUNS // 3)
    numpy_loop = short.microseconds(plain.observe, SLOW_RUNS)
    ode, apart = _ode(short)
    rows = [
        _row(f"compiled cascade, {SHORT:g} s record", ours, ours),
        _row(f"compiled cascade, {LONG:g} s record", ours_long, ours),
        _row("compiled cascade, one sample at a time from Python", _single(short), ours),
        _row("the same scheme, plain numpy loop", numpy_loop, ours),
        _row("the paper's ODE, solve_ivp DOP853, rtol 1e-8", ode, ours),
    ]
    targets = [
        Target(name=f"step, {SHORT:g} s", value=ours, bound=MOST_MICROSECONDS, at_least=False, unit=" µs"),
        Target(name=f"step, {LONG:g} s", value=ours_long, bound=MOST_MICROSECONDS, at_least=False, unit=" µs"),
        Target(name="plain numpy loop / ours", value=numpy_loop / ours, bound=NUMPY_RATIO, at_least=True, unit="×"),
        Target(name="solve_ivp / ours", value=ode / ours, bound=ODE_RATIO, at_least=True, unit="×"),
    ]
    notes = [f"noise-free, the compiled observer ends {apart:.1e} from the ODE (largest entry of x̂)"]
    figures: dict[str, object] = {"microseconds_per_step": {row[0]: float(row[1]) for row in rows}}
    absent = missing("gtsam")
    if absent:
        notes.append(absent)
    else:
        ekf = _gtsam(short)
        rows += [_row(f"GTSAM NavStateImuEKF: {use}", value, ours) for use, value in ekf.items()]
        same = ekf["imu, range, mag"]
        targets.append(
            Target(name="NavStateImuEKF / ours", value=same / ours, bound=EKF_RATIO, at_least=True, unit="×")
        )
        notes.append(
            "NavStateImuEKF is judged with the sensors ours uses; its range and mag rows are computed in Python, "
            "and it starts at the truth"
        )
        figures["gtsam_microseconds_per_step"] = ekf
    report(
        "observer",
        title=f"One cascade step, the paper's path at {RATE:g} Hz",
        columns=("", "µs per step", "× ours"),
        rows=rows,
        targets=targets,
        notes=notes,
        figures=figures | {"versions": versions("numpy", "numba", "scipy", "gtsam")},
    )


def _row(name: str, microseconds: float, ours: float) -> tuple[str, str, str]:
    return name, f"{microseconds:.3g}", f"{microseconds / ours:.3g}"


def _single(record: Record) -> float:
    """Microseconds of one `cascade.step` called from Python, copies and checks included."""
    z = record.measurements
    samples = [
        cascade.Sample(z.time[k], z.gyro[k], z.accel[k], z.mag[k], z.range_time[k : k + 1], z.range[k : k + 1])
        for k in range(SINGLE_STEPS + 1)
    ]

    def run() -> None:
        state = cascade.begin(samples[0], record.start, record.setting, symmetric=True)
        for sample in samples[1:]:
            state = cascade.step(state, sample)

    return 1e6 * median_seconds(run, RUNS // 3) / SINGLE_STEPS


def _ode(record: Record) -> tuple[float, float]:
    """Microseconds per 200 Hz step of the integrated ODE, and how far it ends from our observer without noise."""
    from paper_ode import solve

    p, truth, start = record.preset, record.truth, record.start

    def run() -> np.ndarray:
        return solve(p, start.state, start.rotation, truth.rotation[0], truth.time)

    elapsed = median_seconds(run, SLOW_RUNS)
    silent = sensors.Noise(gyro=0.0, accel=0.0, mag=0.0, range=0.0)
    quiet = msgspec.structs.replace(p.sensors, noise=silent)
    z = sensors.measure(truth, path=p.path, world=p.world, sensors=quiet, rng=np.random.default_rng(0))
    ours = cascade.observe(z, start, record.setting).state[-1]
    return 1e6 * elapsed / record.steps, float(np.max(np.abs(ours - run()[-1, : model.STATES])))


def _gtsam(record: Record) -> dict[str, float]:
    """Microseconds per step of NavStateImuEKF with the IMU alone, and with the sensors added one by one."""
    from gtsam_ekf import USES, run

    truth, found = record.truth, {}
    for use in USES:

        def filter_record(use: str = use) -> np.ndarray:
            return run(
                record.preset,
                record.measurements,
                rotation=truth.rotation[0],
                position=truth.position[0],
                velocity=truth.velocity[0],
                use=use,
            )

        found[use] = 1e6 * median_seconds(filter_record, RUNS // 3) / record.steps
    return found


if __name__ == "__main__":
    main()
