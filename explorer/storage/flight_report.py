"""A recorded flight judged: was it informative, and what do the observers make of its ranges? No viser here.

The same functions as `rangenav log`: still.world_of → logs.informative → logs.observe.
"""

import math
from dataclasses import dataclass
from typing import Literal

from rangenav import flight_summary, logs, rest
from rangenav.flight_summary import ObserverSummary, WindowSummary
from rangenav.formats import Flight, recorded_flight
from rangenav.inputs import Input, Vec3, require, require_within
from rangenav.preset import MAX_DURATION

Ranges = Literal["measured", "synthetic"]
WorldSource = Literal["", "still", "given"]
"""Where gravity and field come from: the file, its still start, or a person."""


class FlightOptions(Input, frozen=True, kw_only=True):
    """What a person decides about a flight."""

    anchor: Vec3
    """m, inertial."""
    source: WorldSource = ""
    gravity: Vec3 = (0.0, 0.0, -9.81)
    """m/s², inertial; used if given."""
    magnetic: Vec3 = (1.0, 0.0, 0.0)
    """Direction, inertial; used if given."""
    ranges: Ranges = "measured"
    range_sigma: float = 0.1
    """m"""
    window: float = 6.0
    """s"""
    position_sigma: float = 0.5
    """m: above it a window is weak."""
    begin: float = 0.0
    end: float | None = None
    """s: what is judged of the record, None to its end; at rest nothing is told but which way is down."""

    def __post_init__(self) -> None:
        super().__post_init__()
        require_within("the ranges' noise", self.range_sigma, 1e-3, 1e2, "m")
        require_within("the window", self.window, 0.1, MAX_DURATION, "s")
        if self.end is not None:
            require(self.begin < self.end, f"the part must begin before it ends, got {self.begin:g} to {self.end:g} s")
        require(self.position_sigma > 0, f"the position error asked for must be positive, got {self.position_sigma:g}")
        if self.source == "given":
            require(any(self.magnetic), "the magnetic field must be a direction, got 0, 0, 0")
            require(any(self.gravity), "gravity must not be zero")


@dataclass(frozen=True, eq=False)
class FlightReport:
    """The answer."""

    summary: str
    """Where the record was informative."""
    verdict: str
    windows: WindowSummary
    observer: ObserverSummary | None
    """None without ranges."""
    world_source: str
    """Where gravity and field come from."""


def judge(flight: Flight, asked: FlightOptions) -> FlightReport:
    """Raises ValueError with one sentence if something is still open or cannot be done."""
    if asked.ranges == "synthetic":
        flight = recorded_flight.with_ranges(flight, asked.anchor, sigma=asked.range_sigma, seed=0)
    x, y, z = asked.magnetic
    length = (x * x + y * y + z * z) ** 0.5 or 1.0
    given = (asked.gravity, (x / length, y / length, z / length)) if asked.source == "given" else None
    world, questions, told = rest.world_of(flight, anchor=asked.anchor, given=given, confirmed=asked.source == "still")
    if len(flight.range) and questions:
        raise ValueError(f"{questions[0].asks}? {questions[0].evidence}: choose above where they come from")
    noise = rest.noise_at_rest(flight)  # like the world, from the whole record: from where it rests
    flight = recorded_flight.between(flight, asked.begin, math.inf if asked.end is None else asked.end)
    seen = logs.informative(
        flight, window=asked.window, range_sigma=asked.range_sigma, requirement=asked.position_sigma, noise=noise
    )
    observed = None
    if len(flight.range) and world is not None:
        sensors = logs.sensors_of(flight, range_sigma=asked.range_sigma)
        observed = flight_summary.summarise_observer(logs.observe(flight, world, sensors=sensors))
    return FlightReport(seen.words, seen.verdict, flight_summary.summarise_windows(seen), observed, told)


def world_evidence(flight: Flight) -> tuple[WorldSource, str]:
    """Where gravity and field may come from, and what the record itself says about them."""
    world, questions, told = rest.world_of(flight, anchor=(0.0, 0.0, 0.0))
    if world is not None:
        return "", told
    question = questions[0]
    return ("still" if question.suggestion == "still" else "given"), question.evidence
