"""A change that would meet the requirements, in a clause: tones to add, or a slower flight."""

import math

import msgspec

from rangenav import continuity, provenance, signals
from rangenav.certificate import tone_search
from rangenav.certificate.figures import demanded, excess, figures, shortfall
from rangenav.certificate.tone_search import PHASE, Added, upwards
from rangenav.observability import blindness
from rangenav.observability.derivative_bounds import UnboundedDerivativeError
from rangenav.preset import Preset

SLOWEST = 16.0


def remedy(preset: Preset, at: float) -> str | None:
    """A clause on what would meet the requirements on samples, None if nothing does, as certificates of version 1 have
    it. at: start (s) of the least excited window.
    """
    if provenance.restriction(preset.source, preset.path) is not None:
        return provenance.ADOPT
    if continuity.discontinuity(preset.path, preset.duration) is not None:
        return continuity.JOIN
    try:
        reached = figures(preset)
    except UnboundedDerivativeError:
        return None
    if max(shortfall(reached, preset).values()) > 0:
        added = tone_search.smallest_tones(preset, at)
        return None if added is None else f"add {_described_by_version_1(added)}"
    factor = slower(preset)
    return None if factor is None else f"fly it {factor:g} times slower, if that leaves excitation enough"


def described(added: Added) -> str:
    """The tones as a clause. They are an example: no search shows that none smaller would do."""
    each = [f"{one} with phase {PHASE:g}" for one in _sizes(added)]
    return f"for example {'a tone' if len(each) == 1 else 'tones'} of " + " and ".join(each)


def _sizes(added: Added) -> list[str]:
    return [
        f"{added.amplitude:g} m at {w:g} rad/s along {blindness.name(n)}"
        for n, w in zip(added.directions, added.frequencies, strict=True)
    ]


def _described_by_version_1(added: Added) -> str:
    each = _sizes(added)
    return f"a tone of at least {each[0]}" if len(each) == 1 else "tones of at least " + " and ".join(each)


def slower(preset: Preset) -> float | None:
    """How many times slower a motion must be flown to keep its vehicle's limits; None if it keeps them, or never."""
    if max(excess(demanded(preset), preset.vehicle).values(), default=-math.inf) <= 0:
        return None  # what is missed is the accuracy, for which slower may be worse
    factor = 1.0
    while factor < SLOWEST:
        factor *= 1.05
        try:
            slowed = msgspec.structs.replace(preset, path=signals.slowed(preset.path, factor))
            broken = max(excess(demanded(slowed), preset.vehicle).values(), default=-math.inf) > 0
        except ValueError:
            return None
        if not broken:
            return upwards(factor)
    return None
