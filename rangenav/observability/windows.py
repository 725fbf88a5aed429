"""The arguments of every question about a path: the signal, the times t at which windows start, and their length δ (s).

Each public function of this package checks them here, once, before it computes.
"""

from typing import Any

import numpy as np
from numpy import ndarray as Array

from rangenav.arguments import array, described, finite_array, number
from rangenav.inputs import require


def checked(path: Any, start: Any, window: Any) -> tuple[Array, float]:
    """Starts (s), at least one, as float64, and the length (s) of all windows.

    Raises ValueError in one sentence for a path that is no signal, starts that are no row of finite numbers, or a
    length that is not positive.
    """
    refuse_arrays(path)
    starts = finite_array("start", start, ("w",))
    require(len(starts) > 0, "start must hold the start of at least one window, got none")
    length = number("window", window)
    require(length > 0, f"window must be longer than 0 s, got {length:g} s")
    return starts, length


def checked_one(path: Any, start: Any, window: Any) -> tuple[Array, float]:
    """The same of the one window that starts at `start` (s)."""
    return checked(path, np.array([number("start", start)]), window)


def offsets(name: str, tau: Any, rows: int) -> Array:
    """Times since the start of each window (s): one row for all of them, or as many rows as there are windows."""
    checked_tau = array(name, tau, ("k",) if np.ndim(tau) == 1 else ("v", "k"))
    fits = checked_tau.ndim == 1 or len(checked_tau) in (1, rows)
    require(fits, f"{name} must have one row, or one for each of the {rows} windows, got {len(checked_tau)}")
    return finite_array(name, checked_tau, checked_tau.shape)


def refuse_arrays(path: Any) -> None:
    """Raise ValueError for what cannot be evaluated: a path is a signal, and sampled positions are none."""
    if not (callable(path) and hasattr(type(path), "bound")):
        raise ValueError(f"path must be a signal (rangenav.signals), got {described(path)}")
