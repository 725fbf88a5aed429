"""What the check of a lesson judges, and what it answers.

A state is a frozen value: the page makes it from what is shown, and a test reads it from a file. The file names a
preset, and what differs from it:

    preset = "circle"              # a shipped preset
    [set.path]                     # a table is merged into the preset's; one of another `kind` takes its place
    tones = [...]
    [answers]                      # what was answered in the lesson
    misprints = "model"
    [pinned]                       # the same again, for the pinned run A
    preset = "paper-slow"
"""

import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any, Literal, NamedTuple

import msgspec

from explorer.model.settings import Drafts, Printed, Settings, effective
from rangenav import formats, preset, toml_limits
from rangenav.inputs import Vec3, require, shortened
from rangenav.preset import Preset
from rangenav.vehicle import BY_NAME

CACHED = 8
"""Exported files, each of which takes a tenth of a second to make."""


class Outcome(NamedTuple):
    """What a check answers."""

    metric: float
    """The number that the bar shows, in the unit that the lesson names; NaN if there is none yet."""
    passed: bool
    hint: str
    """What is still missing, or what was reached, in one sentence."""


@dataclass(frozen=True, kw_only=True)
class State:
    """Everything that a check may look at."""

    settings: Settings
    pinned: Settings | None = None
    """The settings of the pinned run A."""
    answers: Mapping[str, str] = field(default_factory=dict)
    """What was answered in this lesson, by the name of its question."""
    exported: tuple[str, bytes] | None = None
    """The name of the format and the content of the file that was exported last."""

    @property
    def preset(self) -> Preset:
        """The preset as it is computed: time scale and printed initial values applied."""
        return effective(self.settings)


class StateFile(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The content of a state's file."""

    preset: str
    set: dict[str, Any] = {}
    vehicle: str = ""
    """A vehicle of the catalogue in place of the preset's, by its typed name: free, crazyflie-2.1."""
    time_scale: float = 1.0
    printed: Printed = Printed()
    twin_turn: Vec3 | None = None
    drafts: Drafts = Drafts()
    """What appears once another family is chosen: the points of a path that the student is to complete, for example."""
    answers: dict[str, str] = {}
    pinned: "StateFile | None" = None
    exported: Literal["", "polynomial", "reference"] = ""
    """The format in which the preset was exported; its file is made when the state is read."""


def read(path: Path) -> State:
    """The state in a file. Raises ValueError with one sentence that begins with the file's name."""
    try:
        text = path.read_text(encoding="utf-8")
        return _state(toml_limits.decode(text, StateFile))
    except OSError as error:
        raise ValueError(f"{path.name}: cannot be read: {error.strerror}") from None
    except ValueError as error:  # msgspec's and that of a text that is not UTF-8 are ones
        raise ValueError(f"{path.parent.name}/{path.name}: {shortened(str(error))}") from None


def _state(file: StateFile) -> State:
    settings = _settings(file)
    return State(
        settings=settings,
        pinned=_settings(file.pinned) if file.pinned is not None else None,
        answers=file.answers,
        exported=_exported(file.exported, effective(settings)) if file.exported else None,
    )


def _settings(file: StateFile) -> Settings:
    chosen = preset.load(file.preset)
    if file.set:
        chosen = msgspec.convert(_merged(msgspec.to_builtins(chosen), file.set), Preset)
    if file.vehicle:
        require(file.vehicle in BY_NAME, f"vehicle must be one of {', '.join(BY_NAME)}, got {file.vehicle!r}")
        chosen = msgspec.structs.replace(chosen, vehicle=BY_NAME[file.vehicle])
    return Settings(
        origin=file.preset,
        preset=chosen,
        time_scale=file.time_scale,
        printed=file.printed,
        twin_turn=file.twin_turn,
        drafts=file.drafts,
    )


def _merged(table: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """A table with changes; a table within it is merged too, unless the change states another kind."""
    merged = dict(table)
    for key, change in changes.items():
        before = table.get(key)
        if isinstance(before, Mapping) and isinstance(change, Mapping) and _same_kind(before, change):
            merged[key] = _merged(before, change)
        else:
            merged[key] = change
    return merged


def _same_kind(before: Mapping[str, Any], change: Mapping[str, Any]) -> bool:
    return change.get("kind", before.get("kind")) == before.get("kind")


@lru_cache(maxsize=CACHED)
def _exported(name: str, chosen: Preset) -> tuple[str, bytes]:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"motion{formats.row(name).suffix}"
        formats.export(chosen, name, path)
        return name, path.read_bytes()
