"""The verdict on a motion: blind, weak, observable, or not judged, and then why not; with it, whether the excitation μ
that the requirement asks for is reached. Only an observable motion whose μ is reached has the sign ✓.

The library, the command line, the page and the certificates all take it from `judge`.
"""

import math
from dataclasses import dataclass
from typing import Literal

from rangenav import continuity, provenance
from rangenav.inputs import Vec3
from rangenav.model import STATES
from rangenav.number_format import quantity
from rangenav.observability.undetermined import Cause
from rangenav.provenance import Source
from rangenav.signals import Signal

LEAST_GRAVITY, MOST_GRAVITY = 1.0, 30.0
"""m/s²; the Moon has 1.6, Jupiter 24.8."""
MOST_DRIFT = 3.0
"""Multiples of the predicted error by which the accelerometer's noise may move a position within the window. The ranges
of the window hold a part of that: the shipped presets, up to 1.8, keep to the predicted error in their runs."""
THESE = "for these ranges"
"""How the reason begins where a motion of full rank is blind."""
Word = Literal["blind", "weak", "observable", "not judged"]
Excitation = Literal["met", "not met", "not proven"]
"""Whether the required μ is reached; not proven: it lies between the bound and the least μ that was evaluated."""
Sign = Literal["✓", "✗", "!", "?"]
"""Good, bad, to be noticed, not known."""
SIGNS: dict[Word, Sign] = {"observable": "✓", "weak": "!", "blind": "✗", "not judged": "?"}


@dataclass(frozen=True, kw_only=True)
class Verdict:
    """What one range can tell of a motion."""

    word: Word
    """blind: rank below 13, or ranges that do not determine the position; weak: neither, but the predicted error
    exceeds the requirement, or is so large that it says nothing; observable: none of these."""
    reason: str = ""
    """One clause that says why the motion is not judged, blind for its ranges, or weak although its error is one that
    the requirement allows; empty otherwise."""
    excitation: Excitation = "met"

    @property
    def judged(self) -> bool:
        """Whether the path is one whose excitation may be judged."""
        return self.word != "not judged"

    @property
    def sign(self) -> Sign:
        """✓ observable; ✗ blind; ? not judged; ! weak, or observable with a required μ that is not reached."""
        return "!" if self.word == "observable" and self.excitation != "met" else SIGNS[self.word]

    @property
    def unmet(self) -> str:
        """The clause on a required μ that is not reached; empty where it is, and for a motion that is blind anyway."""
        lacks = self.word in ("observable", "weak") and self.excitation != "met"
        return f"the excitation required is {self.excitation}" if lacks else ""

    @property
    def summary(self) -> str:
        """The word, with the required μ that is not reached: "observable, but the excitation required is not met"."""
        return f"{self.word}, {'but' if self.word == 'observable' else 'and'} {self.unmet}" if self.unmet else self.word

    def __str__(self) -> str:
        between = " " if self.reason.startswith(THESE) else ": "
        return f"{self.summary}{between}{self.reason}" if self.reason else self.summary


@dataclass(frozen=True)
class Undetermined:
    """Why the ranges of a window do not determine the position along a path of full rank."""

    reason: str
    """One clause."""
    rounded: bool = False
    """Whether rounding alone is the cause, as far as is known: the motion is then weak and not blind."""


def excitation_reached(mu: float, lower: float | None, required: float) -> Excitation:
    """Whether a required μ is reached (all m²/s⁷).

    mu: the least of the evaluated windows. lower: no window has less; None where nothing is known to bound μ: the
    evaluated windows then decide.
    """
    if mu < required:
        return "not met"
    return "met" if lower is None or lower >= required else "not proven"


def judge(
    rank: int,
    position_sigma: float | None,
    required_sigma: float,
    *,
    excitation: Excitation = "met",
    restriction: str | None = None,
    rounded: bool = False,
    ranges: Undetermined | None = None,
    farthest: float = math.inf,
) -> Verdict:
    """The verdict on a motion.

    rank: of the lifted Gramian (of 13) on the worst window.
    position_sigma: predicted 1-σ position error (m) at the end of the worst window; None, NaN or infinite where its
    ranges do not determine the position: then even a motion of full rank is blind, for these ranges.
    required_sigma: the largest error (m) that the requirement allows.
    excitation: whether the required μ is reached; see `excitation_reached`.
    restriction: why the motion is not judged at all, if it is not; see `restriction`.
    rounded: whether the rank is 13 and lower only as computed; see `observability.continuation`. The motion is then
    weak and not blind: more digits would tell, and a longer window does.
    ranges: why those of the worst window do not determine the position; see `for_these_ranges`.
    farthest: the largest distance to the anchor (m). A single range leaves a sphere of positions, so an error above
    `sphere(farthest)` says no more of the position than one range does, whatever the requirement allows.
    """
    if restriction is not None:
        return Verdict(word="not judged", reason=restriction, excitation=excitation)
    if rounded:
        return Verdict(word="weak", reason=below_rounding(rank), excitation=excitation)
    if rank < STATES:
        return Verdict(word="blind", excitation=excitation)
    if position_sigma is None or not math.isfinite(position_sigma):
        if ranges is not None and ranges.rounded:
            return Verdict(word="weak", reason=ranges.reason, excitation=excitation)
        why = "they do not determine the position" if ranges is None else ranges.reason
        return Verdict(word="blind", reason=f"{THESE}: {why}", excitation=excitation)
    if position_sigma > required_sigma:
        return Verdict(word="weak", excitation=excitation)
    if position_sigma > sphere(farthest):
        return Verdict(word="weak", reason=says_nothing(position_sigma, farthest), excitation=excitation)
    return Verdict(word="observable", excitation=excitation)


