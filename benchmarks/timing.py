"""Shared by all benchmarks: repeated timing, the median, a table for people and one line of JSON for programs."""

import importlib.metadata
import json
import platform
import sys
import time
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass

import numpy as np
from rich.console import Console
from rich.table import Table

WIDTH = 110
"""Columns of the table when the output is not a terminal."""


@dataclass(frozen=True, kw_only=True)
class Target:
    """A measured figure and the bound it has to keep."""

    name: str
    value: float
    bound: float
    at_least: bool
    unit: str = ""

    @property
    def met(self) -> bool:
        """Whether the figure keeps its bound."""
        return self.value >= self.bound if self.at_least else self.value <= self.bound

    def __str__(self) -> str:
        rule = f"{'≥' if self.at_least else '≤'} {self.bound:g}{self.unit}"
        return f"{self.name}: {self.value:.3g}{self.unit} ({rule}: {'met' if self.met else 'MISSED'})"


def alternate(calls: Mapping[str, tuple[Callable[[], object], int]], rounds: int) -> dict[str, float]:
    """Median wall-clock time (s) of each named call, made as often as its number says in each of several rounds.

    Taking turns lets whatever else the machine does meet all of them alike. The first call of each is not counted.
    """
    elapsed: dict[str, list[float]] = {name: [] for name in calls}
    for call, _ in calls.values():
        call()
    for _ in range(rounds):
        for name, (call, repeats) in calls.items():
            for _ in range(repeats):
                begin = time.perf_counter()
                call()
                elapsed[name].append(time.perf_counter() - begin)
    return {name: float(np.median(values)) for name, values in elapsed.items()}


def missing(distribution: str) -> str | None:
    """A sentence if the peer is not installed here, None if it is."""
    try:
        importlib.metadata.version(distribution)
    except importlib.metadata.PackageNotFoundError:
        return f'{distribution} is not installed (pip install ".[bench]"): that comparison is left out'
    return None


def versions(*distributions: str) -> dict[str, str]:
    """What ran: Python, the processor's kind, and the version of each distribution that is installed."""
    result = {"python": platform.python_version(), "machine": platform.machine()}
    return result | {name: importlib.metadata.version(name) for name in distributions if missing(name) is None}


def report(
    benchmark: str,
    *,
    title: str,
    columns: tuple[str, ...],
    rows: list[tuple[str, ...]],
    targets: list[Target],
    notes: list[str],
    figures: dict[str, object],
) -> None:
    """Print the table, the targets and the notes, then everything as exactly one JSON line."""
    table = Table(title=title)
    for number, column in enumerate(columns):
        table.add_column(column, justify="right" if number else "left")
    for row in rows:
        table.add_row(*row)
    console = Console() if sys.stdout.isatty() else Console(width=WIDTH)
    console.print(table)
    for line in [*map(str, targets), *notes]:
        console.print(line, highlight=False, markup=False, soft_wrap=True)
    judged = [asdict(target) | {"met": target.met} for target in targets]
    print(json.dumps({"benchmark": benchmark, **figures, "targets": judged, "notes": notes}), flush=True)
