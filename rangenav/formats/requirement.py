"""Does a preset deliver what it asks of its motion? The plain check before an export: μ on every window, and rank."""

from rangenav.analysis import analyse
from rangenav.model import STATES
from rangenav.preset import Preset


def unmet(preset: Preset) -> str | None:
    """Why the preset misses its requirement, None if it does not. One expected unobservable must be it."""
    found, asked = analyse(preset), preset.requirement
    if preset.expect == "unobservable":
        seen = f"it is expected unobservable, yet every window of {asked.window:g} s has rank {found.rank}"
        return seen if found.rank == STATES else None
    if found.rank < STATES:
        return (
            f"blind: rank {found.rank} of {STATES} on the window of {asked.window:g} s at t = {found.gramian_at:.3g} s"
        )
    if found.mu < asked.mu:
        at = f"on the window of {asked.window:g} s at t = {found.mu_at:.3g} s"
        return f"its excitation is {found.mu:.3g} m²/s⁷ {at}, less than the required {asked.mu:.3g}"
    return None
