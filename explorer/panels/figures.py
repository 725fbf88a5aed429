"""All figures behind the verdict, as rows of a table: observability, observer, sensors and vehicle."""

import html
import math

from explorer.model import palette
from explorer.model.compute import Picture
from explorer.model.glossary import TERMS
from rangenav import continuity, sensors, window_text
from rangenav.number_format import quantity, significant
from rangenav.vehicle import FREE

ROW = f'<tr><td style="color:{palette.SECONDARY_TEXT}">{{}}</td><td>{{}}</td></tr>'
CHIP_STYLE = (
    "border:1px solid;border-radius:3px;padding:0 0.35em;margin-left:0.6em;font-size:max(0.75em, var(--rn-least, 0px))"
)
ROUND_OFF = 1e-9
"""m: a path through the anchor is 0 m from it, and not 1e-15."""
CHIP = f'<span style="color:{{}};{CHIP_STYLE}">{{}}</span>'


def about(picture: Picture) -> str:
    """The mark of what comes from sampled windows; empty once all windows are judged."""
    return "≈ " if picture.analysis.proof is None else ""


TERMS_OF_ROWS: dict[str, tuple[str, str]] = {
    "rank": ("rank", ""),
    "blind": ("blind", ""),
    "μ (PE)": ("excitation", ""),
    "least λ(W)": ("weakest direction", ""),
    "σ lifted": ("window accuracy", ": linear model"),
    "σ nonlinear": ("window accuracy", ": true model"),
    "settled": ("settled", ""),
    "ranges": ("range fit", ""),
    "steady error": ("steady error", ""),
    "this run": ("steady error", ""),
    "observer": ("diverged", ""),
    "mind": ("verdict", ": mind"),
    "sensors": ("unmodelled", ""),
    "vehicle": ("vehicle limits", ""),
}
"""Row → the term of the glossary that names and defines it, and what is added to the name."""


def number(value: float, unit: str = "") -> str:
    """The value with its unit. A length of the size of rounding errors is written as 0."""
    return quantity(0.0 if unit == "m" and abs(value) < ROUND_OFF else value, unit)


def chips(picture: Picture) -> str:
    """Labels after the verdict: the switches “as printed” that are on, and a covariance that diverges."""
    printed = picture.settings.printed
    on = [name.replace("_", " ") for name in printed.__struct_fields__ if getattr(printed, name)]
    labels = [CHIP.format(palette.PRINTED_FORMULA, f"PRINTED: {', '.join(on)}")] if on else []
    if picture.summary.diverged:
        labels.append(CHIP.format(palette.ERROR, "⚠ diverged"))
    return "".join(labels)


def table(picture: Picture) -> str:
    """The rows as HTML."""
    return f"<table>{''.join(ROW.format(_named(name), text) for name, text in rows(picture))}</table>"


def _named(row: str) -> str:
    """The label of a row's term, which shows its definition."""
    key, addition = TERMS_OF_ROWS[row]
    return f'<span title="{html.escape(TERMS[key].hint)}">{html.escape(TERMS[key].label)}{addition}</span>'


def rows(picture: Picture) -> list[tuple[str, str]]:
    """Name and text of every row of the verdict's table."""
    rows = [*_observability_rows(picture), *_observer_rows(picture)]
    caveats = picture.analysis.caveats(picture.preset)
    if caveats:
        rows.append(("mind", "<br>".join(f"▲ {sentence}" for sentence in caveats)))
    sentences = sensors.effect_sentences(picture.preset.sensors)
    if sentences:
        rows.append(("sensors", "<br>".join(f"▲ {html.escape(sentence)}" for sentence in sentences)))
    return [*rows, ("vehicle", _vehicle(picture))]


