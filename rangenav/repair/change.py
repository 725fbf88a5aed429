"""One kind of change that can repair a motion: a map θ → preset, where θ = 0 changes nothing."""

from collections.abc import Callable
from typing import Literal

import msgspec
import numpy as np
from jaxtyping import Bool, Float
from numpy import ndarray as Array

from rangenav.preset import Preset
from rangenav.results import result
from rangenav.signals import Signal

ChangeKind = Literal["tones", "amplitude", "frequency", "timescale", "waypoints"]
KINDS: tuple[ChangeKind, ...] = ("tones", "amplitude", "frequency", "timescale", "waypoints")


@result
class Change:
    """One way of changing a preset. θ = 0 changes nothing."""

    box: Float[Array, "n 2"]
    """Where θ may lie."""
    make: Callable[[Array], Preset]
    """θ → the changed preset. Raises ValueError where there is none."""
    effort: Callable[[Array], float]
    """The size of the change."""
    description: Callable[[Array], str]
    rounded: Callable[[Array], Array]
    """θ rounded to numbers that a person would write."""
    rays: tuple[Float[Array, "n"], ...]
    """Ends of the rays from θ = 0 along which a first solution is searched."""
    grows: Bool[Array, "n"] | None = None
    """Which unknowns grow along a ray; None: all of them. Frequencies and phases stay."""

    def ray(self, end: Float[Array, "n"], share: float) -> Float[Array, "n"]:
        """A share of the way from no change to `end`."""
        return share * end if self.grows is None else np.where(self.grows, share * end, end)


def with_path(preset: Preset, path: Signal) -> Preset:
    """The same run along another path. Raises ValueError where that is no run."""
    return msgspec.structs.replace(preset, path=path)
