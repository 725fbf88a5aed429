"""Gains by search: a stated trade between settling soon and being exact afterwards, over several training seeds.

    J = (1 − w) ln settle + w ln steady,   settle = √(s_p s_a),   steady = √(e_p e_a)
s and e are settling times and steady errors of position and attitude (`trade`), w is the steadiness asked for.

A random search with shrinking steps, in logarithms, first of the Riccati gains, then of the attitude's, which do not
act on x̂. Nelder–Mead, Powell and CMA-ES ended within 0.04 of it in J after as many evaluations, now above and now
below; this one sees more of the trade-off on its way. The best seen is taken, and the start is among them: on the
training seeds J never rises.
"""

from collections.abc import Callable, Iterator
from functools import partial

import msgspec
import numpy as np
from msgspec.structs import replace

from rangenav import ensemble, tradeoff
from rangenav.attitude import HALFWAY_RANGE, K1_RANGE, MEMORY_RANGE
from rangenav.gains import Gains
from rangenav.inputs import require, require_within
from rangenav.preset import Preset
from rangenav.progress import Cancelled, Progress, never, unheard
from rangenav.results import result
from rangenav.riccati import P0_RANGE, Q_RANGE, V_RANGE, Blocks
from rangenav.tradeoff import Point

MAX_EVALUATIONS = 10_000
MAX_KEPT = 10_000_000
"""IMU samples of all training records, 0.1 kB each, which are kept for every evaluation."""
TRAINING_OFFSET = 100_000
"""Training seeds count up from the preset's seed plus this; held out are those from the preset's own on, which people
look at."""
SIDE_WEIGHTS = (0.15, 0.85)
"""Searched as well, for the ends of the trade-off curve."""
SIDE_SHARE = 0.2
"""Of the evaluations, for each of them."""
RICCATI_SHARE = 0.6
"""Of each search; the attitude has fewer gains."""
FIRST_STEP, LAST_STEP = 2.0, 0.1
"""Standard deviation of a step in natural logarithms, a factor of seven at first and a tenth in the end."""
GROWTH = 1.3
"""Of the step after a success."""
MOVED = 0.4
"""Share of the gains that one step changes."""
STARTS = 200
"""Random starts, to see whether the gains found still come home from anywhere."""
Where = tuple[str, ...]
"""The fields that lead to one gain."""
RICCATI: dict[Where, tuple[float, float]] = {
    ("riccati", "q"): Q_RANGE,
    **{("riccati", "v", block): V_RANGE for block in Blocks.__struct_fields__},
    **{("riccati", "p0", block): P0_RANGE for block in Blocks.__struct_fields__},
}
ATTITUDE: dict[Where, tuple[float, float]] = {
    ("attitude", "k1"): K1_RANGE,
    ("attitude", "rho2"): (1e-4, 1.0),  # beside rho1, which stays: only the products with k1 do anything
}
SCHEDULE: dict[Where, tuple[float, float]] = {
    ("attitude", "schedule", "steady"): K1_RANGE,
    ("attitude", "schedule", "halfway"): HALFWAY_RANGE,
    ("attitude", "schedule", "memory"): MEMORY_RANGE,
}


@result
class Tuned:
    """What a search found, and what that is worth on seeds it has not seen."""

    preset: Preset
    """With the gains found."""
    steadiness: float
    before: Point
    after: Point
    seen: tuple[Point, ...]
    """Everything tried, the start first."""
    held_out_before: Point
    """On as many seeds that the search has not seen, counted up from the preset's own."""
    held_out_after: Point
    starts_before: float
    """Share of random starts that hold 0.3 m and 5° over the last second."""
    starts_after: float


