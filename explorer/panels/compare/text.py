"""The text and the tables of the Compare tab, as HTML. Names of presets and files come from visitors, so they are
escaped."""

import html
from collections.abc import Iterable

from explorer.model import palette, side_by_side
from explorer.model.comparison import Baseline
from explorer.model.compute import Picture
from explorer.model.consistency import RunConsistency
from rangenav import range_fit
from rangenav.ensemble import Ensemble, spread
from rangenav.number_format import NEVER, percent, quantity, significant
from rangenav.record import Summary

BLOCK = (
    '<div style="padding:0.2em 0.9em 0.5em;font-size:0.82em;line-height:1.4;font-variant-numeric:tabular-nums">{}</div>'
)
TABLE = '<table style="border-collapse:collapse;width:100%">{}</table>'
CELL = "padding:0.1em 0.5em 0.1em 0;vertical-align:top"
HEAD = f"{CELL};opacity:.65;text-align:left;font-weight:400"
GREY = '<span style="opacity:.7">{}</span>'

FOLLOWS = BLOCK.format(GREY.format("Follows as soon as nothing moves."))
"""In place of figures that take long, while another picture follows soon."""


def nothing_pinned() -> str:
    """A text on the use of pinning, shown while no run is pinned."""
    return BLOCK.format(
        GREY.format("Pin a run, change anything: A stays in every plot, and what changed is shown here.")
    )


def differences(a: Picture, b: Picture, choices: list[str], figures: list[str]) -> str:
    """The settings and the figures that differ between the pinned run A and the run B on the page."""
    first, second = _named("A", palette.PINNED), _named("B", palette.ESTIMATE)
    head = f"{first} {_run(a, b)} {GREY.format('(pinned)')}<br>{second} {_run(b, a)} {GREY.format('(on the page)')}"
    if not choices:
        return BLOCK.format(head + "<br>" + GREY.format("A and B have the same settings so far."))
    consequences = _list(figures) if figures else GREY.format("No figure changed by more than half a percent.")
    return BLOCK.format(
        f"{head}<div style='margin-top:.4em'>settings that differ:</div>{_list(choices)}"
        f"figures that differ:{consequences}"
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
                f"<b>{quantity(statistics.median, unit, otherwise=NEVER)}</b>",
                " – ".join(quantity(end, unit, otherwise=NEVER) for end in (statistics.low, statistics.high)),
            ]
        )
        for name, statistics, unit in ((name, spread(values), unit) for name, values, unit in rows)
    )
    return BLOCK.format(
        f"{seed_text}<br>{band}{TABLE.format(lines)}{settled} of {count} settle in position and attitude.<br>"
        f"On their ranges: {range_fit.counted(list(runs.fit), blind=_blind(picture))}."
    )


def baselines(picture: Picture, shown: Iterable[Baseline], refusals: list[str]) -> str:
    """The figures of the cascade and of the other estimators."""
    shown = tuple(shown)
    if not shown:
        return BLOCK.format(GREY.format("Switch one on: it runs on the same record, and is drawn beside the cascade."))
    steps = len(picture.motion.time) - 1
    cascade_duration = _milliseconds(picture.summary, steps)
    lines = _head(["", "settled", "steady", "time"]) + _estimator_row(
        "cascade", palette.ESTIMATE, picture.summary, steps, cascade_duration
    )
    texts = [_on_ranges("cascade", picture.summary, picture)]
    for name, candidate in shown:
        color = palette.ESTIMATORS[name]
        if candidate is None:
            lines += _row([_named(name, color), "at work …", "", ""])
        else:
            lines += _estimator_row(name, color, candidate.summary, steps, cascade_duration)
            texts.append(f"<b>{name}</b>: {html.escape(candidate.outcome)}")
            if name == "EKF":  # the refinement has no innovations: it is made of all ranges at once
                texts.append(_on_ranges(name, candidate.summary, picture))
    texts += [f"⚠ {html.escape(sentence)}" for sentence in refusals]
    return BLOCK.format(TABLE.format(lines) + "<br>".join(texts))


