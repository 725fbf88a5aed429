"""What to try where no change was found: a longer window, or another place of the anchor, each with its figure."""

import numpy as np

from rangenav.certificate import cures, remedy, tone_search
from rangenav.certificate.figures import demanded
from rangenav.number_format import quantity
from rangenav.preset import Preset
from rangenav.repair.change import ChangeKind
from rangenav.repair.outcome import CannotRepairError, WayOut, certificate_of
from rangenav.vehicle import CRAZYFLIE

LONGER = (1.5, 2.0, 3.0)
"""Windows that are tried, as multiples of the preset's."""
TRIES = 60
"""Motions that are tried with each of them."""
TOO_NEAR, FAR = CRAZYFLIE.anchor_distance_min or 0.1, 10.0
"""m"""


def ways_out(preset: Preset, by: ChangeKind, reason: str, at: float) -> CannotRepairError:
    """The error with its reason and what to try; what "would do" was certified, and misses nothing.

    at: start (s) of the least excited window.
    """
    away = float(np.min(demanded(preset).anchor_distance))
    where = "away from the path" if away < TOO_NEAR else "closer"
    anchor = f"move the anchor {where}: it is {quantity(away, 'm')} away" if away < TOO_NEAR or away > FAR else ""
    window, tried = "", None
    if by == "tones":
        for factor in LONGER:
            longer = float(f"{factor * preset.requirement.window:.2g}")
            found = _with_window(preset, longer, at)
            if found is not None:
                tried, window = longer, f"with a window δ of {longer:g} s {remedy.described(found)} would do"
                break
    advice = f"try {anchor or 'a longer window, or move the anchor'}" + (f"; {window}" if window else "")
    ways: tuple[WayOut, ...] = ("anchor",) if anchor and tried is None else ("window", "anchor")
    return CannotRepairError(f"{reason}; {advice}", ways=ways, window=tried)


def _with_window(preset: Preset, window: float, at: float) -> tone_search.Added | None:
    """The tones with which another window (s) meets every requirement, as their certificate says; None if none do, or
    if the flight is too short for that window.
    """
    try:
        added = tone_search.smallest_tones(cures.with_window(preset, window), at, tries=iter(range(TRIES)))
        return added if added is not None and certificate_of(added.preset).meets else None
    except ValueError:
        return None
