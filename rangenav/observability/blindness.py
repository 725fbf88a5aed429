"""Blind directions: inertial directions in the null spaces of a window's Gramian and of its snap."""

import numpy as np
import scipy.linalg
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.arguments import finite_array
from rangenav.model import GRAVITY, POSITION, STATES, VELOCITY
from rangenav.number_format import fixed
from rangenav.observability.cubic_fit import CUBIC
from rangenav.observability.pseudoinverse import unseen_unknowns
from rangenav.results import result
from rangenav.signals import AXES

SHARE = 1e-6
"""A block is undetermined if the part in it of a unit vector of position, velocity and gravity (scaled units) that is
not seen is longer than this."""
SAME = 0.9999
"""Cosine above which two directions count as one, and above which a direction has the name of an axis."""
EQUAL = 8
"""Decimals to which shares of the axes in a span are compared."""
UNEXCITED = 1e-12
"""Share of the largest excitation eigenvalue below which a direction counts as not excited."""
BLOCKS = {"position": POSITION, "velocity": VELOCITY, "gravity": GRAVITY}


@result
class Direction:
    """One inertial direction, and what the ranges do not determine along it."""

    vector: Float[Array, "3"]
    kinds: tuple[str, ...]
    """Of "snap", "position", "velocity", "gravity"."""
    summary: str


def directions(
    null_basis: Float[Array, "13 k"], excitation: Float[Array, "3"], axes: Float[Array, "3 3"]
) -> tuple[Direction, ...]:
    """The blind directions of a window, from the null space of its Gramian and from its excitation.

    The excitation is given by its eigenvalues (m²/s⁷, ascending) and its axes (unit vectors in columns, inertial).
    Raises ValueError for arrays of other shapes, or numbers that are not finite.
    """
    null_basis = finite_array("null_basis", null_basis, (STATES, "k"))
    excitation, axes = finite_array("excitation", excitation, (3,)), finite_array("axes", axes, (3, 3))
    spans = {"snap": axes[:, excitation <= UNEXCITED * max(excitation[-1], np.finfo(float).tiny)]}
    unknowns = np.concatenate([np.zeros((CUBIC, null_basis.shape[1])), unseen_unknowns(null_basis)])
    for name, block in BLOCKS.items():
        left, size, _ = np.linalg.svd(unknowns[block])
        spans[name] = left[:, : int(np.sum(size > SHARE))]
    named: list[tuple[Array, list[str]]] = []
    for kind, span in spans.items():
        for vector in _readable_basis(span):
            _add(named, vector, kind)
    return tuple(Direction(vector=v, kinds=tuple(kinds), summary=_summary(v, kinds)) for v, kinds in named)


def _add(named: list[tuple[Array, list[str]]], vector: Array, kind: str) -> None:
    for known, kinds in named:
        if abs(known @ vector) > SAME:
            kinds.append(kind)
            return
    named.append((vector, [kind]))


def _readable_basis(span: Array) -> list[Array]:
    """A basis of the span, with coordinate axes where the span contains them: pivoted QR of its projector."""
    dimension = span.shape[1]
    if dimension == 0:
        return []
    projector = np.round(span @ span.T, EQUAL)  # rounding chooses no first among equal axes
    basis = np.asarray(scipy.linalg.qr(projector, pivoting=True)[0])
    vectors = [basis[:, k] for k in range(dimension)]
    vectors = [np.where(np.abs(v) < 1e-9, 0.0, v) for v in vectors]
    return [v if v[np.argmax(np.abs(v))] > 0 else -v for v in vectors]


def name(vector: Float[Array, "3"]) -> str:
    """x, y or z where the direction is an axis, else its three numbers."""
    for axis, k in AXES.items():
        if abs(vector[k]) > SAME:
            return axis
    return f"({', '.join(fixed(value) for value in vector.tolist())})"


def _summary(vector: Array, kinds: list[str]) -> str:
    along = name(vector)
    undetermined = [kind for kind in kinds if kind != "snap"]
    sentences = [f"nothing excites {along}: the path has no snap along it"] if "snap" in kinds else []
    if undetermined:
        *others, last = undetermined
        what = f"{', '.join(others)} and {last}" if others else last
        sentences.append(f"{what} along {along} cannot be told")
    return "; ".join(sentences)
