"""Whether an observer's innovations say that it is consistent, overconfident or lost; the truth is not used.

    noise-matched gains, EKF: √mean NIS, above 1 beyond a chance of 1e-6: overconfident by that factor
    constant gains: mean and whiteness of ν/√S, since their S is a design quantity: |mean| √n/std, |r₁| √n ≤ 5

All over the last quarter of the ranges. It is said of the ranges only: on a blind motion a wrong position fits as well.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np
import scipy
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.acquisition import COLLECTING, CONSTANT, LOST, MATCHED
from rangenav.cascade import Estimate
from rangenav.kernels.layout import GATE
from rangenav.number_format import quantity

Word = Literal["consistent", "overconfident", "correlated", "lost", "not judged"]
WORDS: tuple[Word, ...] = get_args(Word)
Mode = Literal["constant", "noise-matched", "filter"]
"""filter: the extended Kalman filter, which has no other gains."""
FEWEST = 20
"""Innovations in the last quarter below which nothing is said."""
CHANCE = 1e-6
DEVIATIONS = 5.0
"""Standard deviations of mean and correlation, by chance exceeded in 6e-7 of the runs."""
MOST_OUTLIERS = 1 / 3
"""A larger share of innovations above the gate are no outliers."""
TINY = 1e-100
"""Below the innovations of any run: without noise they may all be 0."""
FAR = 10**0.5
"""Multiples of √S: larger innovations of constant gains that wait for the ranges fit nothing, although S is a design
quantity."""
WHITE = "consistent by mean and whiteness of the innovations"
"""What is said of constant gains, of whose covariance nothing is judged."""
BLIND = "fits the ranges, position cannot be told"
NOT_JUDGED = f"the fit is not judged: fewer than {FEWEST} ranges in the last quarter"
COLLECTED = "fits the ranges, which contradict the guess and have not determined the position yet: constant gains"


@dataclass(frozen=True, kw_only=True)
class RangeFit:
    """How well an estimate fits its ranges."""

    word: Word
    factor: float | None
    """By how much its innovations exceed their σ; None for constant gains whose innovations are not far above it."""
    collecting: bool = False
    """Whether constant gains run in place of noise-matched ones, until the ranges determine the position."""
    mode: Mode = "constant"
    """The gains that the run has had."""
    given_up: int = 0
    """How often noise-matched gains have given up their guess, because the ranges contradicted it."""
    off: float | None = None
    """RMS of |p̂| − d (m) over the last quarter, where it is far above the noise; None where it is not, or not known."""

    @property
    def gains(self) -> str:
        """The gains with what became of them: "noise-matched gains, the initial guess given up 2 times"."""
        if self.mode != "noise-matched":
            return "constant gains" if self.mode == "constant" else "an extended Kalman filter"
        times = "once" if self.given_up == 1 else f"{self.given_up} times"
        given_up = f", the initial guess given up {times}" if self.given_up else ""
        now = ", constant gains at the end" if self.collecting or (self.word == "lost" and self.given_up) else ""
        return f"noise-matched gains{given_up}{now}"

    def summary(self, *, blind: bool) -> str:
        """The word with its figure. blind: whether the motion leaves the position undetermined."""
        return _text(self, blind=blind, off=self.off)

    def statement(self, *, blind: bool, predicted: float | None) -> str:
        """The summary with the gains and the predicted 1-σ of the position (m), which the ranges alone do not show.

        predicted: None, NaN or infinite where the ranges do not determine the position.
        """
        said = f"{self.summary(blind=blind)} ({self.gains})"
        sigma = quantity(predicted, "m")
        return said if blind else f"{said}; predicted position {'±' if sigma[0].isdigit() else ''}{sigma}"

    def report(self, *, blind: bool) -> dict[str, str | float]:
        """As a JSON object; `factor` only where there is one."""
        factor = {} if self.factor is None else {"factor": self.factor}
        run: dict[str, str | float] = {"mode": self.mode, "given_up": self.given_up, "gains": self.gains}
        return {"word": self.word, "words": self.summary(blind=blind), **factor, **run}


def counted(fits: Sequence[RangeFit], *, blind: bool) -> str:
    """How many runs have each word, the most frequent first; overconfident ones with their least and largest factor."""
    words = [fit.word if fit.word == "overconfident" else _text(fit, blind=blind) for fit in fits]
    parts = []
    for word in sorted(set(words), key=lambda word: (-words.count(word), word)):
        factors = [fit.factor for fit in fits if fit.word == word and fit.factor is not None]
        over = f" ×{min(factors):.2g} to ×{max(factors):.2g}" if word == "overconfident" else ""
        parts.append(f"{words.count(word)} {word}{over}")
    return ", ".join(parts)


def _text(fit: RangeFit, *, blind: bool, off: float | None = None) -> str:
    """The word in a clause. off: m, shown as the distance from the ranges; without it, runs that differ read alike."""
    distance = "" if off is None else f" by {quantity(off, 'm')}"
    far = "" if fit.off is None else f"its distance from the anchor is wrong{distance}"
    if fit.word == "consistent" and far:
        undetermined = ", and the ranges do not determine the position" if blind else ""
        return f"the innovations are as expected, but {far}{undetermined}"
    if fit.word == "consistent" and (blind or fit.collecting):
        return BLIND if blind else COLLECTED
    if fit.word == "consistent" and fit.mode == "constant":
        return WHITE
    if fit.word == "overconfident":
        return f"overconfident ×{fit.factor:.2g}"
    if fit.word == "correlated":
        return f"the innovations have a mean or are correlated{f', and {far}' if far else ''}"
    return NOT_JUDGED if fit.word == "not judged" else fit.word


def of(estimate: Estimate) -> RangeFit:
    """The fit of a run. One without phases is the extended Kalman filter's, whose gains follow the noise, too."""
    phase = None if estimate.phase is None else np.asarray(estimate.phase)
    if phase is None:
        return replace(_judged(estimate, None), mode="filter")
    if (phase == CONSTANT).all():
        return _judged(estimate, CONSTANT)
    given_up = int(np.sum((phase[:-1] == MATCHED) & (phase[1:] != MATCHED)))
    return replace(_judged(estimate, int(phase[-1])), mode="noise-matched", given_up=given_up)


