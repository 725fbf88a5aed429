"""What the shown run is compared with: a pinned run, other estimators on the same record, the band of many seeds.

    pinned      a whole Picture of other settings (A)
    baselines   the extended Kalman filter and the iterated smoother ("refined"), on the record of the shown run
    seeds       the same settings with other noise
    basin       the same settings started from attitude errors about many axes
    proposed    a motion that a repair has found, until it is accepted or discarded
A pinned run stays until it is unpinned. All other results belong to the inputs of one run (`inputs_of`,
`basin.setup_of`), and are drawn only while the page shows that run.
"""

from dataclasses import dataclass
from typing import Literal, NamedTuple

from explorer.model.compute import Picture
from rangenav import comparison, record
from rangenav.comparison import Candidate
from rangenav.ensemble import Basin, Ensemble
from rangenav.gains import Gains, Guess
from rangenav.model import ModelForm
from rangenav.preset import Preset
from rangenav.record import Record, TruthInputs
from rangenav.sensors import Sensors

Name = Literal["EKF", "refined"]
NAMES: tuple[Name, ...] = ("EKF", "refined")
"""In the order in which they are drawn and listed."""


class RunInputs(NamedTuple):
    """Everything that decides the estimates of one run: the truth, the noise, and the observer."""

    truth: TruthInputs
    sensors: Sensors
    seed: int
    gains: Gains
    guess: Guess
    form: ModelForm


class Baseline(NamedTuple):
    """Another estimator on the record of the shown run."""

    name: Name
    candidate: Candidate | None
    """None while it is being computed."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Comparison:
    """Everything that the shown run is compared with; each part may be missing."""

    pinned: Picture | None = None
    baselines: tuple[Baseline, ...] = ()
    seeds: Ensemble | None = None
    basin: Basin | None = None
    proposed: Preset | None = None


NOTHING = Comparison()


def inputs_of(picture: Picture) -> RunInputs:
    """The inputs of the run that a picture shows."""
    p = picture.preset
    return RunInputs(record.truth_inputs(p), p.sensors, p.seed, p.gains, p.guess, form_of(picture))


def form_of(picture: Picture) -> ModelForm:
    """The model that the picture's observer uses."""
    return "printed" if picture.settings.printed.model else "derived"


def run_baseline(name: Name, picture: Picture) -> Candidate:
    """Run another estimator on the record of a picture. For 20 s at 200 Hz the EKF takes 20 ms, the refinement 200 ms.

    Raises ValueError if the record has no ranges, or is too long for a covariance of each sample.
    """
    run = Record(
        preset=picture.preset,
        truth=record.simulated(record.truth_inputs(picture.preset)),
        measurements=picture.measurements,
        estimate=picture.estimate,
        errors=picture.errors,
        summary=picture.summary,
        form=form_of(picture),
    )
    return comparison.filtered(run) if name == "EKF" else comparison.refined(run)
