"""The report on a recorded flight: was it informative, and how large are the errors of the observers?

The functions are those of `rangenav log`: record_checks.restriction → rest.world_of → logs.whole → logs.informative →
logs.observe.
"""

import math
from dataclasses import dataclass, replace
from typing import Literal

from rangenav import flight_summary, logs, record_checks, rest
from rangenav.flight_summary import ObserverSummary, WindowSummary
from rangenav.formats import Flight, recorded_flight
from rangenav.inputs import Input, Vec3, require, require_within
from rangenav.logs import WholeRecord
from rangenav.preset import MAX_DURATION

Ranges = Literal["measured", "synthetic"]
WorldSource = Literal["", "still", "given"]
"""Where gravity and field come from: the file, its start at rest, or a person."""

ORIGIN: Vec3 = (0.0, 0.0, 0.0)
"""m; stands for the anchor where there are no ranges, and none is used."""
NO_ANCHOR = "where does the anchor stand? the file does not say: choose “as given below” for it, and give its place"


class FlightOptions(Input, frozen=True, kw_only=True):
    """What a person chooses before a flight is judged."""

    anchor: Vec3 | None = None
    """m, inertial; None: where the file says."""
    source: WorldSource = ""
    gravity: Vec3 = (0.0, 0.0, -9.81)
    """m/s², inertial; used if the source is “given”."""
    magnetic: Vec3 = (1.0, 0.0, 0.0)
    """Direction, inertial; used if the source is “given”."""
    ranges: Ranges = "measured"
    range_sigma: float = 0.1
    """m"""
    window: float = 6.0
    """s"""
    position_sigma: float = 0.5
    """m, the predicted position error above which a window of full rank is weak."""
    begin: float = 0.0
    end: float | None = None
    """s, the part of the record that is judged; None: to its end. A part at rest excites nothing."""

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
    """Windows and observers of one flight."""

    whole: WholeRecord
    """The verdict on the whole record, or why it is not judged."""
    summary: str
    """Where the record was informative."""
    windows: WindowSummary
    observer: ObserverSummary | None
    """None without ranges."""
    ranges_source: str
    """The ranges that were used, and where their anchor comes from, one clause; empty without ranges."""
    world_source: str
    """Where gravity and magnetic field come from, one sentence."""
    failure: str | None
    """Why the observer failed, one clause; None if it did not, or did not run."""
    required: float
    """m, the predicted position error above which a record or a window is weak."""


def judge(flight: Flight, options: FlightOptions) -> FlightReport:
    """Judge a flight. Raises ValueError with one sentence if gravity and field are unknown, or data are missing."""
    synthetic = options.range_sigma if options.ranges == "synthetic" else None
    anchor = options.anchor or flight.anchor
    if anchor is None:
        require(synthetic is None and not len(flight.range), NO_ANCHOR)
        anchor = ORIGIN
    if synthetic is not None:
        flight = recorded_flight.with_ranges(flight, anchor, sigma=synthetic, seed=0)
    x, y, z = options.magnetic
    length = (x * x + y * y + z * z) ** 0.5 or 1.0
    confirmed = options.source == "still"
    chosen = (options.gravity, (x / length, y / length, z / length)) if options.source == "given" else None
    world, questions, source = rest.world_of(flight, anchor=anchor, vectors=chosen, confirmed=confirmed)
    if len(flight.range) and questions:
        raise ValueError(f"{questions[0].asks}? {questions[0].evidence}: choose above where they come from")
    given = {} if chosen is None else {"gravity": chosen[0], "magnetic": chosen[1]}
    noise = rest.noise_at_rest(flight)  # from the whole record, like the world: the judged part may not be at rest
    flight = recorded_flight.between(flight, options.begin, math.inf if options.end is None else options.end)
    restriction = record_checks.restriction(replace(flight, anchor=anchor, **given))
    ranges_source = flight_summary.ranges_source(
        flight, anchor, synthetic=synthetic, anchor_given=options.anchor is not None
    )
    windows = logs.informative(
        flight,
        window=options.window,
        range_sigma=options.range_sigma,
        requirement=options.position_sigma,
        noise=noise,
        restriction=restriction,
    )
    whole = logs.whole(
        flight,
        range_sigma=options.range_sigma,
        requirement=options.position_sigma,
        noise=noise,
        restriction=restriction,
    )
    observed = None
    if len(flight.range) and world is not None:
        sensors = logs.sensors_of(flight, range_sigma=options.range_sigma)
        observed = flight_summary.summarise_observer(logs.observe(flight, world, sensors=sensors))
    failure = None if observed is None else flight_summary.failure(observed, options.position_sigma)
    return FlightReport(
        whole,
        windows.summary,
        flight_summary.summarise_windows(windows),
        observed,
        ranges_source,
        source,
        failure,
        options.position_sigma,
    )


def world_evidence(flight: Flight) -> tuple[WorldSource, str]:
    """The source of gravity and field that the record suggests, and its evidence in a sentence.

    Where the record suggests none, it is the file, which does not say: gravity and field are then asked for.
    """
    world, questions, source = rest.world_of(flight, anchor=ORIGIN)
    if world is not None:
        return "", source
    question = questions[0]
    return ("still" if question.suggestion == "still" else ""), question.evidence
