"""The preset of an imported path: flown if a multirotor can fly it, windows of six seconds, and its source."""

from pathlib import Path
from typing import cast

from rangenav.formats.import_result import ImportResult, gravity, settled
from rangenav.inputs import Vec3, require
from rangenav.motion import World
from rangenav.preset import MAX_DURATION, MAX_TITLE, MIN_DURATION, Preset, Requirement
from rangenav.provenance import MAX_FILE, MAX_WORDS, Source, SourceFormat, fingerprint
from rangenav.signals import AngularVelocity, Flown, Multisine

WINDOW = 6.0
"""s, as in the shipped presets; half the flight if that is shorter."""
MAGNETIC = 0.7071067811865476
"""Each of the field's components, north and down, as in the shipped presets."""
SAME_LENGTH = 1e-6
"""Share by which a duration may be rounded up."""


def as_preset(result: ImportResult, *, duration: float | None = None, anchor: Vec3 = (0.0, 0.0, 0.0)) -> Preset:
    """The preset of a path that was read. Raises ValueError for open questions, or a file that holds no path."""
    settled(result)
    if result.path is None:
        raise ValueError(f"{result.source}: holds a recorded flight and no path: ask `rangenav log` about it")
    longest = min(result.duration, MAX_DURATION)
    length = longest if duration is None else duration
    rule = f"duration must lie between {MIN_DURATION:g} s and the file's {longest:.6g} s, got {length:g} s"
    require(MIN_DURATION <= length <= longest * (1 + SAME_LENGTH), f"{result.source}: {rule}")
    path, origin = result.path, source(result)
    world = World(
        gravity=gravity(result.frame),
        magnetic=(MAGNETIC, 0.0, -MAGNETIC if result.frame == "z-up" else MAGNETIC),
        anchor=anchor,
    )

    def made(turning: AngularVelocity) -> Preset:
        return Preset(
            title=_printable(Path(result.source).stem)[:MAX_TITLE].strip() or "imported",
            story=f"Imported from {result.format}."
            if result.derivatives == "file"
            else f"Imported from {result.format}; its snap is the fit's, not the flight's.",
            duration=length,
            path=path,
            angular_velocity=turning,
            world=world,
            requirement=Requirement(window=min(WINDOW, length / 2)),
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


def source(result: ImportResult) -> Source:
    """Where the path comes from. Raises ValueError for a file without a path."""
    if result.path is None:
        raise ValueError(f"{result.source}: holds no path")
    return Source(
        file=_printable(result.source)[-MAX_FILE:] or "?",
        sha256=result.sha256,
        format=cast(SourceFormat, result.format),
        derivatives=result.derivatives,
        fitted=result.fitted[:MAX_WORDS],
        unjudged=(result.unjudged or "")[:MAX_WORDS],
        path_sha256=fingerprint(result.path),
    )


def _printable(name: str) -> str:
    """A file's name as it can be shown on one line."""
    return "".join(c if c.isprintable() else "?" for c in name)
