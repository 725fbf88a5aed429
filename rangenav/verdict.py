"""The verdict on a motion: blind, weak, observable, or not judged, and then why not.

The library, the command line, the page and the certificates all take it from `judge`.
"""

import math
from dataclasses import dataclass
from typing import Literal

from rangenav import continuity, provenance
from rangenav.inputs import Vec3
from rangenav.model import STATES
from rangenav.provenance import Source
from rangenav.signals import Signal

LEAST_GRAVITY, MOST_GRAVITY = 1.0, 30.0
"""m/s²; the Moon has 1.6, Jupiter 24.8."""
Word = Literal["blind", "weak", "observable", "not judged"]


@dataclass(frozen=True, kw_only=True)
class Verdict:
    """What one range can tell of a motion."""

    word: Word
    """blind: rank below 13, or ranges that do not determine the position; weak: neither, but the predicted error
    exceeds the requirement; observable: none of these."""
    reason: str = ""
    """One clause that says why the motion is not judged, or why it is blind for its ranges; empty otherwise."""

    @property
    def judged(self) -> bool:
        """Whether the path is one whose excitation may be judged."""
        return self.word != "not judged"

    def __str__(self) -> str:
        return f"{self.word}: {self.reason}" if self.reason else self.word


def judge(
    rank: int, position_sigma: float | None, required_sigma: float, *, restriction: str | None = None, ranges: str = ""
) -> Verdict:
    """The verdict on a motion.

    rank: of the lifted Gramian (of 13) on the worst window.
    position_sigma: predicted 1-σ position error (m) at the end of the worst window; None, NaN or infinite where its
    ranges do not determine the position: then even a motion of full rank is blind, for these ranges.
    required_sigma: the largest error (m) that the requirement allows.
    restriction: why the motion is not judged at all, if it is not; see `restriction`.
    ranges: a clause on the ranges of the worst window, for the reason; see `for_these_ranges`.
    """
    if restriction is not None:
        return Verdict(word="not judged", reason=restriction)
    if rank < STATES:
        return Verdict(word="blind")
    if position_sigma is None or not math.isfinite(position_sigma):
        return Verdict(word="blind", reason=f"for these ranges: {ranges or 'they do not determine the position'}")
    return Verdict(word="observable" if position_sigma <= required_sigma else "weak")


def for_these_ranges(count: int, start: float, window: float, period: float | None) -> str:
    """Why `count` ranges in a window (s) from `start` (s) do not determine the position along a path of full rank."""
    where = f"the {window:g} s from t = {start:.4g} s"
    if count < STATES:
        return f"{where} hold {count} of them, and {STATES} are needed"
    repeats = f", which repeats every {period:.4g} s" if period else ""
    return f"the {count} in {where} fall on too few places of the path{repeats}"


def caveats(gravity: Vec3, range_sigma: float) -> tuple[str, ...]:
    """Why a verdict holds of no real flight, one sentence each: ranges without noise, a gravity that no planet has.

    gravity: m/s². range_sigma: m.
    """
    size, sentences = math.hypot(*gravity), []
    if range_sigma == 0:
        sentences.append("The ranges have no noise, so every position that they determine is exact.")
    if not LEAST_GRAVITY <= size <= MOST_GRAVITY:
        sentences.append(f"Gravity is {size:.3g} m/s², which is no planet's; the verdict holds for this gravity alone.")
    return tuple(sentences)


def restriction(path: Signal, source: Source | None, duration: float) -> str | None:
    """Why a path is not judged, as one clause: its snap comes from a fit, or it jumps. None if the path is judged.

    source: the file that the path was imported from, if it was. duration: of the flight, s.
    """
    return provenance.restriction(source, path) or continuity.discontinuity(path, duration)
