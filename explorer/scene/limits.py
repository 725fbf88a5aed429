"""The parts of the path that exceed limits of the vehicle: a thick line over them, and markers with labels.

Each marker stands where one limit is exceeded most. The line is recognised without its colour: it is wider than the
other lines.
"""

import math
from itertools import pairwise

import numpy as np
from jaxtyping import Bool, Float
from numpy import ndarray as Array
from viser import SceneApi

from explorer.model import palette
from explorer.model.drawn import Drawn
from explorer.scene.bounds import EMPTY_LINE, INVISIBLE_SIZE, SceneBounds, chord_samples
from explorer.scene.labels import Labels
from rangenav.motion import Motion
from rangenav.number_format import quantity, significant
from rangenav.vehicle import WORDS, Break

THICKNESS = 8.0
"""px; the line of the path itself has 3."""
MARKS = 3
"""How many limits get a marker."""
MARKER_SHARE = 0.12
"""Radius of a marker, in units of the scene."""


class LimitMarks:
    """The nodes under /path/broken."""

    def __init__(self, scene: SceneApi, labels: Labels) -> None:
        color = palette.rgb(palette.LIMIT_EXCEEDED)
        self._line = scene.add_line_segments(
            "/path/broken", EMPTY_LINE, color, thickness=THICKNESS, thickness_units="screen", visible=False
        )
        self._drawn = Drawn()
        self._marks = [_Mark(scene, labels, k) for k in range(MARKS)]

    def draw(self, motion: Motion, breaks: tuple[Break, ...], bounds: SceneBounds) -> None:
        """Show where limits are exceeded. At most three get a marker: those that are exceeded for longest."""
        if not self._drawn.changed(motion, breaks, bounds):
            return
        where = exceeding_samples(breaks, len(motion.time))
        lines = exceeding_segments(motion, where, bounds) if breaks else np.empty((0, 2, 3))
        self._line.visible = len(lines) > 0
        if len(lines):
            self._line.points = lines.astype(np.float32)
        for k, mark in enumerate(self._marks):
            mark.draw(motion, breaks[k] if k < len(breaks) else None, bounds)


class _Mark:
    """A marker with a label where one limit is exceeded most."""

    def __init__(self, scene: SceneApi, labels: Labels, k: int) -> None:
        name, color = f"/path/broken{k + 1}", palette.rgb(palette.LIMIT_EXCEEDED)
        self._node = scene.add_icosphere(
            name, 1.0, color, subdivisions=0, flat_shading=True, scale=INVISIBLE_SIZE, visible=False
        )

        def where() -> np.ndarray | None:
            return np.asarray(self._node.position) if self._node.visible else None

        self._label = labels.add(f"{name}/label", where, rank=10 + k, side="bottom-left")

    def draw(self, motion: Motion, limit_break: Break | None, bounds: SceneBounds) -> None:
        self._node.visible = limit_break is not None
        if limit_break is not None:
            at = int(np.argmin(np.abs(motion.time - limit_break.at)))
            self._node.position, self._node.scale = motion.position[at], MARKER_SHARE * bounds.unit
            self._label.write(marker_label(limit_break))


def exceeding_samples(breaks: tuple[Break, ...], count: int) -> Bool[Array, "n"]:
    """The samples at which any limit is exceeded."""
    return (
        np.logical_or.reduce([limit_break.where for limit_break in breaks]) if breaks else np.zeros(count, dtype=bool)
    )


def exceeding_segments(motion: Motion, where: Bool[Array, "n"], bounds: SceneBounds) -> Float[Array, "m 2 3"]:
    """The chords of the drawn path that hold at least one of the samples `where`."""
    ends = chord_samples(motion, bounds)
    hit = np.array([where[first : last + 1].any() for first, last in pairwise(ends)])
    return np.stack([motion.position[ends[:-1][hit]], motion.position[ends[1:][hit]]], axis=1)


def marker_label(limit_break: Break) -> str:
    """Which limit is exceeded, the value that is reached, and when."""
    name, unit = WORDS[limit_break.limit]
    if limit_break.limit == "thrust_to_weight":
        reached = f"{significant(limit_break.reached)} × weight"
    elif limit_break.limit == "tilt":
        reached = quantity(math.degrees(limit_break.reached), "°")
    else:
        reached = quantity(limit_break.reached, unit)
    return f"✕ {name} {reached} at {limit_break.at:.1f} s"
