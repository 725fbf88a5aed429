"""The path p(t) = base(t) + wiggle(t) + offset + drift t: editors of its parts, and changes of the whole path.

The wiggle is optional, and may be of another family than the base."""

import math
from collections.abc import Callable
from typing import cast

import msgspec
import numpy as np

from explorer.model.glossary import MOTION
from explorer.model.settings import Drafts
from explorer.panels.motion.families import PATH_LABELS, ROWS
from explorer.panels.motion.families.editor import SignalSlot
from explorer.panels.motion.signal import SignalEditor
from explorer.widgets.controls import Choice, Number, Switch
from explorer.widgets.form import Form
from explorer.widgets.section import Section
from explorer.widgets.vector import Vector
from rangenav import signals, so3
from rangenav.inputs import Vec3, require
from rangenav.signals import Family, Multisine, Signal, Sum, Tone

PATH = SignalSlot(
    menu=MOTION["path family"].label, unit="m", amplitude=(-3.0, 3.0), frequency=(0.05, 20.0), open_tones=1
)
WIGGLE = SignalSlot(menu="second motion made of", unit="m", amplitude=(-1.0, 1.0), frequency=(0.05, 20.0), open_tones=0)
FAMILY_HINT = (
    "; ".join(f"{row.path_label}: {row.path_hint}" for row in ROWS if row.path_label)
    + ". Each keeps what is entered in it."
)
FIRST_WIGGLE = Multisine(tones=(Tone(axis="z", amplitude=0.1, frequency=6.0),))
"""The wiggle offered at first, on the axis that planar paths lack."""
ZERO: Vec3 = (0.0, 0.0, 0.0)
AXES: dict[int, str] = {0: "x", 1: "y", 2: "z"}


class PathPanel:
    """The editors of base and wiggle, and the sum's offset and drift."""

    def __init__(self, form: Form) -> None:
        self.section = section = Section(form, "Path p(t), inertial axes")
        with section:
            self.base_editor = SignalEditor(form, PATH, PATH_LABELS, hint=FAMILY_HINT)
            self._wiggle_section = Section(form)
            with self._wiggle_section:
                self._has_wiggle = Switch(
                    self._wiggle_section, MOTION["second motion"].label, hint=MOTION["second motion"].hint
                )
            self._wiggle_editor = SignalEditor(form, WIGGLE, PATH_LABELS, hint=FAMILY_HINT, visible=False)
            self._sum_offset = _SumOffset(form)

    def refresh(self, duration: float) -> None:
        """Show the editors of the path chosen. Raises InvalidInputError after showing the reason below the control.

        A family that was just chosen may start from the signal as it is over the duration (s) of the flight.
        """
        self.base_editor.refresh(duration)
        has_wiggle = self._has_wiggle.read()
        self._show_wiggle(has_wiggle)
        if has_wiggle:
            self._wiggle_editor.refresh(duration)
            with self._wiggle_section.catching():
                self.read()

    def read(self) -> Signal:
        """The path in the editors on the page. Raises InvalidInputError."""
        base = cast(Family, self.base_editor.read())
        if not self._wiggle_editor.visible:
            return base
        wiggle = cast(Family, self._wiggle_editor.read())
        with self._wiggle_section.checking():
            return self._sum_offset.read(Sum(base=base, wiggle=wiggle))

    def write(self, path: Signal, base: Signal, drafts: Drafts) -> None:
        """Show a path."""
        (first, second), (first_base, second_base) = _parts(path), _parts(base)
        self.base_editor.write(first, first_base, drafts.path)
        self._has_wiggle.write(second is not None, second_base is not None)
        if second is not None:
            self._wiggle_editor.write(second, second_base, drafts.wiggle)
        elif drafts.wiggle:
            *others, last = drafts.wiggle
            self._wiggle_editor.write(last, second_base, tuple(others))
        else:
            self._wiggle_editor.write(FIRST_WIGGLE, second_base)
        self._sum_offset.write(path, base)
        self._show_wiggle(second is not None)

    def drafts(self) -> tuple[tuple[Family, ...], tuple[Family, ...]]:
        """The drafts of base and wiggle, besides the path itself. A wiggle that is switched off comes last."""
        wiggle_drafts = self._wiggle_editor.drafts()
        if not self._wiggle_editor.visible and self._wiggle_editor.signal != FIRST_WIGGLE:
            wiggle_drafts = (*wiggle_drafts, self._wiggle_editor.signal)
        return cast(tuple[Family, ...], self.base_editor.drafts()), cast(tuple[Family, ...], wiggle_drafts)

    def replace(self, path: Signal) -> None:
        """Show another path; what the controls are reset to stays as it was."""
        first, second = _parts(path)
        self.base_editor.replace(first)
        if second is not None:
            self._wiggle_editor.replace(second)
        self._sum_offset.replace(path)

    @property
    def points(self) -> tuple[Vec3, ...]:
        """The waypoints of the base, if it has any, with the sum's offset and without the wiggle."""
        return tuple(_translated(point.value, self._offset, 1) for point in self.base_editor.points)

    def move(self, index: int, value: Vec3) -> None:
        """Move a waypoint of the base to a position (m)."""
        self.base_editor.move(index, _translated(value, self._offset, -1))

    @property
    def _offset(self) -> Vec3:
        return self._sum_offset.offset if self._has_wiggle.read() else ZERO

    def _show_wiggle(self, visible: bool) -> None:
        self._wiggle_editor.show(visible)
        self._sum_offset.section.show(visible)