def below_rounding(rank: int) -> str:
    """The clause on a window whose 13 functions are independent, and of which `rank` count in double precision."""
    more = STATES - rank
    return (
        f"rank at least {rank} of {STATES}, {more} more {'is' if more == 1 else 'are'} below rounding: the position is "
        "not determined at this precision"
    )


def undetermined(rounded: bool) -> str:
    """Why a predicted error is null. rounded: see `judge`."""
    window = "this window does not determine it"
    return f"null: {window} at this precision" if rounded else f"null: blind, {window}"


def sphere(farthest: float) -> float:
    """The diameter (m) of the largest sphere on which a range leaves the position: twice the largest distance (m)."""
    return 2 * farthest


def says_nothing(position_sigma: float, farthest: float) -> str:
    """The clause on an error (m) that is larger than the sphere of all positions at one range."""
    return (
        f"the predicted error, {quantity(position_sigma, 'm')}, exceeds the {quantity(sphere(farthest), 'm')} across "
        "the sphere on which a single range leaves the position"
    )


def for_these_ranges(
    cause: Cause | None, count: int, start: float, window: float, *, rate: float, period: float | None
) -> Undetermined | None:
    """Why `count` ranges in a window (s) from `start` (s) do not determine the position along a path of full rank.

    rate: of the ranges, Hz. period: of the path, s. None where there is no cause: they determine it.
    """
    if cause is None:
        return None
    where = f"the {window:g} s from t = {start:.4g} s"
    if cause == "too few":
        return Undetermined(f"{where} hold {count} of them, and {STATES} are needed")
    if cause == "same places":
        repeats = f", which repeats every {period:.4g} s" if period else ""
        return Undetermined(f"the {count} in {where} fall on too few places of the path{repeats}")
    if cause == "alias":
        return Undetermined(
            f"the {count} in {where} do not determine the position, nor do those of longer windows: at {rate:g} Hz "
            "they miss what distinguishes this path"
        )
    reason = f"the {count} ranges in {where} do not determine the position at this precision"
    return Undetermined(reason, rounded=True)


def caveats(
    gravity: Vec3,
    range_sigma: float,
    *,
    position_sigma: float = 0.0,
    farthest: float = math.inf,
    window: float = 0.0,
    drift: float = 0.0,
) -> tuple[str, ...]:
    """Why a verdict is of little use, one sentence each: ranges without noise, a gravity that no planet has, a
    predicted error above the distance to the anchor, an IMU whose noise is far above the predicted error.

    gravity: m/s². range_sigma, position_sigma (on the worst window), farthest (the largest distance to the anchor): m.
    window: s. drift: how far the accelerometer's noise alone moves a position within the window (m); see
    `sensors.drift`.
    """
    size, sentences = math.hypot(*gravity), []
    if range_sigma == 0:
        sentences.append("The ranges have no noise, so every position that they determine is exact.")
    if not LEAST_GRAVITY <= size <= MOST_GRAVITY:
        sentences.append(f"Gravity is {size:.3g} m/s², which is no planet's; the verdict holds for this gravity alone.")
    if farthest < position_sigma < math.inf:
        sentences.append(
            f"The predicted error, {quantity(position_sigma, 'm')}, exceeds the largest distance to the anchor, "
            f"{quantity(farthest, 'm')}."
        )
    if drift > MOST_DRIFT * position_sigma:
        sentences.append(
            f"The IMU's noise alone moves the position by {quantity(drift, 'm')} within {quantity(window, 's')}; the "
            f"predicted error, {quantity(position_sigma, 'm')}, assumes a perfect IMU."
        )
    return tuple(sentences)


def restriction(path: Signal, source: Source | None, duration: float) -> str | None:
    """Why a path is not judged, as one clause: its snap comes from a fit, or it jumps. None if the path is judged.

    source: the file that the path was imported from, if it was. duration: of the flight, s.
    """
    return provenance.restriction(source, path) or continuity.discontinuity(path, duration)
