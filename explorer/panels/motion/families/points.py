"""Waypoints and minimum snap: timed points, dragged in the scene, typed as a table, or moved one at a time."""

from typing import Generic, TypeVar

import msgspec

from explorer.panels.motion.families import SignalSlot, table
from explorer.widgets.controls import Choice, Number, Text, Vector
from explorer.widgets.form import Form, Section
from rangenav.inputs import Vec3, require
from rangenav.signals import MinimumSnap, Waypoint, Waypoints, waypoints
from rangenav.signals.waypoints import MAX_POINTS

F = TypeVar("F", Waypoints, MinimumSnap)
COLUMNS = ("t", "x", "y", "z")
LONGEST = 250_000
"""Characters of a table: more than 2000 points with all their digits."""
MAX_CHOSEN = 200
"""Points offered in the dropdown; the table holds them all."""
OPEN, CLOSED = "open: at rest at both ends", "closed: it comes back to the first"
DEFAULT_GAP = 1.0
"""s from the last point back to the first, if there is no other to go by."""


class PointsEditor(Generic[F]):
    """One curve; the table, the chosen point and the handles in the scene all show the same points."""

    def __init__(self, form: Form, place: SignalSlot, first: F) -> None:
        self._signal, self._index, self._boxed = first, 0, first.points[0]
        self._table = table.Table[Waypoint](COLUMNS, _row, _cells)
        self._section = section = Section(form)
        with section:
            hint = "Whether the curve ends at its last point, at rest, or closes smoothly and repeats."
            self._ends = Choice(section, "ends", {False: OPEN, True: CLOSED}, hint=hint)
            hint = "s from the first point until it is reached again; used by a closed curve."
            self._period = Number(section, "period (s)", step=0.01, hint=hint)
            hint = f"One point per line: t x y z, in s and {place.unit}; times must increase. Paste a whole path here."
            self._text = Text(section, "points: t x y z", hint=hint, longest=LONGEST, lines=True)
        self._one = one = Section(form)
        with one:
            hint = "The point that the boxes below move; dragging one in the scene chooses it."
            self._chosen = Choice(one, "point", {0: "1"}, hint=hint)
            hint = "s: after the point before and before the next."
            self._time = Number(one, "its time (s)", step=0.01, hint=hint)
            hint = f"{place.unit}: where the curve is at that time."
            self._value = Vector(one, f"its place ({place.unit})", step=0.001, hint=hint)
            hint = "A point between this one and the next, where the curve passes already; or none where this one is."
            actions = {"+ after it": self._insert, "− delete it": self._delete}
            form.buttons("", actions, hint=hint)

    @property
    def points(self) -> tuple[Waypoint, ...]:
        """The points as last read or written."""
        return self._signal.points

    def read(self) -> F:
        """The curve. What was moved last counts: a box, the table, or the ends."""
        with self._section.catching():
            points = self._table.parse(self._text.read())
            require(2 <= len(points) <= MAX_POINTS, f"2 to {MAX_POINTS} waypoints make a path, got {len(points)}")
            signal = self._closed(points)
        with self._one.catching():
            signal = self._with_boxes(signal)
        self._take(signal)
        return signal

    def write(self, signal: F, base: F | None) -> None:
        """Show a curve."""
        self._signal = signal
        text = self._table.format(signal.points)
        self._text.write(text, table.Table[Waypoint](COLUMNS, _row, _cells).format(base.points) if base else None)
        self._ends.write(signal.period is not None, base and base.period is not None)
        self._period.write(signal.period or _suggested(signal), base.period if base else None)
        self._show_boxes()

    def move(self, index: int, value: Vec3) -> None:
        """Put a point elsewhere, as when it is dragged. Raises Refused after saying why."""
        with self._section.catching():
            if 0 <= index < len(self._signal.points):
                self._index = index
                self._put(waypoints.move(self._signal, index, value))

    def show(self, visible: bool) -> None:
        """Show or hide all of it."""
        self._section.show(visible)
        self._one.show(visible)

    def _closed(self, points: tuple[Waypoint, ...]) -> F:
        closed, period = self._ends.read(), self._period.read()
        if closed and self._signal.period is None and period <= points[-1].time - points[0].time:
            period = _suggested(self._signal)
            self._period.show(period)
        wanted = period if closed else None
        if (points, wanted) == (self._signal.points, self._signal.period):
            return self._signal
        return msgspec.structs.replace(self._signal, points=points, period=wanted)

    def _with_boxes(self, signal: F) -> F:
        """The curve with what the boxes say of the chosen point, if they were moved since they were shown."""
        index = self._chosen.read()
        if index != self._index or index >= len(signal.points):
            self._index = index
            return signal
        typed = self._time.read(), self._value.read()
        if typed == (self._boxed.time, self._boxed.value):
            return signal
        moved = waypoints.retime(signal, index, typed[0])
        return waypoints.move(moved, index, typed[1])

    def _take(self, signal: F) -> None:
        """Bring everything that was not typed into up to date."""
        if signal.points != self._table.points:
            self._text.show(self._table.format(signal.points))
        self._signal = signal
        self._show_boxes()

    def _put(self, signal: F) -> None:
        self._text.show(self._table.format(signal.points))
        self._signal = signal
        self._show_boxes()

    def _show_boxes(self) -> None:
        points = self._signal.points
        self._index = min(self._index, len(points) - 1)
        self._chosen.offer({i: str(i + 1) for i in range(min(len(points), max(MAX_CHOSEN, self._index + 1)))})
        if self._chosen.read() != self._index:
            self._chosen.show(self._index)
        point = points[self._index]
        if point != self._boxed or self._time.read() != point.time or self._value.read() != point.value:
            self._boxed = point
            self._time.show(point.time)
            self._value.show(point.value)

    def _insert(self) -> None:
        with self._one.answering():
            self.read()
            made = waypoints.insert(self._signal, self._index)
            self._index += 1
            self._put(made)

    def _delete(self) -> None:
        with self._one.answering():
            self.read()
            self._put(waypoints.delete(self._signal, self._index))


def waypoints_editor(form: Form, place: SignalSlot) -> PointsEditor[Waypoints]:
    """For the C⁸ curve."""
    return PointsEditor(form, place, Waypoints(points=_NOWHERE))


def minimum_snap_editor(form: Form, place: SignalSlot) -> PointsEditor[MinimumSnap]:
    """For the curve of least snap."""
    return PointsEditor(form, place, MinimumSnap(points=_NOWHERE))


_NOWHERE = (Waypoint(time=0.0, value=(0.0, 0.0, 0.0)), Waypoint(time=1.0, value=(0.0, 0.0, 0.0)))


def _row(cells: list[float]) -> Waypoint:
    t, x, y, z = cells
    return Waypoint(time=t, value=(x, y, z))


def _cells(point: Waypoint) -> list[float]:
    return [point.time, *point.value]


def _suggested(signal: Waypoints | MinimumSnap) -> float:
    """A period that brings the curve back as fast as it goes on average."""
    times = [point.time for point in signal.points]
    length = times[-1] - times[0]
    return round(length + (length / (len(times) - 1) or DEFAULT_GAP), 3)
