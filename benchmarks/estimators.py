"""How good estimators are and from where they converge: cascade, its refinement, our EKF, GTSAM's EKF and batch.

20 s, everything at 200 Hz with the default noise. Steady: RMS over the last half, medians over seeds, position in body
axes. The cascade starts at x̂ = 0 with R̂ a quarter turn off, the refinement from the cascade, the filters at the truth,
the batch where our smoother starts. Random starts: position and velocity off by 2 m and 2 m/s (1 σ on each axis), any
attitude; a start converged if position and attitude are within 0.5 m and 5° (RMS over the last quarter).
"""

import argparse
import time
from collections.abc import Callable
from dataclasses import dataclass

import msgspec
import numpy as np
from cases import DURATION, FAR, NEAR, RATE, Case, Found, case
from rich.progress import track
from timing import Target, missing, report, versions

from rangenav import baselines, cascade, record, refine, strapdown
from rangenav.gains import Gains

PATHS = ("paper", "paper-slow", "lissajous", "soft")
SEEDS, STARTS, COLD_BATCHES = 10, 20, 10
NEAR_POSITION, NEAR_ATTITUDE = 0.5, 5.0
MATCHED = Gains(mode="noise-matched")
LOW = msgspec.structs.replace(MATCHED, attitude=msgspec.structs.replace(MATCHED.attitude, k1=0.5))
CONSTANT, NOISE_MATCHED, LOW_K1 = (
    "cascade, constant gains",
    "cascade, noise-matched",
    "the same with k1 = 0.5",
)
EKF, REFINED = "our EKF", "refinement"
GTSAM_EKF, BATCH_50, BATCH_200 = "GTSAM EKF", "GTSAM batch, 50 Hz keys", "GTSAM batch, 200 Hz keys"
BOUNDS = {
    ("paper", REFINED): 0.025,
    ("paper-slow", REFINED): 0.025,
    ("paper", NOISE_MATCHED): 0.045,
    ("paper-slow", NOISE_MATCHED): 0.075,
}
MOST_DEGREES, MOST_MILLISECONDS, MOST_APART = 0.4, 50.0, 1e-3
NAVLIE = "navlie does not install here; MATH.md §10 has for its EKF .047 m/.34°, 550–770 µs per step, 6–12 of 16 starts"


def by_cascade(gains: Gains | None = None) -> Callable[[Case], Found]:
    """The cascade with the given gains, or the preset's."""

    def run(c: Case) -> Found:
        began = time.process_time()
        estimate = cascade.observe(c.measurements, c.start, c.setting(gains))
        seconds = time.process_time() - began
        return Found(position=estimate.position(c.preset.world), rotation=estimate.rotation, seconds=seconds)

    return run


def by_refinement(c: Case) -> Found:
    """The smoother, started by the cascade with the preset's gains; its time is its own."""
    estimate = cascade.observe(c.measurements, c.start, c.setting())
    began = time.process_time()
    refined = refine.refine(c.measurements, estimate, c.setting()).track
    return Found(position=refined.position, rotation=refined.rotation, seconds=time.process_time() - began)


def by_ekf(c: Case) -> Found:
    """Our extended Kalman filter."""
    began = time.process_time()
    filtered = baselines.filtered(c.measurements, c.near(), FAR if c.cold else NEAR, c.setting())
    return Found(position=filtered.position, rotation=filtered.rotation, seconds=time.process_time() - began)


def by_gtsam_ekf(c: Case) -> Found:
    """GTSAM's, with range and magnetometer."""
    import gtsam_ekf

    position, velocity, rotation = c.near()
    first = gtsam_ekf.start(rotation, position, velocity)
    sigma = tuple(np.sqrt(np.diag(FAR if c.cold else NEAR))[[6, 0, 3]])
    began = time.process_time()
    positions, rotations = [position], [rotation]
    for ekf in gtsam_ekf.steps(c.preset, c.measurements, first, use=gtsam_ekf.USES[2], sigma=sigma):
        state = ekf.state()
        positions.append(state.position())
        rotations.append(state.attitude().matrix())
    seconds = time.process_time() - began
    return Found(position=np.array(positions), rotation=np.array(rotations), seconds=seconds)


def by_gtsam_batch(every: int) -> Callable[[Case], Found]:
    """GTSAM's graph: from where our smoother starts, or cold by dead reckoning from the random start."""
    import gtsam_batch

    def run(c: Case) -> Found:
        first = _dead_reckoned(c) if c.cold else _started(c)
        start = gtsam_batch.Trajectory(first.position, first.velocity, first.rotation)
        began = time.process_time()
        solved, _ = gtsam_batch.solve(c.preset, c.measurements, start, every=every)
        seconds = time.process_time() - began
        return Found(position=solved.position, rotation=solved.rotation, seconds=seconds, every=every)

    return run


def _started(c: Case) -> strapdown.Track:
    return refine.started(c.measurements, cascade.observe(c.measurements, c.start, c.setting()), c.setting())


def _dead_reckoned(c: Case) -> strapdown.Track:
    """The filter with neither ranges nor magnetometer."""
    z = c.measurements
    silent = record.Measurements(
        time=z.time,
        gyro=z.gyro,
        accel=z.accel,
        mag=np.full_like(z.mag, np.nan),
        range_time=np.empty(0),
        range=np.empty(0),
    )
    return baselines.filtered(silent, c.near(), FAR, c.setting())


