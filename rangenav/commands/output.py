"""What every command prints: one JSON object, or the same report as a table for people."""

import json
from pathlib import Path
from typing import Annotated, Any

import tyro
from rich.console import Console
from rich.table import Table
from rich.text import Text

from rangenav.inputs import require

PresetName = Annotated[tyro.conf.Positional[str], tyro.conf.arg(metavar="PRESET")]
"""A shipped preset's name or a path to a TOML file."""
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


def print_json(report: dict[str, Any]) -> None:
    """Exactly one JSON object on stdout; a number that is not finite is an error of ours, not output."""
    print(json.dumps(report, allow_nan=False, ensure_ascii=False))


def require_place(flag: str, path: Path | None, suffix: str) -> None:
    """Refuse a file that could not be written or would be called otherwise: before the work and not after it."""
    if path is not None:
        require(path.suffix == suffix, f"{flag} must name a file that ends in {suffix}, got {path}")
        require(path.parent.is_dir(), f"{flag} {path}: no such folder")


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
        elif isinstance(value, list) and value and isinstance(value[0], str):
            rows += [(f"{prefix}{key}", sentence) for sentence in value]
        else:
            rows.append((prefix + key, readable(value, floor if key in ("mu", "eigenvalues") else 0.0)))
    return rows


def readable(value: Any, floor: float = 0.0) -> str:
    """A number to four figures, a list of them with spaces, null as a dash, rounding noise as what it is."""
    if isinstance(value, list):
        return "  ".join(readable(entry, floor) for entry in value) or "none"
    if isinstance(value, float):
        return "< floor" if floor > 0 and value < floor else f"{value:.4g}"
    return "–" if value is None else str(value)
