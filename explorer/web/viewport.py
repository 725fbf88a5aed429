"""How wide the visitor's window is, which viser 1.1.1 does not tell: from what a dock takes of the 3-D canvas."""

import time

import viser

NARROW, WIDTH_ERROR = 1600, 30
"""px: a window below this width gets one column of plots; and how well the width is known."""
PATIENCE, LOOK = 1.5, 0.02
"""s to wait for the browser to tell its width, which a headless or hidden one may never do; and between two looks."""


def width(client: viser.ClientHandle, canvas: int, dock: int) -> float:
    """CSS pixels, after a dock of a known width (px) has opened beside what was `canvas` px wide before. viser tells
    the canvas in device pixels; their ratio shows in what the dock takes from it."""
    patience = time.monotonic() + PATIENCE
    while client.camera.image_width == canvas and time.monotonic() < patience:
        time.sleep(LOOK)
    taken = canvas - client.camera.image_width
    return canvas * dock / taken if taken > 0 else canvas


def is_narrow(width: float) -> bool:
    """Whether it has room for one column of plots only."""
    return width < NARROW - WIDTH_ERROR