def attempt(run: Callable[[Case], Found], c: Case) -> tuple[np.ndarray, np.ndarray, float]:
    """Errors over time and seconds; infinite ones where a peer stops with an exception or gives no numbers."""
    try:
        with np.errstate(all="ignore"):
            found = run(c)
            position, attitude = c.errors(found)
        return np.nan_to_num(position, nan=np.inf), np.nan_to_num(attitude, nan=np.inf), found.seconds
    except (RuntimeError, ValueError):  # GTSAM's indeterminate system, or a rotation it refuses
        return np.full(2, np.inf), np.full(2, np.inf), np.nan


def rms(errors: np.ndarray, share: float) -> float:
    """Over the last share of the record."""
    return float(np.sqrt(np.mean(errors[int(len(errors) * (1 - share)) :] ** 2)))


def contenders() -> dict[str, tuple[Callable[[Case], Found], int]]:
    """Each estimator with the number of random starts it is asked for."""
    found: dict[str, tuple[Callable[[Case], Found], int]] = {
        CONSTANT: (by_cascade(), STARTS),
        NOISE_MATCHED: (by_cascade(MATCHED), STARTS),
        LOW_K1: (by_cascade(LOW), STARTS),
        REFINED: (by_refinement, STARTS),
        EKF: (by_ekf, STARTS),
    }
    if missing("gtsam") is None:
        found |= {
            GTSAM_EKF: (by_gtsam_ekf, STARTS),
            BATCH_50: (by_gtsam_batch(4), COLD_BATCHES),
            BATCH_200: (by_gtsam_batch(1), 0),
        }
    return found


@dataclass(frozen=True, kw_only=True)
class Figures:
    """One estimator on one path."""

    position: float
    worst_position: float
    attitude_deg: float
    milliseconds: float
    """Of processor time, for 10 s of record: on a busy machine it is steadier than the clock."""
    converged: int
    starts: int


def measure(run: Callable[[Case], Found], name: str, *, seeds: int, starts: int) -> Figures:
    """Medians over seeds, and the count of random starts that converge."""
    run(case(name, 0, cold=False))  # compiled, and in the cache
    warm = [attempt(run, case(name, seed, cold=False)) for seed in range(seeds)]
    positions = [rms(position, 0.5) for position, _, _ in warm]
    cold = [attempt(run, case(name, seed, cold=True)) for seed in range(starts)]
    there = [rms(p, 0.25) < NEAR_POSITION and rms(a, 0.25) < NEAR_ATTITUDE for p, a, _ in cold]
    return Figures(
        position=float(np.median(positions)),
        worst_position=float(np.max(positions)),
        attitude_deg=float(np.median([rms(attitude, 0.5) for _, attitude, _ in warm])),
        milliseconds=float(np.median([seconds for _, _, seconds in warm])) * 1e3 * 10 / DURATION,
        converged=int(np.sum(there)),
        starts=starts,
    )


def main() -> None:
    """Measure, compare, print."""
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--seeds", type=int, default=SEEDS)
    seeds = arguments.parse_args().seeds
    asked, names = contenders(), [(path, name) for path in PATHS for name in contenders()]
    figures = {
        (path, name): measure(asked[name][0], path, seeds=seeds, starts=asked[name][1])
        for path, name in track(names, description="estimators", transient=True)
    }
    notes = [
        NAVLIE,
        f"medians of {seeds} seeds; batches: the graph built in Python included, cold ones start dead reckoned",
    ]
    if absent := missing("gtsam"):
        notes.append(absent)
    report(
        "estimators",
        title=f"{DURATION:g} s at {RATE:g} Hz; {seeds} seeds",
        columns=("path", "estimator", "position m (worst)", "attitude °", "random starts", "CPU ms per 10 s"),
        rows=[_row(path, name, f) for (path, name), f in figures.items()],
        targets=_targets(figures),
        notes=notes,
        figures={
            "figures": [
                {"path": path, "estimator": name, **{key: getattr(f, key) for key in f.__dataclass_fields__}}
                for (path, name), f in figures.items()
            ],
            "versions": versions("numpy", "numba", "gtsam"),
        },
    )


def _row(path: str, name: str, f: Figures) -> tuple[str, ...]:
    share = f"{f.converged}/{f.starts}" if f.starts else "–"
    accuracy = f"{f.position:.3f} ({f.worst_position:.3f})"
    return path, name, accuracy, f"{f.attitude_deg:.2f}", share, f"{f.milliseconds:.3g}"


def _targets(figures: dict[tuple[str, str], Figures]) -> list[Target]:
    targets = [
        Target(name=f"{name}, {path}", value=figures[path, name].position, bound=bound, at_least=False, unit=" m")
        for (path, name), bound in BOUNDS.items()
    ]
    low, slowest = figures["paper", LOW_K1], max(figures[path, REFINED].milliseconds for path in PATHS)
    targets += [
        Target(
            name=f"{NOISE_MATCHED}, k1 = 0.5, paper",
            value=low.attitude_deg,
            bound=MOST_DEGREES,
            at_least=False,
            unit="°",
        ),
        Target(name="refinement of 10 s", value=slowest, bound=MOST_MILLISECONDS, at_least=False, unit=" ms"),
    ]
    if ("paper", BATCH_200) in figures:
        apart = max(abs(figures[path, REFINED].position - figures[path, BATCH_200].position) for path in PATHS)
        targets.append(
            Target(name="refinement less GTSAM's batch", value=apart, bound=MOST_APART, at_least=False, unit=" m")
        )
    return targets


if __name__ == "__main__":
    main()
