"""The same settings with y and z of all axes reversed: z up instead of down, or down instead of up."""

from msgspec.structs import replace

from explorer.model.settings import Settings
from rangenav import axes
from rangenav.preset import Preset
from rangenav.signals import Family


def relabelled(settings: Settings) -> Settings:
    """The settings in the other axes, with the drafts of families that are not in use."""
    drafts = settings.drafts
    flipped = replace(
        drafts,
        path=tuple(_flipped(draft) for draft in drafts.path),
        wiggle=tuple(_flipped(draft) for draft in drafts.wiggle),
        angular_velocity=tuple(axes.flipped_turning(draft) for draft in drafts.angular_velocity),
    )
    return replace(settings, preset=axes.flipped(settings.preset), drafts=flipped)


def in_axes_of(base: Preset, other: Preset) -> Preset:
    """A preset in the axes of another one: relabelled if their gravities point to opposite sides of z = 0."""
    return axes.flipped(base) if base.world.gravity[2] * other.world.gravity[2] < 0 else base


def _flipped(signal: Family) -> Family:
    flipped = axes.flipped_signal(signal)
    assert isinstance(flipped, Family)  # a signal stays in its family, and only sums are in none
    return flipped
