"""The preset of an imported path: flown if a multirotor can fly it, a loop if it closes, and its source.

No file of a path says where the anchor stands or over which windows the path is to be judged. Both are chosen, and
`choices` says so.
"""

import math
from pathlib import Path
from typing import Literal, cast

import msgspec
import numpy as np

from rangenav.formats import hover_ramps
from rangenav.formats.import_result import ImportResult, gravity, settled
from rangenav.inputs import Vec3, require
from rangenav.motion import World
from rangenav.preset import MAX_DURATION, MAX_TITLE, MIN_DURATION, Preset, Requirement
from rangenav.provenance import MAX_FILE, MAX_WORDS, Source, SourceFormat, fingerprint
from rangenav.signals import AngularVelocity, Flown, Multisine, Polynomials, Signal

WINDOW = 6.0
"""s, as in the shipped presets; half the flight if that is shorter."""
LOOP_WINDOW = (10.0, 20.0)
"""s: the least and the most that whole turns of a loop may last to be its window; a longer loop has the least."""
LOOPED = 20.0
"""s, that a loop is flown at least."""
NEAREST, SHARE = 1.0, 0.5
"""m, and a share of the path's longest side: the anchor stands so far outside the path, whichever is more."""
FARTHEST = 5e4
"""m, of each coordinate of the anchor: a world holds none beyond 100 km."""
MAGNETIC = 0.7071067811865476
"""Each of the field's components, north and down, as in the shipped presets."""
SAME_LENGTH = 1e-6
"""Share by which a duration may be rounded up."""
BOX_SAMPLES = 2001
Ends = Literal["hold", "repeat"]


def as_preset(
    result: ImportResult,
    *,
    duration: float | None = None,
    anchor: Vec3 | None = None,
    window: float | None = None,
    ends: Ends | None = None,
) -> Preset:
    """The preset of a path that was read; what is None is chosen, and `choices` says how.

    duration, window: s. ends: what the path does after its end. Raises ValueError for open questions, or a file that
    holds no path.
    """
    settled(result)
    if result.path is None:
        raise ValueError(f"{result.source}: holds a recorded flight and no path: ask `rangenav log` about it")
    path, loop = _path(result, ends)
    longest = MAX_DURATION if loop else min(result.duration, MAX_DURATION)
    delta = window or (_window_of_loop(result.duration) if loop else None)
    flown = _looped(result.duration, delta or WINDOW) if loop else longest
    length = flown if duration is None else duration
    rule = f"duration must lie between {MIN_DURATION:g} s and the file's {longest:.6g} s, got {length:g} s"
    require(MIN_DURATION <= length <= longest * (1 + SAME_LENGTH), f"{result.source}: {rule}")
    origin, z_up = source(result, path), result.frame == "z-up"
    delta = delta if delta is not None and (window is not None or delta < length) else min(WINDOW, length / 2)
    world = World(
        gravity=gravity(result.frame),
        magnetic=(MAGNETIC, 0.0, -MAGNETIC if z_up else MAGNETIC),
        anchor=_anchor(path, result.duration, z_up=z_up) if anchor is None else anchor,
    )

    def made(turning: AngularVelocity) -> Preset:
        return Preset(
            title=_printable(Path(result.source).stem)[:MAX_TITLE].strip() or "imported",
            story=f"Imported from a file of the format {result.format}."
            if result.derivatives == "file"
            else f"Imported from a file of the format {result.format}. Its snap is that of the fit, not of the flight.",
            duration=length,
            path=path,
            angular_velocity=turning,
            world=world,
            requirement=Requirement(window=delta),
            source=origin,
        )

    try:
        return made(Flown())
    except ValueError as error:
        if "flown" not in str(error):
            raise ValueError(f"{result.source}: {error}") from None
    try:
        return made(Multisine())
    except ValueError as error:
        raise ValueError(f"{result.source}: {error}") from None


