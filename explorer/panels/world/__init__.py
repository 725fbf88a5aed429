"""The World tab: the anchor, gravity and the direction of z, the magnetic direction."""

import math

from explorer.model.glossary import MOTION
from explorer.widgets.form import Action, Form
from explorer.widgets.section import Section, complaining
from explorer.widgets.vector import Vector
from rangenav.inputs import Vec3, require
from rangenav.motion import World

Z_DOWN, Z_UP = "z points down, as in the paper (NED, FRD)", "z points up (NWU, FLU)"
GRAVITY_ASIDE = "gravity is not along z"
RELABEL_HINT = (
    "Describes the same world, path, body and offsets with y and z the other way round, inertial and body axes alike. "
    "Nothing that can be measured changes."
)


class WorldPanel:
    """The anchor, gravity and the magnetic direction."""

    def __init__(self, form: Form, relabel: Action) -> None:
        self._anchor_section = anchor = Section(form, "Anchor")
        with anchor:
            self._anchor = Vector(anchor, MOTION["anchor"].caption, hint=MOTION["anchor"].hint)
        self.section = axes = Section(form, "Gravity and axes")
        with axes:
            self._line = form.gui.add_markdown("")
            self._gravity = Vector(axes, MOTION["gravity"].caption, hint=MOTION["gravity"].hint)
            self._relabel = form.button("Relabel the axes: z up ↔ z down", relabel, hint=RELABEL_HINT)
        self._magnetic_section = magnetic = Section(form, "Magnetic direction")
        with magnetic:
            self._magnetic = Vector(magnetic, MOTION["magnetic"].caption, hint=MOTION["magnetic"].hint)
        self._unit_magnetic: Vec3 = (0.0, 0.0, 0.0)

    def refresh(self) -> None:
        """Say where z points. Raises InvalidInputError after showing the reason below the control."""
        with complaining(self._anchor_section, self.section):
            _, gravity = self._anchor_and_gravity()
        self._describe_axes(gravity)
        with self._magnetic_section.catching():
            self.read()

    def read(self) -> World:
        """The world chosen. Raises InvalidInputError."""
        anchor, gravity = self._anchor_and_gravity()
        with self._magnetic_section.checking():
            typed = self._magnetic.read()
            return World(
                anchor=anchor, gravity=gravity, magnetic=typed if typed == self._unit_magnetic else _direction(typed)
            )

    def write(self, world: World, base: World) -> None:
        """Show a world."""
        self._anchor.write(world.anchor, base.anchor)
        self._gravity.write(world.gravity, base.gravity)
        self._unit_magnetic = world.magnetic
        self._magnetic.write(world.magnetic, base.magnetic)
        self._describe_axes(world.gravity)

    def move_anchor(self, position: Vec3) -> None:
        """Move the anchor to a position (m), as a drag does."""
        self._anchor.show(position)

    def _anchor_and_gravity(self) -> tuple[Vec3, Vec3]:
        with self._anchor_section.checking():
            anchor = self._anchor.read()
            World(anchor=anchor)
        with self.section.checking():
            gravity = self._gravity.read()
            World(gravity=gravity, magnetic=_direction_across(gravity))
        return anchor, gravity

    def _describe_axes(self, gravity: Vec3) -> None:
        aside = math.hypot(gravity[0], gravity[1]) > 1e-9 * math.hypot(*gravity)
        line = GRAVITY_ASIDE if aside else Z_DOWN if gravity[2] > 0 else Z_UP
        if line != self._line.content:
            self._line.content = line


def _direction(vector: Vec3) -> Vec3:
    length = math.hypot(*vector)
    require(1e-9 < length < 1e9, f"the magnetic direction must have a length between 1e-9 and 1e9, got {length:g}")
    return vector[0] / length, vector[1] / length, vector[2] / length


def _direction_across(gravity: Vec3) -> Vec3:
    """A unit vector that is not collinear with gravity, so that gravity is checked by itself."""
    return (1.0, 0.0, 0.0) if abs(gravity[0]) <= 0.5 * math.hypot(*gravity) else (0.0, 1.0, 0.0)
