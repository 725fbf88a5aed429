"""The words and the table of the Auto-tune section, as HTML: all of it made of numbers and of our own words."""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

from explorer.model.compute import Picture
from explorer.panels.gains.tradeoff_plot import ATTITUDE, POSITION, told
from rangenav.preset import Preset
from rangenav.tradeoff import Point
from rangenav.tune import STARTS, Tuned

PARTS = {
    "path": "another path",
    "angular_velocity": "another turning",
    "initial_rotation": "another R(0)",
    "duration": "another duration",
    "world": "another world",
    "sensors": "other sensors",
    "guess": "another initial estimate",
}
"""What a search depends on beside the gains, and how it is told when the page shows another."""
CELL = "padding:0.1em 0.6em 0.1em 0;text-align:left;font-weight:400;vertical-align:top"
HEAD = f"{CELL};opacity:.65;white-space:nowrap"
TABLE = '<table style="border-collapse:collapse;width:100%;font-variant-numeric:tabular-nums">{}</table>'


class Row(NamedTuple):
    """One figure of a point."""

    name: str
    of: Callable[[Point], float]


ROWS = (
    Row("position settles (s)", lambda point: point.settle_position),
    Row("attitude settles (s)", lambda point: point.settle_attitude),
    Row("position error then (m)", lambda point: point.steady_position),
    Row("attitude error then (°)", lambda point: math.degrees(point.steady_attitude)),
    Row("runs that settle (%)", lambda point: 100 * point.settled),
)


def summary(found: Tuned, runs: int) -> str:
    """What the search reached, on the seeds it was trained on and on others, and whether it still comes home."""
    w = found.steadiness
    before, after = found.before.objective(w), found.after.objective(w)
    held_before, held_after = found.held_out_before.objective(w), found.held_out_after.objective(w)
    points = (found.before, found.after, found.held_out_before, found.held_out_after)
    rows = [(row.name, *(f"{row.of(point):.3g}" for point in points)) for row in ROWS]
    rows.append(("J, lower is better", *(_signed(J) for J in (before, after, held_before, held_after))))
    return _verdict(found, runs, held_after - held_before) + _table(rows) + _starts(found)


def _verdict(found: Tuned, runs: int, held_out: float) -> str:
    tried = len(found.seen)
    if found.after is found.before:
        return f"<b>None of the {tried - 1} other gains tried did better</b> than those it began with."
    seeds = f"{runs} seeds" if runs > 1 else "one seed"
    said = f"<b>The best of {tried} gains</b>, by w = {found.steadiness:g} on {seeds}; “held out” are as many others."
    if held_out > 0:
        said += (
            "<div>⚠ <b>Worse on held-out seeds</b>: these gains suit the noise they were found on. "
            "More seeds may help.</div>"
        )
    return said


def _starts(found: Tuned) -> str:
    before, after = found.starts_before, found.starts_after
    sign = "⚠ " if after < before else ""
    return (
        f"<div>{sign}Of {STARTS} random starts {before:.1%} hold 0.3 m and 5° at the end; now <b>{after:.1%}</b>.</div>"
    )


def differs(began: Preset, shown: Picture | None) -> str:
    """What the page shows otherwise than when the search began, or than a search can."""
    if shown is None:
        return ""
    other = [words for name, words in PARTS.items() if getattr(began, name) != getattr(shown.preset, name)]
    said = f"The page shows {_listed(other)} by now: what these gains do there was not tried." if other else ""
    if shown.settings.printed.model:
        said += " Searched with the derived model, while the run on the page follows the printed one."
    return f"<div>⚠ {said}</div>" if said else ""


def picked(point: Point, held_out: Point | None, found: Tuned, shown: Picture | None) -> str:
    """What the picked gains reach on the training seeds and, once that is known, on held-out ones."""
    which = {id(found.after): " (found)", id(found.before): " (start)"}.get(id(point), "")
    here = " <b>On the page now.</b>" if shown is not None and shown.preset.gains == point.gains else ""
    others = "…" if held_out is None else _reached(held_out, found.steadiness)
    return (
        f"<b>Picked{which}</b>: {_reached(point, found.steadiness)}.{here}"
        f'<div style="opacity:.75">On held-out seeds: {others}</div>'
    )


def _reached(point: Point, steadiness: float) -> str:
    return (
        f"position {told(POSITION, point)}; attitude {told(ATTITUDE, point)}; J {_signed(point.objective(steadiness))}"
    )


def _signed(number: float) -> str:
    return f"{number:.3f}".replace("-", "−")


def _table(rows: Sequence[Sequence[str]]) -> str:
    groups = f'<tr><th style="{HEAD}"></th>' + "".join(
        f'<th colspan="2" style="{HEAD}">{name}</th>' for name in ("trained on", "held out")
    )
    head = "".join(f'<th style="{HEAD}">{name}</th>' for name in ("", "before", "after", "before", "after"))
    lines = "".join(
        f"<tr>{''.join(f'<td style={chr(34)}{CELL}{chr(34)}>{cell}</td>' for cell in row)}</tr>" for row in rows
    )
    return TABLE.format(f"{groups}</tr><tr>{head}</tr>{lines}")


def _listed(parts: Sequence[str]) -> str:
    return parts[0] if len(parts) == 1 else f"{', '.join(parts[:-1])} and {parts[-1]}"
