"""A preset from an imported path: flown where it can be, and judged over windows of six seconds."""

from pathlib import Path

from rangenav.formats.imported import Imported, gravity, settled
from rangenav.inputs import Vec3
from rangenav.motion import World
from rangenav.preset import MAX_DURATION, MAX_TITLE, Preset, Requirement
from rangenav.signals import Flown, Multisine, Turning

WINDOW = 6.0
"""s, as in the shipped presets; half the flight where that is shorter."""
MAGNETIC = 0.7071067811865476
"""North and down in equal parts, as in the shipped presets."""


def as_preset(found: Imported, *, duration: float | None = None, anchor: Vec3 = (0.0, 0.0, 0.0)) -> Preset:
    """The preset of a path that was read. Raises ValueError for open questions, or a file that holds no path."""
    settled(found)
    if found.path is None:
        raise ValueError(f"{found.source}: holds a recorded flight and no path: ask `rangenav log` about it")
    length = min(duration or found.duration, MAX_DURATION)
    world = World(
        gravity=gravity(found.frame),
        magnetic=(MAGNETIC, 0.0, -MAGNETIC if found.frame == "z-up" else MAGNETIC),
        anchor=anchor,
    )

    def made(turning: Turning) -> Preset:
        return Preset(
            title=Path(found.source).stem[:MAX_TITLE] or "imported",
            story=f"Imported from {found.format}."
            if found.unjudged is None
            else f"Imported from {found.format}; its snap is the knots', not the flight's.",
            duration=length,
            path=found.path,  # type: ignore[arg-type]
            angular_velocity=turning,
            world=world,
            requirement=Requirement(window=min(WINDOW, length / 2)),
        )

    try:
        return made(Flown())
    except ValueError as error:
        if "flown" not in str(error):
            raise ValueError(f"{found.source}: {error}") from None
    try:
        return made(Multisine())
    except ValueError as error:
        raise ValueError(f"{found.source}: {error}") from None
