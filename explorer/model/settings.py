"""What one visitor has chosen: a preset, a time scale, and which of the paper's misprints to follow.

The names of the fields are part of the file format of saved work.
"""

from typing import Literal

import msgspec

from rangenav import axes, signals
from rangenav.attitude import Schedule
from rangenav.inputs import Input, Vec3, require, require_within
from rangenav.preset import Preset
from rangenav.signals import AngularVelocity, Family

GainUnits = Literal["paper", "physical"]
"""The units in which gains are shown. They change no result, so they are not part of Settings and not undone."""
MIN_TIME_SCALE, MAX_TIME_SCALE = 0.1, 10.0
MAX_DRAFTS = 8
PRINTED_POSITION = (1.0, 0.0, 0.0)
PRINTED_VELOCITY = (-0.0125, 2.5, -4.33)
"""The initial values that the paper prints (m, m/s). They do not belong to its path: see docs, "Departures"."""


class Printed(Input, frozen=True, kw_only=True):
    """One switch for each departure from the printed paper that changes a computation; True follows the paper."""

    model: bool = False
    """C_5 = 0 and input |g|² in the observer's model."""
    excitation: bool = False
    """φ = ä − ω×ȧ − 2ω×(ω×a)."""
    reduced_row: bool = False
    """r_{4,2} = 4ȧᵀ − 3aᵀ[ω]x."""
    body_axes: bool = False
    """The excitation integral in body axes."""
    initial_values: bool = False
    """p(0) and v(0) as printed: the path then drifts away from its formula."""
    attitude_rate: bool = False
    """Time constants of the attitude error as printed, twice the true ones."""


PRINTED_LABELS = {
    "model": "use the paper's misprinted model",
    "excitation": "printed signal φ",
    "reduced_row": "printed row r₄,₂",
    "body_axes": "excitation in body axes",
    "initial_values": "printed initial values",
    "attitude_rate": "printed attitude rate",
}
"""The label of each switch."""


class Drafts(Input, frozen=True, kw_only=True):
    """What was entered and is not in use: choosing another family, or switching a part off, loses nothing."""

    path: tuple[Family, ...] = ()
    wiggle: tuple[Family, ...] = ()
    angular_velocity: tuple[AngularVelocity, ...] = ()
    schedule: Schedule = Schedule()
    """The schedule of k1 while it is switched off."""

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("path", "wiggle", "angular_velocity"):
            count = len(getattr(self, name))
            require(count <= MAX_DRAFTS, f"at most {MAX_DRAFTS} drafts of a {name} are kept, got {count}")


class Settings(Input, frozen=True, kw_only=True):
    """Everything that decides what the page shows, and the drafts."""

    origin: str = ""
    """The name of the preset that the settings come from; the page marks what differs from it."""
    edition: str = ""
    """The edition of the visitor's own file that was opened, so that no other edition is overwritten; else empty."""
    preset: Preset
    time_scale: float = 1.0
    """The path runs this many times slower."""
    printed: Printed = Printed()
    drafts: Drafts = Drafts()
    twin_turn: Vec3 | None = None
    """The chosen turn of the evil twin about the anchor (rotation vector, rad); None: the default turn."""

    def __post_init__(self) -> None:
        super().__post_init__()
        require_within("time_scale", self.time_scale, MIN_TIME_SCALE, MAX_TIME_SCALE)


def _printed_start(preset: Preset) -> dict[str, Vec3]:
    """The printed initial values, in the axes of the preset."""
    start = {"position": PRINTED_POSITION, "velocity": PRINTED_VELOCITY}
    if preset.world.gravity[2] >= 0:
        return start
    return {name: axes.flipped_vector(vector) for name, vector in start.items()}


def is_another(before: Settings, after: Settings) -> bool:
    """Whether other settings come from another preset. The same preset saved or renamed is no other one."""
    if before.origin == after.origin:
        return False
    try:
        saved, shown = effective(after), effective(before)
    except ValueError:  # what cannot be computed cannot have been saved
        return True
    return msgspec.structs.replace(saved, title=shown.title, story=shown.story, expect=shown.expect) != shown


def effective(settings: Settings) -> Preset:
    """The preset that is computed, downloaded and judged: time scale and printed initial values change its path."""
    path = settings.preset.path
    if settings.time_scale != 1.0:
        path = signals.slowed(path, settings.time_scale)
    if settings.printed.initial_values:
        path = signals.with_start(path, **_printed_start(settings.preset))
    if path is settings.preset.path:  # the preset is not checked again
        return settings.preset
    return msgspec.structs.replace(settings.preset, path=path)
