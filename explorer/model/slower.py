"""How many times slower a motion has to be flown, so that it keeps the limits of its vehicle.

The path stays as it is. A path that does not repeat then lasts longer, and so does its flight.
"""

import msgspec

from explorer.model.settings import Settings, effective
from rangenav import motion, record, vehicle
from rangenav.certificate.cures import SLOWER
from rangenav.motion import Motion
from rangenav.preset import MAX_DURATION, Preset
from rangenav.vehicle import CATALOGUE, FREE, THRUST_MARGIN

FACTORS = (*SLOWER, 4.0, 6.0)
MOST_THRUST = max(one.thrust_to_weight or 0.0 for one in CATALOGUE) / (1 + THRUST_MARGIN)
"""Times the weight: what the strongest vehicle of the catalogue may use."""


def factor(settings: Settings) -> float:
    """The least of the factors with which every limit is kept; 0 if none does."""
    for k in FACTORS:
        try:
            flown = effective(slowed(settings, k))
            if keeps_limits(record.motion_of(record.truth_inputs(flown)), flown):
                return k
        except ValueError:  # a speed below the least, or a flight that is too long for these rates
            continue
    return 0.0


def slowed(settings: Settings, k: float) -> Settings:
    """The same motion, so many times slower. Raises ValueError for a speed below the least."""
    preset = settings.preset
    longer = preset.duration * k if preset.path.period is None else preset.duration
    return msgspec.structs.replace(
        settings,
        time_scale=settings.time_scale * k,
        preset=msgspec.structs.replace(preset, duration=min(longer, MAX_DURATION)),
    )


def keeps_limits(moved: Motion, flown: Preset) -> bool:
    """Whether a motion keeps the limits of its vehicle; without one, the thrust of the strongest of the catalogue."""
    if flown.vehicle == FREE:
        return motion.limits(moved, world=flown.world).thrust_to_weight <= MOST_THRUST
    return not vehicle.broken(moved, flown.vehicle, world=flown.world)
