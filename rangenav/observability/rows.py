"""Output rows in closed form: how one range at time s depends on the state at time t, without an ODE or an attitude.

In axes fixed in inertia, with τ = s − t and D = p(s) − p(t) − τ v(t) − ½τ² g = ∫_t^s (s−r) a_I(r) dr,
    𝒞Φ(s, t) = [1, τ, τ²/2, τ³/6, Dᵀ, τDᵀ, ½τ²Dᵀ]                     (lifted, 13; paper eq. 7)
    ∂(½d²)/∂(p, v, g) = [qᵀ, τ qᵀ, ½τ² qᵀ],  q = p(s) − p_anchor         (nonlinear, 9)
    r_4 R̄ᵀ = [p⁗ᵀ, 4p⃛ᵀ, 6a_Iᵀ], the fourth derivative of Dᵀ(p + τv + ½τ²g)     (reduced pair, 9; Proposition 1)
A window is observable exactly when the 13 functions {1, τ, τ², τ³, Dᵢ, τDᵢ, τ²Dᵢ} are linearly independent on it.
All rows of one window come from the same places: a Visit keeps them, so that the path is evaluated once.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Literal

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.arguments import finite_array
from rangenav.inputs import Vec3
from rangenav.observability import quadrature, windows
from rangenav.results import result
from rangenav.signals import Signal, curved_part

CHUNK = 4096
"""Rows weighted and reduced at once: half a megabyte stays in the cache, all windows together cost twice the time."""
ROUNDING = 64 * np.finfo(float).eps
"""Absolute error of a row per metre of path amplitude, when D is a small difference of large positions."""
TALLEST = 512
"""Rows of one QR decomposition. From about 700 rows of 13 on, OpenBLAS wakes its threads for it: five windows then take
0.17 ms on a machine with nothing else to do, and 130 to 230 ms on one whose cores are busy."""
Moment = Literal["start", "end"]


@result
class Visit:
    """Where a path is during w windows, k times in each: at quadrature nodes, or where ranges were taken."""

    start: Float[Array, "w"]
    """s"""
    window: float
    tau: Float[Array, "v k"]
    """s since each start; one row for all windows (v = 1), or w rows."""
    weight: Float[Array, "v k"]
    """Of each time in a mean over its window."""
    place: Float[Array, "w 3 k"]
    """m, inertial; axes before times, so that sums run along the long side."""
    bent: Float[Array, "w 3 k"]
    """m, without the path's offset and drift: they cancel in D, and beforehand they cost no digits."""
    position: Float[Array, "2 w 3"]
    """Of the bent path, at the windows' starts and ends."""
    velocity: Float[Array, "2 w 3"]
    rounding: float
    """The rows' absolute error."""


def visit(path: Signal, start: Float[Array, "w"], window: float) -> Visit:
    """The windows at their quadrature nodes, and at both ends with no weight.

    Raises ValueError for what `windows.checked` refuses, and for windows with too many nodes.
    """
    start, window = windows.checked(path, start, window)
    tau, weight = quadrature.nodes(path, start, window)
    ends = np.zeros((len(tau), 1))
    return visit_at(
        path,
        start,
        window,
        tau=np.concatenate([ends, tau, ends + window], axis=1),
        weight=np.concatenate([ends, weight, ends], axis=1),
    )


def visit_at(
    path: Signal, start: Float[Array, "w"], window: float, *, tau: Float[Array, "v k"], weight: Float[Array, "v k"]
) -> Visit:
    """The windows at chosen times. The path is evaluated without its straight part, which is then added.

    Raises ValueError for what `windows.checked` refuses, and for times or weights of other shapes.
    """
    start, window = windows.checked(path, start, window)
    tau = windows.offsets("tau", tau, len(start))
    weight = finite_array("weight", weight, ("v", tau.shape[-1]))
    curve, time, ends = curved_part(path), start[:, None] + tau, np.stack([start, start + window])
    places = _axes_first(curve(time))
    offset, drift = (path(start[:1], order) - curve(start[:1], order) for order in (0, 1))
    return Visit(
        start=start,
        window=window,
        tau=tau,
        weight=weight,
        place=places + offset[..., None] + drift[..., None] * (time - start[0])[:, None],
        bent=places,
        position=curve(ends),
        velocity=curve(ends, 1),
        rounding=rounding(path, start, window),
    )


def rounding(path: Signal, start: Float[Array, "w"], window: float) -> float:
    """The rows' absolute rounding error: positions of size |p| and velocities times δ are subtracted in D.

    A path that no bound is known of, because it drifts or jumps, is as large as it is seen to be.
    """
    path = curved_part(path)
    sizes = [path.bound(order) for order in (0, 1)]
    if not math.isfinite(sum(sizes)):
        time = np.append(start, start[-1] + window)
        sizes = [float(np.linalg.norm(path(time, order), axis=-1).max()) for order in (0, 1)]
    return ROUNDING * (sizes[0] + window * sizes[1])


def triangles(
    seen: Visit, weight: Float[Array, "v k"], made: Callable[[Visit], Float[Array, "_ k n"]]
) -> Float[Array, "w r n"]:
    """R of the QR decomposition of each window's weighted rows, which `made` makes of a visit: RᵀR = Σ weight hᵀh."""
    root = np.broadcast_to(np.sqrt(weight), (len(seen.start), weight.shape[1]))
    found = []
    for inside, part in _parts(seen):
        matrix = made(part)
        matrix *= root[inside, :, None]
        found.append(_triangle(matrix))
    return np.concatenate(found)


