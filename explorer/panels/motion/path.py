"""The path: a base of one family, and if wanted a wiggle of another on top; and what can be done to it as a whole."""

import math
from collections.abc import Callable
from typing import cast

import msgspec
import numpy as np

from explorer.model.conversion import FamilyName
from explorer.model.settings import Drafts
from explorer.panels.motion.families import SignalSlot
from explorer.panels.motion.signal import SignalEditor
from explorer.widgets.controls import Choice, Number, Switch, Vector
from explorer.widgets.form import Form, Section
from rangenav import signals, so3
from rangenav.inputs import Vec3, require
from rangenav.signals import Family, Multisine, Signal, Sum, Tone

PATH = SignalSlot(unit="m", amplitude=(-3.0, 3.0), frequency=(0.05, 20.0), step=0.01, open_tones=1)
WIGGLE = SignalSlot(unit="m", amplitude=(-1.0, 1.0), frequency=(0.05, 20.0), step=0.01, open_tones=0)
FAMILIES: dict[FamilyName, str] = {
    "multisine": "sines",
    "formula": "formulas",
    "waypoints": "waypoints",
    "minimum-snap": "minimum snap",
    "polynomials": "polynomials",
}
FAMILY_HINT = (
    "sines: tones on each axis; formulas: an expression in t; waypoints: a smooth curve (C⁸) through timed points; "
    "minimum snap: what flight planners make, which lowers what this needs; polynomials: pieces as in flight files. "
    "What is entered in one is kept while another is in use."
)
FIRST_WIGGLE = Multisine(tones=(Tone(axis="z", amplitude=0.1, frequency=6.0),))
"""Of the axis that planar paths lack."""
NONE: Vec3 = (0.0, 0.0, 0.0)
AXES: dict[int, str] = {0: "x", 1: "y", 2: "z"}


class PathPanel:
    """Editors of base and wiggle, and the tools for the whole path."""

    def __init__(self, form: Form) -> None:
        self.section = section = Section(form, "Path p(t), inertial axes")
        with section:
            self._base = SignalEditor(form, PATH, FAMILIES, hint=FAMILY_HINT)
            self._switches = Section(form)
            with self._switches:
                hint = "A second signal added to the path, of any family: a planar path may need only a little of it."
                self._wiggled = Switch(self._switches, "plus a wiggle", hint=hint)
            self._wiggle = SignalEditor(form, WIGGLE, FAMILIES, hint=FAMILY_HINT, shown=False)
            self._straight = _Straight(form)

    def read(self, duration: float) -> Signal:
        """The path chosen. Raises Refused after saying why beside the control."""
        base = cast(Family, self._base.read(duration))
        wiggled = self._wiggled.read()
        self._show_wiggle(wiggled)
        if not wiggled:
            return base
        wiggle = cast(Family, self._wiggle.read(duration))
        with self._switches.catching():
            return self._straight.read(Sum(base=base, wiggle=wiggle))

    def write(self, path: Signal, base: Signal, drafts: Drafts) -> None:
        """Show a path."""
        (first, second), (first_base, second_base) = _parts(path), _parts(base)
        self._base.write(first, first_base, drafts.path)
        self._wiggled.write(second is not None, second_base is not None)
        if second is not None:
            self._wiggle.write(second, second_base, drafts.wiggle)
        elif drafts.wiggle:
            *others, last = drafts.wiggle
            self._wiggle.write(last, second_base, tuple(others))
        else:
            self._wiggle.write(FIRST_WIGGLE, second_base)
        self._straight.write(path, base)
        self._show_wiggle(second is not None)

    def drafts(self) -> tuple[tuple[Family, ...], tuple[Family, ...]]:
        """What is kept of base and wiggle beside the path itself; a wiggle that is off comes last of its own."""
        kept = self._wiggle.drafts()
        if not self._wiggled.read() and self._wiggle.signal != FIRST_WIGGLE:
            kept = (*kept, self._wiggle.signal)
        return cast(tuple[Family, ...], self._base.drafts()), cast(tuple[Family, ...], kept)

    def put(self, path: Signal) -> None:
        """Show another path in place of this one."""
        first, second = _parts(path)
        self._base.put(first)
        if second is not None:
            self._wiggle.put(second)
        self._straight.put(path)

    @property
    def points(self) -> tuple[Vec3, ...]:
        """Where the waypoints of the base are, if it has any: with a sum's offset, without its wiggle."""
        return tuple(_plus(point.value, self._offset, 1) for point in self._base.points)

    def move(self, index: int, value: Vec3) -> None:
        """Put a waypoint of the base elsewhere."""
        self._base.move(index, _plus(value, self._offset, -1))

    @property
    def _offset(self) -> Vec3:
        return self._straight.offset if self._wiggled.read() else NONE

    def _show_wiggle(self, visible: bool) -> None:
        self._wiggle.show(visible)
        self._straight.section.show(visible)


class _Straight:
    """Offset and drift of a sum; its parts have their own where their family has."""

    def __init__(self, form: Form) -> None:
        self.section = section = Section(form, "Offset and drift of the sum", expanded=False)
        with section:
            self._offset = Vector(section, "sum's offset (m)", step=0.01, hint="m, inertial axes: added to both.")
            self._drift = Vector(
                section, "sum's drift (m/s)", step=0.01, hint="m/s, inertial axes; it excites nothing."
            )

    def read(self, path: Sum) -> Sum:
        return msgspec.structs.replace(path, offset=self._offset.read(), drift=self._drift.read())

    def write(self, path: Signal, base: Signal) -> None:
        shown = path if isinstance(path, Sum) else None
        origin = base if isinstance(base, Sum) else None
        self._offset.write(shown.offset if shown else NONE, origin.offset if origin else NONE)
        self._drift.write(shown.drift if shown else NONE, origin.drift if origin else NONE)

    @property
    def offset(self) -> Vec3:
        return self._offset.read()

    def put(self, path: Signal) -> None:
        if isinstance(path, Sum):
            self._offset.show(path.offset)
            self._drift.show(path.drift)


class WholePath:
    """Scale, turn, mirror, centre: each press changes the path itself, and Ctrl+Z takes it back."""

    def __init__(self, form: Form, edit: Callable[[Callable[[Signal, Vec3], Signal]], None]) -> None:
        self._edit = edit
        self._section = section = Section(form, "Whole path: scale, turn, mirror, centre", expanded=False)
        with section:
            hint = "All these keep the anchor where it is and change the path about it; Ctrl+Z takes a press back."
            self._factor = Number(section, "factor", step=0.1, hint=f"Times as large, seen from the anchor. {hint}")
            self._axis = Choice(section, "axis", AXES, hint="To turn about, through the anchor; or a mirror's normal.")
            self._angle = Number(section, "angle (°)", step=5.0, hint="To turn by, right-handed about the axis.")
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

    def fit(self, duration: float) -> None:
        """How long (s) the flight is whose box is centred."""
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


def _plus(place: Vec3, offset: Vec3, sign: int) -> Vec3:
    return place[0] + sign * offset[0], place[1] + sign * offset[1], place[2] + sign * offset[2]


def _parts(path: Signal) -> tuple[Family, Family | None]:
    return (path.base, path.wiggle) if isinstance(path, Sum) else (path, None)
