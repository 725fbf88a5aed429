"""The parts of the path that exceed limits of the vehicle: a thick line over them, and markers with labels.

Each marker stands where one limit is exceeded most. The line is recognised without its colour: it is wider than the
other lines, and the estimate's path is dashed.
"""

import math
from itertools import pairwise

import numpy as np
from jaxtyping import Bool, Float
from numpy import ndarray as Array
from viser import SceneApi

from explorer.model import palette
from explorer.scene.bounds import EMPTY_LINE, INVISIBLE_SIZE, SceneBounds, chord_samples
from rangenav.motion import Motion
from rangenav.number_format import quantity, significant
from rangenav.vehicle import WORDS, Break

THICKNESS = 8.0
"""px; the line of the path itself has 3."""
LABEL_ANCHORS = ("bottom-left", "top-left", "bottom-right")
"""The sides of the markers on which the labels lie: two limits are often exceeded most at the same position."""
MARKER_SHARE = 0.12
"""Radius of a marker, in units of the scene."""


class LimitMarks:
    """The nodes under /path/broken."""

    def __init__(self, scene: SceneApi) -> None:
        color = palette.rgb(palette.LIMIT_EXCEEDED)
        self._line = scene.add_line_segments(
            "/path/broken", EMPTY_LINE, color, thickness=THICKNESS, thickness_units="screen", visible=False
        )
        markers, labels = [], []
        for k, anchor in enumerate(LABEL_ANCHORS):
            name = f"/path/broken{k + 1}"
            markers.append(
                scene.add_icosphere(
                    name, 1.0, color, subdivisions=0, flat_shading=True, scale=INVISIBLE_SIZE, visible=False
                )
            )
            labels.append(scene.add_label(f"{name}/label", "", anchor=anchor, font_screen_scale=0.9))
        self._markers, self._labels = markers, labels

    def draw(self, motion: Motion, breaks: tuple[Break, ...], bounds: SceneBounds) -> None:
        """Show where limits are exceeded. At most three get a marker: those that are exceeded for longest."""
        lines = exceeding_segments(motion, exceeding_samples(breaks, len(motion.time)), bounds)
        self._line.visible = len(lines) > 0
        if len(lines):
            self._line.points = lines.astype(np.float32)
        for k, (marker, label) in enumerate(zip(self._markers, self._labels, strict=True)):
            marker.visible = k < len(breaks)
            if k < len(breaks):
                at = int(np.argmin(np.abs(motion.time - breaks[k].at)))
                marker.position, marker.scale = motion.position[at], MARKER_SHARE * bounds.unit
                label.text = marker_label(breaks[k])


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
