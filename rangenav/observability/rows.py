"""Output rows in closed form: how one range at time s depends on the state at time t, without an ODE or an attitude.

In axes fixed in inertia, with τ = s − t and D = p(s) − p(t) − τ v(t) − ½τ² g = ∫_t^s (s−r) a_I(r) dr,
    𝒞Φ(s, t) = [1, τ, τ²/2, τ³/6, Dᵀ, τDᵀ, ½τ²Dᵀ]                     (lifted, 13; paper eq. 7)
    ∂(½d²)/∂(p, v, g) = [qᵀ, τ qᵀ, ½τ² qᵀ],  q = p(s) − p_anchor         (nonlinear, 9)
    r_4 R̄ᵀ = [p⁗ᵀ, 4p⃛ᵀ, 6a_Iᵀ], the fourth derivative of Dᵀ(p + τv + ½τ²g)     (reduced pair, 9; Proposition 1)
A window is observable exactly when the 13 functions {1, τ, τ², τ³, Dᵢ, τDᵢ, τ²Dᵢ} are linearly independent on it.
All rows of a window need the path at the same times. `PathSamples` holds these samples, so the path is evaluated once.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from typing import Literal

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.arguments import finite_array
from rangenav.inputs import Vec3
from rangenav.observability import quadrature, rounding, windows
from rangenav.results import result
from rangenav.signals import Signal, curved_part

CHUNK = 4096
"""Rows that are weighted and reduced at once: half a megabyte, which fits the cache. All rows at once take twice the
time."""
TALLEST = 512
"""Rows of one QR decomposition. From about 700 rows of 13 on, OpenBLAS wakes its threads for it: five windows then take
0.17 ms on a machine with nothing else to do, and 130 to 230 ms on one whose cores are busy."""
Moment = Literal["start", "end"]


@result
class PathSamples:
    """Positions of a path in w windows, at k times in each: at quadrature nodes, or where ranges are measured."""

    start: Float[Array, "w"]
    """s"""
    window: float
    tau: Float[Array, "v k"]
    """s since each start; one row for all windows (v = 1), or w rows."""
    weight: Float[Array, "v k"]
    """The weight of each time in a mean over its window."""
    position: Float[Array, "w 3 k"]
    """m, inertial; axes before times, so that sums run along the long side."""
    curved: Float[Array, "w 3 k"]
    """m, the position without the path's offset and drift: both cancel in D, and leaving them out saves digits."""
    end_position: Float[Array, "2 w 3"]
    """m, of the curved part, at the windows' starts and ends."""
    end_velocity: Float[Array, "2 w 3"]
    """m/s, likewise."""
    size: Float[Array, "w"]
    """m: the numbers that the positions were computed from, which times the rounding of one number is their error."""
    rounding: float
    """The absolute rounding error of the rows of D."""


def sample(path: Signal, start: Float[Array, "w"], window: float) -> PathSamples:
    """Samples at the quadrature nodes of each window, and at both of its ends with weight 0.

    Raises ValueError for what `windows.checked` refuses, and for windows with too many nodes.
    """
    start, window = windows.checked(path, start, window)
    tau, weight = quadrature.nodes(path, start, window)
    ends = np.zeros((len(tau), 1))
    return sample_at(
        path,
        start,
        window,
        tau=np.concatenate([ends, tau, ends + window], axis=1),
        weight=np.concatenate([ends, weight, ends], axis=1),
    )


def sample_at(
    path: Signal, start: Float[Array, "w"], window: float, *, tau: Float[Array, "v k"], weight: Float[Array, "v k"]
) -> PathSamples:
    """Samples at chosen times. The path is evaluated without its straight part, which is then added.

    Raises ValueError for what `windows.checked` refuses, and for times or weights of other shapes.
    """
    start, window = windows.checked(path, start, window)
    tau = windows.offsets("tau", tau, len(start))
    weight = finite_array("weight", weight, ("v", tau.shape[-1]))
    curve, time, ends = curved_part(path), start[:, None] + tau, np.stack([start, start + window])
    curved_position = _axes_first(curve(time))
    offset, drift = (path(start[:1], order) - curve(start[:1], order) for order in (0, 1))
    position = curved_position + offset[..., None] + drift[..., None] * (time - start[0])[:, None]
    return PathSamples(
        start=start,
        window=window,
        tau=tau,
        weight=weight,
        position=position,
        curved=curved_position,
        end_position=curve(ends),
        end_velocity=(velocity := curve(ends, 1)),
        size=rounding.sizes(path, ends, position, curved_position, velocity),
        rounding=rounding.of_rows(path, start, window),
    )


def triangles(
    samples: PathSamples, weight: Float[Array, "v k"], rows_of: Callable[[PathSamples], Float[Array, "_ k n"]]
) -> Float[Array, "w r n"]:
    """R of the QR decomposition of each window's weighted rows h, which `rows_of` computes: RᵀR = Σ weight hᵀh."""
    return factors(samples, weight, ((inside, rows_of(some)) for inside, some in parts(samples)))


def factors(
    samples: PathSamples, weight: Float[Array, "v k"], rows: Iterable[tuple[slice, Float[Array, "_ k n"]]]
) -> Float[Array, "w r n"]:
    """The same from the rows of each group of windows, which are weighted in place."""
    root = np.broadcast_to(np.sqrt(weight), (len(samples.start), weight.shape[1]))
    reduced = []
    for inside, matrix in rows:
        matrix *= root[inside, :, None]
        reduced.append(_triangle(matrix))
    return np.concatenate(reduced)


