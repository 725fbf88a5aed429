"""The position of the antenna, p + R r for a lever arm r (m, body axes), and its true range at any time.

From the last IMU sample on, R turns by one Magnus step of order 4 over the cubic through ω and ω̇ at both ends of the
interval: exact on a sample, of fifth order in the step between. A body that turns by 3.6 rad/s and by 10 rad/s² is
1.5e-9 rad off at 50 Hz, far less than its R itself (7e-8); the geodesic between the samples would be off by 5e-4.
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav import so3
from rangenav.inputs import Vec3
from rangenav.motion import GAUSS_OFFSET, Motion, World
from rangenav.signals import Signal

AT_THE_IMU: Vec3 = (0.0, 0.0, 0.0)
AT_ONCE = 16_384
"""Ranges whose rotations are computed together: they fit a cache, and two million at once would take 1.6 GB."""


def distance(
    motion: Motion, time: Float[Array, "m"], *, path: Signal, world: World, lever_arm: Vec3
) -> Float[Array, "m"]:
    """|p + R r − p_anchor| (m) at times (s) within the motion: the true range of an antenna at r."""
    place = path(time)
    if lever_arm != AT_THE_IMU:
        place = place.copy()
        for first in range(0, len(time), AT_ONCE):
            part = slice(first, first + AT_ONCE)
            place[part] += rotation(motion, time[part]) @ np.asarray(lever_arm, dtype=float)
    return np.linalg.norm(place - np.asarray(world.anchor), axis=-1)


def rotation(motion: Motion, time: Float[Array, "m"]) -> Float[Array, "m 3 3"]:
    """R at times (s) from the first sample of a motion to its last."""
    stamps = motion.time
    k = np.clip(np.searchsorted(stamps, time, side="right") - 1, 0, len(stamps) - 1)
    after = np.minimum(k + 1, len(stamps) - 1)
    step = np.where(after > k, stamps[after] - stamps[k], 1.0)[:, None]  # nothing follows the last one, where s is 0
    s = (time - stamps[k])[:, None]
    ends = (motion.angular_velocity[k], motion.angular_velocity[after])
    slopes = (motion.angular_acceleration[k] * step, motion.angular_acceleration[after] * step)
    first, second = (_cubic(ends, slopes, gauss * s / step) for gauss in (0.5 - GAUSS_OFFSET, 0.5 + GAUSS_OFFSET))
    turn = s / 2 * (first + second) + np.sqrt(3) / 12 * s**2 * np.cross(first, second)
    return motion.rotation[k] @ so3.exp(turn)


def _cubic(ends: tuple[Array, Array], slopes: tuple[Array, Array], u: Array) -> Array:
    """Hermite's cubic at the fraction u of an interval; slopes per interval."""
    rise = ends[1] - ends[0]
    bend = slopes[0] + slopes[1] - 2 * rise
    return ends[0] + u * (slopes[0] + u * (rise - slopes[0] - bend + u * bend))
