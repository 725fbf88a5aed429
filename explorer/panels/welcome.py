"""The first minute: a card over the scene with one sentence, the marks of the scene and four doors. It is shown and
closed in the browser, which remembers it; “?” brings it back."""

import viser

from explorer.model.layers import LAYERS
from explorer.panels.legend import mark

SENTENCE = (
    "One radio range to one anchor, an IMU and a magnetometer: when is that enough to know where you are? "
    "Change the motion, the sensors or the gains, and the page says so at once."
)
MARKS = ("path", "tail", "uncertainty", "sphere", "blind", "twin")
DOORS = (
    (
        "Learn",
        "why a hover is lost: the first lesson, six minutes",
        'data-rn-event="learn" data-rn-flag="welcomed" data-rn-tab="Learn"',
    ),
    ("Tune", "an observer: its gains, on this motion", 'data-rn-event="go-tune" data-rn-flag="welcomed"'),
    ("Design", "a motion to fly, and take it as a file", 'data-rn-flag="welcomed" data-rn-tab="Presets"'),
    ("Look around", "drag the scene, press play", 'data-rn-flag="welcomed"'),
)
"""Name, what is behind it, and what the button does."""
DOOR = '<button type="button" class="rn-door-button" {}><b>{}</b><span>{}</span></button>'
CLOSE = '<button type="button" class="rn-button" data-rn-flag="{}" aria-label="Close">{}</button>'


def add_welcome(gui: viser.GuiApi) -> None:
    """Put the card over the scene."""
    gui.add_html(f'<div class="rn-card rn-welcome" role="dialog" aria-label="Welcome">{welcome()}</div>')


def welcome() -> str:
    """The first card, as HTML."""
    layers = {layer.name: layer for layer in LAYERS}
    marks = "".join(
        f"<span>{mark(layers[name])} <b>{layers[name].label}</b> {layers[name].hint}</span>" for name in MARKS
    )
    doors = "".join(DOOR.format(action, name, what) for name, what, action in DOORS)
    head = f'<div class="rn-card-head"><b>rangenav</b>{CLOSE.format("welcomed", "✕")}</div>'
    return f'{head}<p>{SENTENCE}</p><div class="rn-doors">{doors}</div><div class="rn-marks">{marks}</div>'
