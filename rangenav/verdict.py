"""The verdict on a motion: blind, weak, observable, or not judged, and then why not.

The library, the command line, the page and the certificates all take it from `judge`.
"""

import math
from dataclasses import dataclass
from typing import Literal

from rangenav import continuity, provenance
from rangenav.model import STATES
from rangenav.provenance import Source
from rangenav.signals import Signal

Word = Literal["blind", "weak", "observable", "not judged"]


@dataclass(frozen=True, kw_only=True)
class Verdict:
    """What one range can tell of a motion."""

    word: Word
    """blind: rank below 13; weak: full rank, but the predicted error exceeds the requirement; observable: neither."""
    reason: str = ""
    """One clause that says why the motion is not judged; empty where it is."""

    @property
    def judged(self) -> bool:
        """Whether the path is one whose excitation may be judged."""
        return self.word != "not judged"

    def __str__(self) -> str:
        return self.word if self.judged else f"{self.word}: {self.reason}"


def judge(rank: int, position_sigma: float | None, required_sigma: float, *, restriction: str | None = None) -> Verdict:
    """The verdict on a motion.

    rank: of the lifted Gramian (of 13) on the worst window.
    position_sigma: predicted 1-σ position error (m) at the end of the worst window; None or NaN if undetermined.
    required_sigma: the largest error (m) that the requirement allows.
    restriction: why the motion is not judged at all, if it is not; see `restriction`.
    """
    if restriction is not None:
        return Verdict(word="not judged", reason=restriction)
    if rank < STATES:
        return Verdict(word="blind")
    accurate = position_sigma is not None and math.isfinite(position_sigma) and position_sigma <= required_sigma
    return Verdict(word="observable" if accurate else "weak")


def restriction(path: Signal, source: Source | None, duration: float) -> str | None:
    """Why a path is not judged, as one clause: its snap comes from a fit, or it jumps. None if the path is judged.

    source: the file that the path was imported from, if it was. duration: of the flight, s.
    """
    return provenance.restriction(source, path) or continuity.discontinuity(path, duration)
