"""The cubic that fits the path in a window: Cₖ = ½(2k + 1) ∫ p Lₖ du, Legendre polynomials Lₖ, k = 0 … 3.

u = 2τ/δ − 1 runs from −1 to 1. The lifted state holds such polynomials whatever the motion, so its rank depends on
what the path has besides its cubic.
"""

from functools import lru_cache

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.observability.rows import PathSamples
from rangenav.results import result

CUBIC = 4
"""Polynomials that the lifted state has whatever the motion."""


@result
class CubicFit:
    """The polynomials at the samples of some windows, and the cubic that fits each window's path."""

    polynomials: Float[Array, "v 6 k"]
    """L₀ … L₅."""
    cubic: Float[Array, "w 4 3"]
    """C: by Legendre's integrals, which is the best fit; any other cubic would serve, as long as it is subtracted."""

    def some(self, inside: slice) -> "CubicFit":
        """That of some windows."""
        polynomials = self.polynomials if len(self.polynomials) == 1 else self.polynomials[inside]
        return CubicFit(polynomials=polynomials, cubic=self.cubic[inside])


@lru_cache(maxsize=2)
def of(samples: PathSamples) -> CubicFit:
    """The fit in windows whose samples are known.

    Cached by identity: spectra and accuracies of the same windows are computed from the same samples.
    """
    u = 2 * samples.tau / samples.window - 1
    values = [np.ones_like(u), u]
    for k in range(1, CUBIC + 1):
        values.append(((2 * k + 1) * u * values[-1] - k * values[-2]) / (k + 1))
    polynomials, scale = np.stack(values, axis=1), (2 * np.arange(CUBIC) + 1.0)[:, None]
    integrals = (polynomials[:, :CUBIC] * samples.weight[:, None]) @ samples.curved.swapaxes(1, 2)
    return CubicFit(polynomials=polynomials, cubic=scale * integrals)
