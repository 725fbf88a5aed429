"""Frame, gravity, field and anchor of a run, in comments of its table: `# anchor = 0.0 0.0 0.1`."""

import re

from rangenav.formats.exported_run import ExportedRun
from rangenav.formats.recorded_flight import Frame
from rangenav.formats.text import Table
from rangenav.inputs import Vec3, require

VECTORS = ("gravity", "magnetic", "anchor")
"""m/s², a direction, and m; inertial axes."""
WORLD = re.compile(r"(gravity|magnetic|anchor)\s*=\s*(\S+)\s+(\S+)\s+(\S+)")
FRAME = re.compile(r"frame\s*=\s*(z-up|z-down)")
LARGEST = 1e9


def written(run: ExportedRun) -> list[str]:
    """The comments of a run, one line each."""
    frame = [f"# frame = {run.frame}"] if run.frame else []
    return [*frame, *(f"# {name} = " + " ".join(repr(value) for value in getattr(run, name)) for name in VECTORS)]


def frame(table: Table) -> Frame | None:
    """Which way z points, if a comment says so."""
    for comment in table.comments:
        if match := FRAME.fullmatch(comment):
            return "z-up" if match[1] == "z-up" else "z-down"
    return None


def vectors(table: Table) -> dict[str, Vec3]:
    """Gravity, field and anchor, as far as comments say. Raises ValueError for what is no vector."""
    stated: dict[str, Vec3] = {}
    for comment in table.comments:
        if match := WORLD.fullmatch(comment):
            try:
                x, y, z = (float(part) for part in match.groups()[1:])
            except ValueError:
                raise ValueError(f"{table.source}: {match[1]} must be three numbers, got {comment[:60]!r}") from None
            fine = all(abs(value) <= LARGEST for value in (x, y, z))
            require(fine, f"{table.source}: {match[1]} must be three finite numbers, got {comment[:60]!r}")
            stated[match[1]] = (x, y, z)
    return stated
