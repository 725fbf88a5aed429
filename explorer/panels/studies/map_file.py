"""A map as a file: a table (CSV) with every metric of every point, a picture (SVG, PNG), or the study's file (TOML)."""

import csv
import io
from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal

import msgspec
import numpy as np

from explorer.charts.plot_file import DOTS, METADATA, drawing_settings
from explorer.model import palette
from explorer.model.basin import on_scale as colour_at
from explorer.model.study_judgement import contour, not_flyable, shares
from explorer.model.study_map import FLYABLE
from explorer.panels.studies.picture import SHADES, Shown, end_of_scale, ticks, titled
from explorer.panels.studies.text import wanted
from rangenav.studies.metrics import METRICS
from rangenav.studies.study import Study
from rangenav.studies.study_file import StudyFile

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MapFormat = Literal["csv", "svg", "png"]
SIZE = (6.4, 5.0)
"""Width and height in inches."""


def table(of: Study, shown: Shown) -> bytes:
    """CSV in UTF-8: a line of names with their units, then a line for each point; the first parameter is the slowest.

    A cell is empty where there is no value; "inf" where it is infinite. The last columns say why a point is invalid,
    of which preset the map is, and which windows σ, μ and ranks are the worst of.
    """
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    metrics = of.file.metrics
    named = [_named(one.path, one.unit) for one in shown.names]
    writer.writerow([*named, *(_named(name, METRICS[name].unit) for name in metrics), "reason", "preset", "windows"])
    of_map, origin = shown.map, (shown.preset, _windows(of.file.metrics, shown.windows))
    for i, j in np.ndindex(of_map.computed.shape):
        if of_map.computed[i, j]:
            place = repr(float(of_map.first[i])), repr(float(of_map.second[j]))
            values = (float(of_map.values[name][i, j]) for name in metrics)
            cells = ("" if np.isnan(value) else repr(value) for value in values)
            writer.writerow([*place, *cells, of_map.reason[i, j], *origin])
    return buffer.getvalue().encode()


def picture(shown: Shown, kind: Literal["svg", "png"]) -> bytes:
    """The map with its axes, colours, contour, hatching and cross, as the page shows it."""
    with drawing_settings():
        from matplotlib.colors import ListedColormap
        from matplotlib.figure import Figure

        figure = Figure(figsize=SIZE, layout="constrained")
        axes = figure.add_subplot()
        of = shown.map
        share, ends = shares(of, shown.metric)
        invalid = of.computed & (of.reason != "")
        scale = ListedColormap(colour_at(np.linspace(0.0, 1.0, SHADES)) / 255.0)
        drawn = axes.imshow(
            np.where(invalid, np.nan, share).T, origin="lower", aspect="auto", cmap=scale, vmin=0.0, vmax=1.0
        )
        _over(axes, shown, invalid)
        for place, axis, set_ticks in zip((0, 1), shown.axes, (axes.set_xticks, axes.set_yticks), strict=True):
            count = of.computed.shape[place]
            set_ticks([at * count - 0.5 for at, _ in ticks(axis)], [text for _, text in ticks(axis)])
        axes.set_xlabel(shown.names[0].caption)
        axes.set_ylabel(shown.names[1].caption)
        axes.set_title(titled(shown), loc="left", fontsize="medium", fontweight="bold")
        bar = figure.colorbar(drawn, ax=axes)
        written_ends = ["", ""] if ends is None else [end_of_scale(shown.metric, end) for end in ends]
        bar.set_ticks([0.0, 1.0], labels=written_ends)
        figure.supxlabel("\n".join(caption(shown)), fontsize="small")
        buffer = io.BytesIO()
        figure.savefig(buffer, format=kind, dpi=DOTS, metadata=METADATA[kind])
    return buffer.getvalue()


def study(of: Study, shown: Shown) -> StudyFile:
    """The map's study with the metric that is shown, and whether the vehicle can fly it: the table of all metrics that
    were computed on the way would bury it."""
    kept = tuple(dict.fromkeys((shown.metric, *(name for name in of.file.metrics if name == FLYABLE))))
    return msgspec.structs.replace(of.file, metrics=kept)


def caption(shown: Shown) -> list[str]:
    """What a reader of the picture alone must know: the signs that it has, the preset, and what the values rest on."""
    of = shown.map
    invalid = of.computed & (of.reason != "")
    lines = contour(of, shown.metric, shown.bound)
    signs = [
        f"line: {wanted(shown.metric, shown.bound)}" if shown.bound is not None and lines else "",
        "hatched: vehicle's limits broken" if (not_flyable(of) & ~invalid).any() else "",
        "×: cannot be computed" if invalid.any() else "",
        "dot: infinite" if np.isinf(of.values[shown.metric]).any() else "",
        "white cross: present design" if shown.cross is not None else "",
    ]
    windows = _windows((shown.metric,), shown.windows)
    seeds = f"{shown.runs} seed{'s' if shown.runs > 1 else ''}" if METRICS[shown.metric].needs == "run" else ""
    unfinished = "" if of.share == 1 else f"{int(of.computed.sum())} of {of.computed.size} points computed"
    rests = [f"preset {shown.preset}", windows and f"{windows}: others may be worse", seeds, unfinished]
    return ["; ".join(filter(None, line)) for line in (signs, rests) if any(line)]


def _windows(metrics: Sequence[str], judged: str) -> str:
    """Which windows the metrics of observability come from; empty if none of the metrics is one."""
    return judged if any(METRICS[one].needs == "analysis" for one in metrics) else ""


def _over(axes: "Axes", shown: Shown, invalid: np.ndarray) -> None:
    """Contour, hatching, marks and cross over the cells."""
    from matplotlib.collections import PolyCollection

    n, m = shown.map.computed.shape
    hatched = not_flyable(shown.map) & ~invalid
    edge = {"edgecolors": palette.MAP_EDGE, "linewidths": 0.0}
    axes.add_collection(PolyCollection(_squares(hatched), facecolors="none", hatch="////", **edge))
    axes.add_collection(PolyCollection(_squares(invalid), facecolors=palette.MAP_INVALID, **edge))
    i, j = np.nonzero(invalid)
    axes.plot(i, j, linestyle="none", marker="x", color=palette.MAP_EDGE, markersize=4)
    i, j = np.nonzero(np.isinf(shown.map.values[shown.metric]))
    axes.plot(i, j, linestyle="none", marker=".", color=palette.MAP_LINE, markersize=3)
    for line in contour(shown.map, shown.metric, shown.bound):
        for color, width in ((palette.MAP_EDGE, 3.0), (palette.MAP_LINE, 1.5)):
            axes.plot(line[:, 0], line[:, 1], color=color, linewidth=width)
    if shown.cross is not None:
        for color, width in ((palette.MAP_EDGE, 4.0), (palette.MAP_LINE, 2.0)):
            axes.plot(*shown.cross, linestyle="none", marker="+", markersize=14, markeredgewidth=width, color=color)
    axes.set_xlim(-0.5, n - 0.5)
    axes.set_ylim(-0.5, m - 0.5)


def _squares(where: np.ndarray) -> list[np.ndarray]:
    """The four corners of each cell."""
    corners = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)])
    return [place + corners for place in np.argwhere(where)]


def _named(name: str, unit: str) -> str:
    return f"{name} ({unit})" if unit else name
