"""`rangenav tune`: gains by search, for a stated trade between settling soon and being exact afterwards."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import msgspec
import numpy as np
import tyro
from rich.console import Console
from rich.progress import Progress
from rich.table import Table
from rich.text import Text

from rangenav import preset as presets
from rangenav.commands.output import PresetName, flattened, print_json, readable
from rangenav.inputs import require

if TYPE_CHECKING:
    from rangenav.tradeoff import Measure, Point
    from rangenav.tune import Tuned

WORDS = {
    "settled": "share of runs that settle",
    "settle_position_s": "position settles, s",
    "settle_attitude_s": "attitude settles, s",
    "steady_position": "steady position, m",
    "steady_attitude_deg": "steady attitude, °",
}
"""What the keys of a result mean, for people."""
SIDES = ("before", "after")


def tune(
    preset: PresetName,
    *,
    runs: int = 8,
    evaluations: int = 300,
    steadiness: float = 0.5,
    output: Annotated[Path | None, tyro.conf.arg(aliases=["-o"], metavar="TUNED.toml")] = None,
    overwrite: bool = False,
    json: bool = False,
) -> None:
    """Search for gains that settle soon and are exact afterwards, and judge them on seeds the search has not seen.

    Args:
        preset: A shipped preset's name or a path to a TOML file.
        runs: Number of training seeds, and of held-out ones.
        evaluations: How many gains are tried.
        steadiness: What exactness counts, 0 to 1; the rest is what settling soon counts.
        output: Write the preset with the gains found here.
        overwrite: Replace the file if it exists.
        json: Print one JSON object.
    """
    from rangenav import tune as search

    chosen = presets.load(preset)
    if output is not None:
        _refuse_output(output, overwrite)
    # the command's own stderr is kept for complaints; a person at a terminal sees the bar on the real one
    console = Console(file=sys.__stderr__)
    with Progress(console=console, transient=True, disable=json or not console.is_terminal) as bar:
        task = bar.add_task("searching", total=1.0)
        found = search.tune(
            chosen,
            runs=runs,
            evaluations=evaluations,
            steadiness=steadiness,
            progress=lambda share: bar.update(task, completed=share),
        )
    if output is not None:
        presets.save(found.preset, output)
    report = tuning_report(found, before=chosen, name=preset, runs=runs, output=output)
    return print_json(report) if json else _print(report)


def tuning_report(
    found: "Tuned", *, before: presets.Preset, name: str, runs: int, output: Path | None
) -> dict[str, Any]:
    """What `rangenav tune --json` prints."""
    first = before.seed
    return {
        "preset": name,
        "runs": runs,
        "evaluations": len(found.seen),
        "steadiness": found.steadiness,
        "objective": {
            "before": found.before.objective(found.steadiness),
            "after": found.after.objective(found.steadiness),
        },
        "gains": {"before": msgspec.to_builtins(before.gains), "after": msgspec.to_builtins(found.preset.gains)},
        "training": {"before": _reached(found.before), "after": _reached(found.after)},
        "held_out": {
            "seeds": [first, first + runs - 1],
            "before": _reached(found.held_out_before),
            "after": _reached(found.held_out_after),
        },
        "starts_held": {"before": found.starts_before, "after": found.starts_after},
        "curve": {
            "position": _curve(found, "settle_position", "steady_position", 1.0, "m"),
            "attitude": _curve(found, "settle_attitude", "steady_attitude", float(np.degrees(1)), "°"),
        },
        "saved": None if output is None else str(output),
    }


def _print(report: dict[str, Any]) -> None:
    """The same for people: before beside after, then the trade-off curves."""
    table = Table("", "before", "after", title=Text(f"{report['preset']}: {report['evaluations']} gains tried"))
    for title, group in (("training seeds", report["training"]), ("held-out seeds", report["held_out"])):
        table.add_section()
        for key, words in WORDS.items():
            table.add_row(f"{title}: {words}", *(readable(group[side][key]) for side in SIDES))
    table.add_section()
    table.add_row("share of random starts held", *(readable(report["starts_held"][side]) for side in SIDES))
    table.add_row("objective, training seeds", *(readable(report["objective"][side]) for side in SIDES))
    table.add_section()
    before, after = (dict(flattened(report["gains"][side])) for side in SIDES)
    for key, value in before.items():
        if after[key] != value:
            table.add_row(key, value, after[key])
    console = Console()
    console.print(table)
    for part, points in report["curve"].items():
        console.print(f"{part}, where none of the gains tried does better in both:")
        for point in points:
            console.print(f"  {point['words']}")
    if report["saved"] is not None:
        console.print(Text(f"saved as {report['saved']}"))


def _reached(point: "Point") -> dict[str, float]:
    return {
        "settled": point.settled,
        "settle_position_s": point.settle_position,
        "settle_attitude_s": point.settle_attitude,
        "steady_position": point.steady_position,
        "steady_attitude_deg": float(np.degrees(point.steady_attitude)),
    }


def _curve(found: "Tuned", settle: "Measure", steady: "Measure", factor: float, unit: str) -> list[dict[str, Any]]:
    from rangenav.tradeoff import front

    points = []
    for point in front(found.seen, settle, steady):
        at, error = getattr(point, settle), factor * getattr(point, steady)
        words = f"settles at {at:.3g} s, then {error:.3g} {unit}"
        points.append({"settle_s": at, "steady": error, "words": words, "gains": msgspec.to_builtins(point.gains)})
    return points


def _refuse_output(path: Path, overwrite: bool) -> None:
    """Before the work and not after it."""
    require(path.suffix == ".toml", f"--output must name a file that ends in .toml, got {path}")
    require(path.parent.is_dir(), f"--output {path}: no such folder")
    require(overwrite or not path.exists(), f"--output {path}: exists already; --overwrite replaces it")
