"""The camera by buttons and commands: views of the whole scene, and steps around what the camera looks at."""

from functools import partial
from typing import NamedTuple

from explorer.scene import Scene
from explorer.scene.view import Direction, Step
from explorer.widgets.form import Action, Form


class Move(NamedTuple):
    """One button."""

    face: str
    label: str
    """What a reader of the screen says, and the palette shows."""


VIEWS: dict[Direction, Move] = {
    "first": Move("first", "First view of the scene"),
    "above": Move("above", "View from above"),
    "x": Move("x", "View against the x axis"),
    "y": Move("y", "View against the y axis"),
}
STEPS: dict[Step, Move] = {
    "left": Move("←", "Camera to the left"),
    "right": Move("→", "Camera to the right"),
    "up": Move("↑", "Camera up"),
    "down": Move("↓", "Camera down"),
    "closer": Move("+", "Camera closer"),
    "farther": Move("−", "Camera farther away"),
}
BUTTON = '<button type="button" class="rn-button" data-rn-event="camera-{0}" title="{1}" aria-label="{1}">{2}</button>'
ROW = (
    '<div class="rn-camera"><button type="button" class="rn-button" data-rn-flag="camera" '
    'title="Show or fold the buttons of the camera">camera</button>'
    '<div role="group" aria-label="Camera">{}</div></div>'
)


class CameraPanel:
    """A row of buttons over the scene, folded at first; each is a command of the palette, too."""

    def __init__(self, form: Form, scene: Scene) -> None:
        views = {name: (move, partial(scene.look, name)) for name, move in VIEWS.items()}
        steps = {name: (move, partial(scene.step_camera, name)) for name, move in STEPS.items()}
        moves: dict[str, tuple[Move, Action]] = {**views, **steps}
        self.actions: dict[str, Action] = {f"camera-{name}": action for name, (_, action) in moves.items()}
        """What the buttons do, by the names that they send."""
        buttons = (BUTTON.format(name, move.label, move.face) for name, (move, _) in moves.items())
        form.gui.add_html(ROW.format("".join(buttons)))
        for move, action in moves.values():
            form.command(move.label, action, step=False)
