"""Eigenvalues as a small bar on a logarithmic scale, with the floor below which they are rounding."""

import math
from collections.abc import Sequence

from rangenav.number_format import power_of_ten, significant

LEVELS = "▁▂▃▄▅▆▇█"
BELOW_FLOOR = "·"


def spectrum_bar(eigenvalues: Sequence[float], floor: float) -> tuple[str, ...]:
    """Eigenvalues (ascending) as one level each between two powers of ten; a dot for each below the floor.

    `10⁻⁷ ▁▃▃▃▄▄▅▅▅▆▆▇█ 10⁷`, then the floor and how many lie below it.
    """
    known = [value for value in eigenvalues if value > floor]
    if not known:
        return (f"all {len(eigenvalues)} eigenvalues lie below the floor {significant(floor, 2)}",)
    low, high = math.floor(math.log10(min(known))), math.ceil(math.log10(max(known)))
    bar = "".join(_level(value, low, high) if value > floor else BELOW_FLOOR for value in eigenvalues)
    below = len(eigenvalues) - len(known)
    count = f"; {below} of {len(eigenvalues)} below it ({BELOW_FLOOR})" if below else ""
    stated = f" (floor {significant(floor, 2)}{count})" if floor > 0 else ""
    return (f"{power_of_ten(low)} {bar} {power_of_ten(high)}{stated}",)


def _level(value: float, low: int, high: int) -> str:
    share = (math.log10(value) - low) / max(high - low, 1)
    return LEVELS[min(int(share * len(LEVELS)), len(LEVELS) - 1)]
