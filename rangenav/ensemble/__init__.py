"""Many runs of one preset: many seeds, many starts, a sphere of starts, and predicted against achieved accuracy.

    seeds(preset, count)        what noise alone changes
    starts(preset, count, rng)  what the start changes: x̂ = 0 and R̂(0) uniform on SO(3)
    basin(preset, angle)        how long the attitude takes from starts all around, at one angle
    each(work, items)           the pool of threads they share; the only one but for the kernels' warm-up
All take `progress` and `cancelled`, and give the same numbers however many threads there are. A cancelled computation
raises CancelledError (`rangenav.progress`).
"""

from rangenav.ensemble.achieved import Achieved, achieved
from rangenav.ensemble.basin import Basin, basin, sphere
from rangenav.ensemble.pool import each, refuse_work
from rangenav.ensemble.runs import seeds, spread, starts
from rangenav.ensemble.values import Band, Ensemble, Spread

__all__ = [
    "Achieved",
    "Band",
    "Basin",
    "Ensemble",
    "Spread",
    "achieved",
    "basin",
    "each",
    "refuse_work",
    "seeds",
    "sphere",
    "spread",
    "starts",
]
