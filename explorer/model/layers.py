"""The layers of the 3-D picture, in the order of the legend: what each shows, and whether it is drawn at first."""

from typing import NamedTuple

from explorer.model import palette


class Layer(NamedTuple):
    """One entry of the legend."""

    name: str
    label: str
    hint: str
    mark: str
    """Kind of its mark in the legend: line, tail, ball, ring or arrow."""
    color: palette.Color
    shown: bool = True
    """Whether it is drawn until the visitor chooses."""


LAYERS = (
    Layer("path", "true path", "Where the vehicle is; the solid vehicle flies along it.", "line", palette.TRUTH),
    Layer("tail", "estimate", "The ghost, and where it was in the last 3 s.", "tail", palette.ESTIMATE),
    Layer(
        "uncertainty", "its 1 σ", "How far off the observer expects to be: one standard deviation.", "ball",
        palette.ESTIMATE,
    ),
    Layer("sphere", "range", "All places at the measured distance from the anchor.", "ring", palette.RANGE_SPHERE),
    Layer(
        "blind", "blind directions", "Along them the ranges do not tell where the vehicle is.", "arrow",
        palette.BLIND_DIRECTION,
    ),
    Layer(
        "twin", "evil twin", "Another motion with the same ranges and the same sensors.", "line", palette.TWIN
    ),
    Layer(
        "vectors", "g and m", "Gravity and the magnetic field, thin as estimated.", "arrow", palette.GRAVITY,
        shown=False,
    ),
    Layer(
        "excitation", "excitation", "The directions that the window excites; its arrow is the weakest.", "ball",
        palette.EXCITATION, shown=False,
    ),
    Layer("labels", "labels", "Names in the picture.", "", palette.GREY),
)  # fmt: skip
AT_FIRST = frozenset(layer.name for layer in LAYERS if not layer.shown)
"""The layers that are not drawn until the visitor switches them on."""


def hidden(switched: frozenset[str]) -> frozenset[str]:
    """The layers that are not drawn, after the visitor has switched some."""
    return AT_FIRST ^ (switched & frozenset(layer.name for layer in LAYERS))
