"""Starts at and near the undesired equilibria R̃ = 2uuᵀ − I (paper, U_π): turned by 180° about eigenvectors u of M."""

import html
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from explorer.model.compute import Picture
from explorer.model.drawn import Drawn
from explorer.widgets.form import Form
from explorer.widgets.html import NOTE
from explorer.widgets.section import Section
from rangenav import attitude, so3
from rangenav.attitude import AttitudeGains
from rangenav.inputs import Vec3
from rangenav.motion import World

NEAR_OFFSET = math.radians(1.0)
LOCATIONS = ("across both m and g", "in their plane, across it", "between m and g")
"""Where the eigenvectors of M = ρ1 mmᵀ + ρ2 ggᵀ lie: of eigenvalue zero, of the middle and of the largest one."""
EXPLANATION = (
    "At R̃ = 2uuᵀ − I, u an eigenvector of M = ρ1 mmᵀ + ρ2 ggᵀ, the filter's correction vanishes: “almost global” leaves"
    " these three out. At exactly 180° noise alone decides when and which way the filter leaves. From x̂(0) = zero the "
    "gravity estimate is wrong at first and pushes it off within a second; from the truth, and with little noise, it "
    "lingers."
)
START_HINT = (
    "Sets angle and axis above. u is in inertial axes, and follows from the gains, the magnetic field and gravity."
)
SetAttitudeError = Callable[[Vec3, float], None]


@dataclass(frozen=True)
class Equilibrium:
    """One of the three equilibria."""

    axis: Vec3
    """u, of length one; its largest component is positive."""
    location: str
    """Where the axis lies with respect to m and g."""

    @property
    def label(self) -> str:
        """The label of its button."""
        return f"180° · {axis_text(self.axis)} · {self.location}"


def undesired_equilibria(gains: AttitudeGains, world: World) -> list[Equilibrium]:
    """The three undesired equilibria; the first one belongs to the largest eigenvalue of M."""
    _, axes = np.linalg.eigh(attitude.decay_matrix(gains, world))
    directions = [u * np.sign(u[np.argmax(np.abs(u))]) for u in axes.T]
    equilibria = [
        Equilibrium((float(u[0]), float(u[1]), float(u[2])), location)
        for u, location in zip(directions, LOCATIONS, strict=True)
    ]
    return equilibria[::-1]


def distances(error: Float[Array, "3 3"], equilibria: list[Equilibrium]) -> list[float]:
    """Angles (rad) from an attitude error R̃ to each of the equilibria."""
    axes = np.array([equilibrium.axis for equilibrium in equilibria])
    rotations = 2 * axes[:, :, None] * axes[:, None, :] - np.eye(3)
    return [float(angle) for angle in so3.angle(rotations.swapaxes(1, 2) @ error)]


def axis_text(axis: Vec3) -> str:
    """An axis in two decimals."""
    return "(" + ", ".join(f"{round(entry, 2) + 0.0:g}" for entry in axis) + ")"


class EquilibriaSection:
    """The angle from the start to the nearest equilibrium and, in a folder, a button for each of the three."""

    def __init__(self, form: Form, equilibrium: SetAttitudeError) -> None:
        self._set_attitude_error = equilibrium
        self._line = form.gui.add_html("")
        with Section(form, "Start at a half turn", expanded=False):
            form.gui.add_html(NOTE.format(html.escape(EXPLANATION)))
            self._buttons = [form.button(f"180°, {k}", partial(self._start_at, k), hint=START_HINT) for k in range(3)]
            hint = "The half turn that is nearest now, but by 179°."
            form.button("almost: 1° off the nearest of these", self._start_near, hint=hint)
        self._equilibria: list[Equilibrium] = []
        self._nearest, self._drawn = 0, Drawn()

    def draw(self, picture: Picture) -> None:
        """Label the buttons, and show the angle from the start to the nearest equilibrium."""
        p = picture.preset
        if not self._drawn.changed(p.gains.attitude, p.world, p.guess):
            return
        self._equilibria = undesired_equilibria(p.gains.attitude, p.world)
        for button, equilibrium in zip(self._buttons, self._equilibria, strict=True):
            if equilibrium.label != button.label:
                button.label = equilibrium.label
        axis = np.array(p.guess.attitude_axis) / math.hypot(*p.guess.attitude_axis)
        angles = distances(so3.exp(p.guess.attitude_angle * axis), self._equilibria)
        self._nearest = int(np.argmin(angles))
        nearest = self._equilibria[self._nearest]
        degrees = round(math.degrees(angles[self._nearest]), 2)
        line = f"The start is <b>{degrees:g}°</b> from the nearest undesired equilibrium: an attitude error of a half "
        line += f"turn about {axis_text(nearest.axis)}, {nearest.location}, where the filter stands still."
        if NOTE.format(line) != self._line.content:
            self._line.content = NOTE.format(line)

    def _start_at(self, k: int) -> None:
        if self._equilibria:  # else nothing is drawn yet, and no button says what it does
            self._set_attitude_error(self._equilibria[k].axis, math.pi)

    def _start_near(self) -> None:
        if self._equilibria:
            self._set_attitude_error(self._equilibria[self._nearest].axis, math.pi - NEAR_OFFSET)
