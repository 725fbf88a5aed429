"""Every colour of the page and what it stands for. No other module spells a colour; a test checks that.

    data      Okabe–Ito: distinct to readers with any colour vision, on white and on black
    text      pairs light-dark(on white, on black), each with enough contrast to be read
    scale     viridis: its lightness alone shows the order
A role names what is drawn ("estimate"); a hue is used where a plot needs several curves that have no role of their own.
The module stands in `model`, the lowest room, because model, charts, scene and panels all import it.
"""

from typing import Literal

Color = str
"""#RRGGBB"""
Rgb = tuple[int, int, int]
"""Red, green and blue from 0 to 255, as viser takes them."""

BLUE, VERMILLION, GREEN, PURPLE = "#0072B2", "#D55E00", "#009E73", "#CC79A7"
ORANGE, SKY, GREY = "#E69F00", "#56B4E9", "#888888"
SLATE = "#6B7785"
"""Neither a run nor a vector: of things that stand."""
LIGHT_GREEN, LIGHT_PURPLE = "#78CDAF", "#E4B2CE"

# Runs: the same in plots, in the 3-D picture and in text
TRUTH, ESTIMATE = BLUE, VERMILLION
PINNED, TWIN = PURPLE, ORANGE
PROPOSED = GREEN
"""The motion that a repair proposes."""
ESTIMATORS: dict[Literal["EKF", "refined"], Color] = {"EKF": SKY, "refined": GREEN}
"""The estimators that are compared with the cascade. All runs stay apart for readers with deuteranopia and protanopia:
a test simulates both."""
SEEDS, SEEDS_EDGE = GREY, VERMILLION
"""The median of many seeds, and the edges of the band around it."""

# Plots
CLAIMED_SIGMA, REQUIRED, NOISE_FLOOR = BLUE, GREY, GREY
X_AXIS, Y_AXIS, Z_AXIS, NORM = VERMILLION, GREEN, BLUE, GREY
LEAST, MIDDLE, GREATEST = VERMILLION, SKY, BLUE
"""Eigenvalues of a spectrum; those between the least and the greatest share a colour."""
EXCITATION_EIGENVALUES = (VERMILLION, PURPLE, SKY)
"""Least first."""
PRINTED_EIGENVALUES = (ORANGE, GREEN, BLUE)
"""The same with the printed condition: no colour stands for a derived eigenvalue, too."""
DERIVED, PRINTED = BLUE, ORANGE
"""A formula as derived, and as the paper prints it."""
MEASURED = SKY
TURN_RATE = ORANGE
OTHER_AXIS: dict[bool, Color] = {False: "#8A3D7A", True: "#D99AC9"}
"""The numbers of a horizontal axis that is not the time of the flight, by whether the page is dark."""
PLOT_GRID, PAGE_GRID = "#DDDDDD", "#88888828"
"""Of an exported picture, and of a plot on the page, light or dark."""
TRANSLUCENT, FILL = "B0", "38"
"""Opacities (hexadecimal, 0 to FF), put behind a colour: curves that show through, and what is tinted below a curve."""

# The 3-D picture
SCENE_GRID: dict[bool, tuple[Color, Color]] = {False: ("#C8C8C8", "#8C8C8C"), True: ("#3C3C3C", "#6A6A6A")}
"""The lines of the ground, and each tenth of them, by whether the page is dark."""
ANCHOR, RANGE_SPHERE, WAYPOINT = SLATE, SKY, BLUE
GRAVITY, GRAVITY_ESTIMATE = GREEN, LIGHT_GREEN
MAGNETIC, MAGNETIC_ESTIMATE = PURPLE, LIGHT_PURPLE
"""The estimate of a vector has the lighter tint of the true one."""
BLIND_DIRECTION, LIMIT_EXCEEDED = ORANGE, VERMILLION
EXCITATION, WEAKEST_AXIS = GREEN, ORANGE
EQUILIBRIUM = PURPLE
TAIL_END = "#F0B48C"
"""The far end of the estimate's tail, which begins in the colour of the estimate."""
GLOBE, GLOBE_INK = "#D6D6D6", "#141414"
SETTLING_SCALE: tuple[Color, ...] = (
    "#FDE725", "#ADDC30", "#5EC962", "#28AE80", "#21918C", "#2C728E", "#3B528B", "#472C7A", "#440154",
)  # fmt: skip
"""From the soonest (light) to the latest (dark)."""
NEVER_SETTLES = VERMILLION
"""Not on the scale; what never settles is also larger and of another shape."""

# Maps of two parameters
MAP_SCALE = SETTLING_SCALE
"""From the best value (light) to the worst (dark); where neither is better, from the least to the largest."""
MAP_INVALID, MAP_LINE, MAP_EDGE = "#9A9A9A", "#FFFFFF", "#141414"
"""A point that cannot be computed; and lines over the map, light with a dark edge, which every colour shows."""

# Text and controls
GOOD, WARNING, ERROR = "light-dark(#00785A, #4FD1AD)", "light-dark(#9A5B00, #F0B35A)", "light-dark(#B3261E, #FF8F86)"
UNOBSERVABLE = "light-dark(#7A3E00, #E0A878)"
"""Certified as such: neither good nor an error."""
NEUTRAL = "light-dark(#555555, #BBBBBB)"
RUN_TEXT: dict[Color, Color] = {
    PINNED: "light-dark(#9C3F74, #D99AC9)",
    ESTIMATE: "light-dark(#A84300, #FF9152)",
    SKY: "light-dark(#1B6699, #6CBFF0)",
    GREEN: "light-dark(#00785A, #4FD1AD)",
}
"""The name of a run in text, by its colour in the plots and in the scene."""
SECONDARY_TEXT, CAPTION_TEXT = "light-dark(#666666, #A8A8A8)", "light-dark(#5C5C5C, #B0B0B0)"
PRINTED_FORMULA = "light-dark(#8A3D7A, #D99AC9)"
"""Of the label that says which printed formulas are switched on."""
JUMP_NOTICE = "light-dark(#8A5300, #F0B35A)"
"""Of the sentences on jumps of a piecewise path."""
THUMBNAIL_LINE, THUMBNAIL_ANCHOR, THUMBNAIL_FRAME = "light-dark(#0072B2, #56B4E9)", VERMILLION, "light-dark(#CCC, #555)"
BAR_TRACK = "#8883"
QUIET_BUTTON = "#5C7596"
CODE_INK, CODE_GROUND = "#000000", "#FFFFFF"
"""A QR code, dark on light in both themes: cameras read no other."""
TOOLTIP, TOOLTIP_TEXT = "#333333", "#FFFFFF"
FOCUS, DEFINITION_EDGE, DEFINITION_FILL = SKY, SKY, "rgba(128,128,128,.09)"
WINDOW, BRUSH = SKY, ORANGE
"""The window that is shown over every plot, and the next one while it is drawn with the mouse."""
NOTIFY_WARNING, NOTIFY_ERROR = "orange", "red"
"""Names in the browser's own theme."""


def rgb(color: Color) -> Rgb:
    """The three numbers of #RRGGBB."""
    return int(color[1:3], 16), int(color[3:5], 16), int(color[5:7], 16)


def linear(color: Color) -> Rgb:
    """The three numbers to send where the browser takes a colour for linear light: arrows, lines of many colours."""
    r, g, b = (round(255 * (channel / 255) ** 2.2) for channel in rgb(color))
    return r, g, b
