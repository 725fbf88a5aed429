"""Waypoints and minimum snap: timed points, dragged in the scene, typed as a table, or moved one at a time."""

from typing import Generic, Literal, TypeVar

import msgspec

from explorer.panels.motion.families.editor import SignalSlot
from explorer.panels.motion.families.table import Table
from explorer.widgets.controls import Choice, Number, Text
from explorer.widgets.form import Form
from explorer.widgets.section import Section, complaining
from explorer.widgets.vector import Vector
from rangenav.inputs import Vec3, require
from rangenav.signals import MinimumSnap, Waypoint, Waypoints, waypoints
from rangenav.signals.waypoints import MAX_POINTS

F = TypeVar("F", Waypoints, MinimumSnap)
MAX_TEXT = 250_000
"""Characters of the table: more than 2000 points with all their digits."""
MAX_LISTED = 200
"""Points that the dropdown lists; the table has all of them."""
Ends = Literal["rest", "free", "closed"]
ENDS: dict[Ends, str] = {
    "rest": "open: at rest at both ends",
    "free": "open: in motion at both ends",
    "closed": "closed: it comes back to the first",
}
DEFAULT_GAP = 1.0
"""s from the last point back to the first where the curve has no other gap to go by."""


class PointsEditor(Generic[F]):
    """One curve. The editor owns the curve; the table, the boxes and the drag handles in the scene are views of it."""

    def __init__(self, form: Form, slot: SignalSlot, first: F) -> None:
        self._signal, self._index = first, 0
        """The curve, and the index of the point that the boxes show."""
        self._point_in_boxes = first.points[0]
        self._text_of_points, self._formatted = "", first.points[:0]
        """The text of the table, and the points for which it was written."""
        self._section = section = Section(form)
        with section:
            hint = "Whether the curve ends at its last point, at rest or in motion, or closes smoothly and repeats."
            self._ends = Choice(section, "ends of the curve", ENDS, hint=hint)
            hint = "How long a closed curve takes until it is back at its first point."
            self._period = Number(section, "period (s)", hint=hint)
            hint = f"One point per line: t x y z, in s and {slot.unit}; times must increase. Paste a whole path here."
            self._text = Text(section, "points, a line t x y z each", hint=hint, longest=MAX_TEXT, lines=True)
        self._point_section = Section(form)
        with self._point_section as section:
            hint = "The point that the boxes below move; dragging one in the scene chooses it."
            self._chosen = Choice(section, "chosen point", {0: "1"}, hint=hint)
            hint = "When the curve is at this point: later than at the point before, earlier than at the next."
            self._time = Number(section, "time of the point (s)", hint=hint)
            hint = "Where the curve is at that time."
            self._value = Vector(section, f"position of the point ({slot.unit})", hint=hint)
            hint = "A point between this one and the next, where the curve passes already; or none where this one is."
            actions = {"+ after it": self._insert, "− delete it": self._delete}
            form.buttons("", actions, hint=hint)

    @property
    def points(self) -> tuple[Waypoint, ...]:
        """The points of the curve."""
        return self._signal.points

    def refresh(self) -> None:
        """Own the curve that the controls make, and show it in all of them. Raises InvalidInputError after showing the
        reason below the control."""
        with complaining(self._section, self._point_section):
            signal, points, text = self._typed()
            with self._point_section.checking():
                self._index = self._chosen.read()
        if self._signal.period is None and signal.period is not None:
            self._period.show(signal.period)  # just closed: the box may have held a period that is too short
        if signal.points == points:
            self._signal, self._text_of_points = signal, text  # the text stays as it was typed
            self._show_boxes()
        else:
            self._set(signal)

    def read(self) -> F:
        """The curve with what the visitor has moved: the table, the ends, or the boxes of the point they show.

        Raises InvalidInputError.
        """
        signal, _, _ = self._typed()
        return signal

    def write(self, signal: F, base: F | None) -> None:
        """Show a curve."""
        self._set(signal)
        self._text.write(self._text_of_points, TABLE.format(base.points) if base else None)
        self._ends.write(_ends_of(signal), _ends_of(base) if base else None)
        self._period.write(signal.period or _suggested_period(signal), base.period if base else None)

    def move(self, index: int, value: Vec3) -> None:
        """Move a point to a position, as a drag does. Raises InvalidInputError after showing the reason."""
        with self._section.catching():
            if 0 <= index < len(self.points):
                self._index = index
                self._set(waypoints.move(self._signal, index, value))

    def show(self, visible: bool) -> None:
        """Show or hide all of it."""
        self._section.show(visible)
        self._point_section.show(visible)

    def _set(self, signal: F) -> None:
        """Another curve: the table and the boxes show it."""
        self._signal, self._formatted, self._text_of_points = signal, signal.points, TABLE.format(signal.points)
        self._text.show(self._text_of_points)
        self._show_boxes()

    def _typed(self) -> tuple[F, tuple[Waypoint, ...], str]:
        """The curve that the controls make, and the points and the text of the table in it."""
        with self._section.checking():
            text = self._text.read()
            points = self.points if text == self._text_of_points else TABLE.parse(text, self._formatted)
            require(2 <= len(points) <= MAX_POINTS, f"2 to {MAX_POINTS} waypoints make a path, got {len(points)}")
            curve = self._with_ends(points)
        with self._point_section.checking():
            return self._with_boxes(curve), points, text

    def _with_ends(self, points: tuple[Waypoint, ...]) -> F:
        """The curve through the points, open or closed as the controls say."""
        ends, period = self._ends.read(), self._period.read()
        closed, free = ends == "closed", ends == "free"
        if closed and self._signal.period is None and period <= points[-1].time - points[0].time:
            period = _suggested_period(self._signal)
        chosen = period if closed else None
        if (points, chosen, free) == (self.points, self._signal.period, self._signal.free_ends):
            return self._signal
        return msgspec.structs.replace(self._signal, points=points, period=chosen, free_ends=free)

    def _with_boxes(self, signal: F) -> F:
        """The curve with what the boxes say of the chosen point, if they were moved since they were shown."""
        index = self._chosen.read()
        if index != self._index or index >= len(signal.points):
            return signal
        time, value = self._time.read(), self._value.read()
        if (time, value) == (self._point_in_boxes.time, self._point_in_boxes.value):
            return signal
        return waypoints.move(waypoints.retime(signal, index, time), index, value)

    def _show_boxes(self) -> None:
        """Offer the points, and show the chosen one."""
        count = len(self.points)
        self._index = min(self._index, count - 1)
        self._chosen.offer({i: str(i + 1) for i in range(min(count, max(MAX_LISTED, self._index + 1)))})
        if self._chosen.read() != self._index:
            self._chosen.show(self._index)
        point = self.points[self._index]
        shown = self._time.read(), self._value.read()
        if point != self._point_in_boxes or shown != (point.time, point.value):
            self._point_in_boxes = point
            self._time.show(point.time)
            self._value.show(point.value)

    def _insert(self) -> None:
        with self._point_section.answering():
            self.refresh()
            inserted = waypoints.insert(self._signal, self._index)
            self._index += 1
            self._set(inserted)

    def _delete(self) -> None:
        with self._point_section.answering():
            self.refresh()
            self._set(waypoints.delete(self._signal, self._index))


