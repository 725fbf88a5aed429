"""What stands beside the run on view: a pinned one (A), other estimators on the same record, the band of many seeds.

    A        a whole Picture, of other settings
    rivals   the extended Kalman filter, and the refinement of the whole record, on the run's own record
    seeds    the same settings under other noise
    basin    the same settings started from attitude errors all around
All but A belong to one run: `run_of` and `attraction.setup_of` tell which, and what belongs to another is not drawn.
No viser here.
"""

from dataclasses import dataclass
from typing import Literal, NamedTuple

from explorer.model.compute import Picture
from rangenav import comparison, record
from rangenav.comparison import Candidate
from rangenav.ensemble import Basin, Ensemble
from rangenav.gains import Gains, Guess
from rangenav.model import ModelForm
from rangenav.record import Record, TruthInputs
from rangenav.sensors import Sensors

Name = Literal["EKF", "refined"]
NAMES: tuple[Name, ...] = ("EKF", "refined")
"""In the order in which they are drawn and told."""


class RunInputs(NamedTuple):
    """Everything that decides what the observers make of a record, its noise included."""

    course: TruthInputs
    sensors: Sensors
    seed: int
    gains: Gains
    guess: Guess
    form: ModelForm


class Baseline(NamedTuple):
    """Another estimator on the record of the run on view."""

    name: Name
    candidate: Candidate | None
    """None while it is still at work."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Comparison:
    """All of it; each part may be missing."""

    pinned: Picture | None = None
    baselines: tuple[Baseline, ...] = ()
    seeds: Ensemble | None = None
    basin: Basin | None = None


NOTHING = Comparison()


def run_of(picture: Picture) -> RunInputs:
    """Which run a picture shows."""
    p = picture.preset
    return RunInputs(record.course_of(p), p.sensors, p.seed, p.gains, p.guess, form_of(picture))


def form_of(picture: Picture) -> ModelForm:
    """Which model its observer follows."""
    return "printed" if picture.settings.printed.model else "derived"


def run_baseline(name: Name, picture: Picture) -> Candidate:
    """Run another estimator on the record of a picture: the EKF takes 20 ms for 20 s at 200 Hz, the refinement 200.

    Raises ValueError if the record has no ranges, or is too long for a covariance of each sample.
    """
    of = Record(
        preset=picture.preset,
        truth=record.simulated(record.course_of(picture.preset)),
        measurements=picture.measurements,
        estimate=picture.estimate,
        errors=picture.errors,
        summary=picture.summary,
        form=form_of(picture),
    )
    return comparison.filtered(of) if name == "EKF" else comparison.refined(of)
