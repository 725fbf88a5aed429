"""Integrals over pieces of polynomials in 50 digits, by multiplying and integrating the polynomials: no quadrature.

An independent witness for excitation and Gramians. The pieces come from the coefficients alone, cut and moved by
binomials; nothing of the library is evaluated.
"""

from dataclasses import dataclass
from typing import Any

import mpmath as mp
import numpy as np

from rangenav.signals import MinimumSnap, Polynomials, Waypoints

mp.mp.dps = 50
Real = Any
"""A number of mpmath, which makes its classes at run time: no type expression can name them."""
Polynomial = list[Real]
Curve = Waypoints | MinimumSnap | Polynomials


@dataclass(frozen=True, eq=False, kw_only=True)
class Stretch:
    """One polynomial per axis in u = t − begin, ascending, for 0 ≤ u ≤ length."""

    begin: Real
    length: Real
    axes: list[Polynomial]


def stretches(curve: Curve, first: float, last: float) -> list[Stretch]:
    """The curve from first to last (s), cut at its knots. Outside its pieces it rests, or repeats with its period."""
    knots, table = _table(curve)
    start, end = mp.mpf(first), mp.mpf(last)
    duration = knots[-1] - knots[0]
    pieces = [(knots[m], knots[m + 1], table[m]) for m in range(len(table))]
    if curve.period is not None:
        turns = range(int(mp.floor((start - knots[0]) / duration)), int(mp.ceil((end - knots[0]) / duration)))
        pieces = [(a + k * duration, b + k * duration, axes) for k in turns for a, b, axes in pieces]
    else:
        before = [[axis[0]] for axis in table[0]]
        after = [[value(axis, knots[-1] - knots[-2])] for axis in table[-1]]
        pieces = [(knots[0] - 1000, knots[0], before), *pieces, (knots[-1], knots[-1] + 1000, after)]
    cut = [(max(a, start), min(b, end), a, axes) for a, b, axes in pieces if min(b, end) > max(a, start)]
    return [Stretch(begin=a, length=b - a, axes=[moved(p, a - knot) for p in axes]) for a, b, knot, axes in cut]


def excitation(curve: Curve, start: float, window: float) -> np.ndarray:
    """Eigenvalues of ∫p⁗p⁗ᵀ over [start, start + window], ascending."""
    snaps = [[derivative(axis, 4) for axis in s.axes] for s in stretches(curve, start, start + window)]
    lengths = [s.length for s in stretches(curve, start, start + window)]
    return _eigenvalues(list(zip(snaps, lengths, strict=True)), 3)


def lifted(curve: Curve, gravity: tuple, start: float, window: float) -> np.ndarray:
    """Eigenvalues of the lifted Gramian (1/δ)∫hᵀh, ascending."""
    parts = stretches(curve, start, start + window)
    position = [axis[0] for axis in parts[0].axes]
    velocity = [value(derivative(axis, 1), mp.mpf(0)) for axis in parts[0].axes]
    rows = []
    for stretch in parts:
        tau = [stretch.begin - mp.mpf(start), mp.mpf(1)]
        square = [c / 2 for c in times(tau, tau)]
        fall = [[-p] for p in position]
        D = [
            plus(axis, at, [-v * c for c in tau], [-mp.mpf(g) * c for c in square])
            for axis, at, v, g in zip(stretch.axes, fall, velocity, gravity, strict=True)
        ]
        cube = [c / 3 for c in times(square, tau)]
        h = [[mp.mpf(1)], tau, square, cube, *D, *(times(tau, d) for d in D), *(times(square, d) for d in D)]
        rows.append((h, stretch.length))
    return _eigenvalues(rows, 13) / window


def nonlinear(curve: Curve, anchor: tuple, start: float, window: float) -> np.ndarray:
    """Eigenvalues of the nonlinear Gramian, ascending."""
    rows = []
    for stretch in stretches(curve, start, start + window):
        tau = [stretch.begin - mp.mpf(start), mp.mpf(1)]
        square = [c / 2 for c in times(tau, tau)]
        q = [plus(axis, [-mp.mpf(a)]) for axis, a in zip(stretch.axes, anchor, strict=True)]
        rows.append(([*q, *(times(tau, p) for p in q), *(times(square, p) for p in q)], stretch.length))
    return _eigenvalues(rows, 9) / window


def value(polynomial: Polynomial, u: Real) -> Real:
    """The value of a polynomial at u, by Horner's scheme."""
    return mp.polyval(polynomial[::-1], u)


def derivative(polynomial: Polynomial, order: int) -> Polynomial:
    """The derivative of a polynomial, of any order."""
    for _ in range(order):
        polynomial = [j * c for j, c in enumerate(polynomial)][1:] or [mp.mpf(0)]
    return polynomial


def moved(polynomial: Polynomial, shift: Real) -> Polynomial:
    """p(u + shift), by the binomial formula."""
    degree = len(polynomial) - 1
    return [
        mp.fsum(mp.binomial(j, i) * polynomial[j] * shift ** (j - i) for j in range(i, degree + 1))
        for i in range(degree + 1)
    ]


def times(a: Polynomial, b: Polynomial) -> Polynomial:
    """The product of two polynomials."""
    product = [mp.mpf(0)] * (len(a) + len(b) - 1)
    for i, x in enumerate(a):
        for j, y in enumerate(b):
            product[i + j] += x * y
    return product


def plus(*terms: Polynomial) -> Polynomial:
    """The sum of polynomials."""
    return [mp.fsum(t[j] for t in terms if j < len(t)) for j in range(max(map(len, terms)))]


def _table(curve: Curve) -> tuple[list[Real], list[list[Polynomial]]]:
    """Knots and, for each piece, the ascending coefficients of each axis, all taken as the doubles that they are."""
    if isinstance(curve, Polynomials):
        knots = [mp.mpf(float(t)) for t in np.concatenate([[0.0], np.cumsum([p.duration for p in curve.pieces])])]
        return knots, [[[mp.mpf(c) for c in axis] for axis in (p.x, p.y, p.z)] for p in curve.pieces]
    pieces = curve.piecewise()
    table = pieces.tables[0].transpose(1, 2, 0)
    return [mp.mpf(float(t)) for t in pieces.knots], [[[mp.mpf(float(c)) for c in axis] for axis in p] for p in table]


def _eigenvalues(rows: list[tuple[list[Polynomial], Real]], size: int) -> np.ndarray:
    """Eigenvalues of the sum of ∫hᵀh over all stretches, ascending."""
    W = mp.zeros(size)
    for h, length in rows:
        powers = [length**j for j in range(60)]
        for i in range(size):
            for j in range(i + 1):
                product = times(h[i], h[j])
                W[i, j] += mp.fsum(c * powers[k + 1] / (k + 1) for k, c in enumerate(product))
                W[j, i] = W[i, j]
    return np.array([float(value) for value in sorted(mp.eigsy(W, eigvals_only=True))])
