"""Ensembles in threads beside the same runs one after the other: many seeds, random starts, a sphere of starts.

The peer is the library's own single run in a loop; for starts and axes it is one run for each, because that is how one
would do it without knowing that x̂ serves them all.
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
"""The loops run this part of the work, and their time is multiplied."""
ROUNDS = 5
MOST_SECONDS = 1.0
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
        (f"{counts[name]} {name}", f"{found['seconds']:.2f} s", f"{found['ratio']:.1f} ×")
        for name, found in figures.items()
    ]
    report(
        "ensemble",
        title="Ensembles beside the same runs one after the other",
        columns=("what", "ours", "loop takes"),
        rows=rows,
        targets=[Target(name="100 seeds", value=seconds["seeds"], bound=MOST_SECONDS, at_least=False, unit=" s")],
        notes=["as many threads as cores; the peer is record.run_seed, or one observe for each start, in a loop"],
        figures={**figures, "versions": versions("numpy", "numba")},
    )


def _loop(p: Preset, count: int) -> None:
    """One run for each of some random starts, on one record."""
    course = record.truth_inputs(p)
    truth, z = record.simulated(course), record.measured(course, p.sensors, p.seed)
    setting = cascade.ObserverConfig(world=p.world, sensors=p.sensors, gains=p.gains)
    for rotation in Rotation.random(count, random_state=0).as_matrix():
        estimate = cascade.observe(z, cascade.Start(state=np.zeros(13), rotation=rotation), setting)
        found = errors.of(estimate, truth=truth.state, rotation=truth.motion.rotation)
        record.summarise(estimate, found, 0.0)


if __name__ == "__main__":
    main()
