"""The worst windows among all, for μ, rank and σ, and of which of them it is proven that no window is worse.

Analysis, certificates and the page at rest take them from here, so that all name the same window and the same verdict.
"""

import math

from rangenav.model import STATES
from rangenav.motion import World
from rangenav.observability import undetermined
from rangenav.observability.undetermined import Cause
from rangenav.observability.worst_accuracy import WorstAccuracy, worst_accuracy
from rangenav.observability.worst_excitation import FLIGHT, WorstExcitation, worst_excitation
from rangenav.observability.worst_rank import WorstRank, worst_rank
from rangenav.preset import Preset, Requirement
from rangenav.progress import stop_if_unwanted
from rangenav.results import result
from rangenav.signals import Signal

Arguments = tuple[Signal, World, float, Requirement, float, float, float]
"""Path, world, duration (s), requirement; σ (m) and rate (Hz) of the ranges, and the share of them that arrives."""


@result
class Proof:
    """The worst windows among all: what is proven of every window, and what is sampled, as each of them says."""

    excitation: WorstExcitation
    rank: WorstRank
    accuracy: WorstAccuracy
    undetermined: Cause | None
    """Why the ranges of the worst window do not determine the position; None where they do, or where its rank is below
    13 as computed."""

    @property
    def rank_proven(self) -> bool:
        """Whether no window has a lower rank: by cores, or of rank 13 because the ranges in each determine it all.

        Never of a rank that is low because of rounding, or may be.
        """
        by_cores = self.rank.proof is not None and self.rank.proof.proved and self.rank.proof.rank == self.rank.rank
        by_cores = by_cores and self.rank.resolved
        by_ranges = self.rank.rank == STATES and self.rank.starts == FLIGHT
        return by_cores or (by_ranges and math.isfinite(self.accuracy.windows.bound))

    @property
    def accuracy_proven(self) -> bool:
        """Whether no window has a larger σ; of an undetermined position, whether more digits would not determine it."""
        if self.undetermined is not None:
            return self.undetermined in undetermined.PROVEN
        return math.isfinite(self.accuracy.windows.bound) or self.rank.resolved

    @property
    def rounded(self) -> bool:
        """Whether the position of a window is undetermined because of rounding alone, as far as is known."""
        return self.rank.rounded or self.undetermined == "rounding"


def arguments(preset: Preset) -> Arguments:
    """What the worst windows of a preset depend on, as `prove` takes it."""
    sensors = preset.sensors
    return (
        preset.path,
        preset.world,
        preset.duration,
        preset.requirement,
        sensors.sigma.range,
        sensors.range_rate,
        sensors.arriving,
    )


def prove(
    path: Signal,
    world: World,
    duration: float,
    requirement: Requirement,
    range_sigma: float,
    range_rate: float,
    arriving: float = 1.0,
    *,
    compiled: bool = False,
) -> Proof:
    """The worst windows among all; each part is cached by its own inputs. Certificates take them from here.

    compiled: σ by compiled code, which is worth its loading for a program that judges many motions. Never for a
    certificate: its last digits shall not depend on the program that issues it.
    Within `progress.stopping` it raises CancelledError as soon as it is no longer wanted.
    """
    window = requirement.window
    stop_if_unwanted()
    excited = worst_excitation(path, window, duration, requirement.mu)
    rank = worst_rank(path, world, duration, window)
    worst = worst_accuracy(
        path, world, duration, window, sigma=range_sigma, rate=range_rate, share=arriving, compiled=compiled
    )
    return Proof(
        excitation=excited,
        rank=rank,
        accuracy=worst,
        undetermined=_cause(path, world, window, worst, rate=range_rate, noise=range_sigma or 1.0)
        if rank.rank == STATES and not math.isfinite(worst.windows.bound)
        else None,
    )


def _cause(path: Signal, world: World, window: float, worst: WorstAccuracy, *, rate: float, noise: float) -> Cause:
    held = worst.windows
    return undetermined.cause(path, world, window=window, first=held.first, last=held.last, rate=rate, noise=noise)
