"""The excitation of one window as an ellipsoid: {x : xᵀ W⁻¹ x ≤ 1}, W = ∫_t^{t+δ} p⁗ p⁗ᵀ ds (paper, Proposition 1).

Its semi-axes √λᵢ (m/s^3.5) are the excitation of each direction, and μ is the square of the least one. A direction in
which the ellipsoid is flat has no excitation.
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.observability import blindness, excitation
from rangenav.results import result
from rangenav.signals import Signal


@result
class Ellipsoid:
    """The excitation of the window that starts at `start` (s)."""

    start: float
    window: float
    eigenvalues: Float[Array, "3"]
    """m²/s⁷, ascending; values that are rounding are set to 0."""
    axes: Float[Array, "3 3"]
    """Columns, in the order of the eigenvalues: a right-handed frame, inertial."""
    summary: str

    @property
    def semi_axes(self) -> Float[Array, "3"]:
        """m/s^3.5, ascending."""
        return np.sqrt(self.eigenvalues)

    @property
    def weakest(self) -> Float[Array, "3"]:
        """The unit vector along which the window is excited least."""
        return self.axes[:, 0]


def ellipsoid(path: Signal, start: float, window: float) -> Ellipsoid:
    """The excitation of the window [start, start + window] (s)."""
    values, axes = excitation.directions(path, start, window)
    excited = values > blindness.UNEXCITED * values[-1]
    values = np.where(excited, values, 0.0)
    axes = axes * np.where(axes[np.abs(axes).argmax(axis=0), range(3)] < 0, -1.0, 1.0)
    axes[:, 2] *= np.sign(np.linalg.det(axes))
    return Ellipsoid(start=start, window=window, eigenvalues=values, axes=axes, summary=_summary(values, axes))


def _summary(values: Array, axes: Array) -> str:
    weakest, strongest = (blindness.name(np.where(np.abs(n) < 1e-9, 0.0, n)) for n in (axes[:, 0], axes[:, 2]))
    if values[2] == 0:
        return "nothing is excited: the path has no snap in this window"
    if values[0] == 0:
        count = int(np.sum(values == 0))
        across = f"but {strongest}" if count == 2 else f"along {weakest}"
        return f"nothing is excited {across}: the path has no snap there"
    share = np.sqrt(values[2] / values[0])
    less = f"the snap along it is {share:.3g} times smaller than along {strongest} (rms)"
    return f"weakest along {weakest}: μ = {values[0]:.3g} m²/s⁷; {less}"
