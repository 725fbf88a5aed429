"""A page without a browser: a viser server nobody connects to, which remembers every message it would send."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any, cast

import numpy as np
import viser
from viser.infra import Message
from viser.transforms import SO3


@dataclass
class Camera:
    """The camera that the page would report."""

    position: Any = (3.0, 3.0, 3.0)
    look_at: Any = (0.0, 0.0, 0.0)
    fov: float = 1.3
    far: float = 1000.0
    image_width: int = 900
    image_height: int = 1000
    update_timestamp: float = 0.0
    up: Any = (0.0, 0.0, -1.0)
    callbacks: list[Callable[["Camera"], None]] = field(default_factory=list)

    @property
    def wxyz(self) -> np.ndarray:
        """The rotation from (right, down, ahead) to the inertial axes."""
        up = np.asarray(self.up, dtype=float)
        ahead = np.asarray(self.look_at, dtype=float) - np.asarray(self.position, dtype=float)
        ahead = ahead / np.linalg.norm(ahead)
        right = np.cross(ahead, up)
        right = right / np.linalg.norm(right)
        return SO3.from_matrix(np.stack([right, np.cross(ahead, right), ahead], axis=1)).wxyz

    def on_update(self, callback: Callable[["Camera"], None]) -> None:
        self.callbacks.append(callback)

    def report(self, position: Any) -> None:
        """The page reports where its camera is."""
        self.position = position
        for callback in self.callbacks:
            callback(self)


@dataclass
class Page:
    """A stand-in for one client."""

    server: viser.ViserServer
    camera: Camera = field(default_factory=Camera)
    messages: list[Message] = field(default_factory=list)
    """Sent since a test last cleared them."""
    created: list[Message] = field(default_factory=list)
    """All that have created a control or a node."""

    def __post_init__(self) -> None:
        interface = self.server.gui._websock_interface
        send = interface.queue_message

        def record(message: Message) -> None:
            self.messages.append(message)
            if hasattr(message, "props"):
                self.created.append(message)
            send(message)

        interface.queue_message = record  # type: ignore[method-assign]

    @property
    def gui(self) -> viser.GuiApi:
        return self.server.gui

    @property
    def scene(self) -> viser.SceneApi:
        return self.server.scene

    @property
    def client(self) -> viser.ClientHandle:
        return cast(viser.ClientHandle, self)

    def node(self, name: str) -> viser.SceneNodeHandle:
        """A node of the 3-D picture."""
        handle = self.scene.get_handle_by_name(name)
        assert handle is not None, name
        return handle

    def updates(self, prop: str) -> list[Any]:
        """All values of a property of controls that were sent since the messages were last cleared."""
        sent = [vars(message)["updates"] for message in self.messages if type(message).__name__ == "GuiUpdateMessage"]
        return [update[prop] for update in sent if prop in update]

    def live_style(self) -> str:
        """The elements that change as time moves: positions of the cursors, and values in the legends."""
        return "".join(content for content in self.updates("content") if content.startswith("<style>:root{"))

    def type_text(self, label: str, text: str) -> None:
        """Write into the first text box with a label, as a visitor would."""
        boxes = (vars(message) for message in self.created if type(message).__name__ == "GuiTextMessage")
        uuid = next(box["uuid"] for box in boxes if box["props"].label == label)
        handle = self.gui._gui_input_handle_from_uuid[uuid]  # viser has no public way to find a control
        assert handle is not None
        handle.value = text

    def kinds(self) -> set[str]:
        """Names of the types of the messages so far."""
        return {type(message).__name__ for message in self.messages}

    def numbers(self) -> Iterator[float]:
        """Every number in the messages so far."""
        for message in self.messages:
            yield from _numbers(vars(message))


def _numbers(value: Any) -> Iterator[float]:
    if isinstance(value, float | int | np.floating):
        yield float(value)
    elif isinstance(value, np.ndarray):
        yield from (float(entry) for entry in value.ravel())
    elif isinstance(value, dict):
        for entry in value.values():
            yield from _numbers(entry)
    elif isinstance(value, tuple | list):
        for entry in value:
            yield from _numbers(entry)
    elif hasattr(value, "__dict__"):
        yield from _numbers(vars(value))
