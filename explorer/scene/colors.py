"""Colours of the 3-D picture (Okabe–Ito). An estimate of a vector has the lighter tint of the true one."""

Color = tuple[int, int, int]

BLUE, VERMILLION, SKY, ORANGE = (0, 114, 178), (213, 94, 0), (86, 180, 233), (230, 159, 0)
GREEN, LIGHT_GREEN, PURPLE, LIGHT_PURPLE = (0, 158, 115), (120, 205, 175), (204, 121, 167), (228, 178, 206)
OLIVE = (153, 153, 51)
"""The evil twin's alone (Tol's muted scheme): purple is what is pinned."""
PALE = (205, 195, 190)
"""Where the estimate's path begins."""


def linear(color: Color) -> Color:
    """What to send where the browser takes a colour for linear light (arrows, lines of many colours)."""
    r, g, b = (round(255 * (channel / 255) ** 2.2) for channel in color)
    return r, g, b
