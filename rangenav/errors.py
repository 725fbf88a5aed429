"""How far an estimate is from the truth: x̂ in body axes (paper, fig. 3) and the attitude (fig. 4)."""

from dataclasses import dataclass
from types import ModuleType

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.cascade import Estimate


@dataclass(frozen=True, eq=False, kw_only=True)
class Errors:
    """Norms over time."""

    position: Float[Array, "n"]
    """m"""
    velocity: Float[Array, "n"]
    """m/s"""
    gravity: Float[Array, "n"]
    """m/s²"""
    attitude: Float[Array, "n"]
    """rad"""


def of(estimate: Estimate, *, truth: Float[Array, "n 13"], rotation: Float[Array, "n 3 3"]) -> Errors:
    """Norms of the body-axes errors, and the angle of R̃ = R R̂ᵀ."""
    found = norms(estimate.state, truth)
    attitude = angles(estimate.rotation[None], rotation)[0]
    return Errors(position=found[0], velocity=found[1], gravity=found[2], attitude=attitude)


def norms(state: Float[Array, "n 13"], truth: Float[Array, "n 13"]) -> Float[Array, "3 n"]:
    """Lengths of the differences of position, velocity and gravity."""
    out = np.empty((len(truth), 3))
    _kernel().norms(state, truth, out)
    return np.ascontiguousarray(out.T)


def angles(found: Float[Array, "j n 3 3"], rotation: Float[Array, "n 3 3"]) -> Float[Array, "j n"]:
    """Angles (rad) of R R̂ᵀ over time, for each of many R̂."""
    out = np.empty(found.shape[:2])
    _kernel().angles(found, rotation, out)
    return out


def _kernel() -> ModuleType:
    """Imported where it is used, as in `cascade`."""
    from rangenav.kernels import errors as kernel

    return kernel
