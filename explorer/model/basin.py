"""The basin of attraction of the attitude filter on the page: its inputs, its colours, and the slowest start.

A start is an initial attitude error: a rotation by one fixed angle about one of many axes (`rangenav.ensemble.basin`).
Each axis is a point on a sphere. The colour of a point is the settling time, after which the attitude error stays
below 5°.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float, UInt8
from msgspec.structs import replace
from numpy import ndarray as Array

from explorer.model import palette
from explorer.model.compute import Picture
from rangenav import attitude, record
from rangenav.ensemble import Basin
from rangenav.gains import Gains, Guess
from rangenav.preset import Preset
from rangenav.record import TruthInputs
from rangenav.sensors import Sensors


class Setup(NamedTuple):
    """Everything that decides how long a start takes to settle, except the start."""

    truth: TruthInputs
    sensors: Sensors
    seed: int
    gains: Gains
    guess: Guess
    """Without its attitude error, which each start replaces."""


def setup_of(preset: Preset) -> Setup:
    """The setup of a preset whose path has its time scale and printed initial values applied."""
    default = Guess()
    guess = replace(preset.guess, attitude_axis=default.attitude_axis, attitude_angle=default.attitude_angle)
    return Setup(record.truth_inputs(preset), preset.sensors, preset.seed, preset.gains, guess)


def slowest(basin: Basin) -> int:
    """The index of the start that settles last; of those that never settle, the one with the largest final error."""
    return int(np.lexsort((basin.final, basin.settle))[-1])


def settling_span(basin: Basin) -> tuple[float, float] | None:
    """The first and the last settling time (s); None if no start settles."""
    settled = basin.settle[np.isfinite(basin.settle)]
    return (float(settled.min()), float(settled.max())) if len(settled) else None


def colors(basin: Basin) -> UInt8[Array, "a 3"]:
    """A colour for each start; the lightest settles first."""
    span, share = settling_span(basin), np.zeros(len(basin.settle))
    if span is not None and span[1] > span[0]:
        share = (np.minimum(basin.settle, span[1]) - span[0]) / (span[1] - span[0])
    scale = on_scale(share)
    scale[~np.isfinite(basin.settle)] = palette.rgb(palette.NEVER_SETTLES)
    return scale


def on_scale(share: Float[Array, "a"]) -> UInt8[Array, "a 3"]:
    """Colours (sRGB) from the light end (0) to the dark one (1)."""
    stops = np.array([palette.rgb(color) for color in palette.SETTLING_SCALE], dtype=float)
    positions = np.linspace(0.0, 1.0, len(stops))
    channels = [np.interp(share, positions, channel) for channel in stops.T]
    return np.stack(channels, axis=1).round().astype(np.uint8)


def equilibria(picture: Picture) -> Float[Array, "3 3"]:
    """The axes u of the undesired equilibria R̃ = 2uuᵀ − I, a row for each, of the largest eigenvalue of M first."""
    _, vectors = np.linalg.eigh(attitude.decay_matrix(picture.preset.gains.attitude, picture.preset.world))
    return vectors.T[::-1]
