"""Where the evil twin is, in numbers: what dragging it in the scene does. Only there when it is one of a family.

The turn about the anchor is kept as one rotation vector (rad); here it is an angle about an axis.
"""

import math

import numpy as np

from explorer.widgets.controls import Vector
from explorer.widgets.dials import Dial
from explorer.widgets.form import Form, Section
from rangenav import twin
from rangenav.inputs import Vec3, refuse_nonfinite, require
from rangenav.twin import Refusal, Twin

MIN_AXIS_LENGTH = 1e-9
"""Of an axis; shorter, it points nowhere."""
UP: Vec3 = (0.0, 0.0, 1.0)


class TwinPanel:
    """An angle, an axis where any will do, and a way back to the usual twin."""

    def __init__(self, form: Form) -> None:
        self._section = section = Section(form, "Evil twin")
        self._turn: Vec3 | None = None
        self._shown: tuple[float, Vec3] | None = None
        with section:
            hint = "Turns the twin about the anchor, as dragging it in the scene does; its range stays the true one."
            self.angle = Dial(
                section, "twin's angle (°)", (-180.0, 180.0), step=0.1, hint=hint, scale=math.degrees(1.0)
            )
            hint = "Of that turn, inertial axes; any length but zero. To and fro on a line there is only one."
            self.axis = Vector(section, "twin's axis", step=0.01, hint=hint)
            form.button("The usual twin", self.use_default, hint="A right angle, where that leads far enough.")
        section.show(False)

    def read(self) -> Vec3 | None:
        """The turn (rad) that was dragged or typed; None for the usual twin. Raises Refused."""
        if self._shown is not None:
            with self._section.catching():
                typed = self.angle.read(), self.axis.read()
                if typed != self._shown:
                    self._turn, self._shown = _rotation_vector(*typed), typed
        return self._turn

    def write(self, turn: Vec3 | None) -> None:
        """Show a turn; the usual one is shown when it is known."""
        if turn != self._turn:
            self._turn = turn
            if turn is not None and self._shown is not None:
                self._show(turn)

    def draw(self, twin_or_refusal: Twin | Refusal) -> None:
        """Show the turn of the twin that was found, or nothing where there is none to turn."""
        if not isinstance(twin_or_refusal, Twin) or not twin_or_refusal.draggable:
            self._section.show(False)
            self._shown = None
            return
        self._section.show(True)
        if self._shown is None or not _same(_rotation_vector(*self._shown), twin_or_refusal.turn):
            self._show(twin_or_refusal.turn, about=twin_or_refusal.axis)

    def _show(self, turn: Vec3, *, about: Vec3 | None = None) -> None:
        """About the only axis there is; else about the turn's own, which a turn of nothing leaves as it was."""
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
