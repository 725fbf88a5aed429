"""One value or several of every family of signals, for tests that hold for all of them."""

import csv
import math
import os
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from rangenav.signals import (
    Formula,
    MinimumSnap,
    Multisine,
    Piece,
    Polynomials,
    Signal,
    Sum,
    Tone,
    Waypoint,
    Waypoints,
    polynomials,
)
from rangenav.signals.base import SignalBase

SHARED_DATA = "RANGENAV_SHARED_DATA"
"""An environment variable: a folder of others' files, with uav_trajectories' in polynomial/; else ../shared/data."""
POLYNOMIAL_FILES = "RANGENAV_POLYNOMIAL_FILES"
"""An environment variable: the folder of uav_trajectories files itself."""


def timed(*, seed: int = 1, count: int = 7, end: float = 12.0, begin: float = 0.0) -> tuple[Waypoint, ...]:
    """Random points at uneven times."""
    rng = np.random.default_rng(seed)
    gaps = rng.uniform(0.5, 1.5, count - 1)
    time = begin + np.concatenate([[0.0], np.cumsum(gaps) / gaps.sum()]) * (end - begin)
    return tuple(Waypoint(time=float(t), value=tuple(rng.normal(size=3).tolist())) for t in time)


MULTISINE = Multisine(
    tones=(
        Tone(axis="x", amplitude=1.0, frequency=2.0, phase=math.pi / 2),
        Tone(axis="y", amplitude=0.3, frequency=4.0, phase=0.3),
        Tone(axis="z", amplitude=-0.4, frequency=6.0),
    ),
    offset=(0.5, -2.0, 3.0),
    drift=(-0.1, 0.25, 0.0),
)
WAYPOINTS = Waypoints(points=timed())
LOOP = Waypoints(points=timed(seed=2, end=10.0, begin=0.5), period=11.0)
MINIMUM_SNAP = MinimumSnap(points=timed(seed=3))
MINIMUM_SNAP_LOOP = MinimumSnap(points=timed(seed=4, end=10.0), period=12.0)
FORMULA = Formula(
    x="cos(2*t) + t/4",
    y="exp(-t/8)*sin(3*t)/(2 + cos(t))",
    z="sqrt(1 + t**2)*tanh(sin(t)) - atan(t - 5)",
    slower=1.5,
    mix=((0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.5, 2.0)),
    offset=(1.0, 2.0, 3.0),
    drift=(0.5, 0.0, -0.25),
)
PERIODIC_FORMULA = Formula(x="2*cos(3*t) - t", y="sin(2*t)**3/(2 + cos(4*t))", z="exp(sin(t))")
POLYNOMIALS = polynomials.from_minimum_snap(MINIMUM_SNAP)
SUM = Sum(base=WAYPOINTS, wiggle=MULTISINE, offset=(0.0, 1.0, 0.0), drift=(0.1, 0.0, -0.2))

EXAMPLES: dict[str, Signal] = {
    "multisine": MULTISINE,
    "waypoints": WAYPOINTS,
    "closed waypoints": LOOP,
    "minimum snap": MINIMUM_SNAP,
    "closed minimum snap": MINIMUM_SNAP_LOOP,
    "formula": FORMULA,
    "periodic formula": PERIODIC_FORMULA,
    "polynomials": POLYNOMIALS,
    "sum": SUM,
    "sum of periodic": Sum(
        base=LOOP, wiggle=Multisine(tones=(Tone(axis="z", amplitude=0.1, frequency=4 * math.pi / 11),))
    ),
    "two waypoints": Waypoints(points=timed(count=2)),
    "standing still": Waypoints(points=tuple(Waypoint(time=float(k), value=(1.0, 2.0, 3.0)) for k in range(3))),
}

BLIND = ("two waypoints", "standing still")
"""Examples that a range does not observe: they stand still, or move in a plane or along a line."""


def keeps_its_family(signal: Signal) -> bool:
    """Whether every edit of a signal is of the same family; what relies on `equivalent` becomes that signal instead."""
    return all(type(part).equivalent is SignalBase.equivalent for part in signal.parts())


def polynomial_file(name: str) -> Polynomials:
    """A file of uav_trajectories, which is not in the repository; skips the test if the file is missing."""
    shared = Path(os.environ.get(SHARED_DATA, Path(__file__).parents[3] / "shared" / "data"))
    path = Path(os.environ.get(POLYNOMIAL_FILES, shared / "polynomial")) / name
    if not path.is_file():
        pytest.skip(f"{name} is not there; {SHARED_DATA} may name the folder above polynomial/{name}")
    with path.open(newline="") as file:
        rows = [[float(entry) for entry in row if entry.strip()] for row in list(csv.reader(file))[1:]]
    return Polynomials(pieces=tuple(_piece(row) for row in rows if row))


def _piece(row: list[float]) -> Piece:
    return Piece(duration=row[0], x=eight(row[1:9]), y=eight(row[9:17]), z=eight(row[17:25]), yaw=eight(row[25:33]))


def eight(row: Sequence[float]) -> polynomials.Coefficients:
    """The coefficients of one axis of a piece, ascending."""
    a, b, c, d, e, f, g, h = row
    return a, b, c, d, e, f, g, h
