"""The text and the tables of the Compare tab, as HTML. Names of presets and of files come from visitors: escaped."""

import html
from collections.abc import Iterable

from explorer.model import palette
from explorer.model.comparison import Baseline
from explorer.model.compute import Picture
from explorer.model.consistency import RunConsistency
from rangenav.ensemble import Ensemble, spread
from rangenav.number_format import NEVER, percent, quantity, significant
from rangenav.record import Summary

"""The run on view."""
BLOCK = (
    '<div style="padding:0.2em 0.9em 0.5em;font-size:0.82em;line-height:1.4;font-variant-numeric:tabular-nums">{}</div>'
)
TABLE = '<table style="border-collapse:collapse;width:100%">{}</table>'
CELL = "padding:0.1em 0.5em 0.1em 0;vertical-align:top"
HEAD = f"{CELL};opacity:.65;text-align:left;font-weight:400"
GREY = '<span style="opacity:.7">{}</span>'


def nothing_pinned() -> str:
    """The use of pinning, while nothing is pinned."""
    return BLOCK.format(
        GREY.format("Pin a run, change anything: A stays in every plot, and what changed is told here.")
    )


def differences(a: Picture, b: Picture, choices: list[str], figures: list[str]) -> str:
    """The settings and the figures that differ between the pinned run A and the run B on the page."""
    head = (
        f'<b style="color:{palette.PINNED}">A</b> {_run(a)} <span style="opacity:.7">(pinned)</span><br>'
        f'<b style="color:{palette.ESTIMATE}">B</b> {_run(b)} <span style="opacity:.7">(what you change)</span>'
    )
    if not choices:
        return BLOCK.format(head + "<br>" + GREY.format("Nothing is chosen otherwise yet."))
    consequences = _list(figures) if figures else GREY.format("No figure changed by more than half a percent.")
    return BLOCK.format(
        f"{head}<div style='margin-top:.4em'>chosen otherwise:</div>{_list(choices)}what came of it:{consequences}"
    )


def seeds(picture: Picture, runs: Ensemble | None, message: str) -> str:
    """The seed of the run on the page, and the figures of many seeds, or the message why there are none."""
    seed_text = f"noise seed on view: <b>{picture.preset.seed}</b> (Sensors tab)"
    if runs is None:
        return BLOCK.format(seed_text + (GREY.format(f"<br>{message}") if message else ""))
    count, settled = len(runs.seed), int(runs.settled.sum())
    band = f"<b>{count} seeds of these settings</b> ({runs.seed[0]} to {runs.seed[-1]}): median and 10–90 %"
    rows = [
        ("steady position", runs.steady_position, "m"),
        ("steady attitude", runs.steady_attitude_deg, "°"),
        ("position settled", runs.settle_position, "s"),
    ]
    lines = "".join(
        _row(
            [
                name,
                f"<b>{quantity(middle.median, unit, otherwise=NEVER)}</b>",
                " – ".join(quantity(end, unit, otherwise=NEVER) for end in (middle.low, middle.high)),
            ]
        )
        for name, middle, unit in ((name, spread(values), unit) for name, values, unit in rows)
    )
    return BLOCK.format(
        f"{seed_text}<br>{band}{TABLE.format(lines)}{settled} of {count} settle in position and attitude."
    )


def baselines(picture: Picture, shown: Iterable[Baseline], refusals: list[str]) -> str:
    """The figures of the cascade and of the other estimators."""
    shown = tuple(shown)
    if not shown:
        return BLOCK.format(GREY.format("Switch one on: it runs on the same record, and is drawn beside the cascade."))
    steps = len(picture.motion.time) - 1
    cost = _milliseconds(picture.summary, steps)
    lines = _head(["", "settled", "steady", "time"]) + _estimator_row(
        "cascade", palette.ESTIMATE, picture.summary, steps, cost
    )
    texts = []
    for name, candidate in shown:
        color = palette.ESTIMATORS[name]
        if candidate is None:
            lines += _row([f'<b style="color:{color}">{name}</b>', "at work …", "", ""])
        else:
            lines += _estimator_row(name, color, candidate.summary, steps, cost)
            texts.append(f"<b>{name}</b>: {html.escape(candidate.outcome)}")
    texts += [f"⚠ {html.escape(sentence)}" for sentence in refusals]
    return BLOCK.format(TABLE.format(lines) + "<br>".join(texts))


def _estimator_row(name: str, color: str, summary: Summary, steps: int, cost: float) -> str:
    settled = quantity(summary.settle_position_s, "s", otherwise=NEVER)
    steady = f"<b>{significant(summary.steady_position)} m</b>, {significant(summary.steady_attitude_deg)}°"
    seed_text = _milliseconds(summary, steps)
    ratio = f" ({significant(seed_text / cost, 2)}×)" if cost > 0 and name != "cascade" else ""
    return _row([f'<b style="color:{color}">{name}</b>', settled, steady, f"{quantity(seed_text, 'ms')}{ratio}"])


def consistency(run: RunConsistency, of_seeds: RunConsistency | None, count: int, *, matched: bool) -> str:
    """Normalized innovations (NIS) and errors (NEES), and predicted and achieved σ, over the last quarter."""
    columns = [run] if of_seeds is None else [run, of_seeds]
    lines = _head(["last quarter", "this run", *([f"{count} seeds"] if of_seeds is not None else [])])
    lines += _row(["NIS (1 expected)", *(f"<b>{significant(column.nis)}</b>" for column in columns)])
    lines += _row(["inside its 95 % band", *(percent(column.nis_inside) for column in columns)])
    lines += _row(["NEES (3 expected)", *(f"<b>{significant(column.nees)}</b>" for column in columns)])
    lines += _row(["its 95 % band", *(f"{significant(c.nees_low)} – {significant(c.nees_high)}" for c in columns)])
    lines += _row(["inside it", *(percent(column.nees_inside) for column in columns)])
    lines += _row(["σ achieved (RMS)", *(f"<b>{quantity(column.achieved, 'm')}</b>" for column in columns)])
    lines += _row(["σ that P claims", *(quantity(column.estimated, "m") for column in columns)])
    lines += _row(["σ predicted, lifted", *(quantity(column.lifted, "m") for column in columns)])
    lines += _row(["σ predicted, nonlinear", *(quantity(column.cramer_rao, "m") for column in columns)])
    text = (
        "Bands here are of single values; many seeds have one of their mean, which is narrow."
        if of_seeds is None
        else f"The observer is {of_seeds.summary} (position, {count} seeds; their bands are of the mean)."
    )
    if not matched:
        text += " With constant gains P follows from q and V, not from the noise: it promises nothing."
    text += " Predictions know one window of ranges and perfect IMU; the observer also remembers what came before."
    return BLOCK.format(TABLE.format(lines) + GREY.format(text))


def _run(picture: Picture) -> str:
    return f"{html.escape(picture.settings.origin or 'unnamed')}, noise seed {picture.preset.seed}"


def _list(sentences: list[str]) -> str:
    items = "".join(f"<li>{html.escape(sentence)}</li>" for sentence in sentences)
    return f'<ul style="margin:0 0 .3em;padding-left:1.2em;overflow-wrap:anywhere">{items}</ul>'


def _head(cells: list[str]) -> str:
    return "<tr>" + "".join(f'<th style="{HEAD}">{cell}</th>' for cell in cells) + "</tr>"


def _row(cells: list[str]) -> str:
    return "<tr>" + "".join(f'<td style="{CELL}">{cell}</td>' for cell in cells) + "</tr>"


def _milliseconds(summary: Summary, steps: int) -> float:
    return summary.microseconds_per_step * steps / 1e3