def _judged(estimate: Estimate, phase: int | None) -> RangeFit:
    part = estimate.innovation[3 * len(estimate.innovation) // 4 :]
    part = part[np.isfinite(part).all(axis=1) & (part[:, 1] > 0)]
    with np.errstate(over="ignore"):
        normalised = part[:, 0] / np.sqrt(part[:, 1])
    if phase == LOST or not np.isfinite(estimate.state[-1]).all() or not np.isfinite(normalised).all():
        return RangeFit(word="lost", factor=None)
    if len(part) < FEWEST:
        return RangeFit(word="not judged", factor=None)
    if phase not in (CONSTANT, COLLECTING):
        return _by_size(normalised)
    collecting = phase == COLLECTING
    largest = max(float(np.abs(normalised).max()), TINY)
    exceeds = largest * float(np.sqrt(np.mean((normalised / largest) ** 2)))
    if collecting and exceeds > FAR:
        return RangeFit(word="overconfident", factor=exceeds, collecting=True)
    return RangeFit(word=_by_whiteness(normalised), factor=None, collecting=collecting)


def _by_whiteness(normalised: Float[Array, "r"]) -> Literal["consistent", "correlated"]:
    scaled = normalised / max(float(np.abs(normalised).max()), TINY)  # squares of what is left do not overflow
    centred, root = scaled - scaled.mean(), np.sqrt(len(scaled))
    size = max(float(np.sqrt(np.mean(centred**2))), TINY)
    mean, correlation = scaled.mean() / size * root, np.mean(centred[1:] * centred[:-1]) / size / size * root
    return "consistent" if abs(mean) <= DEVIATIONS and abs(correlation) <= DEVIATIONS else "correlated"


def _by_size(normalised: Float[Array, "r"]) -> RangeFit:
    size = np.abs(normalised)
    within = size[size <= np.sqrt(GATE)]
    kept = within if len(within) >= (1 - MOST_OUTLIERS) * len(size) else size
    largest, n = max(float(kept.max()), TINY), len(kept)
    factor = largest * float(np.sqrt(np.mean((kept / largest) ** 2)))
    sure = factor > np.sqrt(2 * scipy.special.gammaincinv(n / 2, 1 - CHANCE) / n)
    return RangeFit(word="overconfident" if sure else "consistent", factor=factor)
