"""The estimate of the shown run in the 3-D picture: a ghost of the vehicle, its 1σ ellipsoid, the estimated gravity
and magnetic vectors, and an arrow towards an estimate that is outside the scene."""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array
from viser import SceneApi

from explorer.model import palette
from explorer.model.compute import Picture
from explorer.scene.airframe import shape_of
from explorer.scene.arrows import Arrow
from explorer.scene.bounds import SCENE_RADII, SceneBounds, ellipsoid_axes, last_known, quaternion
from explorer.scene.labels import Labels
from explorer.scene.vehicle import Vehicle
from explorer.web.frames import place, turn
from rangenav.number_format import quantity


class EstimateNodes:
    """The nodes /estimate and /ellipsoid, and the arrows under /compass that belong to the estimate."""

    def __init__(self, scene: SceneApi, labels: Labels) -> None:
        self._ghost = Vehicle(scene, labels, "estimate", palette.ESTIMATE, opacity=0.4, rank=2)
        self._ellipsoid_enabled, self._compass = True, np.zeros(3)
        self._ellipsoid = scene.add_icosphere(
            "/ellipsoid",
            1.0,
            palette.rgb(palette.ESTIMATE),
            subdivisions=10,
            opacity=0.13,
            material="toon3",
            cast_shadow=False,
            receive_shadow=False,
            visible=False,
        )

        def origin() -> np.ndarray:
            return self._compass

        self._gravity = Arrow(
            scene, labels, "/compass/gravity_estimate", "g est.", palette.GRAVITY_ESTIMATE, rank=22, origin=origin
        )
        self._magnetic = Arrow(
            scene, labels, "/compass/magnetic_estimate", "m est.", palette.MAGNETIC_ESTIMATE, rank=23, origin=origin
        )
        self._away = Arrow(scene, labels, "/compass/far", "", palette.ESTIMATE, rank=2, origin=origin)
        self._magnetic_samples = np.zeros((0, 3))

    def appear(self, *, vectors: bool, ellipsoid: bool) -> None:
        """Switch the layers on or off; they follow at the next `move`."""
        self._gravity.enabled = self._magnetic.enabled = vectors
        self._ellipsoid_enabled = ellipsoid

    def fit(self, picture: Picture, bounds: SceneBounds) -> None:
        """Take the sizes of a scene and the magnetometer samples of a picture."""
        self._magnetic_samples = last_known(picture.measurements.mag)
        self._ghost.fit(bounds, shape_of(picture.preset.vehicle))
        unit = bounds.unit
        self._gravity.fit(length=2.2 * unit, radius=0.022 * unit)
        self._magnetic.fit(length=2.0 * unit, radius=0.022 * unit)
        self._away.fit(length=3.0 * unit, radius=0.03 * unit)

    def move(self, picture: Picture, k: int, bounds: SceneBounds) -> None:
        """Show the estimate at sample k."""
        position, rotation = picture.position_estimate[k], picture.estimate.rotation[k]
        finite, self._compass = bool(np.isfinite(rotation).all()), picture.motion.position[k]
        self._gravity.point(rotation @ picture.estimate.state[k, 10:13] if finite else np.zeros(3))
        self._magnetic.point(rotation @ self._magnetic_samples[k] if finite else np.zeros(3))
        inside = finite and bounds.holds(position)
        self._ghost.show(inside)
        if inside:
            self._ghost.place(position, rotation)
            self._away.hide()
            self._move_ellipsoid(picture, k, bounds)
        else:
            self._ellipsoid.visible = False
            self._point_away(position - picture.motion.position[k])

    def _point_away(self, offset: Float[Array, "3"]) -> None:
        """The ghost is outside the scene: an arrow at the vehicle points to it, and a label gives the distance (m)."""
        with np.errstate(over="ignore", invalid="ignore"):
            distance = float(np.linalg.norm(offset))
        finite = np.isfinite(distance)
        label = f"estimate {quantity(distance, 'm')} this way" if finite else "the estimate is not a number any more"
        self._away.set_label(label)
        self._away.point(offset if finite else np.ones(3))

    def _move_ellipsoid(self, picture: Picture, k: int, bounds: SceneBounds) -> None:
        axes = ellipsoid_axes(picture.estimate.covariance[k, 0])
        drawn = axes is not None and axes[0][2] < SCENE_RADII * bounds.radius
        self._ellipsoid.visible = drawn and self._ellipsoid_enabled
        self._ghost.label.write("estimate" if drawn else "estimate (very uncertain)")
        if axes is not None and drawn and self._ellipsoid_enabled:
            x, y, z = (float(axis) for axis in axes[0])
            self._ellipsoid.scale = (x, y, z)
            turn(self._ellipsoid, quaternion(picture.estimate.rotation[k] @ axes[1]))
            place(self._ellipsoid, picture.position_estimate[k])
