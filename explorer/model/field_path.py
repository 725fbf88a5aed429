"""One number of some settings by its path, as in a preset's file: gains.riccati.q, path.tones.1.amplitude, time_scale.

Paths are those of `rangenav.field_path`; they begin in the preset, or name what the page has besides it.
"""

import re

from explorer.model.glossary import field_label
from explorer.model.settings import Settings
from rangenav import field_path

OF_SETTINGS = ("time_scale", "twin_turn")
"""The first parts of paths that do not lead into the preset."""


def value(settings: Settings, path: str) -> float:
    """The number. Raises ValueError with one sentence if the path names none."""
    return field_path.value(settings, path, below=_below(path))


def replaced(settings: Settings, path: str, number: float) -> Settings:
    """The settings with another number. Raises ValueError with one sentence if it does not fit."""
    value(settings, path)
    return field_path.replaced(settings, {path: number}, below=_below(path))


def label(path: str) -> str:
    """What the page calls it: path.tones.3.amplitude → path, tone 3, amplitude."""
    return field_label(re.sub(r"\.(\d+)", r"[\1]", path))


def _below(path: str) -> str:
    return "" if path.split(".")[0] in OF_SETTINGS else "preset"
