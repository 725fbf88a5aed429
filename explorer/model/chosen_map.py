"""What a visitor has chosen for a map of two parameters: remembered with the page, and shown again after a reload.

The names of the fields are part of the file format of saved work.
"""

from explorer.model.study_axes import MAX_COUNT, MIN_COUNT
from rangenav.inputs import Input, require
from rangenav.studies.metrics import METRICS
from rangenav.studies.parameters import Linear, Log

MAX_RUNS = 50


class ChosenMap(Input, frozen=True, kw_only=True):
    """Axes, metric and seeds. The values of a map are not saved: they are computed again."""

    across: Linear | Log
    upwards: Linear | Log
    metric: str
    runs: int = 1
    """Seeds at each point."""
    drawn: bool = False
    """Whether a map was on the page."""

    def __post_init__(self) -> None:
        super().__post_init__()
        require(self.metric in METRICS, f"metric: there is no {self.metric!r}")
        require(1 <= self.runs <= MAX_RUNS, f"runs must be a whole number between 1 and {MAX_RUNS}, got {self.runs}")
        for axis in (self.across, self.upwards):
            rule = f"count must be a whole number between {MIN_COUNT} and {MAX_COUNT}, got {axis.count}"
            require(MIN_COUNT <= (axis.count or 0) <= MAX_COUNT, rule)
