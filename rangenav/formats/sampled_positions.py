"""The path of a file that holds positions and no derivatives: a curve near them, whose excitation is not judged."""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.formats import spline_fit
from rangenav.formats.import_result import ImportResult, Question
from rangenav.formats.recorded_flight import Frame
from rangenav.formats.sampled_rows import SampledRows
from rangenav.inputs import require


def imported(
    rows: SampledRows,
    position: Float[Array, "n 3"],
    *,
    format: str,
    largest: float,
    frame: Frame,
    knots: float | None,
    findings: list[str],
    questions: tuple[Question, ...] = (),
) -> ImportResult:
    """What was read: the curve through the rows, or the questions without whose answers there is none.

    position: m, of the rows that are used. largest: no position of the format lies farther out (m).
    """
    source = rows.table.source
    rule = f"{source}: positions must lie within {largest:g} m"
    require(float(np.abs(position).max()) <= largest, rule)
    curve = spline_fit.fit(rows.time, position, spacing=knots, source=source) if rows.fits else None
    return ImportResult(
        source=source,
        format=format,
        rows=len(rows.time),
        rate=rows.rate,
        duration=float(rows.time[-1]),
        frame=frame,
        findings=(*findings, *(() if curve is None else (curve.summary,))),
        questions=(*rows.questions, *questions),
        path=None if curve is None else curve.path,
        derivatives="fit",
        fitted="" if curve is None else curve.summary,
        fit_error=None if curve is None else curve.largest,
        unjudged=spline_fit.unjudged(rows.time, position),
    )
