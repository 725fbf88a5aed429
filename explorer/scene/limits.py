"""Where the path asks too much of the vehicle: a thick line over it, and at each worst place a marker with a word.

The line is told from the others by its width as well as its colour, and from the estimate's dashes by having none.
"""

import math
from itertools import pairwise

import numpy as np
from jaxtyping import Bool, Float
from numpy import ndarray as Array
from viser import SceneApi

from explorer.scene.bounds import NO_LINE, UNSEEN, SceneBounds, chords
from explorer.scene.colors import VERMILLION
from rangenav.motion import Motion
from rangenav.vehicle import WORDS, Break

THICKNESS = 8.0
"""px; the path itself has 3."""
MAX_MARKED = 3
ANCHORS = ("bottom-left", "top-left", "bottom-right")
"""Of the words, which lie around their markers: two limits are often broken worst at the same place."""
MARKER_SHARE = 0.12
"""Radius of a marker, in units of the stage."""


class LimitMarks:
    """The nodes under /path/broken."""

    def __init__(self, scene: SceneApi) -> None:
        self._line = scene.add_line_segments(
            "/path/broken", NO_LINE, VERMILLION, thickness=THICKNESS, thickness_units="screen", visible=False
        )
        markers, labels = [], []
        for k, anchor in enumerate(ANCHORS):
            name = f"/path/broken{k + 1}"
            markers.append(
                scene.add_icosphere(
                    name, 1.0, VERMILLION, subdivisions=0, flat_shading=True, scale=UNSEEN, visible=False
                )
            )
            labels.append(scene.add_label(f"{name}/label", "", anchor=anchor, font_screen_scale=0.9))
        self._markers, self._labels = markers, labels

    def draw(self, motion: Motion, breaks: tuple[Break, ...], on: SceneBounds) -> None:
        """Show where the limits are broken, and say of the three broken for longest where they are broken worst."""
        lines = segments(motion, broken(breaks, len(motion.time)), on)
        self._line.visible = len(lines) > 0
        if len(lines):
            self._line.points = lines.astype(np.float32)
        for k, (marker, label) in enumerate(zip(self._markers, self._labels, strict=True)):
            marker.visible = k < len(breaks)
            if k < len(breaks):
                at = int(np.argmin(np.abs(motion.time - breaks[k].at)))
                marker.position, marker.scale = motion.position[at], MARKER_SHARE * on.unit
                label.text = word(breaks[k])


def broken(breaks: tuple[Break, ...], count: int) -> Bool[Array, "n"]:
    """The samples on which any limit is broken."""
    return np.logical_or.reduce([one.where for one in breaks]) if breaks else np.zeros(count, dtype=bool)


def segments(motion: Motion, where: Bool[Array, "n"], on: SceneBounds) -> Float[Array, "m 2 3"]:
    """Those chords of the drawn path on which a sample is broken, be it one alone."""
    ends = chords(motion, on)
    hit = np.array([where[first : last + 1].any() for first, last in pairwise(ends)])
    return np.stack([motion.position[ends[:-1][hit]], motion.position[ends[1:][hit]]], axis=1)


def word(one: Break) -> str:
    """What is broken, how far, and when."""
    name, unit = WORDS[one.limit]
    if one.limit == "thrust_to_weight":
        reached = f"{one.reached:.3g} × weight"
    elif one.limit == "tilt":
        reached = f"{math.degrees(one.reached):.3g}°"
    else:
        reached = f"{one.reached:.3g} {unit}"
    return f"✕ {name} {reached} at {one.at:.1f} s"
