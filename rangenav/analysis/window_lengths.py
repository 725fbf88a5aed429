"""How long a window must be: for rank 13, and for the position error that a preset requires."""

from collections.abc import Callable
from typing import TypeVar

from rangenav.observability import horizon
from rangenav.observability.horizon import Horizon
from rangenav.observability.shortest_windows import ShortestWindows, shortest_windows
from rangenav.preset import Preset

Lengths = TypeVar("Lengths", Horizon, ShortestWindows)


def how_long(preset: Preset) -> Horizon:
    """How long a window must be for rank 13, and for the accuracy that a preset requires, as curves of its length.

    The worst is that of five starts, and ranges are summed as if they came at all times; `shortest` has every start
    and the ranges themselves.
    """
    return _against_length(horizon.horizon, preset)


def shortest(preset: Preset) -> ShortestWindows:
    """The shortest windows whose ranges, as the preset really takes them, give the accuracy that it requires."""
    return _against_length(shortest_windows, preset)


def _against_length(compute: Callable[..., Lengths], preset: Preset) -> Lengths:
    """What is computed for windows of many lengths, from the flight of a preset and its ranges."""
    sensors = preset.sensors
    return compute(
        preset.path,
        preset.world,
        preset.duration,
        sigma=sensors.sigma.range,
        rate=sensors.range_rate,
        share=sensors.arriving,
        position_sigma=preset.requirement.position_sigma,
    )
