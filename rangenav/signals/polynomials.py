"""Polynomials: pieces of degree 7 with their durations, as uav_trajectories files and the Crazyflie hold them.

Each piece has eight ascending coefficients in its own local time for x, y, z and yaw. Files need not be smooth: where a
derivative jumps, `jumps` says by how much, and `complaints` names the jumps that no vehicle could follow.
"""

import math
from functools import lru_cache
from typing import Literal, cast

import msgspec
import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.inputs import Input, require, require_within
from rangenav.results import result
from rangenav.signals import piecewise
from rangenav.signals.piecewise import Pieces
from rangenav.signals.piecewise_family import PiecewiseFamily
from rangenav.signals.waypoints import MinimumSnap

DEGREE = 7
MAX_PIECES = 2000
MIN_DURATION, MAX_DURATION = 1e-3, 1e4
MAX_COEFFICIENT = 1e15
MAX_REACH = 1e7
TURNS_PER_PIECE = 2.0
"""Half-waves of the fastest motion in a piece of degree 7, as assumed for quadrature."""
COMPLAINTS = {0: ("position", 1e-3, "m"), 1: ("velocity", 1e-2, "m/s"), 2: ("acceleration", 0.1, "m/s²")}
"""No vehicle follows jumps of this size and more: with the acceleration its attitude jumps, by 0.1/9.81 = 0.6° here.
Files print six decimals, which is a thousand times finer."""
CACHED = 16
Coefficients = tuple[float, float, float, float, float, float, float, float]
ZERO: Coefficients = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


class Piece(Input, frozen=True, kw_only=True):
    """One polynomial of degree 7 per axis; coefficient j belongs to (t − start)ʲ."""

    duration: float
    """s"""
    x: Coefficients = ZERO
    """In the signal's unit per sʲ, as y and z."""
    y: Coefficients = ZERO
    z: Coefficients = ZERO
    yaw: Coefficients = ZERO
    """rad per sʲ: kept for the file, no part of the signal."""

    def __post_init__(self) -> None:
        super().__post_init__()
        require_within("duration", self.duration, MIN_DURATION, MAX_DURATION, "s")
        for axis in ("x", "y", "z", "yaw"):
            largest = max(getattr(self, axis), key=abs)
            require_within(axis, largest, -MAX_COEFFICIENT, MAX_COEFFICIENT)


class Polynomials(PiecewiseFamily, frozen=True, kw_only=True, tag="polynomials", tag_field="kind", cache_hash=True):
    """Pieces one after the other from t = 0."""

    pieces: tuple[Piece, ...]
    ends: Literal["hold", "repeat"] = "hold"
    """After the last piece the signal holds where it is, or begins anew."""

    def __post_init__(self) -> None:
        super().__post_init__()
        count = len(self.pieces)
        require(1 <= count <= MAX_PIECES, f"1 to {MAX_PIECES} pieces make a path, got {count}")
        total = math.fsum(piece.duration for piece in self.pieces)
        require(total <= MAX_DURATION, f"the pieces must last {MAX_DURATION:g} s at most, got {total:g} s")
        reach = piecewise.hull(_pieces(self), 0)
        require(reach <= MAX_REACH, f"the pieces may reach out to {reach:.2g}, which is beyond {MAX_REACH:g}")

    def piecewise(self) -> Pieces:
        """The polynomials, in times since t = 0."""
        return _pieces(self)

    @property
    def bandwidth(self) -> float:
        """The highest frequency that the shortest piece can hold (rad/s)."""
        return TURNS_PER_PIECE * math.pi / min(piece.duration for piece in self.pieces)

    def bound(self, order: int) -> float:
        """A bound on |signal(t, order)| for every t, from Bernstein coefficients; infinite if a lower one jumps."""
        return _bound(self, order)

    @property
    def period(self) -> float | None:
        """The total duration (s) if the signal repeats, else None."""
        return _pieces(self).duration if self.ends == "repeat" else None

    def slowed(self, factor: float) -> "Polynomials":
        """The signal s(t / factor), its yaw included."""
        return msgspec.structs.replace(self, pieces=tuple(_slowed_piece(piece, factor) for piece in self.pieces))

    def mapped(self, matrix: Float[Array, "3 3"], shift: Float[Array, "3"]) -> "Polynomials":
        """matrix · signal + shift; the yaw of the pieces is kept."""
        return msgspec.structs.replace(self, pieces=tuple(_mixed_piece(piece, matrix, shift) for piece in self.pieces))


@result
class Jumps:
    """How far the derivatives jump at each knot, the first and the last included."""

    time: Float[Array, "k"]
    """s"""
    step: Float[Array, "k 5 3"]
    """Of position to snap, after minus before: m, m/s … m/s⁴ for a path."""


def jumps(signal: Polynomials) -> Jumps:
    """The jumps C⁰ to C⁴. At the ends the signal stands still before and after, or meets its own beginning."""
    curve = _pieces(signal)
    return Jumps(time=curve.knots, step=piecewise.jumps(curve))


