"""The numbers that a handout holds: the motion, the estimate, the plots and the verdict of each picture.

Times are thinned, and numbers keep four digits: a file with two sliders stays below a megabyte without its library.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy import ndarray as Array

from explorer.charts import curves
from explorer.charts.plot_list import GROUPS
from explorer.charts.plots import Plot
from explorer.model import assessment
from explorer.model.compute import Picture
from rangenav import so3

MOMENTS, BUCKETS, DIGITS = 241, 100, 4
PLOTS = ("position", "attitude", "excitation", "predicted")
"""The plots of a handout whose lesson names none."""


def plots(names: Sequence[str]) -> tuple[Plot, ...]:
    """The plots by name or title; those that do not exist are left out, and without any the usual ones are taken."""
    every = [plot for group in GROUPS for plot in group.plots if not group.slow]
    chosen = tuple(plot for plot in every if plot.name in names or plot.title in names)
    return chosen or tuple(plot for plot in every if plot.name in PLOTS)


def style(plot: Plot) -> dict[str, Any]:
    """What is the same in all pictures of one plot."""
    return {
        "title": plot.title,
        "unit": plot.unit,
        "log": plot.log,
        "x": plot.x_name,
        "along": plot.along_flight,
        "curves": [
            {
                "label": c.label or c.name,
                "legend": bool(c.label),
                "color": c.color,
                "dash": list(c.dash),
                "width": c.width,
            }
            for c in plot.curves
        ],
        "equation": plot.definition.equation,
        "meaning": plot.definition.meaning,
    }


def variant(picture: Picture, shown: Sequence[Plot], base: Picture | None = None) -> dict[str, Any]:
    """One picture. What is the same as in the picture `base` is left out: the motion, if only a gain differs."""
    same_motion = base is not None and picture.motion is base.motion
    at = np.unique(np.linspace(0, len(picture.motion.time) - 1, MOMENTS).round().astype(int))
    content: dict[str, Any] = {
        "verdict": _verdict(picture),
        "plots": [_drawing(plot, picture) for plot in shown],
        "estimate": _columns(picture.position_estimate[at]),
        "estimated_attitude": _columns(so3.log(picture.estimate.rotation[at])),
        "error": _numbers(picture.errors.position[at]),
    }
    if not same_motion:
        content |= {
            "time": _numbers(picture.motion.time[at]),
            "truth": _columns(picture.motion.position[at]),
            "attitude": _columns(so3.log(picture.motion.rotation[at])),
            "anchor": _numbers(np.asarray(picture.preset.world.anchor)),
            "gravity": _numbers(np.asarray(picture.preset.world.gravity)),
        }
    return content


def _verdict(picture: Picture) -> dict[str, Any]:
    given = assessment.answers(picture)
    sign, color = assessment.SIGNS[assessment.level(given)]
    answers = [(assessment.SIGNS[one.level][0], assessment.QUESTIONS[one.question], one) for one in given]
    return {
        "sign": sign,
        "color": color,
        "word": picture.analysis.verdict.word,
        "summary": assessment.decisive(given).summary,
        "subject": assessment.subject_of(picture),
        "answers": [[mark, question, one.summary, *one.remarks] for mark, question, one in answers],
    }


def _drawing(plot: Plot, picture: Picture) -> dict[str, Any]:
    drawing = plot.draw(picture)
    time, values = curves.decimate(drawing.time, drawing.drawn, BUCKETS)
    shown = [i for i in range(values.shape[1]) if i not in drawing.hidden]
    return {
        "t": _numbers(time),
        "y": {str(i): _numbers(values[:, i]) for i in shown},
        "axis": _numbers(np.asarray(drawing.axis)),
        "empty": plot.reason_if_empty(drawing),
    }


def _columns(values: Array) -> list[list[float | None]]:
    return [_numbers(column) for column in values.T]


def _numbers(values: Array) -> list[float | None]:
    """Numbers with four digits; None where there is none."""
    return [_number(float(value)) for value in values]


def _number(value: float) -> float | None:
    if not math.isfinite(value):
        return None
    rounded = float(f"{value:.{DIGITS}g}")
    return int(rounded) if rounded.is_integer() and abs(rounded) < 1e6 else rounded
