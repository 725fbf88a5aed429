"""What may help where no change of a motion was found: each way out as settings that the page can show."""

from collections.abc import Iterator
from dataclasses import dataclass

import msgspec
import numpy as np

from explorer.model import slower
from explorer.model.settings import Settings, effective
from rangenav.certificate import cures
from rangenav.inputs import Vec3
from rangenav.number_format import vector
from rangenav.preset import Preset
from rangenav.repair import CannotRepairError, ChangeKind

LONGER = 2.0
"""Times the window, where no longer one was certified."""
NEAREST, SHARE = 1.0, 0.5
"""m, and a share of the path's longest side: the anchor is moved so far below the path, whichever is more."""
SAMPLES = 401
DIGITS = 1
"""Decimals of the anchor's new place (m)."""


@dataclass(frozen=True, kw_only=True)
class WayOut:
    """A change of what is on the page, after which another search may find something."""

    label: str
    """In the imperative."""
    settings: Settings
    by: ChangeKind
    """The kind of change that is then searched for."""


def ways_out(settings: Settings, by: ChangeKind, refused: CannotRepairError) -> tuple[WayOut, ...]:
    """The ways out of a refusal; a change that is no valid preset is left out."""
    return tuple(_ways_out(settings, by, refused))


def _ways_out(settings: Settings, by: ChangeKind, refused: CannotRepairError) -> Iterator[WayOut]:
    preset = settings.preset
    if "tones" in refused.ways or by != "tones":
        yield WayOut(label="add tones instead", settings=settings, by="tones")
    if "repair" in refused.ways:
        yield WayOut(label="make it observable", settings=settings, by=by)
    if "window" in refused.ways:
        window = refused.window or float(f"{LONGER * preset.requirement.window:.2g}")
        try:
            judged = cures.with_window(effective(settings), window)
        except ValueError:  # the flight is too short for it
            pass
        else:
            changed = msgspec.structs.replace(preset, duration=judged.duration, requirement=judged.requirement)
            yield WayOut(label=f"set δ to {window:.3g} s", settings=_with(settings, changed), by=by)
    if "slower" in refused.ways and (k := slower.factor(settings)):
        yield WayOut(label=f"fly it {k:g}× slower", settings=slower.slowed(settings, k), by=by)
    place = below(effective(settings))
    if "anchor" in refused.ways and place != preset.world.anchor:
        world = msgspec.structs.replace(preset.world, anchor=place)
        moved = _with(settings, msgspec.structs.replace(preset, world=world))
        yield WayOut(label=f"move the anchor to {vector(place)} m, below the path", settings=moved, by=by)


def below(preset: Preset) -> Vec3:
    """A place (m, inertial) below the middle of the path, clear of it."""
    points = preset.path(np.linspace(0.0, preset.duration, SAMPLES))
    low, high = points.min(axis=0), points.max(axis=0)
    up = -np.asarray(preset.world.gravity) / np.linalg.norm(preset.world.gravity)
    middle, clear = (low + high) / 2, max(NEAREST, SHARE * float((high - low).max()))
    x, y, z = middle - (float(middle @ up) - float((points @ up).min()) + clear) * up
    return round(float(x), DIGITS), round(float(y), DIGITS), round(float(z), DIGITS)


def _with(settings: Settings, preset: Preset) -> Settings:
    return msgspec.structs.replace(settings, preset=preset)
