"""The 13 functions of one window: {1, τ, τ²/2, τ³/6, D, τD, ½τ²D}, D = p(t+τ) − p(t) − τ v(t) − ½τ² g (paper, eq. 7).

A window is observable exactly when they are linearly independent on it. Where they are not, each relation among them is
a change of the state that changes no range of the window.
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.inputs import Vec3
from rangenav.model import STATES
from rangenav.observability import rows, spectrum, windows
from rangenav.observability.continuation import continued
from rangenav.observability.cubic_fit import CUBIC
from rangenav.results import result
from rangenav.signals import Signal

NAMES = (
    *("1", "τ", "τ²/2", "τ³/6"),
    *("D_x", "D_y", "D_z"),
    *("τ D_x", "τ D_y", "τ D_z"),
    *("½τ² D_x", "½τ² D_y", "½τ² D_z"),
)
COORDINATES = ("ξ₁", "ξ₂", "ξ₃", "ξ₄", "p_x", "p_y", "p_z", "v_x", "v_y", "v_z", "g_x", "g_y", "g_z")
UNITS = ("m²", "m²/s", "m²/s²", "m²/s³", *("m",) * 3, *("m/s",) * 3, *("m/s²",) * 3)
"""The state that each function carries to the range, inertial axes."""
POINTS = 201
"""Of a curve in a plot."""
MAX_POINTS = 4096
ABSENT = 1e-6
"""A coefficient (scaled units) below this is left out of a relation: null vectors are good to 1e-9 or so."""
DIGITS = range(3, 10)
"""Of a relation's numbers: the fewest with which it holds on the window. Null vectors are not good to more."""
HOLDS = 2e-3
"""A relation as it is written holds to this share of the largest value of its function."""


@result
class Functions:
    """The 13 functions on [start, start + window] (s)."""

    start: float
    tau: Float[Array, "k"]
    """s, from 0."""
    values: Float[Array, "k 13"]
    """SI: s, s², s³; m, m s, m s²."""
    rank: int
    """How many of them are linearly independent: on the window, or on a longer one on which the path is analytic."""
    null: Float[Array, "m 13"]
    """Changes of the 13 coordinates (SI) that change no range of the window; each has a 1 where the others have 0."""
    relations: tuple[str, ...]
    """The same as relations of the functions: each of the dependent ones in terms of those before it."""
    unseen: tuple[str, ...]
    """The same as changes of the state: `p_z +1 m with ξ₃ +9.81 m²/s²`."""


def functions(
    path: Signal, gravity: Vec3, start: float, window: float, *, until: float = 0.0, points: int = POINTS
) -> Functions:
    """The 13 functions of one window, and the relations among them. Raises ValueError as `windows.checked_one` does.

    until: s, as far as the path is looked at to tell a relation from rounding; see `continuation`.
    """
    starts, window = windows.checked_one(path, start, window)
    if not 2 <= points <= MAX_POINTS:
        raise ValueError(f"points must lie between 2 and {MAX_POINTS}, got {points}")
    tau = np.linspace(0.0, window, points)
    values = rows.lifted(path, gravity, starts, tau)[0]
    gramian = spectrum.window_spectra(path, gravity, starts, window)
    known = continued(path, gravity, float(starts[0]), window, until, int(gramian.rank[0]))
    if known.rank > gramian.rank[0] and known.rank < STATES:
        gramian = spectrum.window_spectra(path, gravity, starts, known.window)
    none = np.zeros((STATES, 0))
    null, own = _echelon(none if known.rank == STATES else spectrum.null_basis(gramian, 0), known.window)
    return Functions(
        start=float(starts[0]),
        tau=tau,
        values=values,
        rank=known.rank,
        null=null,
        relations=tuple(_relation(*tied, values) for tied in zip(null, own, strict=True)),
        unseen=tuple(_unseen(*tied, values) for tied in zip(null, own, strict=True)),
    )


def _echelon(null_basis: Float[Array, "13 m"], window: float) -> tuple[Float[Array, "m 13"], list[int]]:
    """The null space in echelon form from the last coordinate back, and the coordinate that each vector has alone."""
    if null_basis.shape[1]:
        _, size, right = np.linalg.svd(null_basis[CUBIC:], full_matrices=False)  # see `pseudoinverse`
        null_basis = null_basis @ (right.T / size)
    basis = null_basis.T[:, ::-1].copy()
    own: list[int] = []
    for row in range(len(basis)):
        rest = np.abs(basis[row:])
        present = rest.max(axis=0) > ABSENT
        if not present.any():
            break
        column = int(np.argmax(present))
        pivot = row + int(np.argmax(rest[:, column]))
        basis[[row, pivot]] = basis[[pivot, row]]
        basis[row] /= basis[row, column]
        others = np.arange(len(basis)) != row
        basis[others] -= np.outer(basis[others, column], basis[row])
        own.append(len(NAMES) - 1 - column)
    basis = basis[: len(own), ::-1]
    least = np.full_like(basis, ABSENT)
    least[:, :CUBIC] *= np.abs(basis[:, :CUBIC]).max(axis=1, initial=1.0)[:, None]
    basis = np.where(np.abs(basis) > least, basis, 0.0)
    in_si = basis * float(window) ** -spectrum.LIFTED_TIME_POWERS.astype(float)
    in_si /= in_si[range(len(own)), own][:, None]
    return in_si[::-1], own[::-1]


def _relation(vector: Array, own: int, values: Float[Array, "k 13"]) -> str:
    """Σ vⱼ fⱼ = 0 with v_own = 1, as `f_own = …`."""
    digits = _digits(vector, own, values)
    terms = [(-float(vector[j]), NAMES[j]) for j in np.flatnonzero(vector) if j != own]
    if not terms:
        return f"{NAMES[own]} = 0"
    text = "".join(f" {'−' if value < 0 else '+'} {_times(abs(value), name, digits)}" for value, name in terms)
    return f"{NAMES[own]} =" + (text[2:] if text.startswith(" +") else f" −{text[3:]}")


def _unseen(vector: Array, own: int, values: Float[Array, "k 13"]) -> str:
    digits = _digits(vector, own, values)
    order = [own, *(j for j in np.flatnonzero(vector) if j != own)]
    steps = [f"{COORDINATES[j]} {'−' if vector[j] < 0 else '+'}{abs(vector[j]):.{digits}g} {UNITS[j]}" for j in order]
    return steps[0] if len(steps) == 1 else f"{steps[0]} with {', '.join(steps[1:])}"


def _digits(vector: Array, own: int, values: Float[Array, "k 13"]) -> int:
    """How many digits a relation needs: between nearly dependent functions, large terms cancel."""
    bound = HOLDS * np.abs(values[:, own]).max()
    for digits in DIGITS:
        written = np.array([float(f"{value:.{digits}g}") for value in vector])
        if np.abs(values @ (written - vector)).max() <= bound:
            return digits
    return DIGITS[-1]


def _times(size: float, name: str, digits: int) -> str:
    number = f"{size:.{digits}g}"
    if name == "1":
        return number
    return name if float(number) == 1.0 else f"{number} {name}"
