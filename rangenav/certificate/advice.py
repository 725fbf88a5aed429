"""What would help a preset that misses a requirement: one change, named only if its own certificate misses nothing.

A search by samples proposes the change (`tone_search`). A change that was not certified is not named; `rangenav repair`
searches more kinds of change, and for longer."""

from functools import lru_cache

import msgspec

from rangenav import continuity, provenance, signals
from rangenav import preset as presets
from rangenav.certificate import remedy, tone_search
from rangenav.certificate.certify import certify
from rangenav.certificate.schema import Certificate
from rangenav.observability.derivative_bounds import UnboundedDerivativeError
from rangenav.preset import Preset

CACHED = 8
SEARCH = "`rangenav repair` looks for a change that meets every requirement"
"""What is said where no change is known to meet them all."""


@lru_cache(maxsize=CACHED)
def change(preset: Preset) -> str | None:
    """A clause on a change with which every requirement is met, as its certificate says; None if none is known."""
    if provenance.restriction(preset.source, preset.path) is not None:
        return provenance.ADOPT
    if continuity.discontinuity(preset.path, preset.duration) is not None:
        return continuity.JOIN
    try:
        return _tones(preset, _certificate(preset)) or _slower(preset)
    except UnboundedDerivativeError:
        return None


def _tones(preset: Preset, issued: Certificate) -> str | None:
    if all(one.met for one in issued.checks if one.name in ("excitation", "rank", "accuracy")):
        return None  # what is missed is the vehicle's, which more motion does not help
    added = tone_search.smallest_tones(preset, issued.excitation.at)
    return f"add {remedy.described(added)}" if added is not None and _certificate(added.preset).meets else None


def _slower(preset: Preset) -> str | None:
    factor = remedy.slower(preset)
    if factor is None:
        return None
    slowed = msgspec.structs.replace(preset, path=signals.slowed(preset.path, factor))
    return f"fly it {factor:g} times slower" if _certificate(slowed).meets else None


def _certificate(preset: Preset) -> Certificate:
    return certify(presets.dumps(preset).encode(), source="preset")
