"""`rangenav repair` for a person."""

from pathlib import Path

from rangenav.commands.text import layout
from rangenav.commands.text.layout import Report, group
from rangenav.commands.text.verdict import Json, plus_minus
from rangenav.number_format import quantity, shortened, significant
from rangenav.preset import Preset
from rangenav.vehicle import FREE

UNCHANGED = "nothing needs repair: every requirement is met"


def report(preset: Preset, answer: Json, *, name: str, written: Path | None) -> Report:
    """What was changed, and what that achieves; `answer` is the command's JSON object."""
    before, after, needed = answer["before"], answer["after"], preset.requirement
    typed = layout.argument(written or name)
    earlier = f"μ {quantity(before['mu'], 'm²/s⁷')}, position {plus_minus(before['position_sigma'])}"
    wanted = quantity(needed.position_sigma, "m")
    limits = f"the limits of {preset.vehicle.name}"
    flown = f"✓ within {limits}" if after["flyable"] else f"✗ beyond {limits}"
    if preset.vehicle == FREE:
        flown = "no vehicle is chosen, so no limit applies"
    mu, rank = (" (sampled)" if figure in after["sampled"] else "" for figure in ("mu", "rank"))
    again = () if written else (f"repair {typed} --by {answer['by']} -o repaired.toml",)
    export = (f"export {typed} --to {answer['export']} -o flight.csv",) if written and "export" in answer else ()
    changed = (*again, *export, f"analyze {typed}", *((f"simulate {typed}",) if written else ()))
    following = changed if answer["changed"] else (f"simulate {typed}", f"certify {typed}")
    return Report(
        subject=layout.subject(name),
        sign="✓" if after["certified"] else "!",
        answer=shortened(answer["words"]) if answer["changed"] else UNCHANGED,
        title=preset.title,
        groups=(
            *group("before", earlier if answer["changed"] else None),
            *group(
                "after" if answer["changed"] else "as it is",
                f"μ {quantity(after['mu'], 'm²/s⁷')}{mu}, required {significant(needed.mu)}",
                f"rank {after['rank']} of 13{rank}",
                f"position {plus_minus(after['position_sigma'])}, required of this prediction ±{wanted}",
                "✓ certified" if after["certified"] else "✗ not certified",
            ),
            *group(
                "can it be flown",
                flown,
                f"{significant(after['thrust_to_weight'])} × weight in thrust at most",
            ),
            *group("the search", f"{answer['evaluations']} motions tried" if answer["changed"] else None),
            *group("written", str(written) if written else None),
            *layout.next_commands(*following),
        ),
    )
