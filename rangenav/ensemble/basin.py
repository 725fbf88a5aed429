"""A sphere of starts: how long the attitude takes from R̃(0) = exp(angle [axis]x), for axes all around.

The theorem says "almost global". Near the undesired equilibria, errors of 180° about the eigenvectors of
M = ρ1 mmᵀ + ρ2 ggᵀ, a start converges late; a sphere of starts shows where these regions are and how large. All starts
share one record and one x̂, with one attitude filter for each axis.
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav import cascade, record, so3
from rangenav.ensemble.pool import each, refuse_work
from rangenav.ensemble.runs import batch, grid, shared
from rangenav.inputs import require, require_within
from rangenav.preset import Preset
from rangenav.progress import Cancelled, Progress, never, unheard
from rangenav.results import result

MAX_AXES = 2000
GOLDEN_ANGLE = np.pi * (3 - np.sqrt(5))
"""rad, between one axis and the next as seen from the pole: no two of them ever line up."""


@result
class Basin:
    """How each start settles, a row for each axis."""

    angle: float
    """rad, of R̃(0)."""
    axis: Float[Array, "a 3"]
    """Unit vectors, inertial axes: R̃(0) = exp(angle [axis]x)."""
    settle: Float[Array, "a"]
    """s from when on the attitude error stays below 5°; infinite where it does not."""
    final: Float[Array, "a"]
    """rad, at the end."""
    time: Float[Array, "t"]
    """s, the grid of the curves."""
    attitude: Float[Array, "a t"]
    """rad"""


def basin(
    preset: Preset,
    angle: float,
    axes: int = 300,
    *,
    progress: Progress = unheard,
    cancelled: Cancelled = never,
) -> Basin:
    """Settling from starts at `angle` (rad, 0 to π) from the truth, about `axes` axes all around; x̂(0) is the preset's.

    Raises ValueError if that is too much work, and CancelledError when it is cancelled.
    """
    require_within("angle", angle, 0.0, np.pi + 1e-12, "rad")
    require(1 <= axes <= MAX_AXES, f"the number of axes must lie between 1 and {MAX_AXES}, got {axes}")
    refuse_work(preset, axes)
    flown = record.truth_inputs(preset)
    truth, z = record.simulated(flown), record.measured(flown, preset.sensors, preset.seed)
    axis, chosen, R = sphere(axes), np.zeros(len(z.time), dtype=bool), truth.motion.rotation
    chosen[grid(len(z.time))] = True
    rotations, size = so3.exp(-angle * axis) @ R[0], batch(len(z.time))
    inputs = cascade.attitude_inputs(z, *shared(preset, truth, z), truth=R)

    def run(first: int) -> tuple[Array, Array]:
        some = rotations[first : first + size]
        return cascade.attitude_settling(inputs, rotations=some, chosen=chosen, limit=record.SETTLED_ATTITUDE)

    jobs = each(run, range(0, axes, size), samples=len(z.time), progress=progress, cancelled=cancelled)
    curves, above = (np.concatenate(parts) for parts in zip(*jobs, strict=True))
    return Basin(
        angle=angle,
        axis=axis,
        settle=record.settled_after(z.time, above),
        final=curves[:, -1].copy(),
        time=z.time[chosen],
        attitude=curves,
    )


def sphere(count: int) -> Float[Array, "a 3"]:
    """Points spread evenly over the unit sphere: a spiral by the golden angle through slices of equal area."""
    k = np.arange(count)
    z = 1 - (2 * k + 1) / count
    radius, turn = np.sqrt(1 - z**2), GOLDEN_ANGLE * k
    return np.column_stack([radius * np.cos(turn), radius * np.sin(turn), z])
