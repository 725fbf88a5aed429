"""Whether an observer's innovations say that it is consistent, overconfident or lost; the truth is not used.

    noise-matched gains, EKF: √mean NIS, above 1 beyond a chance of 1e-6: overconfident by that factor
    constant gains: mean and whiteness of ν/√S, since their S is a design quantity: |mean| √n/std, |r₁| √n ≤ 5

All over the last quarter of the ranges. It is said of the ranges only: on a blind motion a wrong position fits as well.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array
from scipy.special import gammaincinv

from rangenav.acquisition import COLLECTING, CONSTANT, LOST
from rangenav.cascade import Estimate
from rangenav.kernels.layout import GATE

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
BLIND = "fits the ranges, position cannot be told"
NOT_JUDGED = f"the fit is not judged: fewer than {FEWEST} ranges in the last quarter"
COLLECTED = "fits the ranges, which contradict the guess and have not determined the position yet: constant gains"


@dataclass(frozen=True, kw_only=True)
class RangeFit:
    """How well an estimate fits its ranges."""

    word: Literal["consistent", "overconfident", "correlated", "lost", "not judged"]
    factor: float | None
    """By how much its innovations exceed their σ; None for constant gains whose innovations are not far above it."""
    collecting: bool = False
    """Whether constant gains run in place of noise-matched ones, until the ranges determine the position."""

    def summary(self, *, blind: bool) -> str:
        """The word with its figure. blind: whether the motion leaves the position undetermined."""
        if blind and self.word == "consistent":
            return BLIND
        if self.collecting and self.word == "consistent":
            return COLLECTED
        if self.word == "overconfident":
            return f"overconfident ×{self.factor:.2g}"
        if self.word == "correlated":
            return "not settled on the ranges: the innovations have a mean or are correlated"
        return NOT_JUDGED if self.word == "not judged" else self.word

    def report(self, *, blind: bool) -> dict[str, str | float]:
        """As a JSON object; `factor` only where there is one."""
        factor = {} if self.factor is None else {"factor": self.factor}
        return {"word": self.word, "words": self.summary(blind=blind), **factor}


def counted(fits: Sequence[RangeFit], *, blind: bool) -> str:
    """How many runs have each word, the most frequent first; overconfident ones with their least and largest factor."""
    words = [fit.word if fit.word == "overconfident" else fit.summary(blind=blind) for fit in fits]
    parts = []
    for word in sorted(set(words), key=lambda word: (-words.count(word), word)):
        factors = [fit.factor for fit in fits if fit.word == word and fit.factor is not None]
        over = f" ×{min(factors):.2g} to ×{max(factors):.2g}" if word == "overconfident" else ""
        parts.append(f"{words.count(word)} {word}{over}")
    return ", ".join(parts)


def of(estimate: Estimate) -> RangeFit:
    """The fit of a run. One without phases is the extended Kalman filter's, whose gains follow the noise, too."""
    part = estimate.innovation[3 * len(estimate.innovation) // 4 :]
    part = part[np.isfinite(part).all(axis=1) & (part[:, 1] > 0)]
    phase = None if estimate.phase is None else int(estimate.phase[-1])
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
    sure = factor > np.sqrt(2 * gammaincinv(n / 2, 1 - CHANCE) / n)
    return RangeFit(word="overconfident" if sure else "consistent", factor=factor)
