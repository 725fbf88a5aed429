"""Labels that never lie on each other: each takes the first side of its point that is free, or is left out.

    screen position = camera(point),   rectangle = side + text size,   placed if it meets no rectangle placed before

The labels come in the order of their importance. A label keeps its side while that side is free, so that it does not
jump. Pure functions, but for `Labels`, which holds the labels of one scene.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array
from viser import CameraHandle, LabelHandle, SceneApi
from viser.transforms import SO3

Side = Literal[
    "bottom-center", "top-center", "center-left", "center-right", "bottom-left", "bottom-right", "top-left", "top-right"
]
"""viser's anchor: which point of the label lies at its position. "bottom-center" is a label above its point."""
SIDES: tuple[Side, ...] = (
    "bottom-center", "center-left", "center-right", "top-center",
    "bottom-left", "top-left", "bottom-right", "top-right",
)  # fmt: skip
SCALE, BIG_SCALE = 0.95, 1.6
"""viser's scale of the text, and with big type: 12 px times this."""
LINE, CHARACTER, PADDING = 15.0, 6.6, 5.0
"""px at scale 1: height of a line, mean width of a character, and the margin around the text. viser reports none."""
GAP = 6.0
"""px between two labels in one line."""
SHIFTS: dict[str, float] = {"left": 0.5, "center": 0.0, "right": -0.5}
LIFTS: dict[str, float] = {"bottom": -0.5, "center": 0.0, "top": 0.5}


class Box(NamedTuple):
    """A rectangle on the screen: centre and half sizes, px, y down."""

    x: float
    y: float
    half_width: float
    half_height: float

    def meets(self, other: "Box") -> bool:
        """Whether two rectangles share a point, or lie so near in one line that their texts read as one."""
        return (
            abs(self.x - other.x) < self.half_width + other.half_width + GAP
            and abs(self.y - other.y) < self.half_height + other.half_height
        )

    def is_inside(self, width: float, height: float) -> bool:
        """Whether it lies inside a picture; one of endless size has no edges."""
        if math.isinf(width):
            return True
        across = self.half_width <= self.x <= width - self.half_width
        return across and self.half_height <= self.y <= height - self.half_height


class Item(NamedTuple):
    """What is to be placed: a text at a position on the screen (px, y down), and the side that it has now."""

    text: str
    x: float
    y: float
    side: Side


def place(
    items: Sequence[Item], *, scale: float = SCALE, picture: tuple[float, float] = (math.inf, math.inf)
) -> list[Side | None]:
    """The side of each label, the most important first; None for a label that has no room.

    picture: its width and height (px). A label lies inside the picture, unless its point is at the edge or beyond."""
    placed: list[Box] = []
    sides: list[Side | None] = []
    for item in items:
        boxes: list[tuple[Side, Box]] = [(side, box_of(item, side, scale=scale)) for side in (item.side, *SIDES)]
        inside = [one for one in boxes if one[1].is_inside(*picture)]
        for side, box in inside or boxes:
            if not any(box.meets(other) for other in placed):
                placed.append(box)
                sides.append(side)
                break
        else:
            sides.append(None)
    return sides


def box_of(item: Item, side: Side, *, scale: float = SCALE) -> Box:
    """The rectangle of a label on one side of its position."""
    half_width = (CHARACTER * len(item.text) / 2 + PADDING) * scale
    half_height = (LINE / 2 + PADDING) * scale
    vertical, horizontal = side.split("-")
    x, y = item.x + 2 * SHIFTS[horizontal] * half_width, item.y + 2 * LIFTS[vertical] * half_height
    return Box(x, y, half_width, half_height)


def project(points: Float[Array, "n 3"], camera: CameraHandle) -> Float[Array, "n 2"]:
    """Where points (m) are seen on the picture (px of the screen, y down); NaN behind the camera."""
    right, down, ahead = SO3(np.asarray(camera.wxyz)).inverse().as_matrix() @ (points - np.asarray(camera.position)).T
    scale = camera.image_height / 2 / math.tan(camera.fov / 2)
    seen = np.where(ahead > 0, ahead, np.nan)
    with np.errstate(invalid="ignore"):
        x, y = camera.image_width / 2 + scale * right / seen, camera.image_height / 2 + scale * down / seen
    return np.stack([x, y], axis=1)


@dataclass(eq=False)
class Label:
    """One label, attached to a node: it moves with the node, and `Labels` chooses its side."""

    handle: LabelHandle
    position: Callable[[], Float[Array, "3"] | None]
    """Where it is in the inertial frame (m); None while its node is hidden."""
    rank: int
    """The least is the most important."""
    text: str = ""
    side: Side = "bottom-center"

    def write(self, text: str) -> None:
        """Show another text; the label is left out while the text is empty."""
        if text != self.text:
            self.text = self.handle.text = text


class Labels:
    """All labels of one scene."""

    def __init__(self, scene: SceneApi, camera: CameraHandle) -> None:
        self._scene, self._camera = scene, camera
        self._all: list[Label] = []
        self._scale, self._shown = SCALE, True
        self._height: float | None = None

    def add(
        self,
        name: str,
        position: Callable[[], Float[Array, "3"] | None],
        *,
        rank: int,
        text: str = "",
        side: Side = "bottom-center",
    ) -> Label:
        """A label below the node that its name begins with; it is hidden until `arrange` has found it a place."""
        handle = self._scene.add_label(name, text, anchor=side, font_screen_scale=SCALE, visible=False)
        label = Label(handle=handle, position=position, rank=rank, text=text, side=side)
        self._all.append(label)
        self._all.sort(key=lambda one: one.rank)
        return label

    def appear(self, *, shown: bool, big: bool, height: float) -> None:
        """Show or hide all labels, in usual or big type. height: of the picture, CSS px."""
        self._shown, self._scale, self._height = shown, BIG_SCALE if big else SCALE, height
        for label in self._all:
            if label.handle.font_screen_scale != self._scale:
                label.handle.font_screen_scale = self._scale

    def arrange(self) -> None:
        """Choose the side of each label for the camera as it is, and leave out those that have no room."""
        points = [(label, label.position() if self._shown and label.text else None) for label in self._all]
        present = [(label, point) for label, point in points if point is not None]
        for label, point in points:
            if point is None:
                _show(label, visible=False)
        if not present:
            return
        seen = project(np.array([point for _, point in present]), self._camera)
        ratio = self._scale * (self._camera.image_height / self._height if self._height else 1.0)
        drawn = [(label, xy) for (label, _), xy in zip(present, seen, strict=True) if np.isfinite(xy).all()]
        picture = float(self._camera.image_width), float(self._camera.image_height)
        items = [Item(label.text, float(x), float(y), label.side) for label, (x, y) in drawn]
        for (label, _), side in zip(drawn, place(items, scale=ratio, picture=picture), strict=True):
            _show(label, visible=side is not None)
            if side is not None and side != label.side:
                label.side = label.handle.anchor = side


def _show(label: Label, *, visible: bool) -> None:
    if label.handle.visible != visible:
        label.handle.visible = visible