def _observability_rows(picture: Picture) -> list[tuple[str, str]]:
    analysis, needed = picture.analysis, picture.preset.requirement
    mark, nonlinear = about(picture), f"nonlinear {analysis.nonlinear_rank} of 9"
    at_least = "at least " if analysis.rounded else ""
    rank = f"<b>{mark}{at_least}{analysis.rank} of 13</b>, {nonlinear}"
    rank += f"; worst window from {significant(analysis.gramian_at)} s"
    rank += window_text.later_round(analysis.gramian_at, needed.window, picture.preset.duration)
    rows = [("rank", rank)]
    if analysis.directions:
        rows.append(("blind", "<br>".join(f"✕ {html.escape(direction.summary)}" for direction in analysis.directions)))
    proven = None if analysis.proof is None else analysis.proof.excitation.meets(needed.mu)
    met = "✕" if analysis.mu < needed.mu else "✓" if proven or analysis.proof is None else "? not proven:"
    where = f"over δ = {needed.window:g} s from {significant(analysis.mu_at)} s"
    mu = (
        f"<b>{mark}{number(analysis.mu)}</b> m²/s⁷"
        if analysis.mu >= analysis.mu_floor
        else "<b>0</b> (below the noise floor)"
    )
    alone = continuity.pieces_alone(picture.preset.path, picture.preset.duration)
    rows.append(("μ (PE)", f"{met} {mu} {where}; needs {needed.mu:g}{'' if alone is None else f'; {alone}'}"))
    rows.append(("least λ(W)", _least(float(analysis.gramian[0]), analysis.floor)))
    for name, window, start, end in (
        ("lifted", f"window from {significant(analysis.accuracy_at)} s", analysis.lifted_start, analysis.lifted_end),
        ("nonlinear", "that same window", analysis.nonlinear_start, analysis.nonlinear_end),
    ):
        text = (
            f"position {number(start.position, 'm')} at its start, <b>{mark}{number(end.position, 'm')}</b> at its end"
            f"; {window}"
        )
        undetermined = math.isnan(start.position) and math.isnan(end.position)
        at_this = " at this precision" if analysis.below_rounding else ""
        rows.append((f"σ {name}", f"position not determined{at_this}" if undetermined else text))
    return rows


def _least(eigenvalue: float, floor: float) -> str:
    if eigenvalue < floor:
        return f"below the noise floor {number(floor)} of double precision: no number"
    return f"{number(eigenvalue)} SI (noise floor {number(floor)})"


def _observer_rows(picture: Picture) -> list[tuple[str, str]]:
    summary, blind = picture.summary, picture.analysis.blind
    fit = ("ranges", summary.fit.statement(blind=blind, predicted=picture.analysis.lifted_end.position))
    if summary.diverged:
        return [("observer", f"✕ diverged: {html.escape(summary.divergence or '')}"), fit]
    if blind:
        errors = f"position {number(summary.steady_position, 'm')}, attitude {number(summary.steady_attitude_deg)}°"
        return [
            ("this run", f"steady error {errors}: along the blind directions this error depends on the initial guess"),
            fit,
        ]
    settled = (
        f"position {_since(summary.settle_position_s, '0.3 m')}; attitude {_since(summary.settle_attitude_s, '5°')}"
    )
    steady = (
        f"<b>{number(summary.steady_position, 'm')}</b>, {number(summary.steady_velocity, 'm/s')}, "
        f"{number(summary.steady_gravity, 'm/s²')}, <b>{number(summary.steady_attitude_deg)}°</b>; "
        f"peak {number(summary.peak_position, 'm')}"
    )
    return [("settled", settled), fit, ("steady error", steady)]


def _since(seconds: float | None, limit: str) -> str:
    return (
        f"✕ does not stay below {limit} over the last tenth of the run"
        if seconds is None
        else f"✓ below {limit} from {significant(seconds)} s"
    )


def _vehicle(picture: Picture) -> str:
    return "<br>".join([*_flyable(picture), _demands(picture)])


def _flyable(picture: Picture) -> list[str]:
    """Whether the vehicle can fly the motion, and the limits that the motion exceeds; a free vehicle has no limits."""
    chosen = picture.preset.vehicle
    name = html.escape(chosen.name)
    jump = continuity.discontinuity(picture.preset.path, picture.preset.duration)
    if jump is not None:
        head = f'<b style="color:{palette.ERROR}">✕ not flyable</b> by any vehicle'
        return [head, f"✕ {html.escape(jump)}", *(f"✕ {html.escape(one.summary)}" for one in picture.breaks)]
    if chosen == FREE:
        return []
    if not picture.breaks:
        return [f'<b style="color:{palette.GOOD}">✓ flyable</b> by {name}']
    head = f'<b style="color:{palette.ERROR}">✕ not flyable</b> by {name}'
    return [head, *(f"✕ {html.escape(limit_break.summary)}" for limit_break in picture.breaks)]


def _demands(picture: Picture) -> str:
    limits = picture.limits
    thrust = f"<b>{significant(limits.thrust_to_weight)} times the weight</b> in thrust"
    rate = f"{number(limits.speed, 'm/s')}, {number(math.degrees(limits.body_rate))}°/s"
    return f"{thrust}, {rate}, {number(limits.anchor_distance_min, 'm')} from the anchor at the nearest"
