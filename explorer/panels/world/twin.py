"""The rotation of the evil twin in numbers, as an alternative to dragging it in the scene. Only a twin that belongs to
a family of twins can be turned.

Settings store the rotation about the anchor as a rotation vector (rad); the controls show its angle and its axis.
"""

import math

import numpy as np

from explorer.model.glossary import MOTION
from explorer.widgets.dials import Dial
from explorer.widgets.form import Form
from explorer.widgets.section import Section
from explorer.widgets.vector import Vector
from rangenav import twin
from rangenav.inputs import Vec3, refuse_nonfinite, require
from rangenav.twin import Refusal, Twin

MIN_AXIS_LENGTH = 1e-9
"""Least length of an axis."""
UP: Vec3 = (0.0, 0.0, 1.0)


class TwinPanel:
    """An angle, an axis, and a button for the default twin."""

    def __init__(self, form: Form) -> None:
        self.section = section = Section(form, "Evil twin")
        self._turn: Vec3 | None = None
        self._shown: tuple[float, Vec3] | None = None
        with section:
            angle, axis, degrees = MOTION["twin turn"], MOTION["twin axis"], math.degrees(1.0)
            self.angle = Dial(section, angle.caption, (-180.0, 180.0), step=0.1, hint=angle.hint, scale=degrees)
            self.axis = Vector(section, axis.caption, hint=axis.hint)
            form.button(
                "The usual twin",
                self.use_default,
                hint="Turns the twin by 90°, where that leads far enough from the truth.",
            )
        section.show(False)

    def refresh(self) -> None:
        """Take over what was typed. Raises InvalidInputError after showing the reason below the control."""
        with self.section.catching():
            self._turn, self._shown = self._typed()

    def read(self) -> Vec3 | None:
        """The rotation vector (rad) that was dragged or typed; None for the default twin. Raises InvalidInputError."""
        turn, _ = self._typed()
        return turn

    def write(self, turn: Vec3 | None) -> None:
        """Show a rotation vector. That of the default twin is shown once `draw` knows it."""
        if turn != self._turn:
            self._turn = turn
            if turn is not None and self._shown is not None:
                self._show(turn)

    def draw(self, twin_or_refusal: Twin | Refusal) -> None:
        """Show the rotation of a twin; hide the section if there is no twin, or none that can be turned."""
        if not isinstance(twin_or_refusal, Twin) or not twin_or_refusal.draggable:
            self.section.show(False)
            self._shown = None
            return
        self.section.show(True)
        if self._shown is None or not _same(_rotation_vector(*self._shown), twin_or_refusal.turn):
            self._show(twin_or_refusal.turn, about=twin_or_refusal.axis)

    def _typed(self) -> tuple[Vec3 | None, tuple[float, Vec3] | None]:
        """The rotation vector, and the angle and the axis in the controls; None for these where no twin is shown."""
        if self._shown is None:
            return self._turn, None
        with self.section.checking():
            typed = self.angle.read(), self.axis.read()
            return (self._turn if typed == self._shown else _rotation_vector(*typed)), typed

    def _show(self, turn: Vec3, *, about: Vec3 | None = None) -> None:
        """Show a rotation vector, about the only possible axis or else its own; a zero rotation keeps the axis."""
        angle = math.hypot(*turn) if about is None else float(np.dot(turn, about))
        axis = about
        if axis is None:
            before = self._shown[1] if self._shown is not None else UP
            axis = (turn[0] / angle, turn[1] / angle, turn[2] / angle) if angle else before
        self.angle.show(angle)
        self.axis.show(axis)
        self._shown = self.angle.read(), self.axis.read()

    def use_default(self) -> None:
        self._turn, self._shown = None, None


def _rotation_vector(angle: float, axis: Vec3) -> Vec3:
    refuse_nonfinite("the twin's angle and axis", (angle, *axis))
    length = math.hypot(*axis)
    require(length > MIN_AXIS_LENGTH, f"the twin's axis must have a length, got {axis}")
    return angle * axis[0] / length, angle * axis[1] / length, angle * axis[2] / length


def _same(a: Vec3, b: Vec3) -> bool:
    return bool(np.allclose(a, b, rtol=0, atol=twin.ZERO))
