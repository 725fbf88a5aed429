"""The width of the visitor's window, from what a dock takes of the 3-D canvas: viser 1.1.1 does not report it."""

import time

import viser

NARROW, WIDTH_ERROR = 1600, 30
"""px: a window below this width gets one column of plots; and the error of the measured width."""
WIDTH_TIMEOUT, POLL = 1.5, 0.02
"""s to wait for the browser's width, which a headless or hidden browser may never send; and between two tries."""


def width(client: viser.ClientHandle, canvas: int, dock: int) -> float:
    """The width (CSS px) of the window, after a dock of a known width (CSS px) has opened.

    `canvas` is the width of the 3-D canvas before, in device pixels, as viser reports it. What the dock takes from it
    gives the ratio of device pixels to CSS pixels.
    """
    deadline = time.monotonic() + WIDTH_TIMEOUT
    while client.camera.image_width == canvas and time.monotonic() < deadline:
        time.sleep(POLL)
    taken = canvas - client.camera.image_width
    return canvas * dock / taken if taken > 0 else canvas


def is_narrow(width: float) -> bool:
    """Whether it has room for one column of plots only."""
    return width < NARROW - WIDTH_ERROR