def tune(
    preset: Preset,
    *,
    runs: int = 8,
    evaluations: int = 300,
    steadiness: float = 0.5,
    progress: Progress = unheard,
    cancelled: Cancelled = never,
) -> Tuned:
    """Search for gains on `runs` training seeds with so many evaluations in all, and judge them on as many others.

    The mode stays as it is (noise-matched gains have no q and v), and a schedule of k1 is searched if there is one.
    Raises ValueError for too much work, and CancelledError when it is cancelled.
    """
    require_within("steadiness", steadiness, 0.0, 1.0)
    rule = f"the number of evaluations must lie between 1 and {MAX_EVALUATIONS}, got {evaluations}"
    require(1 <= evaluations <= MAX_EVALUATIONS, rule)
    ensemble.refuse_work(preset, runs, evaluations)
    kept = runs * preset.duration * preset.sensors.imu_rate
    require(kept <= MAX_KEPT, f"runs × duration × IMU rate must not exceed {MAX_KEPT} samples kept, got {kept:.0f}")
    training = tradeoff.runs(preset, preset.seed + TRAINING_OFFSET, runs)
    score = partial(tradeoff.score, preset=preset, cancelled=cancelled)
    seen = []
    for point in _search(partial(score, runs=training), preset, evaluations, steadiness):
        seen.append(point)
        progress(len(seen) / evaluations)
    best = min(seen, key=lambda point: point.objective(steadiness))
    held_out = tradeoff.runs(preset, preset.seed, runs)
    before, after = (score(gains, held_out) for gains in (preset.gains, best.gains))
    tuned = replace(preset, gains=best.gains)
    starts_before, starts_after = (_held(one, cancelled) for one in (preset, tuned))
    return Tuned(
        preset=tuned,
        steadiness=steadiness,
        before=seen[0],
        after=best,
        seen=tuple(seen),
        held_out_before=before,
        held_out_after=after,
        starts_before=starts_before,
        starts_after=starts_after,
    )


def _search(score: Callable[[Gains], Point], preset: Preset, count: int, steadiness: float) -> Iterator[Point]:
    """Everything tried, the start first; one weight after the other, each from the best that is seen for it."""
    rng = np.random.default_rng(preset.seed)
    seen = [score(preset.gains)]
    yield seen[0]
    side = int(SIDE_SHARE * (count - 1))
    riccati, attitude = _searched(preset.gains)
    for weight, share in ((steadiness, count - 1 - 2 * side), *((weight, side) for weight in SIDE_WEIGHTS)):
        first = int(RICCATI_SHARE * share)
        for limits, steps in ((riccati, first), (attitude, share - first)):
            best = min(seen, key=lambda point: point.objective(weight))
            for point in _walk(score, best, limits, weight, steps, rng):
                seen.append(point)
                yield point


def _searched(gains: Gains) -> tuple[dict[Where, tuple[float, float]], dict[Where, tuple[float, float]]]:
    """The gains that do anything in this mode, with their limits."""
    matched = gains.mode == "noise-matched"
    riccati = {where: limits for where, limits in RICCATI.items() if not matched or "p0" in where}
    return riccati, ATTITUDE if gains.attitude.schedule is None else {**ATTITUDE, **SCHEDULE}


def _walk(
    score: Callable[[Gains], Point],
    best: Point,
    limits: dict[Where, tuple[float, float]],
    weight: float,
    count: int,
    rng: np.random.Generator,
) -> Iterator[Point]:
    """Random steps from the best so far; without a success they shrink from the first to the last size."""
    step, decay = FIRST_STEP, (LAST_STEP / FIRST_STEP) ** (1 / max(count, 1))
    for _ in range(count):
        point = score(_drawn(best.gains, limits, step, rng))
        yield point
        better = point.objective(weight) < best.objective(weight)
        best, step = (point, min(step * GROWTH, FIRST_STEP)) if better else (best, step * decay)


def _drawn(gains: Gains, limits: dict[Where, tuple[float, float]], step: float, rng: np.random.Generator) -> Gains:
    """Some of the gains moved, within their limits; drawn again where together they are none (steady above k1)."""
    while True:
        tree, moved = msgspec.to_builtins(gains), rng.random(len(limits)) < MOVED
        moved[rng.integers(len(limits))] = True
        for (*path, name), (low, high) in (item for item, chosen in zip(limits.items(), moved, strict=True) if chosen):
            branch = tree
            for field in path:
                branch = branch[field]
            branch[name] = float(np.clip(branch[name] * np.exp(step * rng.standard_normal()), low, high))
        try:
            return msgspec.convert(tree, Gains)
        except msgspec.ValidationError:
            continue


def _held(preset: Preset, cancelled: Cancelled) -> float:
    return float(np.mean(ensemble.starts(preset, STARTS, np.random.default_rng(0), cancelled=cancelled).held))
