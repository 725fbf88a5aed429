"""Tones for a flight that is too long to be tried in hundreds of versions: three tones of a few sizes, each certified.

The tones go on where the path pauses. Their frequencies have the ratios of `tone_search`, and the first size whose
certificate misses nothing is taken."""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.certificate import tone_search
from rangenav.certificate.figures import figures
from rangenav.observability.derivative_bounds import UnboundedDerivativeError
from rangenav.preset import Preset
from rangenav.repair import tones
from rangenav.repair.change import Change, ChangeKind
from rangenav.repair.export_target import ExportTarget
from rangenav.repair.outcome import certificate_of
from rangenav.repair.search import Budget

SIZES = (0.25, 0.5, 1.0, 2.0, 4.0)
"""m, the amplitude of each of the three tones."""
PACES = 2
"""So many frequencies are tried with each size, the slowest first."""


def too_long(preset: Preset) -> str | None:
    """Why the path cannot be tried in hundreds of versions, one clause; None if it can."""
    try:
        figures(preset)
    except UnboundedDerivativeError as error:
        return f"the flight of {preset.duration:g} s is too long to be tried in hundreds of versions: {error}"
    return None


def way_out(by: ChangeKind) -> str:
    """What to do about a flight that is too long for a search."""
    if by == "tones":
        return (
            f"three added tones of {SIZES[0]:g} to {SIZES[-1]:g} m do not meet the requirement either, as their "
            "certificates say; try a shorter flight or a longer window"
        )
    return "shorten the flight, or repair it by tones, of which a few sizes are tried"


def certified_tones(
    preset: Preset, budget: Budget, *, target: ExportTarget | None
) -> tuple[Change, Float[Array, "n"]] | None:
    """The change and its θ with the smallest of the sizes that a certificate confirms; None if none is confirmed."""
    repeats = target is not None
    change, spread = tones.free_tones(preset, repeats=repeats), tone_search.WHOLE if repeats else tone_search.SPREAD
    for size in SIZES:
        for pace in tone_search.candidates(preset, repeats=repeats)[:PACES]:
            budget.spend()
            frequencies = pace * np.array(spread)
            theta = change.rounded(np.concatenate([size * frequencies**2, frequencies, np.zeros(3)]))
            changed = change.make(theta)
            if certificate_of(changed).meets and (target is None or target.refusal(changed) is None):
                return change, theta
    return None
