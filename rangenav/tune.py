"""Gains by search: a stated tradeoff between settling time and steady error, over several training seeds.

    J = (1 − w) ln settle + w ln steady,   settle = √(s_p s_a),   steady = √(e_p e_a)
s and e are settling times and steady errors of position and attitude (`tradeoff`), w is the steadiness.

The search takes random, shrinking steps in the logarithms of the gains: first of the Riccati gains, then of the
attitude gains, which do not act on x̂. After as many evaluations Nelder–Mead, Powell and CMA-ES reach a J within 0.04 of
this one, above it or below; the random search evaluates more of the tradeoff curve. The result is the best point that
was evaluated. The start is one of the points, so J does not rise on the training seeds.
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
"""IMU samples of all training records together, 0.1 kB each; they stay in memory during the search."""
TRAINING_OFFSET = 100_000
"""Training seeds count up from the preset's seed plus this offset. Held-out seeds count up from the preset's own seed,
whose run is the one that a user sees."""
SIDE_WEIGHTS = (0.15, 0.85)
"""Two more values of w that are searched, for the ends of the tradeoff curve."""
SIDE_SHARE = 0.2
"""Share of the evaluations for each of SIDE_WEIGHTS."""
RICCATI_SHARE = 0.6
"""Share of the evaluations for each w that vary the Riccati gains; the attitude filter has fewer gains."""
FIRST_STEP, LAST_STEP = 2.0, 0.1
"""Standard deviation of a step of the natural logarithm: a factor of seven at first, 10% in the end."""
GROWTH = 1.3
"""Factor of the step size after a success."""
CHANGED_SHARE = 0.4
"""Share of the gains that one step changes."""
STARTS = 200
"""Random starts from which the resulting gains are tested for convergence."""
FieldPath = tuple[str, ...]
"""The names of the fields that lead to one gain."""
RICCATI: dict[FieldPath, tuple[float, float]] = {
    ("riccati", "q"): Q_RANGE,
    **{("riccati", "v", block): V_RANGE for block in Blocks.__struct_fields__},
    **{("riccati", "p0", block): P0_RANGE for block in Blocks.__struct_fields__},
}
ATTITUDE: dict[FieldPath, tuple[float, float]] = {
    ("attitude", "k1"): K1_RANGE,
    ("attitude", "rho2"): (1e-4, 1.0),  # rho1 stays fixed: only the products k1 rho1 and k1 rho2 act
}
SCHEDULE: dict[FieldPath, tuple[float, float]] = {
    ("attitude", "schedule", "steady"): K1_RANGE,
    ("attitude", "schedule", "halfway"): HALFWAY_RANGE,
    ("attitude", "schedule", "memory"): MEMORY_RANGE,
}


@result
class Tuned:
    """The result of a search, and how good its gains are on held-out seeds."""

    preset: Preset
    """The preset with the resulting gains."""
    steadiness: float
    before: Point
    after: Point
    points: tuple[Point, ...]
    """All points that were evaluated, the start first."""
    held_out_before: Point
    """On as many held-out seeds, which count up from the preset's own."""
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
    """Search for gains on `runs` training seeds in `evaluations` evaluations, and judge them on as many held-out seeds.

    The mode is unchanged; noise-matched gains have no q and v. A schedule of k1 is searched if there is one.
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
    points = []
    for point in _search(partial(score, runs=training), preset, evaluations, steadiness):
        points.append(point)
        progress(len(points) / evaluations)
    best = min(points, key=lambda point: point.objective(steadiness))
    held_out = tradeoff.runs(preset, preset.seed, runs)
    before, after = (score(gains, held_out) for gains in (preset.gains, best.gains))
    tuned = replace(preset, gains=best.gains)
    starts_before, starts_after = (_share_held(one, cancelled) for one in (preset, tuned))
    return Tuned(
        preset=tuned,
        steadiness=steadiness,
        before=points[0],
        after=best,
        points=tuple(points),
        held_out_before=before,
        held_out_after=after,
        starts_before=starts_before,
        starts_after=starts_after,
    )


def _search(score: Callable[[Gains], Point], preset: Preset, count: int, steadiness: float) -> Iterator[Point]:
    """All points, the start first. Each weight is searched in turn, from the best point so far for that weight."""
    rng = np.random.default_rng(preset.seed)
    points = [score(preset.gains)]
    yield points[0]
    side = int(SIDE_SHARE * (count - 1))
    riccati, attitude = _search_ranges(preset.gains)
    for weight, share in ((steadiness, count - 1 - 2 * side), *((weight, side) for weight in SIDE_WEIGHTS)):
        first = int(RICCATI_SHARE * share)
        for limits, steps in ((riccati, first), (attitude, share - first)):
            best = min(points, key=lambda point: point.objective(weight))
            for point in _random_steps(score, best, limits, weight, steps, rng):
                points.append(point)
                yield point


def _search_ranges(gains: Gains) -> tuple[dict[FieldPath, tuple[float, float]], dict[FieldPath, tuple[float, float]]]:
    """The gains that act in this mode, with their limits: those of the Riccati observer and those of the attitude."""
    matched = gains.mode == "noise-matched"
    riccati = {fields: limits for fields, limits in RICCATI.items() if not matched or "p0" in fields}
    return riccati, ATTITUDE if gains.attitude.schedule is None else {**ATTITUDE, **SCHEDULE}


def _random_steps(
    score: Callable[[Gains], Point],
    best: Point,
    limits: dict[FieldPath, tuple[float, float]],
    weight: float,
    count: int,
    rng: np.random.Generator,
) -> Iterator[Point]:
    """Random steps from the best point so far. Their size falls from FIRST_STEP to LAST_STEP; a success raises it."""
    step, decay = FIRST_STEP, (LAST_STEP / FIRST_STEP) ** (1 / max(count, 1))
    for _ in range(count):
        point = score(_random_step(best.gains, limits, step, rng))
        yield point
        better = point.objective(weight) < best.objective(weight)
        best, step = (point, min(step * GROWTH, FIRST_STEP)) if better else (best, step * decay)


def _random_step(
    gains: Gains, limits: dict[FieldPath, tuple[float, float]], step: float, rng: np.random.Generator
) -> Gains:
    """Some of the gains changed at random, within their limits; drawn again if they are not valid (steady above k1)."""
    while True:
        tree, changed = msgspec.to_builtins(gains), rng.random(len(limits)) < CHANGED_SHARE
        changed[rng.integers(len(limits))] = True
        for (*path, name), (low, high) in (
            item for item, chosen in zip(limits.items(), changed, strict=True) if chosen
        ):
            branch = tree
            for field in path:
                branch = branch[field]
            branch[name] = float(np.clip(branch[name] * np.exp(step * rng.standard_normal()), low, high))
        try:
            return msgspec.convert(tree, Gains)
        except msgspec.ValidationError:
            continue


def _share_held(preset: Preset, cancelled: Cancelled) -> float:
    return float(np.mean(ensemble.starts(preset, STARTS, np.random.default_rng(0), cancelled=cancelled).held))
