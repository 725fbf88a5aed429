"""`rangenav repair` for a person."""

from pathlib import Path

from rangenav.commands.text import layout
from rangenav.commands.text.layout import Report, group
from rangenav.commands.text.verdict import Json, plus_minus
from rangenav.number_format import quantity, significant
from rangenav.preset import Preset
from rangenav.vehicle import FREE


def report(preset: Preset, answer: Json, *, name: str, written: Path | None) -> Report:
    """What was changed, and what that achieves; `answer` is the command's JSON object."""
    before, after, needed = answer["before"], answer["after"], preset.requirement
    typed = layout.argument(written or name)
    limits = f"the limits of {preset.vehicle.name}"
    flown = f"✓ within {limits}" if after["flyable"] else f"✗ beyond {limits}"
    if preset.vehicle == FREE:
        flown = "no vehicle is chosen, so no limit applies"
    return Report(
        subject=layout.subject(name),
        sign="✓" if after["certified"] else "!",
        answer=layout.three_digits(answer["words"]),
        title=preset.title,
        groups=(
            *group("before", f"μ {quantity(before['mu'], 'm²/s⁷')}, position {plus_minus(before['position_sigma'])}"),
            *group(
                "after",
                f"μ {quantity(after['mu'], 'm²/s⁷')}, required {significant(needed.mu)}; rank {after['rank']} of 13",
                f"position {plus_minus(after['position_sigma'])}, required ±{quantity(needed.position_sigma, 'm')}",
                "✓ certified" if after["certified"] else "✗ not certified",
            ),
            *group(
                "can it be flown",
                flown,
                f"{significant(after['thrust_to_weight'])} × weight in thrust at most",
            ),
            *group("the search", f"{answer['evaluations']} motions tried"),
            *group("written", str(written) if written else None),
            *layout.next_commands(
                *(() if written else (f"repair {typed} --by {answer['by']} -o repaired.toml",)),
                *([f"export {typed} --to {answer['export']} -o flight.csv"] if written and "export" in answer else []),
                f"analyze {typed}",
            ),
        ),
    )
