"""The headless command line: `rangenav presets | analyze | simulate`, everything the page does without a browser.

Exit 0: done. Exit 2: bad input, one line on stderr naming file, field and rule. `--json` prints one object on stdout.
"""

import contextlib
import io
import json
import os
import sys
from pathlib import Path
from typing import Annotated, Any, Literal, NoReturn

import msgspec
import tyro
from rich.console import Console
from rich.table import Table
from rich.text import Text

from rangenav import preset as presets
from rangenav.inputs import require

MAX_RUNS = 10_000
UNITS = {
    **dict.fromkeys(("duration", "window", "at", "position_s", "attitude_s"), "s"),
    **dict.fromkeys(("position", "anchor_distance_min", "range_sigma"), "m"),
    **dict.fromkeys(("speed", "velocity"), "m/s"),
    **dict.fromkeys(("acceleration", "gravity"), "m/s²"),
    "attitude_deg": "°",
    "jerk": "m/s³",
    "snap": "m/s⁴",
    "body_rate": "rad/s",
    "range_rate": "Hz",
    "microseconds_per_step": "µs",
}
app = tyro.extras.SubcommandApp()


@app.command(name="presets")
def list_presets(*, json: bool = False) -> None:
    """List the shipped presets: name, title, expectation.

    Args:
        json: Print one JSON object.
    """
    shipped = presets.shipped()
    if json:
        rows = {name: {"title": p.title, "story": p.story, "expect": p.expect} for name, p in shipped.items()}
        return print_json({"presets": rows})
    table = Table("preset", "title", "expected")
    for name, p in shipped.items():
        table.add_row(name, Text(p.title), p.expect)
    return Console().print(table)


@app.command
def analyze(preset: tyro.conf.Positional[str], *, window: float | None = None, json: bool = False) -> None:
    """Say what a preset's motion lets one range tell: excitation, Gramian, rank, blind directions, accuracy.

    Args:
        preset: A shipped preset's name or a path to a TOML file.
        window: Window δ in seconds; the preset's own by default.
        json: Print one JSON object.
    """
    from rangenav import analysis, report

    chosen = presets.load(preset)
    if window is not None:
        chosen = analysis.with_window(chosen, window, source=f"{preset}, --window")
    found = report.analysis_report(chosen, analysis.analyse(chosen), name=preset)
    return print_json(found) if json else print_table(f"{chosen.title}: {found['verdict']}", found)


@app.command
def simulate(
    preset: tyro.conf.Positional[str],
    *,
    seed: int | None = None,
    runs: int = 1,
    model: Literal["derived", "printed"] = "derived",
    save: Annotated[Path | None, tyro.conf.arg(metavar="RUN.npz")] = None,
    json: bool = False,
) -> None:
    """Simulate a preset, run the cascaded observer on it and say how well it did.

    Args:
        preset: A shipped preset's name or a path to a TOML file.
        seed: Seed of the noise; the preset's own by default.
        runs: Number of seeds, counted up from the first; figures are their medians.
        model: The derived model, or the paper's printed one.
        save: Write every array of the first run here.
        json: Print one JSON object.
    """
    from rangenav import record, report

    chosen = presets.load(preset)
    if seed is not None:
        chosen = msgspec.structs.replace(chosen, seed=seed)
    require(1 <= runs <= MAX_RUNS, f"--runs must lie between 1 and {MAX_RUNS}, got {runs}")
    require(save is None or save.suffix == ".npz", f"--save must name a file that ends in .npz, got {save}")
    record.run_seed(chosen, chosen.seed, form=model)  # so that no timed run waits for the compiler
    first = record.run_seed(chosen, chosen.seed, form=model)
    others = [record.run_seed(chosen, chosen.seed + k, form=model).summary for k in range(1, runs)]
    if save is not None:
        record.save(first, save)
    found = report.simulation_report(first, others, name=preset)
    return print_json(found) if json else print_table(f"{chosen.title}, {model} model", found)


def print_json(report: dict[str, Any]) -> None:
    """Exactly one JSON object on stdout; a number that is not finite is an error of ours, not output."""
    print(json.dumps(report, allow_nan=False, ensure_ascii=False))


def print_table(title: str, report: dict[str, Any]) -> None:
    """The same report for people."""
    table = Table(title=Text(title), show_header=False)
    for key, text in flattened(report):
        table.add_row(key, Text(text), unit(key))  # Text: square brackets in a name or title are no markup
    Console().print(table)


def unit(key: str) -> str:
    """The SI unit of a dotted key, by its most telling word; empty where there is none."""
    if key.startswith("excitation") and ("mu" in key or "eigenvalues" in key or "bound" in key):
        return "m²/s⁷"
    last = key.rsplit(".", 1)[-1].replace("_rmse", "")
    return UNITS.get(last, "")


def flattened(report: dict[str, Any], prefix: str = "") -> list[tuple[str, str]]:
    """Rows of a nested report: dotted key, readable value; numbers below their group's floor say so."""
    rows: list[tuple[str, str]] = []
    floor = report.get("floor", 0.0)
    for key, value in report.items():
        if isinstance(value, dict):
            rows += flattened(value, f"{prefix}{key}.")
        elif isinstance(value, list) and value and isinstance(value[0], dict):
            rows += [(f"{prefix}{key}", str(entry["words"])) for entry in value]
        else:
            rows.append((prefix + key, readable(value, floor if key in ("mu", "eigenvalues") else 0.0)))
    return rows


def readable(value: Any, floor: float = 0.0) -> str:
    """A number to four figures, a list of them with spaces, null as a dash, rounding noise as what it is."""
    if isinstance(value, list):
        return "  ".join(readable(entry, floor) for entry in value) or "none"
    if isinstance(value, float):
        return "< floor" if value < floor else f"{value:.4g}"
    return "–" if value is None else str(value)


def fail(sentence: str) -> NoReturn:
    """Bad input: one line on stderr, exit 2."""
    print(" ".join(sentence.split()), file=sys.stderr)
    raise SystemExit(2)


def main() -> None:
    """Entry point of the `rangenav` script."""
    complaint = io.StringIO()
    try:
        with contextlib.redirect_stderr(complaint):
            app.cli(prog="rangenav", description=__doc__)
            sys.stdout.flush()
    except ValueError as error:
        fail(str(error))
    except BrokenPipeError:  # whoever reads, `head` say, has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except OSError as error:
        fail(f"{error.filename}: {error.strerror}")
    except SystemExit as stop:
        if stop.code == 2:
            fail(usage_error(complaint.getvalue()))
        raise


def usage_error(box: str) -> str:
    """The first paragraph of the parser's framed complaint, as one line."""
    lines = [line.strip("│╭╰╮╯─ \n") for line in box.splitlines()]
    paragraph: list[str] = []
    for line in lines[1:]:
        if line.strip("-"):  # a terminal without box characters draws its rules with hyphens
            paragraph.append(line)
        elif paragraph:
            break
    return " ".join(paragraph).strip() + " (see rangenav --help)"


if __name__ == "__main__":
    main()
