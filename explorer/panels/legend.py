"""The legend of the scene, which is also the list of its layers: each entry is an eye that switches the layer."""

import html

import viser

from explorer.model import palette
from explorer.model.layers import LAYERS, Layer

ENTRY = '<button type="button" class="rn-layer" data-rn-layer="{}" {} title="{}">{}<span>{}</span></button>'
FOLD = '<button type="button" class="rn-button" data-rn-flag="layers" title="Show or fold the legend">legend</button>'


def add_legend(gui: viser.GuiApi) -> None:
    """Put the legend over the scene."""
    gui.add_html(f'<div class="rn-layers">{FOLD}<div>{"".join(entry(layer) for layer in LAYERS)}</div></div>')


def entry(layer: Layer) -> str:
    """One row of the legend: mark and label."""
    off = "" if layer.shown else "data-rn-off"
    return ENTRY.format(layer.name, off, html.escape(layer.hint), mark(layer), html.escape(layer.label))


def mark(layer: Layer) -> str:
    """What the layer looks like in the scene."""
    shapes = {
        "line": '<path d="M2 8h22" stroke-width="3"/>',
        "tail": '<path d="M2 9q8 -6 14 -1" stroke-width="3"/><circle cx="20" cy="7" r="4" fill="{0}" stroke="none"/>',
        "ball": '<ellipse cx="13" cy="8" rx="10" ry="6" stroke-width="1.5" fill="{0}" fill-opacity=".25"/>',
        "ring": '<circle cx="13" cy="8" r="7" stroke-width="1.5" fill="{0}" fill-opacity=".25"/>',
        "arrow": '<path d="M2 8h17m-5 -5l6 5l-6 5" stroke-width="2"/>',
        "": '<path d="M6 13l7 -11l7 11m-11 -4h8" stroke-width="1.5"/>',
    }
    color = palette.NEUTRAL if layer.mark == "" else layer.color
    shape = shapes[layer.mark].format(layer.color)
    return f'<svg width="26" height="16" fill="none" style="stroke:{color}">{shape}</svg>'