class _SumOffset:
    """Offset and drift of a sum; its parts may have their own."""

    def __init__(self, form: Form) -> None:
        self.section = section = Section(form, "Offset and drift of the sum", expanded=False)
        with section:
            self._offset = Vector(
                section, "offset of the sum (m)", hint="Added to the sum of both motions, in inertial axes."
            )
            self._drift = Vector(
                section,
                "drift of the sum (m/s)",
                hint="A constant velocity added to the sum, in inertial axes. It excites nothing.",
            )

    def read(self, path: Sum) -> Sum:
        return msgspec.structs.replace(path, offset=self._offset.read(), drift=self._drift.read())

    def write(self, path: Signal, base: Signal) -> None:
        current = path if isinstance(path, Sum) else None
        original = base if isinstance(base, Sum) else None
        self._offset.write(current.offset if current else ZERO, original.offset if original else ZERO)
        self._drift.write(current.drift if current else ZERO, original.drift if original else ZERO)

    @property
    def offset(self) -> Vec3:
        return self._offset.read()

    def replace(self, path: Signal) -> None:
        if isinstance(path, Sum):
            self._offset.show(path.offset)
            self._drift.show(path.drift)


class PathTransforms:
    """Scale, turn, mirror and centre the path about the anchor; every press is a step to undo."""

    def __init__(self, form: Form, edit: Callable[[Callable[[Signal, Vec3], Signal]], None]) -> None:
        self._edit = edit
        self._section = section = Section(form, "Whole path: scale, turn, mirror, centre", expanded=False)
        with section:
            hint = "All these keep the anchor where it is and change the path about it; Ctrl+Z takes a press back."
            self._factor = Number(
                section,
                "size factor",
                hint=f"How many times larger “scale” makes the path, seen from the anchor. {hint}",
            )
            self._axis = Choice(
                section, "axis or normal", AXES, hint="The axis of “turn”, through the anchor; the normal of “mirror”."
            )
            self._angle = Number(
                section, "angle of the turn (°)", hint="By how much “turn” turns the path, right-handed about the axis."
            )
            actions = {
                "scale": lambda: self._change(self._scaled),
                "turn": lambda: self._change(self._turned),
                "mirror": lambda: self._change(self._mirrored),
                "centre": lambda: self._change(self._centred),
            }
            form.buttons("", actions, hint=f"centre moves the middle of the path's box onto the anchor. {hint}")
        self._factor.write(1.25, 1.25)
        self._angle.write(30.0, 30.0)
        self._axis.write(2, 2)
        self._duration = 20.0

    def set_duration(self, duration: float) -> None:
        """The duration (s) of the flight whose bounding box `centre` moves."""
        self._duration = duration

    def _change(self, edit: Callable[[Signal, Vec3], Signal]) -> None:
        with self._section.answering():
            self._edit(edit)

    def _scaled(self, path: Signal, anchor: Vec3) -> Signal:
        return signals.scaled(path, self._factor.read(), about=anchor)

    def _turned(self, path: Signal, anchor: Vec3) -> Signal:
        angle = self._angle.read()
        require(math.isfinite(angle), f"angle must be a finite number, got {angle}")
        return signals.rotated(path, so3.exp(math.radians(angle) * np.eye(3)[self._axis.read()]), about=anchor)

    def _mirrored(self, path: Signal, anchor: Vec3) -> Signal:
        x, y, z = np.eye(3)[self._axis.read()]
        return signals.mirrored(path, (float(x), float(y), float(z)), about=anchor)

    def _centred(self, path: Signal, anchor: Vec3) -> Signal:
        return signals.centred(path, anchor, duration=self._duration)


def _translated(point: Vec3, offset: Vec3, sign: int) -> Vec3:
    return point[0] + sign * offset[0], point[1] + sign * offset[1], point[2] + sign * offset[2]


def _parts(path: Signal) -> tuple[Family, Family | None]:
    return (path.base, path.wiggle) if isinstance(path, Sum) else (path, None)
