"""settings -> Picture, in stages cached by their own inputs: a gain slider never recomputes a Gramian.

motion        <- path, angular velocity, world, duration, rate
breaks        <- motion's inputs, vehicle
gramian       <- path, gravity, window            (not attitude, not gains, not the anchor)
accuracy      <- gramian's inputs, anchor, sensors
printed       <- path, angular velocity, world, window; computed at its first use
measurements  <- motion's inputs, sensors, seed
estimate      <- measurements' inputs, gains, guess
details       <- see `details`; computed at its first use
convergence   <- estimate's inputs; computed at its first use
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from weakref import WeakValueDictionary

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from explorer.model import convergence, details, slower
from explorer.model.convergence import Convergence
from explorer.model.details import Details
from explorer.model.settings import Printed, Settings, effective
from rangenav import attitude, cascade, motion, record, vehicle
from rangenav.analysis import Analysis, analyse, sampled
from rangenav.errors import Errors
from rangenav.gains import Gains, Guess
from rangenav.model import ModelForm
from rangenav.motion import Limits, Motion
from rangenav.motion_analysis import WINDOWS
from rangenav.observability import excitation, reduced
from rangenav.preset import Preset
from rangenav.progress import Cancelled, CancelledError, never, stopping
from rangenav.proof import arguments
from rangenav.record import Outcome, Summary, TruthInputs, truth_inputs
from rangenav.sensors import Measurements, Sensors
from rangenav.vehicle import Break, Vehicle

MOVING_WINDOWS = 34
"""Windows that are judged while a hand moves: a third of those at rest, so that a path is judged twice as fast."""
CACHED = 4
"""How many results of each stage its cache holds."""
AT_REST: WeakValueDictionary[tuple[object, ...], Analysis] = WeakValueDictionary()
"""The analyses of pictures at rest: a gain that moves keeps all their windows, and the plots of them stay."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Picture:
    """Everything the page draws, all of it belonging to the same settings."""

    settings: Settings
    preset: Preset
    """The preset as computed: time scale and printed initial values applied."""
    motion: Motion
    limits: Limits
    breaks: tuple[Break, ...]
    """The vehicle limits that the motion exceeds, first the one that it exceeds for longest."""
    analysis: Analysis
    """Spectra over sliding windows, the worst of them, blind directions, accuracy and verdict (derived forms).

    It is that of few windows while a hand moves, that of more windows in `at_rest`; `proven` puts the worst of all
    windows in place of the worst sampled ones."""
    measurements: Measurements
    estimate: cascade.Estimate
    errors: Errors
    position_estimate: Float[Array, "n 3"]
    """p̂_I (m, inertial)."""
    summary: Summary
    """Peak, settling time and steady value of each error, and whether the covariance diverged."""
    attitude_time_constants: Float[Array, "3"]
    """s, slowest first; under the printed switch twice as long."""
    slower: float | None = None
    """How many times slower the motion keeps every limit; 0 if at no speed that was tried; None until `proven`."""

    @cached_property
    def phi(self) -> Float[Array, "n 3"]:
        """Rᵀp⁗ (m/s⁴), body axes. Computed at its first use, as all that few plots show."""
        return _phi(truth_inputs(self.preset))[0]

    @cached_property
    def phi_printed(self) -> Float[Array, "n 3"]:
        """The printed φ, body axes."""
        return _phi(truth_inputs(self.preset))[1]

    @cached_property
    def printed_excitation(self) -> Float[Array, "w 3"]:
        """Eigenvalues of the excitation under the printed switches that are on, at analysis.windows.start."""
        window, count = self.preset.requirement.window, len(self.analysis.windows.start)
        return _printed_excitation(truth_inputs(self.preset), window, self.settings.printed, count)

    @cached_property
    def reduced_min(self) -> float:
        """Least eigenvalue of the reduced pair (Proposition 1) under the printed switches that are on."""
        return _reduced(truth_inputs(self.preset), self.preset.requirement.window, self.analysis, self.settings.printed)

    @property
    def at_rest(self) -> "Picture":
        """The same picture with as many windows as its curves need to be smooth, for when no hand moves."""
        rests = len(self.analysis.windows.start) == WINDOWS
        return self if rests else self._at_rest  # not cached where it is this one: a picture would hold itself

    @cached_property
    def _at_rest(self) -> "Picture":
        resting = self.judged_on(WINDOWS)
        AT_REST[_judged_inputs(self.preset)] = resting.analysis
        return resting

    def judged_on(self, windows: int) -> "Picture":
        """The same picture with so many windows, so that its figures can be compared with another picture's."""
        if len(self.analysis.windows.start) == windows:
            return self
        return replace(self, analysis=sampled(self.preset, windows))

    @cached_property
    def details(self) -> Details:
        """The reasons for the verdict. This stage is computed at its first use: it takes as long as all the others
        together, and the page draws it when nothing has changed for a moment."""
        return details.details(self.preset, turn=self.settings.twin_turn)

    @cached_property
    def convergence(self) -> Convergence | None:
        """How fast the error fades by motion and gains alone; None with noise-matched gains."""
        return convergence.convergence(self.preset)

    def proven(self, cancelled: Cancelled = never) -> "Picture":
        """The same picture with the worst of all windows, and the speed that keeps the limits. It takes a tenth of a
        second to some seconds, for which the page has a job. Raises CancelledError soon after `cancelled` says that
        another picture is shown."""
        if cancelled():
            raise CancelledError
        with stopping(cancelled):
            kept = slower.keeps_limits(self.motion, self.preset)
            return replace(
                self, analysis=analyse(self.preset, compiled=True), slower=1.0 if kept else slower.factor(self.settings)
            )


