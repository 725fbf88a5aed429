"""The text and the table of the Auto-tune section, as HTML. No visitor's text is in it, so nothing is escaped."""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

from explorer.model.compute import Picture
from explorer.panels.gains.tradeoff_plot import ATTITUDE, POSITION, point_text
from rangenav.number_format import NEVER, signed, significant
from rangenav.preset import Preset
from rangenav.tradeoff import Point
from rangenav.tune import STARTS, Tuned

PART_TEXTS = {
    "path": "another path",
    "angular_velocity": "another turning",
    "initial_rotation": "another R(0)",
    "duration": "another duration",
    "world": "another world",
    "sensors": "other sensors",
    "guess": "another initial estimate",
}
"""The fields of a preset that a search depends on besides the gains, and the text if the page shows another value."""
CELL = "padding:0.1em 0.6em 0.1em 0;text-align:left;font-weight:400;vertical-align:top"
HEAD = f"{CELL};opacity:.65;white-space:nowrap"
TABLE = '<table style="border-collapse:collapse;width:100%;font-variant-numeric:tabular-nums">{}</table>'


class Figure(NamedTuple):
    """One figure of a point."""

    name: str
    of: Callable[[Point], float]


FIGURES = (
    Figure("position settles (s)", lambda point: point.settle_position),
    Figure("attitude settles (s)", lambda point: point.settle_attitude),
    Figure("steady position error (m)", lambda point: point.steady_position),
    Figure("steady attitude error (°)", lambda point: math.degrees(point.steady_attitude)),
    Figure("runs that settle (%)", lambda point: 100 * point.settled),
)


def summary(tuned: Tuned, runs: int) -> str:
    """The figures of the search on its training seeds and on held-out seeds, and how many random starts converge."""
    w = tuned.steadiness
    before, after = tuned.before.objective(w), tuned.after.objective(w)
    held_before, held_after = tuned.held_out_before.objective(w), tuned.held_out_after.objective(w)
    points = (tuned.before, tuned.after, tuned.held_out_before, tuned.held_out_after)
    table_rows = [(figure.name, *(significant(figure.of(point)) for point in points)) for figure in FIGURES]
    table_rows.append(("J, lower is better", *(signed(J) for J in (before, after, held_before, held_after))))
    return _verdict_text(tuned, runs, held_after - held_before) + _table(table_rows) + _random_starts(tuned)


def outcome(tuned: Tuned, runs: int) -> str:
    """What the search has found, in one sentence: of the runs with other noise, which it has not tried."""
    if tuned.after is tuned.before:
        return f"auto-tune: none of the {len(tuned.points) - 1} other gains tried did better than those on the page"
    pairs = [(figure.name, figure.of(tuned.held_out_before), figure.of(tuned.held_out_after)) for figure in FIGURES]
    changes = (f"{name} {significant(before)} → {significant(after)}" for name, before, after in pairs)
    return f"auto-tune, {'mean of ' if runs > 1 else ''}{_runs(runs)} with other noise: {', '.join(changes)}"


def _runs(count: int) -> str:
    return f"{count} runs" if count > 1 else "one run"


def _verdict_text(tuned: Tuned, runs: int, held_out_change: float) -> str:
    tried = len(tuned.points)
    if tuned.after is tuned.before:
        return f"<b>None of the {tried - 1} other gains tried did better</b> than those it began with."
    seeds = f"{runs} seeds" if runs > 1 else "one seed"
    text = f"<b>The best of {tried} sets of gains</b> at w = {tuned.steadiness:g}, on {seeds}."
    text += f" The columns “held out” are of {'as many other seeds' if runs > 1 else 'another seed'}."
    if held_out_change > 0:
        text += (
            "<div>⚠ <b>Worse on held-out seeds</b>: these gains suit the noise they were found on. "
            "More seeds may help.</div>"
        )
    return text


