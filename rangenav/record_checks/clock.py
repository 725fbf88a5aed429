"""The stamps of the IMU: gaps over which nothing can be integrated, and a rate too low for the turns of the body.

The trapezoidal rule turns the body by ½ h (ω(t) + ω(t + h)): it needs |ω| h well below 1 rad, at every step.
"""

import numpy as np
from jaxtyping import Int
from numpy import ndarray as Array

from rangenav.formats.recorded_flight import Flight, between
from rangenav.number_format import significant
from rangenav.record_checks.check import Evidence

LONG_GAP, LONG_STEPS = 0.25, 8.0
"""A gap of more seconds and of more usual steps than these is asked about."""
LOWEST_USUAL = 2.0
"""Hz: stamps in s of a lower rate may be stamps in ms."""
LARGEST_TURN = 0.5
"""rad: the largest turn per step of the IMU that is integrated; at most a twentieth of the steps may turn more."""


def _gaps(flight: Flight) -> Int[Array, "k"]:
    """The last sample before each long gap."""
    steps = np.diff(flight.time)
    return np.flatnonzero(steps > max(LONG_GAP, LONG_STEPS * float(np.median(steps))))


def longest_part(flight: Flight) -> tuple[float, float]:
    """Begin and end (s) of the longest part of a record without a gap."""
    edges = np.concatenate([[0], _gaps(flight) + 1, [len(flight.time)]])
    longest = int(np.argmax(flight.time[edges[1:] - 1] - flight.time[edges[:-1]]))
    return float(flight.time[edges[longest]]), float(flight.time[edges[longest + 1] - 1])


def without_gaps(flight: Flight) -> Flight:
    """The longest part of a record without a gap; the record itself if it has none."""
    return between(flight, *longest_part(flight)) if len(_gaps(flight)) else flight


def gaps(flight: Flight) -> Evidence | None:
    """Gaps of the IMU: what the body did there is not known."""
    found = _gaps(flight)
    if len(found) == 0:
        return None
    time = flight.time
    worst = int(found[np.argmax(time[found + 1] - time[found])])
    begin, end = longest_part(flight)
    before, after = (_place(flight, k) for k in (worst, worst + 1))
    more = "" if len(found) == 1 else f" ({len(found)} such gaps)"
    text = (
        f"no rows of the IMU for {time[worst + 1] - time[worst]:.3g} s between {before} and {after}{more}, over which "
        f"nothing can be integrated; longest uses the part from {begin:.6g} s to {end:.6g} s, begin and end cut "
        "anywhere"
    )
    return Evidence(text=text, suggestion="longest")


def _place(flight: Flight, k: int) -> str:
    line = "" if flight.lines is None else f"line {int(flight.lines[k])} at "
    return f"{line}{flight.time[k]:.6g} s"


def rate(flight: Flight) -> Evidence | None:
    """An IMU that is sampled too rarely for the turns of the body."""
    turn = np.diff(flight.time) * np.linalg.norm(flight.gyro, axis=-1)[1:]
    usual = float(np.quantile(turn, 0.95))
    if usual <= LARGEST_TURN:
        return None
    hertz = float(1 / np.median(np.diff(flight.time)))
    text = (
        f"the IMU's rate of {significant(hertz)} Hz is too low for this motion: the body turns by up to "
        f"{significant(usual)} rad between two samples, and at most {LARGEST_TURN:g} rad can be integrated"
    )
    if flight.units.get("time", "s") == "s" and hertz <= LOWEST_USUAL:
        text += f"; --time-unit ms, if the stamps are in ms ({significant(1e3 * hertz)} Hz)"
    return Evidence(text=text, suggestion=None)
