"""`rangenav analyze` for a person."""

from rangenav.analysis import Analysis
from rangenav.commands.text import layout
from rangenav.commands.text.layout import Report, group, met
from rangenav.commands.text.spectrum_bar import spectrum_bar
from rangenav.commands.text.verdict import accuracy_lines, flight_lines, headline
from rangenav.model import STATES
from rangenav.number_format import quantity, significant
from rangenav.preset import Preset

NONLINEAR_STATES = 9
MU = "m²/s⁷"


def report(preset: Preset, found: Analysis, *, name: str) -> Report:
    """What one range can tell of a preset's motion; `name` is what the person typed."""
    sign, answer = headline(preset, found)
    typed = layout.argument(name)
    lacking = found.verdict.word in ("blind", "weak")
    following = (f"repair {typed} -o repaired.toml",) if lacking else (f"simulate {typed}", f"certify {typed}")
    return Report(
        subject=layout.subject(name),
        sign=sign,
        answer=answer,
        title=preset.title,
        groups=(
            *group("what can be seen", _rank(found), excitation_lines(preset, found)),
            *group("why not", (f"✗ {direction.summary}" for direction in found.directions)),
            *group("how well", accuracy_lines(preset, found)),
            *group("can it be flown", flight_lines(preset)),
            *group("spectrum", spectrum_bar(found.gramian.tolist(), found.floor)),
            *layout.next_commands(f"explain {typed}", *following),
        ),
    )


def _rank(found: Analysis) -> str:
    return f"rank {found.rank} of {STATES} lifted, {found.nonlinear_rank} of {NONLINEAR_STATES} nonlinear"


def excitation_lines(preset: Preset, found: Analysis) -> list[str]:
    """μ against its requirement, and whether that holds at every time."""
    needed, excited = preset.requirement.mu, found.mu > found.mu_floor
    least = f"{quantity(found.mu, MU)} from {quantity(found.mu_at, 's')}"
    mu = f"excitation μ {least}" if excited else "no excitation (μ 0)"
    lines = [f"{mu}, required {significant(needed)}: {met(found.mu >= needed)}"]
    if found.bound_for_all_t is None:
        return [*lines, "μ is not bounded at every time: the path does not repeat, or its snap has no bound"]
    return [*lines, f"μ is at least {quantity(found.bound_for_all_t, MU)} at every time"] if excited else lines
