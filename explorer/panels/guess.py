"""The initial estimate: x̂(0), and the attitude error R̃(0) = R(0) R̂(0)ᵀ as a turn about an axis."""

import math
from typing import Literal

import viser

from explorer.panels.controls import Choice, Complaint, Dial, Note, Vector
from rangenav.gains import Guess

STATES: dict[Literal["zero", "truth", "offset"], str] = {
    "zero": "zero",
    "truth": "the truth",
    "offset": "truth plus offsets",
}


class GuessPanel:
    """Where the observer starts."""

    def __init__(self, gui: viser.GuiApi, guess: Guess, note: Note) -> None:
        with gui.add_folder("Initial estimate"):
            hint = (
                "x̂(0): zero as in the paper's scenario, the true lifted state, or the lift of truth plus the offsets."
            )
            self._state = Choice(gui, "x̂(0)", STATES, hint=hint, note=note)
            hint = "Angle of the initial attitude error R̃(0) (degrees); near 180° the filter lingers (paper, U_π)."
            self._angle = Dial(
                gui, "R̃(0) angle (°)", (-180.0, 180.0), step=0.1, hint=hint, note=note, scale=math.degrees(1.0)
            )
            hint = "Axis of the initial attitude error, inertial axes; any length but zero."
            self._axis = Vector(gui, "R̃(0) axis", step=0.01, hint=hint, note=note)
            self._complaint = Complaint(gui)
        with gui.add_folder("Offsets from the truth", expand_by_default=False):
            hint = "used when x̂(0) is truth plus offsets; inertial axes."
            self._position = Vector(gui, "position (m)", step=0.1, hint=f"m, {hint}", note=note)
            self._velocity = Vector(gui, "velocity (m/s)", step=0.1, hint=f"m/s, {hint}", note=note)
            self._gravity = Vector(gui, "gravity (m/s²)", step=0.1, hint=f"m/s², {hint}", note=note)
            self._offset_complaint = Complaint(gui)
        self.write(guess)

    def read(self) -> Guess:
        """The guess chosen. Raises Refused after saying why beside the control."""
        with self._complaint.catching():
            state, axis, angle = self._state.read(), self._axis.read(), self._angle.read()
            turned = Guess(attitude_axis=axis, attitude_angle=angle)
        with self._offset_complaint.catching():
            return Guess(
                state=state,
                position_offset=self._position.read(),
                velocity_offset=self._velocity.read(),
                gravity_offset=self._gravity.read(),
                attitude_axis=turned.attitude_axis,
                attitude_angle=turned.attitude_angle,
            )

    def write(self, guess: Guess) -> None:
        """Show a guess."""
        self._state.write(guess.state)
        self._axis.write(guess.attitude_axis)
        self._angle.write(guess.attitude_angle)
        self._position.write(guess.position_offset)
        self._velocity.write(guess.velocity_offset)
        self._gravity.write(guess.gravity_offset)
