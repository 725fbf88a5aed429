"""The estimators of a study: a row for each, with its title, and how it runs on one record.

All estimators of a point run on the same records. A new estimator is one row of ESTIMATORS.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property

import msgspec

from rangenav import comparison, record
from rangenav.attitude import SCHEDULED
from rangenav.comparison import Candidate
from rangenav.gains import Gains
from rangenav.preset import Preset
from rangenav.record import Outcome, Record, Truth
from rangenav.sensors import Measurements


@dataclass(frozen=True)
class Flown:
    """One record of a preset, and the cascade's result on it, which several estimators share."""

    preset: Preset
    truth: Truth
    measurements: Measurements

    @cached_property
    def cascade(self) -> Outcome:
        """The cascade with the preset's gains."""
        return self.with_gains(self.preset.gains)

    def with_gains(self, gains: Gains) -> Outcome:
        """The cascade with other gains."""
        of = self.preset
        return record.observed(self.truth, self.measurements, of.world, of.sensors, gains, of.guess, "derived")

    @property
    def record(self) -> Record:
        """All of one run, as `comparison` takes it."""
        done = self.cascade
        return Record(
            preset=self.preset,
            truth=self.truth,
            measurements=self.measurements,
            estimate=done.estimate,
            errors=done.errors,
            summary=done.summary,
            form="derived",
        )


@dataclass(frozen=True, kw_only=True)
class Estimator:
    """One row of the table."""

    name: str
    title: str
    run: Callable[[Flown], Outcome]


def _scheduled(flown: Flown) -> Outcome:
    gains = flown.preset.gains
    attitude = msgspec.structs.replace(SCHEDULED, rho1=gains.attitude.rho1, rho2=gains.attitude.rho2)
    return flown.with_gains(msgspec.structs.replace(gains, attitude=attitude))


def _matched(flown: Flown) -> Outcome:
    return flown.with_gains(msgspec.structs.replace(flown.preset.gains, mode="noise-matched"))


def _outcome(candidate: Candidate) -> Outcome:
    return Outcome(estimate=candidate.estimate, errors=candidate.errors, summary=candidate.summary)


ROWS = (
    Estimator(name="cascade", title="the cascade with the preset's gains", run=lambda flown: flown.cascade),
    Estimator(name="schedule", title="the cascade with a schedule of k1", run=_scheduled),
    Estimator(name="noise-matched", title="the cascade with noise-matched gains", run=_matched),
    Estimator(
        name="ekf",
        title="extended Kalman filter, the cascade's start",
        run=lambda flown: _outcome(comparison.filtered(flown.record)),
    ),
    Estimator(
        name="refinement",
        title="refinement of the whole record",
        run=lambda flown: _outcome(comparison.refined(flown.record)),
    ),
)
ESTIMATORS: Mapping[str, Estimator] = {row.name: row for row in ROWS}
"""Every estimator by its name."""
