"""A vehicle in the 3-D picture: its body and body axes. The true one is opaque, an estimate a translucent ghost."""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array
from viser import MeshHandle, SceneApi
from viser.transforms import SO3

from explorer.model import palette
from explorer.model.drawn import Drawn
from explorer.scene import airframe
from explorer.scene.bounds import SceneBounds, quaternion, rotation_from_x
from explorer.scene.labels import Labels
from explorer.web.frames import place, turn


class Vehicle:
    """Nodes under /NAME that move together; hidden until `show`."""

    def __init__(
        self,
        scene: SceneApi,
        labels: Labels,
        name: str,
        color: palette.Color,
        *,
        opacity: float | None,
        rank: int,
        text: str | None = None,
    ) -> None:
        """rank: of its label among all labels. text: of the label; by default the name."""
        rgb = palette.rgb(color)
        self._root = scene.add_frame(f"/{name}", axes_length=1.0, axes_radius=0.02, origin_color=rgb, visible=False)
        self._shape: airframe.Shape = "quadrotor"
        self._fitted = Drawn()
        frame, rotors = airframe.body(self._shape), airframe.see_through(self._shape)
        self._body = scene.add_mesh_simple(
            f"/{name}/frame",
            frame.vertices,
            frame.faces,
            color=rgb,
            opacity=opacity,
            flat_shading=True,
            side="double",
        )
        self._rotors = scene.add_mesh_simple(
            f"/{name}/rotors", rotors.vertices, rotors.faces, color=rgb, opacity=(opacity or 1.0) * 0.5, side="double"
        )

        def where() -> np.ndarray | None:
            return np.asarray(self._root.position) if self._root.visible else None

        self.label = labels.add(f"/{name}/label", where, rank=rank, text=name if text is None else text)

    @property
    def parts(self) -> tuple[MeshHandle, ...]:
        """The nodes that a visitor can drag."""
        return self._body, self._rotors

    def fit(self, bounds: SceneBounds, shape: airframe.Shape) -> None:
        """Take the sizes of a scene and the shape of a vehicle. It stands upright when R = I."""
        if not self._fitted.changed(bounds.unit, *bounds.up.tolist(), shape):
            return
        if shape != self._shape:
            self._shape = shape
            for mesh, part in ((self._body, airframe.body(shape)), (self._rotors, airframe.see_through(shape))):
                mesh.vertices, mesh.faces = part.vertices.astype(np.float32), part.faces.astype(np.uint32)
        self._root.axes_length, self._root.axes_radius = 0.9 * bounds.unit, 0.025 * bounds.unit
        self._root.origin_radius = 0.05 * bounds.unit
        # the mesh's z axis is up, the body's may be down, as in the paper: first z to x, then x to up
        upright = SO3(np.array(rotation_from_x(bounds.up))) @ SO3.from_y_radians(np.pi / 2)
        for mesh in (self._body, self._rotors):
            mesh.scale, mesh.wxyz = bounds.unit, upright.wxyz

    def place(self, position: Float[Array, "3"], rotation: Float[Array, "3 3"]) -> None:
        """Put it at a position (m) and rotation (body to inertial) in the inertial frame."""
        place(self._root, position)
        turn(self._root, quaternion(rotation))

    def show(self, visible: bool) -> None:
        self._root.visible = visible
