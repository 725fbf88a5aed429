"""The reasons for the verdict, a stage of a picture: preset -> Details, in parts cached by their own inputs.

horizon    <- path, world, duration, range noise and rate, required σ
functions  <- path, gravity, the worst window
twin       <- path, world, duration, range rate, turn
printed    <- path, angular velocity, world, window, μ

Together they take 20 to 50 ms when the path changes, and nothing when a gain changes. `Picture.details` is this stage.
"""

import threading
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from rangenav import record, twin
from rangenav.analysis import how_long, sampled
from rangenav.inputs import Vec3
from rangenav.motion_analysis import WINDOWS
from rangenav.observability import ellipsoid, frozen, functions, printed
from rangenav.observability.ellipsoid import Ellipsoid
from rangenav.observability.functions import Functions
from rangenav.observability.horizon import Horizon
from rangenav.observability.printed import PrintedAndDerived
from rangenav.observability.spectrum import Spectrum
from rangenav.preset import Preset
from rangenav.record import TruthInputs
from rangenav.signals import Signal
from rangenav.twin import Refusal, Twin

CACHED = 4
ELLIPSOIDS = 256
"""Cached ellipsoids: more than the windows of one path."""
LOADED = threading.Event()
"""Set when python-control has been imported, which takes a second."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Details:
    """The reasons for the verdict on one preset."""

    spectrum: Spectrum
    """Over sliding windows, the same as in the analysis."""
    horizon: Horizon
    """Windows of growing length, from the start of the flight and around the worst window."""
    functions: Functions
    """The 13 functions on the window of least rank."""
    twin: Twin | Refusal
    printed: PrintedAndDerived


def details(preset: Preset, *, turn: Vec3 | None = None) -> Details:
    """The details of a preset; `turn` (rad, about the anchor) turns a twin that may be turned."""
    analysis, requirement = sampled(preset), preset.requirement
    return Details(
        spectrum=analysis.windows.lifted.spectrum,
        horizon=how_long(preset),
        functions=_functions(
            preset.path, preset.world.gravity, analysis.gramian_at, requirement.window, preset.duration
        ),
        twin=twin.twin(preset, turn=turn),
        printed=_printed(
            record.truth_inputs(preset),
            requirement.window,
            analysis.mu,
            analysis.mu_floor,
            requirement.mu,
            analysis.known_rank,
        ),
    )


def excitation_at(preset: Preset, time: float) -> Ellipsoid:
    """The excitation ellipsoid of the computed window that starts nearest to a time (s)."""
    window = preset.requirement.window
    last = preset.duration - window
    k = round(min(max(time / last, 0.0), 1.0) * (WINDOWS - 1))
    return _ellipsoid(preset.path, last * k / (WINDOWS - 1), window)


def import_control() -> None:
    """Import python-control, which the frozen-time test needs; call it in a thread, after the first picture."""
    import control  # noqa: F401

    LOADED.set()


def frozen_summary(preset: Preset) -> str:
    """Frozen-time ranks at the start of the window of least rank, and its own rank; empty until `import_control`."""
    if not LOADED.is_set():
        return ""
    analysis = sampled(preset)
    return _frozen(record.truth_inputs(preset), analysis.gramian_at, analysis.known_rank)


@lru_cache(maxsize=CACHED)
def _functions(path: Signal, gravity: Vec3, start: float, window: float, until: float) -> Functions:
    return functions.functions(path, gravity, start, window, until=until)


@lru_cache(maxsize=CACHED)
def _printed(
    inputs: TruthInputs, window: float, mu: float, floor: float, required: float, rank: int
) -> PrintedAndDerived:
    start = np.linspace(0, inputs.duration - window, WINDOWS)
    trajectory = record.simulated(inputs).motion
    return printed.compare(trajectory, start, window, mu=mu, floor=floor, required=required, rank=rank)


@lru_cache(maxsize=CACHED)
def _frozen(inputs: TruthInputs, start: float, rank: int) -> str:
    return frozen.frozen(record.simulated(inputs).motion, start, windowed=rank).summary


@lru_cache(maxsize=ELLIPSOIDS)
def _ellipsoid(path: Signal, start: float, window: float) -> Ellipsoid:
    return ellipsoid.ellipsoid(path, start, window)
