"""What the ramps of a file ask of a vehicle: no certificate covers them, and a pilot wants to know.

On a ramp the vehicle follows the path in a time of its own, so that it accelerates along the path as well:
p̈ = p''σ'² + p'σ''. A longer ramp asks less.
"""

import numpy as np

from rangenav import motion, vehicle
from rangenav.axes import upright
from rangenav.formats import OutputFile, hover_ramps
from rangenav.preset import Preset
from rangenav.signals import Flown
from rangenav.vehicle import FREE

SAMPLES = 101
"""Of each ramp."""


def broken(preset: Preset, written: OutputFile) -> str | None:
    """Which limits of the preset's vehicle the ramps of a file break, one sentence; None if they keep them all."""
    if written.steady is None or written.steady[0] == 0 or preset.vehicle == FREE:
        return None
    turned, (ramp, end) = upright(preset), written.steady
    course = hover_ramps.HoverRamps(path=turned.path, duration=end, ramp=ramp)
    t = np.concatenate([np.linspace(0, ramp, SAMPLES), np.linspace(end, end + ramp, SAMPLES)])
    own = turned.angular_velocity if isinstance(turned.angular_velocity, Flown) else Flown()
    try:
        body = hover_ramps.attitude(course, own, turned.world.gravity, t)
    except ValueError as error:
        return f"on its ramps, which no certificate covers, {error}"
    jet = np.stack([course(t, order) for order in range(motion.SNAP + 1)])
    moved = motion.carried(jet, body, t, turned.world.gravity)
    breaks = vehicle.broken(moved, turned.vehicle, world=turned.world)
    if not breaks:
        return None
    reasons = "; ".join(one.summary for one in breaks)
    return f"its ramps of {ramp:g} s, which no certificate covers, are too much for {preset.vehicle.name}: {reasons}"
