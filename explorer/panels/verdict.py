"""The verdict as text, shape and colour: what one range determines on this motion, and the errors of the observer."""

import html
import math

import viser

from explorer.model import palette
from explorer.model.compute import Picture
from explorer.widgets.complaint import Complaint
from rangenav import continuity, sensors
from rangenav import verdict as verdicts
from rangenav.model import STATES
from rangenav.number_format import quantity, significant
from rangenav.vehicle import FREE

VERDICT_STYLES = {
    "observable": (
        "●",
        palette.GOOD,
        "OBSERVABLE",
        "full rank, and the predicted error meets the requirement",
    ),
    "weak": ("▲", palette.WARNING, "WEAK", "full rank, but the predicted error exceeds the requirement"),
    "blind": ("✕", palette.ERROR, "BLIND", "some directions cannot be told at all"),
}
"""Shape, colour (Okabe–Ito hues, dark enough to read on white, and light enough on black), word, meaning."""
NOT_JUDGED = "○", palette.NEUTRAL, "NOT JUDGED"
DIMMED = f"color:{palette.SECONDARY_TEXT}"
NAME_STYLE = f"padding:0.1em 0.7em 0.1em 0;{DIMMED};vertical-align:top;white-space:nowrap"
ROW = f'<tr><td style="{NAME_STYLE}">{{}}</td><td>{{}}</td></tr>'
CHIP_STYLE = "border:1px solid;border-radius:3px;padding:0 0.35em;margin-left:0.6em;font-size:0.75em"
ROUND_OFF = 1e-9
"""m: a path through the anchor is 0 m from it, and not 1e-15."""
CHIP = f'<span style="color:{{}};{CHIP_STYLE}">{{}}</span>'


class VerdictPanel:
    """The status block, and above it the progress of compilation."""

    def __init__(self, gui: viser.GuiApi) -> None:
        self._bar = gui.add_progress_bar(0.0, animated=True)
        self._bar_line = gui.add_markdown("Starting …")
        self.complaint = Complaint(gui)
        self._block = gui.add_html("")

    def progress(self, fraction: float, what: str) -> None:
        """Show the progress of compilation; at 1 the bar is hidden."""
        self._bar.visible = self._bar_line.visible = fraction < 1
        self._bar.value = 100 * fraction
        self._bar_line.content = f"Compiling the observers (once per machine): {html.escape(what)}"

    def draw(self, picture: Picture) -> None:
        """Show the verdict on a picture; ≈ marks what is that of sampled windows, and not yet of all."""
        shape, colour, word, meaning = _head(picture)
        head = f'<div style="color:{colour};font-weight:700;font-size:1.15em">{shape} {word}{chips(picture)}</div>'
        subject = f'<div style="{DIMMED}">{html.escape(subject_of(picture))}</div>'
        table = "".join(ROW.format(name, text) for name, text in rows(picture))
        self._block.content = (
            '<div style="padding:0.5em 0.9em;font-size:0.82em;line-height:1.4;font-variant-numeric:tabular-nums">'
            f'{subject}{head}<div style="{DIMMED};margin-bottom:0.4em">{meaning}</div>'
            f'<table style="border-collapse:collapse">{table}</table></div>'
        )


def subject_of(picture: Picture) -> str:
    """What the verdict is on: the motion that the page shows, and no recorded flight."""
    return f"the motion “{picture.preset.title or picture.settings.origin}”, as on the page"


def _head(picture: Picture) -> tuple[str, str, str, str]:
    """Shape, colour, word and meaning of the verdict. An imported curve that jumps, or whose snap comes from a fit, has
    no verdict; its meaning is the reason."""
    verdict = picture.analysis.verdict
    if not verdict.judged:
        reason = html.escape(verdict.reason)
        return *NOT_JUDGED, f"{reason}; what follows is the curve's own, and proves nothing about the flight"
    shape, colour, word, meaning = VERDICT_STYLES[verdict.word]
    if verdict.reason:
        meaning = html.escape(verdict.reason)
    if verdict.sign == "!":
        shape, colour = VERDICT_STYLES["weak"][:2]
    if verdict.unmet:
        meaning += f"; <b>✕ {verdict.unmet}</b>"
    return shape, colour, f"{_about(picture)}{word}", meaning


def _about(picture: Picture) -> str:
    """The mark of what comes from sampled windows; empty once all windows are judged."""
    return "≈ " if picture.analysis.proof is None else ""


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


