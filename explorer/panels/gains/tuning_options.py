"""What a search of gains is asked for: the weight of exactness, the number of runs a score, the number of gains."""

import math

from explorer.model.glossary import COMPARE
from explorer.widgets.controls import Number
from explorer.widgets.dials import Dial
from explorer.widgets.section import Section
from rangenav.inputs import require, require_within

MAX_RUNS, RUNS = 32, 8
MAX_EVALUATIONS, EVALUATIONS = 2000, 300
STEADINESS, WEIGHTS = 0.5, (0.0, 1.0)
WEIGHT, RUNS_TERM, TRIES = COMPARE["exactness"], COMPARE["tuning runs"], COMPARE["tries"]


class TuningOptions:
    """Three controls."""

    def __init__(self, section: Section) -> None:
        self._steadiness = Dial(section, WEIGHT.caption, WEIGHTS, step=0.05, hint=WEIGHT.hint)
        self._steadiness.write(STEADINESS, None)
        self._runs = Number(section, RUNS_TERM.caption, hint=RUNS_TERM.hint)
        self._evaluations = Number(section, TRIES.caption, hint=TRIES.hint)
        self._runs.write(RUNS, None)
        self._evaluations.write(EVALUATIONS, None)

    def read(self) -> tuple[float, int, int]:
        """Weight, runs and tries. Raises ValueError with the reason."""
        steadiness = self._steadiness.read()
        require_within(WEIGHT.label, steadiness, *WEIGHTS)
        runs = whole(RUNS_TERM.label, self._runs.read(), MAX_RUNS)
        return steadiness, runs, whole(TRIES.label, self._evaluations.read(), MAX_EVALUATIONS)


def whole(name: str, value: float, most: int) -> int:
    """A whole number from 1 to `most`. Raises ValueError, by the name, for any other."""
    is_whole = math.isfinite(value) and value == int(value) and 1 <= value <= most
    require(is_whole, f"{name} must be a whole number between 1 and {most}, got {value:g}")
    return int(value)
