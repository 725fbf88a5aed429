"""The whole of a recorded flight: whether it determines the position at all, and how long a window must be for that.

Windows that are too short are blind although the flight is not. So the whole record is judged first. The noise of the
IMU, integrated over all of it, may hide what a part of it determines. Then the record is judged by the window that
predicts the smallest error, or, where the ranges of no window determine the position, by the one whose motion has the
highest rank.
"""

import numpy as np

from rangenav import model
from rangenav.formats.recorded_flight import Flight
from rangenav.logs.sliding import LENGTHS, looks, starts
from rangenav.logs.windows import FEW, WINDOWS, Criteria, Curves, Informative, WindowVerdict, curves, judged
from rangenav.results import result


@result
class WholeRecord:
    """The verdict on a record as a whole."""

    verdict: WindowVerdict
    begin: float
    """s, of the part that the verdict is on: the whole record, or the window that determines most."""
    end: float
    all_of_it: bool
    """Whether that part is the whole record."""
    rank: int
    """Of 13, of the ranges of that part."""
    motion_rank: int
    """Of 13, that ranges at every time of that part would have."""
    ranges: int
    """Of that part."""
    position: float | None
    """m, predicted 1-σ position at its end; None where it is not determined."""
    suffices: float | None
    """s, the shortest of the windows tried that is observable wherever it lies; None if there is none."""
    shortest: float | None
    """s, the shortest of the windows tried that is observable somewhere."""
    restriction: str | None = None
    """Why the record is not judged; None if it is."""

    @property
    def blind(self) -> bool:
        """Whether the ranges leave the position undetermined."""
        return self.verdict in ("blind", FEW)

    @property
    def summary(self) -> str:
        """The verdict, and the length of window that suffices, as a sentence."""
        if self.restriction is not None:
            return f"not judged: {self.restriction}"
        part = "the whole record" if self.all_of_it else f"its part from {self.begin:.4g} to {self.end:.4g} s"
        if self.position is not None:
            first = f"{part} determines the position within {self.position:.3g} m"
        elif self.verdict == FEW:
            count = "no range" if self.ranges == 0 else f"{self.ranges} of the {model.STATES} ranges that are needed"
            return f"{part} has {count}; its motion has rank {model.STATES}"
        elif self.motion_rank < model.STATES:
            first = f"the motion of {part} has rank {self.motion_rank} of {model.STATES}"
        else:
            first = f"the ranges of {part} have rank {self.rank} of {model.STATES}"
        if self.suffices is not None:
            return f"{first}; windows of {self.suffices:g} s suffice wherever they lie"
        if self.shortest is not None:
            return f"{first}; some windows of {self.shortest:g} s suffice, and no length suffices everywhere"
        return f"{first}; no length of window suffices"


def whole(
    flight: Flight,
    *,
    range_sigma: float,
    requirement: float,
    noise: tuple[float, float, float] | None,
    restriction: str | None = None,
) -> WholeRecord:
    """Judge a record as a whole. The arguments are those of `informative`."""
    criteria = Criteria(range_sigma=range_sigma, requirement=requirement, restriction=restriction)
    record = curves(flight, noise)
    begin, length = float(flight.time[0]), float(flight.time[-1] - flight.time[0])
    best = every = judged(record, np.array([begin]), length, criteria)
    at, suffices, shortest = 0, None, None
    for window in LENGTHS if restriction is None else ():
        if window >= length or (suffices is not None and best.each[at] == "observable"):
            break
        informative = looks(record, window, criteria)
        if shortest is None and "observable" in informative.each:
            shortest = window
        if suffices is None and informative.verdict == "observable" and _confirmed(record, flight, window, criteria):
            suffices = window
        k = min(range(len(informative.each)), key=lambda k: _order(informative, k))
        if every.each[0] != "observable" and _order(informative, k) < _order(best, at):
            best, at = informative, k
    position = float(best.sigma[at])
    return WholeRecord(
        verdict=best.each[at],
        begin=float(best.start[at]),
        end=float(best.start[at] + best.window),
        all_of_it=best is every,
        rank=int(best.rank[at]),
        motion_rank=int(best.motion_rank[at]),
        ranges=int(best.ranges[at]),
        position=position if np.isfinite(position) else None,
        suffices=suffices,
        shortest=shortest,
        restriction=restriction,
    )


def _confirmed(record: Curves, flight: Flight, window: float, criteria: Criteria) -> bool:
    return judged(record, starts(flight, window, WINDOWS), window, criteria).verdict == "observable"


def _order(informative: Informative, k: int) -> tuple[float, ...]:
    """Smaller for a window that determines more: by its predicted error, else by rank, ranges, length and motion."""
    sigma = float(informative.sigma[k])
    ranks = (-float(informative.motion_rank[k]), -float(informative.rank[k]), -float(informative.ranges[k]))
    least = float(informative.scaled[k, -1])
    return (sigma if np.isfinite(sigma) else np.inf, *ranks, -informative.window, -least)