def rows(picture: Picture) -> list[tuple[str, str]]:
    """Name and text of every row of the verdict's table."""
    rows = [*_observability_rows(picture), *_observer_rows(picture)]
    caveats = verdicts.caveats(picture.preset.world.gravity, picture.preset.sensors.sigma.range)
    if caveats:
        rows.append(("mind", "<br>".join(f"▲ {sentence}" for sentence in caveats)))
    sentences = sensors.effect_sentences(picture.preset.sensors)
    if sentences:
        rows.append(("sensors", "<br>".join(f"▲ {html.escape(sentence)}" for sentence in sentences)))
    return [*rows, ("vehicle", _vehicle(picture))]


def _observability_rows(picture: Picture) -> list[tuple[str, str]]:
    analysis, needed = picture.analysis, picture.preset.requirement
    about, nonlinear = _about(picture), f"nonlinear {analysis.nonlinear_rank} of 9"
    rank = f"<b>{about}{analysis.rank} of 13</b>, {nonlinear}; worst window from {significant(analysis.gramian_at)} s"
    rows = [("rank", rank)]
    if analysis.directions:
        rows.append(("blind", "<br>".join(f"✕ {html.escape(direction.summary)}" for direction in analysis.directions)))
    proven = None if analysis.proof is None else analysis.proof.excitation.meets(needed.mu)
    met = "✕" if analysis.mu < needed.mu else "✓" if proven or analysis.proof is None else "? not proven:"
    where = f"over δ = {needed.window:g} s from {significant(analysis.mu_at)} s"
    mu = (
        f"<b>{about}{number(analysis.mu)}</b> m²/s⁷"
        if analysis.mu >= analysis.mu_floor
        else "<b>0</b> (below the noise floor)"
    )
    alone = continuity.pieces_alone(picture.preset.path, picture.preset.duration)
    rows.append(("μ (PE)", f"{met} {mu} {where}; needs {needed.mu:g}{'' if alone is None else f'; {alone}'}"))
    rows.append(("least λ(W)", _least(float(analysis.gramian[0]), analysis.floor)))
    for name, start, end in (
        ("lifted", analysis.lifted_start, analysis.lifted_end),
        ("nonlinear", analysis.nonlinear_start, analysis.nonlinear_end),
    ):
        text = (
            f"position {number(start.position, 'm')} at its start, <b>{about}{number(end.position, 'm')}</b> at its end"
        )
        undetermined = math.isnan(start.position) and math.isnan(end.position)
        rows.append((f"σ {name}", "position not determined" if undetermined else text))
    return rows


def _least(eigenvalue: float, floor: float) -> str:
    if eigenvalue < floor:
        return f"below the noise floor {number(floor)} of double precision: no number"
    return f"{number(eigenvalue)} SI (noise floor {number(floor)})"


def _observer_rows(picture: Picture) -> list[tuple[str, str]]:
    summary, blind = picture.summary, picture.analysis.rank < STATES
    fit = ("ranges", summary.fit.statement(blind=blind, predicted=picture.analysis.lifted_end.position))
    if summary.diverged:
        return [("observer", f"✕ diverged: {html.escape(summary.divergence or '')}"), fit]
    if blind:
        errors = f"position {number(summary.steady_position, 'm')}, attitude {number(summary.steady_attitude_deg)}°"
        return [
            ("this run", f"steady error {errors}: along what cannot be told it is this start's luck, no accuracy"),
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
        head = f'<b style="color:{VERDICT_STYLES["blind"][1]}">✕ not flyable</b> by any vehicle'
        return [head, f"✕ {html.escape(jump)}", *(f"✕ {html.escape(one.summary)}" for one in picture.breaks)]
    if chosen == FREE:
        return []
    if not picture.breaks:
        return [f'<b style="color:{VERDICT_STYLES["observable"][1]}">✓ flyable</b> by {name}']
    head = f'<b style="color:{VERDICT_STYLES["blind"][1]}">✕ not flyable</b> by {name}'
    return [head, *(f"✕ {html.escape(limit_break.summary)}" for limit_break in picture.breaks)]


def _demands(picture: Picture) -> str:
    limits = picture.limits
    thrust = f"<b>{significant(limits.thrust_to_weight)} times the weight</b> in thrust"
    rate = f"{number(limits.speed, 'm/s')}, {number(math.degrees(limits.body_rate))}°/s"
    return f"{thrust}, {rate}, {number(limits.anchor_distance_min, 'm')} from the anchor at the nearest"