def _triangle(matrix: Float[Array, "w k n"]) -> Float[Array, "w r n"]:
    """R, of tall matrices by blocks of rows and then of the blocks' own triangles."""
    if matrix.shape[1] > TALLEST:
        blocks = [matrix[:, first : first + TALLEST] for first in range(0, matrix.shape[1], TALLEST)]
        matrix = np.concatenate([np.linalg.qr(block, mode="r") for block in blocks], axis=1)
    return np.asarray(np.linalg.qr(matrix, mode="r"))


def _parts(seen: Visit) -> Iterator[tuple[slice, Visit]]:
    """A few windows after the other."""
    each = max(1, CHUNK // seen.tau.shape[1])
    for first in range(0, len(seen.start), each):
        inside = slice(first, first + each)
        yield (
            inside,
            replace(
                seen,
                start=seen.start[inside],
                tau=seen.tau if len(seen.tau) == 1 else seen.tau[inside],
                weight=seen.weight if len(seen.weight) == 1 else seen.weight[inside],
                place=seen.place[inside],
                bent=seen.bent[inside],
                position=seen.position[:, inside],
                velocity=seen.velocity[:, inside],
            ),
        )


def lifted_of(seen: Visit, gravity: Vec3, moment: Moment) -> Float[Array, "w k 13"]:
    """Rows 𝒞Φ for the state at the start or the end of each window."""
    end = int(moment == "end")
    tau = _since(seen, moment)
    return _lifted(_departure(seen.bent, seen.position[end], seen.velocity[end], gravity, tau), tau)


def nonlinear_of(seen: Visit, anchor: Vec3, moment: Moment) -> Float[Array, "w k 9"]:
    """Rows of ½d² for position, velocity and gravity at the start or the end of each window."""
    return _nonlinear(seen.place - np.asarray(anchor)[:, None], _since(seen, moment))


def lifted(
    path: Signal, gravity: Vec3, reference: Float[Array, "w"], tau: Float[Array, "*v k"]
) -> Float[Array, "w k 13"]:
    """Rows 𝒞Φ(t + τ, t) for each reference time t (s); τ may be negative (what past ranges say about now)."""
    reference, tau = _checked(path, reference, tau)
    curve = curved_part(path)
    places = _axes_first(curve(reference[:, None] + tau))
    return _lifted(_departure(places, curve(reference), curve(reference, 1), gravity, tau), tau)


def nonlinear(
    path: Signal, anchor: Vec3, reference: Float[Array, "w"], tau: Float[Array, "*v k"]
) -> Float[Array, "w k 9"]:
    """Rows of ½d² with respect to (p, v, g) at each reference time, linearised at the true motion."""
    reference, tau = _checked(path, reference, tau)
    return _nonlinear(_axes_first(path(reference[:, None] + tau) - np.asarray(anchor)), tau)


def reduced(
    path: Signal, gravity: Vec3, reference: Float[Array, "w"], tau: Float[Array, "*v k"]
) -> Float[Array, "w k 9"]:
    """Rows of the reduced pair, r_4 = [p⁗ᵀ, 4 p⃛ᵀ, 6 a_Iᵀ] in inertial axes, carried to the reference time."""
    reference, tau = _checked(path, reference, tau)
    time = reference[:, None] + tau
    return carry(path(time, 4), 4 * path(time, 3), 6 * (path(time, 2) - np.asarray(gravity)), tau)


def carry(
    first: Float[Array, "w k 3"], second: Float[Array, "w k 3"], third: Float[Array, "w k 3"], tau: Float[Array, "*v k"]
) -> Float[Array, "w k 9"]:
    """Rows on (p, v, g) at the window's start from rows on (p, v, g) at τ: p + τv + ½τ²g, v + τg, g."""
    s = tau[..., None]
    return np.concatenate([first, s * first + second, s**2 / 2 * first + s * second + third], axis=-1)


def _checked(path: Signal, reference: Array, tau: Array) -> tuple[Array, Array]:
    windows.refuse_arrays(path)
    reference = finite_array("reference", reference, ("w",))
    return reference, windows.offsets("tau", tau, len(reference))


def _since(seen: Visit, moment: Moment) -> Array:
    return seen.tau - seen.window if moment == "end" else seen.tau


def _axes_first(vectors: Float[Array, "w k 3"]) -> Float[Array, "w 3 k"]:
    return np.ascontiguousarray(vectors.swapaxes(1, 2))


def _departure(places: Array, position: Array, velocity: Array, gravity: Vec3, tau: Array) -> Array:
    """D = p(t+τ) − p(t) − τ v(t) − ½τ² g, (w, 3, k)."""
    s = tau[..., None, :]
    return places - position[..., None] - s * velocity[..., None] - s**2 / 2 * np.asarray(gravity)[:, None]


def _lifted(D: Array, tau: Array) -> Array:
    half = tau**2 / 2
    columns = np.empty((len(D), 13, D.shape[-1]))
    columns[:, 0], columns[:, 1], columns[:, 2], columns[:, 3] = 1.0, tau, half, half * tau / 3
    columns[:, 4:7], columns[:, 7:10], columns[:, 10:13] = D, tau[..., None, :] * D, half[..., None, :] * D
    return columns.swapaxes(1, 2)


def _nonlinear(q: Array, tau: Array) -> Array:
    s = tau[..., None, :]
    return np.concatenate([q, s * q, s**2 / 2 * q], axis=1).swapaxes(1, 2)