def choices(preset: Preset, result: ImportResult) -> tuple[str, ...]:
    """What the preset of an imported path has that its file does not say, and why: anchor, window, duration and end."""
    place = np.asarray(preset.world.anchor)
    away = np.linalg.norm(preset.path(np.linspace(0, preset.duration, BOX_SAMPLES)) - place, axis=-1)
    where = ", ".join(f"{value:zg}" for value in preset.world.anchor)
    period, window = preset.path.period, preset.requirement.window
    if period:
        turns = preset.duration / period
        end = (
            f"the path ends where it begins, so it repeats: {turns:.3g} loops of {period:.4g} s in the "
            f"{preset.duration:.4g} s of flight"
        )
    else:
        end = f"the path is flown once, {preset.duration:.4g} s, and holds still at its end"
    loops = f", which is {window / period:.3g} loops" if period else f" of a flight of {preset.duration:.4g} s"
    return (
        f"the anchor stands at ({where}) m, {away.min():.2g} to {away.max():.2g} m from the path: the file does "
        "not say where it stands, so this place was chosen",
        f"the window judged, δ, is {window:.4g} s{loops}",
        end,
    )


def _path(result: ImportResult, ends: Ends | None) -> tuple[Signal, bool]:
    """The path, repeating where it closes or is asked to, and whether it repeats."""
    path = result.path
    assert path is not None
    if not isinstance(path, Polynomials) or path.ends == "repeat":
        require(ends != "repeat", f"{result.source}: a curve that was fitted to positions cannot be made to repeat")
        return path, False
    closes = hover_ramps.closes(path, result.duration)
    if ends == "hold" or (ends is None and not closes):
        return path, False
    rule = f"{result.source}: the path does not end where it begins, or not as fast, and cannot repeat"
    require(closes, rule)
    return msgspec.structs.replace(path, ends="repeat"), True


def _window_of_loop(period: float) -> float:
    """Whole turns, since a window of whole turns has the same excitation wherever it begins, unless they are long."""
    least, most = LOOP_WINDOW
    window = period * math.ceil(least / period - SAME_LENGTH)
    return window if window <= most else least


def _looped(period: float, window: float) -> float:
    """s of flight: whole loops, enough for a window that begins anywhere in a loop."""
    return min(MAX_DURATION, period * math.ceil(max(LOOPED, window + period) / period - SAME_LENGTH))


def _anchor(path: Signal, duration: float, *, z_up: bool) -> Vec3:
    """Below the middle of the path's box, outside it by NEAREST or more; in decimetres. The origin for a path that is
    farther away than an anchor may be."""
    places = path(np.linspace(0, duration, BOX_SAMPLES))
    low, high = places.min(axis=0), places.max(axis=0)
    outside = max(NEAREST, SHARE * float((high - low).max()))
    x, y, _ = (low + high) / 2
    z = low[2] - outside if z_up else high[2] + outside
    if max(abs(x), abs(y), abs(z)) > FARTHEST:
        return 0.0, 0.0, 0.0
    return round(float(x), 1) + 0.0, round(float(y), 1) + 0.0, round(float(z), 1) + 0.0


def source(result: ImportResult, path: Signal | None = None) -> Source:
    """Where a path (None: as it was read) comes from. Raises ValueError for a file without a path."""
    path = result.path if path is None else path
    if path is None:
        raise ValueError(f"{result.source}: holds no path")
    return Source(
        file=_printable(result.source)[-MAX_FILE:] or "?",
        sha256=result.sha256,
        format=cast(SourceFormat, result.format),
        derivatives=result.derivatives,
        fitted=result.fitted[:MAX_WORDS],
        unjudged=(result.unjudged or "")[:MAX_WORDS],
        path_sha256=fingerprint(path),
    )


def _printable(name: str) -> str:
    """A file's name as it can be shown on one line."""
    return "".join(c if c.isprintable() else "?" for c in name)
