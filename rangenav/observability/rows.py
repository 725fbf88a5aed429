"""Output rows in closed form: what one range at time s says about the state at time t, without an ODE or an attitude.

In axes fixed in inertia, with τ = s − t and D = p(s) − p(t) − τ v(t) − ½τ² g = ∫_t^s (s−r) a_I(r) dr,
    𝒞Φ(s, t) = [1, τ, τ²/2, τ³/6, Dᵀ, τDᵀ, ½τ²Dᵀ]                     (lifted, 13; paper eq. 7)
    ∂(½d²)/∂(p, v, g) = [qᵀ, τ qᵀ, ½τ² qᵀ],  q = p(s) − p_anchor         (nonlinear, 9)
    r_4 R̄ᵀ = [p⁗ᵀ, 4p⃛ᵀ, 6a_Iᵀ], the fourth derivative of Dᵀ(p + τv + ½τ²g)     (reduced pair, 9; Proposition 1)
A window is observable exactly when the 13 functions {1, τ, τ², τ³, Dᵢ, τDᵢ, τ²Dᵢ} are linearly independent on it.
"""

import math
from functools import lru_cache

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.inputs import Vec3
from rangenav.signals import Signal, bandwidth_until, bent

PANEL_NODES = 32
PANEL_TURN = 36.0
"""rad of the fastest tone that one panel of 32 Gauss nodes integrates to rounding (squares too: exact to k = 63)."""
MAX_NODES = 1024
"""Nodes in one window; more would ask for more memory than a live page may use."""


def count(window: float, bandwidth: float) -> int:
    """How many nodes a window takes."""
    return PANEL_NODES * max(1, math.ceil(bandwidth * window / PANEL_TURN))


@lru_cache(maxsize=64)
def quadrature(window: float, bandwidth: float) -> tuple[Float[Array, "k"], Float[Array, "k"]]:
    """Nodes τ in [0, window] and weights that sum to one: composite Gauss–Legendre, fine enough for the bandwidth."""
    panels = count(window, bandwidth) // PANEL_NODES
    if panels * PANEL_NODES > MAX_NODES:
        longest = MAX_NODES // PANEL_NODES * PANEL_TURN / bandwidth
        raise ValueError(
            f"requirement.window must be at most {longest:.3g} s for tones of {bandwidth:g} rad/s, got {window:g} s"
        )
    nodes, weights = np.polynomial.legendre.leggauss(PANEL_NODES)
    tau = (np.arange(panels)[:, None] + (nodes + 1) / 2).ravel() * (window / panels)
    return tau, np.tile(weights / (2 * panels), panels)


def nodes(path: Signal, start: Float[Array, "w"], window: float) -> tuple[Float[Array, "k"], Float[Array, "k"]]:
    """The quadrature for windows of a path: fine enough for what is present until the last of them ends."""
    return quadrature(window, bandwidth_until(path, float(np.max(start)) + window))


def lifted(path: Signal, gravity: Vec3, reference: Float[Array, "w"], tau: Float[Array, "k"]) -> Float[Array, "w k 13"]:
    """Rows 𝒞Φ(t + τ, t) for each reference time t (s); τ may be negative (what past ranges say about now)."""
    D = _departure(path, gravity, reference, tau)
    rows = np.empty((len(reference), len(tau), 13))
    rows[..., 0], rows[..., 1], rows[..., 2], rows[..., 3] = 1.0, tau, tau**2 / 2, tau**3 / 6
    rows[..., 4:7] = D
    rows[..., 7:10] = tau[:, None] * D
    rows[..., 10:13] = tau[:, None] ** 2 / 2 * D
    return rows


def nonlinear(
    path: Signal, anchor: Vec3, reference: Float[Array, "w"], tau: Float[Array, "k"]
) -> Float[Array, "w k 9"]:
    """Rows of ½d² with respect to (p, v, g) at each reference time, linearised at the true motion."""
    q = path(reference[:, None] + tau) - np.asarray(anchor)
    return np.concatenate([q, tau[:, None] * q, tau[:, None] ** 2 / 2 * q], axis=-1)


def reduced(path: Signal, gravity: Vec3, reference: Float[Array, "w"], tau: Float[Array, "k"]) -> Float[Array, "w k 9"]:
    """Rows of the reduced pair, r_4 = [p⁗ᵀ, 4 p⃛ᵀ, 6 a_Iᵀ] in inertial axes, carried to the reference time."""
    time = reference[:, None] + tau
    return carry(path(time, 4), 4 * path(time, 3), 6 * (path(time, 2) - np.asarray(gravity)), tau)


def carry(
    first: Float[Array, "w k 3"], second: Float[Array, "w k 3"], third: Float[Array, "w k 3"], tau: Float[Array, "k"]
) -> Float[Array, "w k 9"]:
    """Rows on (p, v, g) at the window's start from rows on (p, v, g) at τ: p + τv + ½τ²g, v + τg, g."""
    s = tau[:, None]
    return np.concatenate([first, s * first + second, s**2 / 2 * first + s * second + third], axis=-1)


def _departure(path: Signal, gravity: Vec3, reference: Array, tau: Array) -> Array:
    """D = p(t+τ) − p(t) − τ v(t) − ½τ² g, (w, k, 3). Offset and drift cancel in it, so they are left out beforehand."""
    path = bent(path)
    position, velocity = path(reference)[:, None], path(reference, 1)[:, None]
    s = tau[:, None]
    return path(reference[:, None] + tau) - position - s * velocity - s**2 / 2 * np.asarray(gravity)
