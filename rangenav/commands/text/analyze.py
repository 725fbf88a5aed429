"""`rangenav analyze` for a person."""

from rangenav import continuity, window_text
from rangenav.analysis import Analysis
from rangenav.commands.text import layout
from rangenav.commands.text.layout import Report, group, met
from rangenav.commands.text.spectrum_bar import spectrum_bar
from rangenav.commands.text.verdict import accuracy_lines, flight_lines, headline, unjudged_help
from rangenav.model import STATES
from rangenav.number_format import quantity, significant
from rangenav.preset import Preset

NONLINEAR_STATES = 9
MU = "m²/s⁷"
UNPROVEN = {
    "met": "? met on sampled windows, not proven of all",
    "not met": "✗ not met",
    "not proven": "! not proven of every window",
}
"""What is said of a required μ that the bound of μ neither proves nor disproves, by `Verdict.excitation`."""


def report(preset: Preset, analysis: Analysis, *, name: str, window: float | None = None) -> Report:
    """What one range can tell of a preset's motion; `name` and `window` (s) are what the person typed.

    Only `explain` has a window, too: the other commands would speak of the preset's own.
    """
    sign, answer = headline(preset, analysis)
    typed = layout.argument(name)
    lacking = analysis.verdict.sign in ("✗", "!")
    following = (f"repair {typed} -o repaired.toml",) if lacking else (f"simulate {typed}", f"certify {typed}")
    if not analysis.verdict.judged:
        following = (f"simulate {typed}", "log RECORD.csv")
    explain = f"explain {typed}"
    following = (explain, *following) if window is None else (f"{explain} --window {window:g}",)
    return Report(
        subject=layout.subject(name),
        sign=sign,
        answer=answer,
        title=preset.title,
        groups=(
            *group("what can be seen", _rank(analysis), excitation_lines(preset, analysis)),
            *group("why not", (f"✗ {direction.summary}" for direction in analysis.directions)),
            *group("how well", accuracy_lines(preset, analysis)),
            *group("can it be flown", flight_lines(preset)),
            *group("would help", unjudged_help(preset)),
            *group("spectrum", spectrum_bar(analysis.gramian.tolist(), analysis.floor)),
            *group("nonlinear", spectrum_bar(analysis.nonlinear.tolist(), analysis.nonlinear_floor)),
            *layout.next_commands(*following),
        ),
    )


def _rank(analysis: Analysis) -> str:
    at_least = "at least " if analysis.rounded else ""
    return (
        f"rank {at_least}{analysis.rank} of {STATES} lifted, {analysis.nonlinear_rank} of {NONLINEAR_STATES} nonlinear"
    )


def excitation_lines(preset: Preset, analysis: Analysis) -> list[str]:
    """μ against its requirement, and whether that holds at every time."""
    needed, excited = preset.requirement.mu, analysis.mu > analysis.mu_floor
    least = f"{quantity(analysis.mu, MU)} from {quantity(analysis.mu_at, 's')}"
    mu = f"excitation μ {least}" if excited else "no excitation (μ 0)"
    alone = continuity.pieces_alone(preset.path, preset.duration)
    proven = None if analysis.proof is None else analysis.proof.excitation.meets(needed)
    answer = UNPROVEN[analysis.verdict.excitation] if proven is None else met(proven)
    reached = f"{mu}, required {significant(needed)}: {answer}"
    return [reached, *([] if alone is None else [alone]), *(_bounded(preset, analysis) if excited else [])]


def _bounded(preset: Preset, analysis: Analysis) -> list[str]:
    """What no window falls below, and which windows that is said of."""
    found = None if analysis.proof is None else analysis.proof.excitation
    if found is None or found.lower is None:
        return ["μ is sampled: nothing is known to bound the path's snap"]
    if found.lower <= 0:
        return ["no bound of μ above 0 is known"]
    windows = window_text.every(preset.requirement.window, preset.duration, found.starts)
    return [f"μ is at least {quantity(found.lower, MU)} in {windows}"]
