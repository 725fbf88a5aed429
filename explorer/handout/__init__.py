"""A handout: any state of the page, or a lesson, as one HTML file that opens from disk without a network.

sliders   settings → the settings at each position of a baked slider
contents  pictures → the numbers that the file holds
document  numbers, text and script → the file
"""

from explorer.handout.document import MAX_BYTES, handout
from explorer.handout.sliders import POSITIONS, Baked, slider

__all__ = ["MAX_BYTES", "POSITIONS", "Baked", "handout", "slider"]