def waypoints_editor(form: Form, slot: SignalSlot) -> PointsEditor[Waypoints]:
    """The editor of the C⁸ curve."""
    return PointsEditor(form, slot, Waypoints(points=_INITIAL_POINTS))


def minimum_snap_editor(form: Form, slot: SignalSlot) -> PointsEditor[MinimumSnap]:
    """The editor of the curve of least snap."""
    return PointsEditor(form, slot, MinimumSnap(points=_INITIAL_POINTS))


_INITIAL_POINTS = (Waypoint(time=0.0, value=(0.0, 0.0, 0.0)), Waypoint(time=1.0, value=(0.0, 0.0, 0.0)))


def _point(cells: list[float]) -> Waypoint:
    t, x, y, z = cells
    return Waypoint(time=t, value=(x, y, z))


def _cells(point: Waypoint) -> list[float]:
    return [point.time, *point.value]


TABLE = Table(("t", "x", "y", "z"), _point, _cells)


def _ends_of(signal: Waypoints | MinimumSnap) -> Ends:
    return "closed" if signal.period is not None else "free" if signal.free_ends else "rest"


def _suggested_period(signal: Waypoints | MinimumSnap) -> float:
    """A period (s) that leaves as much time from the last point back to the first as other points have on average."""
    times = [point.time for point in signal.points]
    length = times[-1] - times[0]
    return round(length + (length / (len(times) - 1) or DEFAULT_GAP), 3)