def complaints(signal: Polynomials, *, inside: tuple[float, float] = (-math.inf, math.inf)) -> tuple[str, ...]:
    """A sentence for each knot (strictly inside some seconds) where position, velocity or acceleration jumps.

    No vehicle can fly that. Pieces that do not repeat may begin and end in motion.
    """
    jumped = jumps(signal)
    sentences = []
    for k, time in enumerate(jumped.time):
        free = signal.ends == "hold" and k in (0, len(jumped.time) - 1)
        if free or not inside[0] < time < inside[1]:
            continue
        for order, (name, least, unit) in COMPLAINTS.items():
            steps = np.abs(jumped.step[k, order])
            if steps.max() >= least:
                axis = "xyz"[int(np.argmax(steps))]
                sentences.append(f"{name} jumps by {steps.max():.2g} {unit} along {axis} at t = {time:.2f} s")
                break
    return tuple(sentences)


def cut(path: Polynomials, begin: float, duration: float) -> Polynomials:
    """The pieces from `begin` on, for a duration (s), each developed anew about where it starts."""
    ends = np.cumsum([piece.duration for piece in path.pieces])
    inside = ends[(ends > begin + MIN_DURATION) & (ends < begin + duration - MIN_DURATION)]
    knots = np.concatenate([[begin], inside, [begin + duration]])
    require(duration > MIN_DURATION and knots[-1] <= ends[-1] + MIN_DURATION, "the file ends before its path does")
    order = np.array([math.factorial(j) for j in range(DEGREE + 1)])
    middle = (knots[1:] + knots[:-1]) / 2  # where there is no doubt which piece is meant
    tables = np.stack([path(middle, j) for j in range(DEGREE + 1)], axis=1) / order[:, None]  # (m, 8, 3)
    half = np.diff(knots) / 2
    developed = _developed(tables, half)
    return Polynomials(pieces=tuple(_piece(2 * h, table) for h, table in zip(half, developed, strict=True)))


def loop(path: Polynomials, first: int, count: int) -> Polynomials:
    """So many pieces, from the piece `first` on (from 0), again and again. Raises ValueError if there are too few."""
    require(first >= 0 and 0 < count <= len(path.pieces) - first, "the file does not hold the pieces of its loop")
    return Polynomials(pieces=path.pieces[first : first + count], ends="repeat")


def from_minimum_snap(curve: MinimumSnap) -> Polynomials:
    """The same curve as polynomials; before a first waypoint later than t = 0 it stands still."""
    parts = curve.piecewise()
    late = float(parts.knots[0])
    require(late == 0 or not parts.repeats, f"to repeat as pieces a curve must begin at t = 0, not at {late:g} s")
    pieces = [_piece(length, table) for length, table in zip(np.diff(parts.knots), _by_piece(parts), strict=True)]
    if late > 0:
        standing = np.zeros((8, 3))
        standing[0] = parts.tables[0][0, 0]
        pieces.insert(0, _piece(late, standing))
    return Polynomials(pieces=tuple(pieces), ends="repeat" if parts.repeats else "hold")


def _developed(tables: Float[Array, "m 8 3"], later: Float[Array, "m"]) -> Float[Array, "m 8 3"]:
    """The coefficients of p(t − later) from those of p(t), by Horner's rule."""
    made = np.zeros_like(tables)
    for j in range(DEGREE, -1, -1):
        higher = -later[:, None, None] * made
        higher[:, 1:] += made[:, :-1]
        made = higher
        made[:, 0] += tables[:, j]
    return made


def _mixed_piece(piece: Piece, matrix: Array, shift: Array) -> Piece:
    table = matrix @ np.array([piece.x, piece.y, piece.z])
    table[:, 0] += shift
    x, y, z = (cast(Coefficients, tuple(row.tolist())) for row in table)
    return msgspec.structs.replace(piece, x=x, y=y, z=z)


def _slowed_piece(piece: Piece, factor: float) -> Piece:
    table = np.array([piece.x, piece.y, piece.z, piece.yaw]) / factor ** np.arange(8)
    x, y, z, yaw = (cast(Coefficients, tuple(row.tolist())) for row in table)
    return Piece(duration=piece.duration * factor, x=x, y=y, z=z, yaw=yaw)


def _by_piece(parts: Pieces) -> Float[Array, "m 8 3"]:
    return parts.tables[0].transpose(1, 0, 2)


def _piece(duration: float, table: Float[Array, "8 3"]) -> Piece:
    x, y, z = (tuple(column.tolist()) for column in table.T)
    return Piece(duration=float(duration), x=x, y=y, z=z)


@lru_cache(maxsize=CACHED)
def _pieces(signal: Polynomials) -> Pieces:
    table = np.array([[piece.x, piece.y, piece.z] for piece in signal.pieces])  # (m, 3, 8)
    knots = np.concatenate([[0.0], np.cumsum([piece.duration for piece in signal.pieces])])
    return piecewise.pieces(knots, table.transpose(2, 0, 1), repeats=signal.ends == "repeat")


@lru_cache(maxsize=4 * CACHED)
def _bound(signal: Polynomials, order: int) -> float:
    return piecewise.bound(_pieces(signal), order)
