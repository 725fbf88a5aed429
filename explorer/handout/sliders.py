"""A baked slider: one number of the settings takes some values, and each is computed before the file is written."""

from dataclasses import dataclass

import numpy as np

from explorer.model import field_path
from explorer.model.settings import Settings
from rangenav.inputs import require

POSITIONS = 15
SPAN = 10.0
"""Of a slider without limits: from a tenth of the number to ten times it."""


@dataclass(frozen=True, kw_only=True)
class Baked:
    """A slider of a handout."""

    path: str
    label: str
    values: tuple[float, ...]
    settings: tuple[Settings, ...]
    """What the page would be at each value."""
    at: int
    """The position that is nearest to what the page shows."""


def slider(settings: Settings, text: str) -> Baked:
    """A slider from `gains.attitude.k1`, or with its limits from `gains.attitude.k1=0.5:20`.

    The positions are spread evenly on a log scale where both limits are above zero, else evenly. Raises ValueError with
    one sentence if the path names no number, or if no two positions are valid.
    """
    path, _, limits = text.partition("=")
    now = field_path.value(settings, path)
    low, high = _limits(text, limits) if limits else _usual_limits(path, now)
    wanted = np.geomspace(low, high, POSITIONS) if low > 0 else np.linspace(low, high, POSITIONS)
    values, states, refusal = [], [], ""
    for value in wanted:
        try:
            states.append(field_path.replaced(settings, path, _rounded(float(value))))
            values.append(_rounded(float(value)))
        except ValueError as reason:
            refusal = str(reason)
    require(len(values) >= 2, f"{path}: no two of its positions are valid: {refusal}")
    at = int(np.argmin(np.abs(np.array(values) - now)))
    return Baked(path=path, label=field_path.label(path), values=tuple(values), settings=tuple(states), at=at)


def _limits(text: str, limits: str) -> tuple[float, float]:
    low, _, high = limits.partition(":")
    try:
        bounds = float(low), float(high)
    except ValueError:
        raise ValueError(f"{text}: limits are two numbers with a colon, such as 0.5:20") from None
    require(
        np.isfinite(bounds[0]) and np.isfinite(bounds[1]) and bounds[0] < bounds[1],
        f"{text}: the first limit must be below the second",
    )
    return bounds


def _usual_limits(path: str, now: float) -> tuple[float, float]:
    require(now != 0, f"{path}: is 0, so its limits must be given, such as {path}=-1:1")
    return (now / SPAN, now * SPAN) if now > 0 else (2 * now, -2 * now)


def _rounded(value: float) -> float:
    return float(f"{value:.3g}")
