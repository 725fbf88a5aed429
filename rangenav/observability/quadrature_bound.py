"""How far the least singular values of a window may be from those of its nodes: a bound of the quadrature's error.

With u in [−1, 1] on a panel of m Gauss nodes, a polynomial of degree d that is at most b there is at most b ρᵈ on the
ellipse of foci ±1 and semi-axes (ρ ± 1/ρ)/2, and tones that turn by x on the panel are at most |A| e^{x(ρ − 1/ρ)/4}.
The mean of what is at most M on the ellipse errs by at most (32/15) M ρ^{−2m}/(1 − ρ⁻²). (Gauss's rule: Trefethen,
Approximation Theory and Approximation Practice, theorem 19.3.) Products of polynomials are integrated exactly, so M is
that of the products with tones. Of a formula nothing is known away from the time axis, and no bound is stated.
"""

import math

import numpy as np

from rangenav.observability import quadrature
from rangenav.observability.coordinates import STATES
from rangenav.observability.cubic_fit import CUBIC
from rangenav.observability.gramian_rank import ROUNDING
from rangenav.signals import Signal, curved_part

SPARE = 20
"""Nodes that are added to each panel with tones: 52 on 36 rad, which leave 1e-33 of the largest squares."""
POLYNOMIAL, DEGREE = 24.0, 5
"""|u²P| and what is added to it, in units of the path's size: a cubic fit is at most 16 |p| and L₄ and L₅ have
coefficients of at most 4, 1 and 2.2; the degree of all of that."""
ELLIPSES = np.geomspace(1.2, 100.0, 200)
"""ρ, of which the best counts."""


def known(path: Signal) -> bool:
    """Whether the error has a bound: of tones and of polynomials."""
    return path.operations() == 0


def relative(path: Signal, window: float, until: float, *, size: float, margin: float) -> float:
    """The most by which least singular values are too large, relatively; above 1 where nothing is shown.

    size: of the path (m), the unit of its columns. margin: the least singular value of the remainders, in units of the
    rounding of columns of that size.
    """
    turn, each = quadrature.panels(path, window, until, spare=SPARE)
    if turn == 0:
        return 0.0
    curve = curved_part(path)
    tones = sum(part.bound(0) for part in curve.parts() if part.piecewise() is None)
    degree = max((len(p.tables) - 1 for part in curve.parts() if (p := part.piecewise()) is not None), default=0)
    rho, log = ELLIPSES, np.log(ELLIPSES)
    with np.errstate(over="ignore"):
        added = math.log(max(tones, 1e-300) / size) + 2 * log + turn * (rho - 1 / rho) / 4
        rest = math.log(POLYNOMIAL) + max(degree + 2, DEGREE) * log
        largest = added + np.logaddexp(math.log(2) + rest, added) + math.log(STATES)
        error = math.log(32 / 15) + largest - 2 * each * log - np.log1p(-(rho**-2.0))
    least = max(margin * ROUNDING, 1e-300)
    inverse = math.sqrt(2 * CUBIC - 1) * (1 + 3 * POLYNOMIAL / least) + 1 / least
    return math.exp(min(0.0, float(error.min()) + 2 * math.log(inverse)))
