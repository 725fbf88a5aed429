"""`rangenav tune`: gains by search, for a stated tradeoff between settling time and steady error."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import msgspec
import numpy as np
import tyro

from rangenav import preset as presets
from rangenav.commands.output import PresetName, print_json
from rangenav.commands.progress import counting
from rangenav.inputs import require

if TYPE_CHECKING:
    from rangenav.tradeoff import Measure, Point
    from rangenav.tune import Tuned


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

    Example: rangenav tune paper-slow -o tuned.toml

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
    from rangenav.commands.text import layout
    from rangenav.commands.text import tune as text

    chosen = presets.load(preset)
    if output is not None:
        _refuse_output(output, overwrite)
    with counting(f"searching gains for {preset}") as progress:
        tuned = search.tune(chosen, runs=runs, evaluations=evaluations, steadiness=steadiness, progress=progress)
    if output is not None:
        presets.save(tuned.preset, output)
    answer = tuning_report(tuned, before=chosen, name=preset, runs=runs, output=output)
    return print_json(answer) if json else layout.show(text.report(answer, name=preset))


def tuning_report(
    tuned: "Tuned", *, before: presets.Preset, name: str, runs: int, output: Path | None
) -> dict[str, Any]:
    """The JSON object of `rangenav tune`: before and after the search, training and held-out seeds, tradeoff curves."""
    first = before.seed
    return {
        "preset": name,
        "runs": runs,
        "evaluations": len(tuned.points),
        "steadiness": tuned.steadiness,
        "objective": {
            "before": tuned.before.objective(tuned.steadiness),
            "after": tuned.after.objective(tuned.steadiness),
        },
        "gains": {"before": msgspec.to_builtins(before.gains), "after": msgspec.to_builtins(tuned.preset.gains)},
        "training": {"before": _measures(tuned.before), "after": _measures(tuned.after)},
        "held_out": {
            "seeds": [first, first + runs - 1],
            "before": _measures(tuned.held_out_before),
            "after": _measures(tuned.held_out_after),
        },
        "starts_held": {"before": tuned.starts_before, "after": tuned.starts_after},
        "curve": {
            "position": _curve(tuned, "settle_position", "steady_position", 1.0, "m"),
            "attitude": _curve(tuned, "settle_attitude", "steady_attitude", float(np.degrees(1)), "°"),
        },
        "saved": None if output is None else str(output),
    }


def _measures(point: "Point") -> dict[str, float]:
    return {
        "settled": point.settled,
        "settle_position_s": point.settle_position,
        "settle_attitude_s": point.settle_attitude,
        "steady_position": point.steady_position,
        "steady_attitude_deg": float(np.degrees(point.steady_attitude)),
    }


def _curve(tuned: "Tuned", settle: "Measure", steady: "Measure", factor: float, unit: str) -> list[dict[str, Any]]:
    from rangenav.tradeoff import front

    points = []
    for point in front(tuned.points, settle, steady):
        at, error = getattr(point, settle), factor * getattr(point, steady)
        words = f"settles at {at:.3g} s, then {error:.3g} {unit}"
        points.append({"settle_s": at, "steady": error, "words": words, "gains": msgspec.to_builtins(point.gains)})
    return points


def _refuse_output(path: Path, overwrite: bool) -> None:
    """Raise ValueError for an output that cannot be written: before the search, not after it."""
    require(path.suffix == ".toml", f"--output must name a file that ends in .toml, got {path}")
    require(path.parent.is_dir(), f"--output {path}: no such folder")
    require(overwrite or not path.exists(), f"--output {path}: exists already; --overwrite replaces it")
