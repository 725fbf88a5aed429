"""The estimators of a study: a row for each, with its title, and how it runs on some records.

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
    """Some records of a preset, and the cascade's results on them, which several estimators share."""

    preset: Preset
    truth: Truth
    measurements: list[Measurements]

    @cached_property
    def cascade(self) -> list[Outcome]:
        """The cascade with the preset's gains."""
        return self.with_gains(self.preset.gains)

    def with_gains(self, gains: Gains) -> list[Outcome]:
        """The cascade with other gains."""
        of, records = self.preset, self.measurements
        every = [gains] * len(records)
        return record.observed_each(self.truth, records, of.world, of.sensors, every, of.guess, "derived")

    @property
    def records(self) -> list[Record]:
        """All of each run, as `comparison` takes it."""
        return [
            Record(
                preset=self.preset,
                truth=self.truth,
                measurements=measurements,
                estimate=done.estimate,
                errors=done.errors,
                summary=done.summary,
                form="derived",
            )
            for measurements, done in zip(self.measurements, self.cascade, strict=True)
        ]


@dataclass(frozen=True, kw_only=True)
class Estimator:
    """One row of the table."""

    name: str
    title: str
    run: Callable[[Flown], list[Outcome]]
    """The results on each record."""


def _scheduled(flown: Flown) -> list[Outcome]:
    gains = flown.preset.gains
    attitude = msgspec.structs.replace(SCHEDULED, rho1=gains.attitude.rho1, rho2=gains.attitude.rho2)
    return flown.with_gains(msgspec.structs.replace(gains, attitude=attitude))


def _matched(flown: Flown) -> list[Outcome]:
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
        run=lambda flown: [_outcome(comparison.filtered(one)) for one in flown.records],
    ),
    Estimator(
        name="refinement",
        title="refinement of the whole record",
        run=lambda flown: [_outcome(comparison.refined(one)) for one in flown.records],
    ),
)
ESTIMATORS: Mapping[str, Estimator] = {row.name: row for row in ROWS}
"""Every estimator by its name."""