def _estimator_row(name: str, color: str, summary: Summary, steps: int, cascade_duration: float) -> str:
    """One estimator's row; `cascade_duration` (ms) is the computing time of the cascade, for comparison."""
    settled = quantity(summary.settle_position_s, "s", otherwise=NEVER)
    steady = f"<b>{significant(summary.steady_position)} m</b>, {significant(summary.steady_attitude_deg)}°"
    duration = _milliseconds(summary, steps)
    ratio = f" ({significant(duration / cascade_duration, 2)}×)" if cascade_duration > 0 and name != "cascade" else ""
    return _row([_named(name, color), settled, steady, f"{quantity(duration, 'ms')}{ratio}"])


def _named(name: str, color: palette.Color) -> str:
    """The name of a run in its colour."""
    return f'<b style="color:{palette.RUN_TEXT[color]}">{name}</b>'


def consistency(run: RunConsistency, of_seeds: RunConsistency | None, count: int, *, matched: bool) -> str:
    """Normalized innovations (NIS) and errors (NEES), and predicted and achieved σ, over the last quarter."""
    results = [run] if of_seeds is None else [run, of_seeds]
    lines = _head(["last quarter", "this run", *([f"{count} seeds"] if of_seeds is not None else [])])
    lines += _row(["NIS (1 expected)", *(f"<b>{significant(result.nis)}</b>" for result in results)])
    lines += _row(["inside its 95 % band", *(percent(result.nis_inside) for result in results)])
    lines += _row(["NEES (3 expected)", *(f"<b>{significant(result.nees)}</b>" for result in results)])
    lines += _row(
        ["its 95 % band", *(f"{significant(result.nees_low)} – {significant(result.nees_high)}" for result in results)]
    )
    lines += _row(["inside it", *(percent(result.nees_inside) for result in results)])
    lines += _row(["σ achieved (RMS)", *(f"<b>{quantity(result.achieved, 'm')}</b>" for result in results)])
    lines += _row(["σ that P claims", *(quantity(result.estimated, "m") for result in results)])
    lines += _row(["σ predicted, lifted", *(quantity(result.lifted, "m") for result in results)])
    lines += _row(["σ predicted, nonlinear", *(quantity(result.cramer_rao, "m") for result in results)])
    text = (
        "The bands are those of single values. The mean of many seeds has a narrower band."
        if of_seeds is None
        else f"The observer is {of_seeds.summary} (position, {count} seeds; their bands are of the mean)."
    )
    if not matched:
        text += " With constant gains P follows from q and V and not from the noise, so it need not match the errors."
    text += " The predictions use the ranges of one window and a perfect IMU."
    text += " The observer has a noisy IMU, and it also uses earlier ranges."
    return BLOCK.format(TABLE.format(lines) + GREY.format(text))


def _on_ranges(name: str, summary: Summary, picture: Picture) -> str:
    said = summary.fit.statement(blind=_blind(picture), predicted=picture.analysis.lifted_end.position)
    return f"<b>{name}</b>, on its ranges: {said}"


def _blind(picture: Picture) -> bool:
    return picture.analysis.blind


def _run(picture: Picture, other: Picture) -> str:
    """The name of a run, as in the view side by side, and its noise."""
    return f"{html.escape(side_by_side.title(picture, other) or 'unnamed')}, noise seed {picture.preset.seed}"


def _list(sentences: list[str]) -> str:
    items = "".join(f"<li>{html.escape(sentence)}</li>" for sentence in sentences)
    return f'<ul style="margin:0 0 .3em;padding-left:1.2em;overflow-wrap:anywhere">{items}</ul>'


def _head(cells: list[str]) -> str:
    return "<tr>" + "".join(f'<th style="{HEAD}">{cell}</th>' for cell in cells) + "</tr>"


def _row(cells: list[str]) -> str:
    return "<tr>" + "".join(f'<td style="{CELL}">{cell}</td>' for cell in cells) + "</tr>"


def _milliseconds(summary: Summary, steps: int) -> float:
    """Computing time (ms) of a run of so many steps."""
    return summary.microseconds_per_step * steps / 1e3
