"""What the page shows of a map: the map while it fills, the design on the page, and what is said of both."""

from dataclasses import dataclass

from explorer.model import study_axes
from explorer.model.settings import Settings
from explorer.model.study_judgement import judged, limits_of
from explorer.model.study_map import Axis, Place, index_of
from explorer.panels.studies import text
from explorer.panels.studies.choice import COMPUTE
from explorer.panels.studies.picture import Shown
from rangenav.studies.maps import StudyMap
from rangenav.studies.requirements import bound_of
from rangenav.studies.study import Study


@dataclass
class Filling:
    """One map while it is computed and afterwards. The job's thread assigns `map`, and the session's loop reads it."""

    study: Study
    place: Place
    metric: str
    map: StudyMap | None = None


def shown(
    filling: Filling, of: StudyMap, settings: Settings | None, metric: str, *, outdated: str, running: bool
) -> Shown:
    """What the picture shows. settings: those on the page. outdated: why the map is not of what is chosen now; empty if
    it is. running: whether it is still being computed."""
    axes = filling.place.axes
    (base,) = filling.study.bases
    names = study_axes.candidate(base, axes[0].path), study_axes.candidate(base, axes[1].path)
    values = None if settings is None else filling.place.values(settings)
    cross, bound = None if values is None else _cross(axes, values), bound_of(metric, base)
    said = text.sentence(
        of, names, metric, bound, judged(of, metric, bound, cross), values,
        inside=cross is not None, matched=base.gains.mode == "noise-matched",
    )  # fmt: skip
    if not running and of.share < 1:
        said = f"{_stopped(of, goes_on=not outdated)} {said}"
    return Shown(
        map=of,
        axes=axes,
        names=names,
        metric=metric,
        bound=bound,
        cross=cross,
        sentence=said,
        outdated=outdated,
        runs=filling.study.file.runs,
        limits=limits_of(base, axes),
        preset=filling.study.names[0].removesuffix(".toml"),
        windows=filling.study.file.windows_judged,
    )


def _stopped(of: StudyMap, *, goes_on: bool) -> str:
    """How much of a map is computed, and how it goes on."""
    kept = f"Stopped: {int(of.computed.sum())} of {of.computed.size} points are computed"
    return f"{kept}, and “{COMPUTE}” goes on from there." if goes_on else f"{kept}."


def _cross(axes: tuple[Axis, Axis], values: tuple[float, float]) -> tuple[float, float] | None:
    """The present design in indices; None outside the map."""
    x, y = (index_of(axis, value) for axis, value in zip(axes, values, strict=True))
    return None if x is None or y is None else (x, y)
