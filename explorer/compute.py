"""settings -> Picture, in stages cached by their own inputs: a gain slider never recomputes a Gramian. No viser here.

    motion        <- path, angular velocity, world, duration, rate
    gramian       <- path, gravity, window            (not attitude, not gains, not the anchor)
    accuracy      <- gramian's inputs, anchor, sensors
    printed       <- path, angular velocity, world, window
    measurements  <- motion's inputs, sensors, seed
    estimate      <- measurements' inputs, gains, guess
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from explorer.settings import Settings
from rangenav import cascade, motion
from rangenav.analysis import Analysis
from rangenav.preset import Preset
from rangenav.record import Summary
from rangenav.sensors import Measurements


@dataclass(frozen=True, eq=False, kw_only=True)
class Picture:
    """Everything the page draws, all of it belonging to the same settings."""

    settings: Settings
    preset: Preset
    """The preset as computed: time scale and printed initial values applied."""
    motion: motion.Motion
    limits: motion.Limits
    phi: Float[Array, "n 3"]
    """Rᵀp⁗ (m/s⁴), body axes."""
    phi_printed: Float[Array, "n 3"]
    """The printed φ, body axes."""
    analysis: Analysis
    """Spectra over sliding windows, worst windows, blind directions, predicted accuracy, verdict (derived forms)."""
    printed_excitation: Float[Array, "w 3"]
    """Eigenvalues of the excitation under the printed switches that are on, at analysis.windows.start."""
    measurements: Measurements
    estimate: cascade.Estimate
    errors: cascade.Errors
    position_estimate: Float[Array, "n 3"]
    """p̂_I (m, inertial)."""
    summary: Summary
    """Peak, settling and steady errors, in numbers; and whether the covariance diverged."""
    attitude_time_constants: Float[Array, "3"]
    """s, slowest first; under the printed switch twice as long."""