def compute(settings: Settings) -> Picture:
    """Compute everything the page draws. Raises ValueError with one sentence if no picture is possible."""
    p, printed = effective(settings), settings.printed
    inputs, analysis = truth_inputs(p), AT_REST.get(_judged_inputs(p)) or sampled(p, MOVING_WINDOWS)
    outcome, position = _observed(
        inputs, p.sensors, p.seed, p.gains, p.guess, "printed" if printed.model else "derived"
    )
    return Picture(
        settings=settings,
        preset=p,
        motion=record.simulated(inputs).motion,
        limits=_limits(inputs),
        breaks=_breaks(inputs, p.vehicle),
        analysis=analysis,
        measurements=record.measured(inputs, p.sensors, p.seed),
        estimate=outcome.estimate,
        errors=outcome.errors,
        position_estimate=position,
        summary=outcome.summary,
        attitude_time_constants=attitude.time_constants(
            p.gains.attitude, p.world, "printed" if printed.attitude_rate else "derived"
        ),
    )


def _judged_inputs(p: Preset) -> tuple[object, ...]:
    """All that the analysis of a preset depends on."""
    return *arguments(p), p.source


def compile_kernels(progress: Callable[[float, str], None]) -> None:
    """Compile the kernels: seconds the first time, later they are read from the disk. progress(fraction, stage)."""
    from rangenav.kernels import precompile

    precompile.compile_all(progress)


def compile_estimators() -> None:
    """Compile the estimators of the Compare tab, which no picture needs."""
    from rangenav.kernels import precompile

    precompile.compile_estimators(lambda _fraction, _what: None)


@lru_cache(maxsize=CACHED)
def _phi(inputs: TruthInputs) -> tuple[Array, Array]:
    trajectory = record.simulated(inputs).motion
    return excitation.phi(trajectory), excitation.phi_printed(trajectory)


@lru_cache(maxsize=CACHED)
def _limits(inputs: TruthInputs) -> Limits:
    return motion.limits(record.simulated(inputs).motion, world=inputs.world)


@lru_cache(maxsize=CACHED)
def _breaks(inputs: TruthInputs, chosen: Vehicle) -> tuple[Break, ...]:
    return vehicle.broken(record.simulated(inputs).motion, chosen, world=inputs.world)


@lru_cache(maxsize=CACHED)
def _printed_excitation(inputs: TruthInputs, window: float, printed: Printed, count: int) -> Array:
    """Eigenvalues of the excitation of so many windows under the printed switches, from samples; with none on, of the
    derived form."""
    trajectory = record.simulated(inputs).motion
    signal = excitation.chosen_signal(trajectory, printed_formula=printed.excitation, body_axes=printed.body_axes)
    start = np.linspace(0, inputs.duration - window, count)
    return excitation.sampled_eigenvalues(signal, trajectory.time, start, window)


@lru_cache(maxsize=CACHED)
def _observed(
    inputs: TruthInputs, sensors: Sensors, seed: int, gains: Gains, guess: Guess, form: ModelForm
) -> tuple[Outcome, Array]:
    """The estimate, and the estimated position in inertial axes (m)."""
    truth, z = record.simulated(inputs), record.measured(inputs, sensors, seed)
    outcome = record.observed(truth, z, inputs.world, sensors, gains, guess, form)
    return outcome, outcome.estimate.position(inputs.world)


def _reduced(inputs: TruthInputs, window: float, analysis: Analysis, printed: Printed) -> float:
    if not (printed.excitation or printed.reduced_row or printed.body_axes):
        return analysis.reduced_min
    return reduced.sampled_least_eigenvalue(
        record.simulated(inputs).motion,
        analysis.gramian_at,
        window,
        printed_formula=printed.excitation,
        printed_row=printed.reduced_row,
        body_axes=printed.body_axes,
    )