def _random_starts(tuned: Tuned) -> str:
    before, after = tuned.starts_before, tuned.starts_after
    sign = "⚠ " if after < before else ""
    held, holds = round(before * STARTS), round(after * STARTS)
    return (
        f"<div>{sign}Of {STARTS} other runs, which begin at random, {held} keep within 0.3 m and 5° at the end with "
        f"the gains before, and <b>{holds}</b> with the new ones.</div>"
    )


def differs(began: Preset, shown: Picture | None) -> str:
    """The differences between the settings of the search and those on the page."""
    if shown is None:
        return ""
    other = [label for name, label in PART_TEXTS.items() if getattr(began, name) != getattr(shown.preset, name)]
    text = f"The page shows {_enumeration(other)} by now: what these gains do there was not tried." if other else ""
    if shown.settings.printed.model:
        text += " Searched with the derived model, while the run on the page follows the printed one."
    return f"<div>⚠ {text}</div>" if text else ""


def picked(point: Point, held_out_change: Point | None, tuned: Tuned, shown: Picture | None) -> str:
    """The figures of the picked gains on the training seeds and, once they are computed, on the held-out seeds."""
    origin = {id(tuned.after): " (found)", id(tuned.before): " (start)"}.get(id(point), "")
    on_page = " <b>On the page now.</b>" if shown is not None and shown.preset.gains == point.gains else ""
    held_out_text = "…" if held_out_change is None else _figures_text(held_out_change, tuned.steadiness)
    return (
        f"<b>Picked{origin}</b>: {_figures_text(point, tuned.steadiness)}.{on_page}"
        f'<div style="opacity:.75">On held-out seeds: {held_out_text}</div>'
    )


def used(before: Picture, after: Picture, point: Point, tuned: Tuned, runs: int) -> str:
    """The figures before and after gains were used: of the runs that the search has tried, and of the run in view."""
    points = (tuned.before, point)
    views = [_figures_of(picture) for picture in (before, after)]
    rows = [
        (figure.name, *(significant(figure.of(one)) for one in points), *(view[k] for view in views))
        for k, figure in enumerate(FIGURES[: len(views[0])])
    ]
    mean = f"the mean of {_runs(runs)}" if runs > 1 else _runs(runs)
    return (
        f"<b>In use.</b>{_table(rows, ('the runs searched', 'the run in view'))}<div>The search improves {mean} with "
        f"other noise and starts; the run in view has noise seed {after.preset.seed} and its own start, so single "
        "figures of it may become worse. The run before is pinned as A: see the Compare tab.</div>"
    )


def _figures_of(picture: Picture) -> tuple[str, ...]:
    """The first figures, of one run."""
    summary = picture.summary
    times = (summary.settle_position_s, summary.settle_attitude_s)
    settled = (NEVER if time is None else significant(time) for time in times)
    return (*settled, significant(summary.steady_position), significant(summary.steady_attitude_deg))


def _figures_text(point: Point, steadiness: float) -> str:
    objective = signed(point.objective(steadiness))
    return f"position {point_text(POSITION, point)}; attitude {point_text(ATTITUDE, point)}; J {objective}"


def _table(table_rows: Sequence[Sequence[str]], names: tuple[str, str] = ("trained on", "held out")) -> str:
    groups = f'<tr><th style="{HEAD}"></th>' + "".join(f'<th colspan="2" style="{HEAD}">{name}</th>' for name in names)
    head = "".join(f'<th style="{HEAD}">{name}</th>' for name in ("", "before", "after", "before", "after"))
    lines = "".join(
        f"<tr>{''.join(f'<td style={chr(34)}{CELL}{chr(34)}>{cell}</td>' for cell in figure)}</tr>"
        for figure in table_rows
    )
    return TABLE.format(f"{groups}</tr><tr>{head}</tr>{lines}")


def _enumeration(parts: Sequence[str]) -> str:
    return parts[0] if len(parts) == 1 else f"{', '.join(parts[:-1])} and {parts[-1]}"
