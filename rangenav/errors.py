"""How far an estimate is from the truth: x̂ in body axes (paper, fig. 3) and the attitude (fig. 4)."""

from types import ModuleType

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.arguments import array
from rangenav.cascade import Estimate
from rangenav.model import STATES
from rangenav.results import result


@result
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
    """Norms of the body-axes errors, and the angle of R̃ = R R̂ᵀ; truth is the true 13-state, rotation the true R.

    Raises ValueError if they have not one row for each sample of the estimate.
    """
    position, velocity, gravity = norms(estimate.state, truth)
    attitude = angles(estimate.rotation[None], rotation)[0]
    return Errors(position=position, velocity=velocity, gravity=gravity, attitude=attitude)


def norms(state: Float[Array, "n 13"], truth: Float[Array, "n 13"]) -> Float[Array, "3 n"]:
    """Lengths of the differences of position, velocity and gravity. Raises ValueError for arrays of other shapes."""
    state = array("state", state, ("n", STATES))
    truth = array("truth", truth, state.shape)
    out = np.empty((len(truth), 3))
    _kernel().norms(state, truth, out)
    return np.ascontiguousarray(out.T)


def angles(estimates: Float[Array, "j n 3 3"], rotation: Float[Array, "n 3 3"]) -> Float[Array, "j n"]:
    """Angles (rad) of R R̂ᵀ over time, for each of many R̂. Raises ValueError for arrays of other shapes."""
    estimates = array("estimates", estimates, ("j", "n", 3, 3))
    rotation = array("rotation", rotation, estimates.shape[1:])
    out = np.empty(estimates.shape[:2])
    _kernel().angles(estimates, rotation, out)
    return out


def _kernel() -> ModuleType:
    """Imported where it is used, as in `cascade`."""
    from rangenav.kernels import errors as kernel

    return kernel
