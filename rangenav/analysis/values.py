"""The analysis of one preset: every number without a window of its own is that of a worst window."""

import math
from functools import cached_property

from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.model import STATES
from rangenav.motion_analysis import Windows
from rangenav.observability import excitation, reduced
from rangenav.observability.accuracy import FourAccuracies, HasAccuracies
from rangenav.observability.blindness import Direction
from rangenav.preset import Preset
from rangenav.proof import Proof
from rangenav.results import result
from rangenav.sensors import drift
from rangenav.verdict import Verdict, caveats


@result
class Analysis(HasAccuracies):
    """The analysis of one preset. Every number without a window of its own is that of a worst window."""

    proof: Proof | None
    """What the worst windows come from; None where they are the worst of the sampled windows."""

    windows: Windows
    mu: float
    """The least excitation eigenvalue over all windows (m²/s⁷)."""
    mu_at: float
    """s, where that window starts."""
    excitation: Float[Array, "3"]
    """All three eigenvalues there."""
    bound_for_all_t: float | None
    """A lower bound of the excitation over every window at every t ≥ 0; None if the path has no period, if no bound
    above 0 is known, or if only sampled windows were computed."""
    gramian_at: float
    """s, where the window of least rank (and then least scaled singular value) starts."""
    gramian: Float[Array, "13"]
    floor: float
    rank: int
    rounded: bool
    """Whether the rank is 13, as a longer window shows, and `rank` is lower because of rounding alone."""
    tolerance: float
    """Relative: a scaled singular value counts above this share of the largest."""
    directions: tuple[Direction, ...]
    accuracy_at: float
    """s, the start of the window whose lifted position error at its end is largest; a blind window counts as worst."""
    accuracies: FourAccuracies
    """Of that window."""
    ranges: int
    """How many ranges that window holds."""
    ranges_rounded: bool
    """Whether they leave the position undetermined because of rounding alone, as far as is known."""
    farthest: float
    """m: the largest distance to the anchor in the flight, on samples."""
    verdict: Verdict

    @property
    def mu_floor(self) -> float:
        """Excitation eigenvalues below it are rounding (m²/s⁷)."""
        return excitation.floor(self.windows.excitation) if self.proof is None else self.proof.excitation.floor

    @property
    def nonlinear_at(self) -> float:
        """s, where the window of least nonlinear rank (and then of least scaled singular value) starts."""
        if self.proof is not None:
            return self.proof.rank.nonlinear_at
        return float(self.windows.start[self.windows.worst_nonlinear[0]])

    @property
    def nonlinear(self) -> Float[Array, "9"]:
        """The eigenvalues of its Gramian, ascending, SI."""
        if self.proof is not None:
            return self.proof.rank.nonlinear_eigenvalues
        return self.windows.worst_nonlinear[1].eigenvalues[0]

    @property
    def nonlinear_floor(self) -> float:
        """Nonlinear eigenvalues below it are rounding."""
        if self.proof is not None:
            return self.proof.rank.nonlinear_floor
        return float(self.windows.worst_nonlinear[1].floor[0])

    @property
    def nonlinear_rank(self) -> int:
        """Of 9."""
        if self.proof is not None:
            return self.proof.rank.nonlinear
        return int(self.windows.worst_nonlinear[1].rank[0])

    @property
    def reduced_min(self) -> float:
        """The least eigenvalue of the reduced pair (Proposition 1) on the window of least rank."""
        return self._reduced[0]

    @property
    def reduced_floor(self) -> float:
        """Below it that eigenvalue is rounding."""
        return self._reduced[1]

    @cached_property
    def _reduced(self) -> tuple[float, float]:
        windows = self.windows
        return reduced.least_eigenvalue(windows.path, windows.world.gravity, self.gramian_at, windows.window)

    @property
    def resolved_mu(self) -> float:
        """μ (m²/s⁷), and 0 where it is rounding."""
        clear = self.mu >= excitation.CLEAR * excitation.most(self.windows.path, self.windows.window)
        return self.mu if clear or self.mu >= self.mu_floor else 0.0

    @property
    def below_rounding(self) -> bool:
        """Whether rank or position are undetermined because of rounding alone, as far as is known."""
        return self.rounded or self.ranges_rounded

    @property
    def blind(self) -> bool:
        """Whether the position cannot be told, for the motion or for its ranges; of motions not judged, by the rank."""
        return self.verdict.word == "blind" or self.known_rank < STATES

    @property
    def known_rank(self) -> int:
        """13 where the rank is lower because of rounding alone."""
        return STATES if self.rounded else self.rank

    def caveats(self, preset: Preset) -> tuple[str, ...]:
        """Why the verdict on this preset is of little use, one sentence each."""
        worst = self.lifted_end.position
        determined, window = math.isfinite(worst), self.windows.window
        return caveats(
            preset.world.gravity,
            preset.sensors.sigma.range,
            position_sigma=worst if determined else 0.0,
            farthest=self.farthest,
            window=window,
            drift=drift(preset.sensors, window) if determined else 0.0,
        )
