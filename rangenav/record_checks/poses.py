"""Poses that a tracker has lost: it writes 0 0 0 where it does not see the body."""

import numpy as np
from jaxtyping import Bool
from numpy import ndarray as Array

from rangenav.formats.import_result import lines
from rangenav.formats.recorded_flight import Flight
from rangenav.record_checks.check import Evidence

JUMP, JUMPS = 0.5, 20.0
"""m, and usual steps, by which a position that is lost jumps to 0 0 0."""
GONE = 0.5
"""Largest share of poses that are lost; a file with more of them rests at its origin."""


def lost(flight: Flight) -> Bool[Array, "n"]:
    """Samples whose position jumps to 0 0 0 and back."""
    none = np.zeros(len(flight.time), dtype=bool)
    if flight.position is None:
        return none
    zero = np.asarray((flight.position == 0).all(axis=-1))
    known = np.flatnonzero(np.isfinite(flight.position).all(axis=-1) & ~zero)
    if not zero.any() or zero.mean() > GONE or len(known) < 2:
        return none
    usual = float(np.quantile(np.linalg.norm(np.diff(flight.position[known], axis=0), axis=-1), 0.9))
    at = np.flatnonzero(zero)
    after = np.clip(np.searchsorted(known, at), 0, len(known) - 1)
    before = np.clip(np.searchsorted(known, at) - 1, 0, len(known) - 1)
    distance = np.minimum(
        np.linalg.norm(flight.position[known[after]], axis=-1), np.linalg.norm(flight.position[known[before]], axis=-1)
    )
    none[at] = distance > max(JUMP, JUMPS * usual)
    return none


def lost_poses(flight: Flight) -> Evidence | None:
    """Positions that are 0 0 0 far from their neighbours: a tracker writes them where it has lost the body."""
    rows = lost(flight)
    if not rows.any():
        return None
    where = "" if flight.lines is None else f", on {lines(flight.lines[rows], counted=True)}"
    text = f"{int(rows.sum())} of {len(rows)} positions are 0 0 0 and far from their neighbours{where}"
    return Evidence(text=text, suggestion="drop")
