"""One vehicle in the 3-D picture: airframe and body axes. The true one is solid, the estimate a ghost."""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array
from viser import MeshHandle, SceneApi
from viser.transforms import SO3

from explorer.scene import airframe
from explorer.scene.bounds import SceneBounds, turn_from_x
from explorer.scene.colors import Color


class Vehicle:
    """Nodes under /NAME that move together."""

    def __init__(self, scene: SceneApi, name: str, color: Color, *, opacity: float | None, label_above: bool) -> None:
        self._root = scene.add_frame(f"/{name}", axes_length=1.0, axes_radius=0.02, origin_color=color)
        frame, rotors = airframe.frame(), airframe.rotors()
        self._body = scene.add_mesh_simple(
            f"/{name}/frame",
            frame.vertices,
            frame.faces,
            color=color,
            opacity=opacity,
            flat_shading=True,
            side="double",
        )
        self._rotors = scene.add_mesh_simple(
            f"/{name}/rotors", rotors.vertices, rotors.faces, color=color, opacity=(opacity or 1.0) * 0.5, side="double"
        )
        anchor = "bottom-center" if label_above else "top-center"
        self.label = scene.add_label(f"/{name}/label", name, anchor=anchor, font_screen_scale=0.9)

    @property
    def parts(self) -> tuple[MeshHandle, ...]:
        """What a pointer can take hold of."""
        return self._body, self._rotors

    def fit(self, on: SceneBounds) -> None:
        """Take the size of the stage, and stand with the rotors up when R = I."""
        self._root.axes_length, self._root.axes_radius = 0.9 * on.unit, 0.025 * on.unit
        self._root.origin_radius = 0.05 * on.unit
        # the mesh's z is up; body axes may have z down, as the paper's have: x to up, after z to x
        upright = SO3(np.array(turn_from_x(on.up))) @ SO3.from_y_radians(np.pi / 2)
        for mesh in (self._body, self._rotors):
            mesh.scale, mesh.wxyz = on.unit, upright.wxyz

    def place(self, position: Float[Array, "3"], rotation: Float[Array, "3 3"]) -> None:
        """Put it at a pose in the inertial frame."""
        self._root.position = position
        self._root.wxyz = SO3.from_matrix(rotation).wxyz

    def show(self, visible: bool) -> None:
        self._root.visible = visible