def _triangle(matrix: Float[Array, "w k n"]) -> Float[Array, "w r n"]:
    """R of each matrix. A tall matrix is reduced by blocks of rows first; then their stacked R is reduced."""
    if matrix.shape[1] > TALLEST:
        blocks = [matrix[:, first : first + TALLEST] for first in range(0, matrix.shape[1], TALLEST)]
        matrix = np.concatenate([np.linalg.qr(block, mode="r") for block in blocks], axis=1)
    return np.asarray(np.linalg.qr(matrix, mode="r"))


def parts(samples: PathSamples) -> Iterator[tuple[slice, PathSamples]]:
    """The samples in groups of a few windows, and which windows these are."""
    each = max(1, CHUNK // samples.tau.shape[1])
    if each >= len(samples.start):
        yield slice(None), samples
        return
    for first in range(0, len(samples.start), each):
        inside = slice(first, first + each)
        yield (
            inside,
            replace(
                samples,
                start=samples.start[inside],
                tau=samples.tau if len(samples.tau) == 1 else samples.tau[inside],
                weight=samples.weight if len(samples.weight) == 1 else samples.weight[inside],
                position=samples.position[inside],
                curved=samples.curved[inside],
                end_position=samples.end_position[:, inside],
                end_velocity=samples.end_velocity[:, inside],
                size=samples.size[inside],
            ),
        )


def lifted_of(samples: PathSamples, gravity: Vec3, moment: Moment) -> Float[Array, "w k 13"]:
    """Rows 𝒞Φ for the state at the start or the end of each window."""
    end = int(moment == "end")
    tau = _since(samples, moment)
    return _lifted(_departure(samples.curved, samples.end_position[end], samples.end_velocity[end], gravity, tau), tau)


def nonlinear_of(samples: PathSamples, anchor: Vec3, moment: Moment) -> Float[Array, "w k 9"]:
    """Rows of ½d² for position, velocity and gravity at the start or the end of each window."""
    return _nonlinear(samples.position - np.asarray(anchor)[:, None], _since(samples, moment))


def lifted(
    path: Signal, gravity: Vec3, reference: Float[Array, "w"], tau: Float[Array, "*v k"]
) -> Float[Array, "w k 13"]:
    """Rows 𝒞Φ(t + τ, t) for each reference time t (s); τ is negative for ranges before t."""
    reference, tau = _checked(path, reference, tau)
    curve = curved_part(path)
    curved_position = _axes_first(curve(reference[:, None] + tau))
    return _lifted(_departure(curved_position, curve(reference), curve(reference, 1), gravity, tau), tau)


def nonlinear(
    path: Signal, anchor: Vec3, reference: Float[Array, "w"], tau: Float[Array, "*v k"]
) -> Float[Array, "w k 9"]:
    """Rows of ½d² with respect to (p, v, g) at each reference time, linearised at the true motion."""
    reference, tau = _checked(path, reference, tau)
    return _nonlinear(_axes_first(path(reference[:, None] + tau) - np.asarray(anchor)), tau)


def reduced(
    path: Signal, gravity: Vec3, reference: Float[Array, "w"], tau: Float[Array, "*v k"]
) -> Float[Array, "w k 9"]:
    """Rows of the reduced pair, r_4 = [p⁗ᵀ, 4 p⃛ᵀ, 6 a_Iᵀ] in inertial axes, propagated to the reference time."""
    reference, tau = _checked(path, reference, tau)
    time = reference[:, None] + tau
    return carry(path(time, 4), 4 * path(time, 3), 6 * (path(time, 2) - np.asarray(gravity)), tau)


def carry(
    first: Float[Array, "w k 3"], second: Float[Array, "w k 3"], third: Float[Array, "w k 3"], tau: Float[Array, "*v k"]
) -> Float[Array, "w k 9"]:
    """Rows for (p, v, g) at the window's start from rows for (p, v, g) at τ, which is (p + τv + ½τ²g, v + τg, g)."""
    s = tau[..., None]
    return np.concatenate([first, s * first + second, s**2 / 2 * first + s * second + third], axis=-1)


def _checked(path: Signal, reference: Array, tau: Array) -> tuple[Array, Array]:
    windows.refuse_arrays(path)
    reference = finite_array("reference", reference, ("w",))
    return reference, windows.offsets("tau", tau, len(reference))


def _since(samples: PathSamples, moment: Moment) -> Array:
    return samples.tau - samples.window if moment == "end" else samples.tau


def _axes_first(vectors: Float[Array, "w k 3"]) -> Float[Array, "w 3 k"]:
    return np.ascontiguousarray(vectors.swapaxes(1, 2))


def _departure(curved_position: Array, position: Array, velocity: Array, gravity: Vec3, tau: Array) -> Array:
    """D = p(t+τ) − p(t) − τ v(t) − ½τ² g, (w, 3, k)."""
    s = tau[..., None, :]
    return curved_position - position[..., None] - s * velocity[..., None] - s**2 / 2 * np.asarray(gravity)[:, None]


def _lifted(D: Array, tau: Array) -> Array:
    half = tau**2 / 2
    columns = np.empty((len(D), 13, D.shape[-1]))
    columns[:, 0], columns[:, 1], columns[:, 2], columns[:, 3] = 1.0, tau, half, half * tau / 3
    columns[:, 4:7], columns[:, 7:10], columns[:, 10:13] = D, tau[..., None, :] * D, half[..., None, :] * D
    return columns.swapaxes(1, 2)


def _nonlinear(q: Array, tau: Array) -> Array:
    s = tau[..., None, :]
    return np.concatenate([q, s * q, s**2 / 2 * q], axis=1).swapaxes(1, 2)
