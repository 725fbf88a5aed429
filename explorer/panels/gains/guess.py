"""The initial estimate: x̂(0), and the attitude error R̃(0) = R(0) R̂(0)ᵀ as an angle about an axis."""

import math
from typing import Literal

from explorer.model.compute import Picture
from explorer.model.glossary import START
from explorer.panels.gains.equilibria import EquilibriaSection
from explorer.widgets.controls import Choice
from explorer.widgets.dials import Dial
from explorer.widgets.form import Form
from explorer.widgets.section import Section, complaining
from explorer.widgets.vector import Vector
from rangenav.gains import Guess
from rangenav.inputs import Vec3

STATE_LABELS: dict[Literal["zero", "truth", "offset"], str] = {
    "zero": "zero",
    "truth": "the truth",
    "offset": "truth plus offsets",
}


HALF_TURNS = -180.0, 180.0
"""Degrees."""


class GuessPanel:
    """The initial estimate of the observer."""

    def __init__(self, form: Form) -> None:
        self._section = section = Section(form, "Initial estimate")
        with section:
            state, angle, axis = (START[name] for name in ("initial estimate", "initial angle", "initial axis"))
            degrees = math.degrees(1.0)
            self._state = Choice(section, state.caption, STATE_LABELS, hint=state.hint)
            self._angle = Dial(
                section, angle.caption, HALF_TURNS, step=0.1, hint=angle.hint, scale=degrees, allowed=HALF_TURNS
            )
            self._axis = Vector(section, axis.caption, hint=axis.hint)
            self._equilibria = EquilibriaSection(form, self._set_attitude_error)
        self._offsets = section = Section(form, "Offsets from the truth", expanded=False)
        with section:
            terms = [START[f"{name} offset"] for name in ("position", "velocity", "gravity")]
            self._position, self._velocity, self._gravity = (
                Vector(section, term.caption, hint=term.hint) for term in terms
            )

    def refresh(self) -> None:
        """Show below the control why the guess is invalid. Raises InvalidInputError."""
        with complaining(self._section, self._offsets):
            self.read()

    def read(self) -> Guess:
        """The guess chosen. Raises InvalidInputError."""
        with self._section.checking():
            state, axis, angle = self._state.read(), self._axis.read(), self._angle.read()
            attitude_error = Guess(attitude_axis=axis, attitude_angle=angle)
        with self._offsets.checking():
            return Guess(
                state=state,
                position_offset=self._position.read(),
                velocity_offset=self._velocity.read(),
                gravity_offset=self._gravity.read(),
                attitude_axis=attitude_error.attitude_axis,
                attitude_angle=attitude_error.attitude_angle,
            )

    def write(self, guess: Guess, base: Guess) -> None:
        """Show a guess."""
        self._state.write(guess.state, base.state)
        self._axis.write(guess.attitude_axis, base.attitude_axis)
        self._angle.write(guess.attitude_angle, base.attitude_angle)
        self._position.write(guess.position_offset, base.position_offset)
        self._velocity.write(guess.velocity_offset, base.velocity_offset)
        self._gravity.write(guess.gravity_offset, base.gravity_offset)

    def draw(self, picture: Picture) -> None:
        """Show the angle from the initial attitude error to the nearest undesired equilibrium."""
        self._equilibria.draw(picture)

    def _set_attitude_error(self, axis: Vec3, angle: float) -> None:
        self._axis.show(axis)
        self._angle.show(angle)
