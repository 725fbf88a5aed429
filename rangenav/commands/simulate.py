"""`rangenav simulate`: the cascaded observer on a preset."""

from pathlib import Path
from typing import Annotated, Literal

import msgspec
import tyro

from rangenav import preset as presets
from rangenav.commands.output import PresetName, print_json, require_place
from rangenav.commands.progress import counting, working
from rangenav.inputs import require

MAX_RUNS = 10_000


def simulate(
    preset: PresetName,
    *,
    seed: int | None = None,
    runs: int = 1,
    model: Literal["derived", "printed"] = "derived",
    save: Annotated[Path | None, tyro.conf.arg(metavar="RUN.npz")] = None,
    json: bool = False,
) -> None:
    """Simulate a preset, run the cascaded observer on it and say how well it did.

    Example: rangenav simulate paper-slow --runs 20

    "Consistent" is said of the ranges only; the page docs/trust.md says what to think of each word. Gains are constant
    unless the preset has the line mode = "noise-matched" under [gains]: then they follow the stated noise.

    Args:
        preset: A shipped preset's name or a path to a TOML file.
        seed: Seed of the noise; the preset's own by default.
        runs: Number of seeds, counted up from the first; figures are their medians.
        model: The derived model, or the paper's printed one.
        save: Write every array of the first run here.
        json: Print one JSON object.
    """
    from rangenav import record, report
    from rangenav.commands.text import layout
    from rangenav.commands.text import simulate as text

    chosen = presets.load(preset)
    if seed is not None:
        chosen = msgspec.structs.replace(chosen, seed=seed)
    require(1 <= runs <= MAX_RUNS, f"--runs must lie between 1 and {MAX_RUNS}, got {runs}")
    require_place("--save", save, ".npz")
    with working(f"simulating {preset}"):
        record.run_seed(chosen, chosen.seed, form=model)  # so that no timed run waits for the compiler
        first = record.run_seed(chosen, chosen.seed, form=model)
    others = []
    with counting(f"simulating {runs} runs") as done:
        for k in range(1, runs):
            others.append(record.run_seed(chosen, chosen.seed + k, form=model).summary)
            done(k / (runs - 1))
    if save is not None:
        record.save(first, save)
    answer = report.simulation_report(first, others, name=preset)
    return print_json(answer) if json else layout.show(text.report(chosen, answer, name=preset, saved=save))
