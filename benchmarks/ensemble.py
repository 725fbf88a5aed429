"""Ensembles in threads, compared with the same runs one after the other: many seeds, random starts, a sphere of starts.

The loop calls the library's single run. It makes one run for each start or axis, as a program must that does not know
that x̂ is the same for all of them.
"""

from collections.abc import Callable

import msgspec
import numpy as np
from scipy.spatial.transform import Rotation
from timing import Target, alternate, report, versions

from rangenav import cascade, ensemble, errors, preset, record
from rangenav.preset import Preset

SEEDS, STARTS, AXES = 100, 1000, 300
PART = 10
"""The loops do one part in this many of the work, and their time is multiplied by it."""
ROUNDS = 5
MIN_BASIN = 10.0
MAX_SECONDS = 1.0
"""For 100 seeds of the page's first preset, 20 s at 200 Hz."""


def main() -> None:
    """Time everything and report."""
    slow = preset.load("paper-slow")
    quick = msgspec.structs.replace(preset.load("paper"), duration=10.0)
    calls: dict[str, tuple[Callable[[], object], int]] = {
        "seeds": (lambda: ensemble.seeds(slow, SEEDS), 1),
        "seeds, loop": (lambda: [record.run_seed(slow, seed) for seed in range(SEEDS // PART)], 1),
        "starts": (lambda: ensemble.starts(quick, STARTS, np.random.default_rng(0)), 1),
        "starts, loop": (lambda: _loop(quick, STARTS // PART), 1),
        "basin": (lambda: ensemble.basin(slow, 3.0, AXES), 1),
        "basin, loop": (lambda: _loop(slow, AXES // PART), 1),
    }
    seconds = alternate(calls, ROUNDS)
    counts = {"seeds": SEEDS, "starts": STARTS, "basin": AXES}
    figures = {
        name: {"seconds": seconds[name], "ratio": PART * seconds[f"{name}, loop"] / seconds[name]} for name in counts
    }
    rows = [
        (f"{counts[name]} {name}", f"{result['seconds']:.2f} s", f"{result['ratio']:.1f} ×")
        for name, result in figures.items()
    ]
    report(
        "ensemble",
        title="Ensembles beside the same runs one after the other",
        columns=("what", "rangenav", "loop takes"),
        rows=rows,
        targets=[
            Target(name="100 seeds", value=seconds["seeds"], bound=MAX_SECONDS, at_least=False, unit=" s"),
            Target(
                name="basin, loop / rangenav", value=figures["basin"]["ratio"], bound=MIN_BASIN, at_least=True, unit="×"
            ),
        ],
        notes=["as many threads as cores; the peer is record.run_seed, or one observe for each start, in a loop"],
        figures={**figures, "versions": versions("numpy", "numba")},
    )


def _loop(p: Preset, count: int) -> None:
    """One run for each of some random starts, on one record."""
    course = record.truth_inputs(p)
    truth, z = record.simulated(course), record.measured(course, p.sensors, p.seed)
    observer_config = cascade.ObserverConfig(world=p.world, sensors=p.sensors, gains=p.gains)
    for rotation in Rotation.random(count, np.random.default_rng(0)).as_matrix():
        estimate = cascade.observe(z, cascade.Start(state=np.zeros(13), rotation=rotation), observer_config)
        result = errors.of(estimate, truth=truth.state, rotation=truth.motion.rotation)
        record.summarise(estimate, z, result, 0.0, range_sigma=p.sensors.sigma.range)


if __name__ == "__main__":
    main()
