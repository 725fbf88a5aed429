"""A visitor without a browser: viser's websocket messages, sent and received as they are (checked against 1.1.1).

It sends whatever a test asks for, also messages that the page itself never sends.
"""

import re
import socket
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import msgspec
import viser
import zstandard
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect
from websockets.typing import Origin, Subprotocol

from explorer.widgets.vector import AXES, box_label
from rangenav.number_format import UNBROKEN

CAMERA = {
    "type": "ViewerCameraMessage",
    "wxyz": (1.0, 0.0, 0.0, 0.0),
    "position": (3.0, 3.0, 3.0),
    "fov": 1.0,
    "near": 0.1,
    "far": 100.0,
    "image_height": 1080,
    "image_width": 1920,
    "look_at": (0.0, 0.0, 0.0),
    "up_direction": (0.0, 0.0, 1.0),
}
HEADER = 8
"""Bytes of each of the two lengths before the compressed messages."""
NO_DOCK = 0.5
"""s after which a server without docks is not waited for any longer."""
CHANGED = " •"
"""Ends the label of a control that differs from its preset."""
WAIT_TIMEOUT = 90.0
"""s; the first picture may have to wait for a compiler."""
QUIET_TIMEOUT = 60.0
"""s after which a server that never stops sending has failed."""
PAUSE, QUIET = 0.01, 0.05
"""s between two looks at a condition while messages come, and at most."""


REMEMBERED = re.compile(r"sessionStorage\.setItem\('([\w-]+)', '(\w+)'\)")
COPIED = re.compile(r"localStorage\.setItem\('viser-user:([\w-]+)', sessionStorage\.getItem\('([\w-]+)'\) \?\? ''\)")
"""The statements of the explorer that a page would run."""


@dataclass
class Storage:
    """The storage of a browser: `shared` by its tabs, and that of one `tab`, which survives a reload."""

    shared: dict[str, str] = field(default_factory=dict)
    tab: dict[str, str] = field(default_factory=dict)
    refused: bool = False
    """Whether the browser refuses storage, as when cookies are blocked."""
    silent: bool = False
    """Whether the browser never answers."""
    forgetful: bool = False
    """Accepts every write and stores nothing."""


class Wire:
    """One connection, and all that the server has sent about controls and nodes of the scene."""

    def __init__(
        self,
        port: int,
        *,
        origin: str | None = None,
        storage: Storage | None = None,
        cookie: str = "",
        narrow: bool = False,
    ) -> None:
        """narrow: whether next to nothing is taken from the system before it is read (see `stall`)."""
        self.elements: dict[str, dict[str, Any]] = {}
        """Properties of every control that exists, by its id; with its value as "value", and its kind as "message"."""
        self.counts: dict[str, int] = {}
        """How many messages of each type have come."""
        self.notifications: list[str] = []
        self.commands: dict[str, str] = {}
        """Ids of the palette's commands, by their labels."""
        self.nodes: dict[str, dict[str, Any]] = {}
        """Position, visibility and properties of every node of the scene, by its name; "owner" is echoed to viser."""
        self.storage = storage or Storage()
        self.on_plot: Callable[[str], object] = lambda uuid: None
        """Called, in the listener's thread, with the id of a plot that has new data."""
        self.dock = 0
        """Width (px) of the first panel that has one."""
        self.downloads: list[tuple[str, bytes]] = []
        """Names and contents of the files that have come."""
        self._transfers: dict[str, tuple[dict[str, Any], list[bytes]]] = {}
        self._pressed = 0
        self.closed_with: int | None = None
        """The code with which the server ended the connection."""
        self._arrived = threading.Event()
        """Set when messages have been taken in: what waits looks again."""
        self._reads = threading.Event()
        self._reads.set()
        self._socket = connect(
            f"ws://127.0.0.1:{port}/",
            origin=Origin(origin or f"http://127.0.0.1:{port}"),
            subprotocols=[Subprotocol(f"viser-v{viser.__version__}")],
            max_size=None,
            additional_headers={"Cookie": cookie} if cookie else {},
            sock=_narrow_socket(port) if narrow else None,
            max_queue=1 if narrow else 16,
        )
        self._listener = threading.Thread(target=self._listen, daemon=True)
        self._listener.start()
        began = time.monotonic()
        self.send(CAMERA)
        self.wait_for(lambda: self.dock or time.monotonic() > began + NO_DOCK, "a dock")
        self.send(CAMERA | {"image_width": CAMERA["image_width"] - self.dock})  # it takes its share of the canvas

    def send(self, message: dict[str, Any]) -> None:
        """Send one message, unchecked."""
        self._socket.send(msgspec.msgpack.encode(message))

    def set(self, label: str, value: Any) -> None:
        """Set a control as the page would; numbers are typed into the boxes for numbers."""
        if isinstance(value, list | tuple):
            for axis, entry in zip(AXES, value, strict=True):
                self.set(box_label(label, axis), str(entry))
            return
        uuid = self.find(label)
        if isinstance(self.elements[uuid].get("value"), str) and isinstance(value, int | float):
            value = str(value)
        self.send({"type": "GuiUpdateMessage", "uuid": uuid, "updates": {"value": value}})

    def press(self, label: str, option: str | None = None) -> None:
        """Press a button, as soon as the page has one of this label, or the first row's button of this name that is
        shown."""
        if option is None:
            self.wait_for(lambda: any(p.get("label") == label for p in list(self.elements.values())), label)
            self.set(label, True)
            return
        for uuid, p in list(self.elements.items()):
            if p.get("label") == label and option in (p.get("options") or ()) and p.get("visible", True):
                self.send({"type": "GuiUpdateMessage", "uuid": uuid, "updates": {"value": option}})
                return
        raise LookupError(f"no button {option!r} in a row {label!r}")

    def press_own(self, name: str) -> None:
        """Press a button of the page's own HTML, by the name that it sends."""
        self._pressed += 1
        self.set("page", f"width=1366&height=768&event={self._pressed}:{name}")

    def upload(self, label: str, name: Any, content: bytes, *, part: int = 2**19, **changed: Any) -> None:
        """Upload a file as the page would; `changed` replaces fields of the announcement."""
        parts = [content[k : k + part] for k in range(0, len(content), part)]
        ids = {"source_component_uuid": self.find(label), "transfer_uuid": f"{name}-{time.monotonic()}"}
        announcement = {"filename": name, "mime_type": "", "part_count": len(parts), "size_bytes": len(content)}
        self.send({"type": "FileTransferStartUpload", **ids, **announcement, **changed})
        for k, piece in enumerate(parts):
            self.send({"type": "FileTransferPart", **ids, "part_index": k, "content": piece})

    def command(self, label: str) -> None:
        """Trigger a command of the palette."""
        self.send({"type": "CommandTriggerMessage", "uuid": self.commands[label]})

    def drag(self, name: str, position: Sequence[float], *, steps: int = 1, done: bool = True) -> None:
        """Drag a node to a position as the page would, in equal steps."""
        start = tuple(self.nodes[name]["position"])
        self.drag_message(name, "start", start, start)
        for k in range(1, steps + 1):
            end = tuple(a + (b - a) * k / steps for a, b in zip(start, position, strict=True))
            self.drag_message(name, "update", start, end)
        if done:
            self.drag_message(name, "end", start, tuple(position))

    def drag_message(self, name: str, phase: str, start: Any, end: Any) -> None:
        """One message of a drag: where the node was taken hold of, and where the pointer is, unchecked."""
        screen = {"start_screen_pos": (0.5, 0.5), "end_screen_pos": (0.5, 0.5)}
        button = {"instance_index": None, "button": "left", "modifier": None, "owner": self.nodes[name]["owner"]}
        places = {"start_position": start, "end_position": end}
        self.send({"type": "SceneNodeDragMessage", "phase": phase, "name": name, **places, **screen, **button})

    def click(self, name: str, *, screen: tuple[float, float] = (0.5, 0.5)) -> None:
        """Click on a node, which viser reports as a click on the scene as well."""
        ray: dict[str, Any] = {"ray_origin": (0.0, 0.0, 9.0), "ray_direction": (0.0, 0.0, -1.0), "modifier": None}
        owned = {"instance_index": None, "owner": self.nodes[name]["owner"]}
        self.send({"type": "SceneNodeClickMessage", "name": name, "screen_pos": screen, **ray, **owned})
        self.send({"type": "ScenePointerMessage", "event_type": "click", "screen_pos": (screen,), **ray})

    def move_gizmo(self, name: str, position: Sequence[Any], *, done: bool = True) -> None:
        """Pull a gizmo to a position, unchecked."""
        owned = {"name": name, "owner": self.nodes[name]["owner"]}
        self.send({"type": "TransformControlsDragStartMessage", **owned})
        pose = {"wxyz": (1.0, 0.0, 0.0, 0.0), "position": position}
        self.send({"type": "TransformControlsUpdateMessage", **pose, **owned})
        if done:
            self.send({"type": "TransformControlsDragEndMessage", **owned})

    def find(self, label: str) -> str:
        """The id of the control with this label, of one that is shown if there are several; the box of a slider has
        the slider's label and “: number”."""
        named = [
            (not properties.get("visible", True), k, uuid)
            for k, (uuid, properties) in enumerate(list(self.elements.items()))
            if (properties.get("label") or "").removesuffix(CHANGED) == label
        ]
        if not named:
            raise LookupError(f"no control {label!r}")
        return min(named)[-1]

    def value(self, label: str) -> Any:
        """What the control shows; of a vector, the texts of its three boxes."""
        shown = self.elements[self.find(label)]["value"]
        if not any(p.get("label") == box_label(label, AXES[1]) for p in list(self.elements.values())):
            return shown
        return shown, *(self.value(box_label(label, axis)) for axis in AXES[1:])

    def text(self) -> str:
        """All text of the page that is shown, as HTML or markdown; a no-break space is read as a space."""
        shown = [p for p in list(self.elements.values()) if p.get("visible", True)]
        text = "\n".join(str(p.get("content") or p.get("_markdown") or "") for p in shown)
        return text.replace(UNBROKEN, " ")

    def wait_for(self, holds: Callable[[], Any], what: str, timeout: float = WAIT_TIMEOUT) -> None:
        """Wait until the condition `holds`. Raises AssertionError after a time-out."""
        deadline = time.monotonic() + timeout
        while not holds():
            if time.monotonic() > deadline:
                raise AssertionError(f"waited {timeout:g} s in vain for {what}; the page says:\n{self.text()}")
            self._arrived.wait(QUIET)  # the condition may also be one of the session, which sends nothing then
            self._arrived.clear()
            time.sleep(PAUSE)

    def wait_for_text(self, text: str) -> None:
        """Wait until the page shows a text."""
        self.wait_for(lambda: text in self.text(), repr(text))

    def wait_until_quiet(self, seconds: float) -> None:
        """Wait until the server has sent nothing for so long; whoever sends for ever fails."""
        began = quiet_since = time.monotonic()
        before = -1
        while time.monotonic() - quiet_since < seconds:
            assert time.monotonic() - began < QUIET_TIMEOUT, "the server does not stop sending"
            time.sleep(0.1)
            if before != (before := sum(self.counts.values())):
                quiet_since = time.monotonic()

    def stall(self) -> None:
        """Read nothing any more, as a browser whose machine sleeps; the server's pings are not answered either."""
        self._reads.clear()

    def close(self) -> None:
        """Close the tab."""
        self._reads.set()
        self._socket.close()
        self._listener.join()

    def _listen(self) -> None:
        try:
            for frame in self._socket:
                assert isinstance(frame, bytes)
                size = int.from_bytes(frame[HEADER : 2 * HEADER], "little")
                packed = zstandard.ZstdDecompressor().decompress(frame[2 * HEADER : 2 * HEADER + size])
                for message in msgspec.msgpack.decode(packed)["messages"]:
                    self._take_in(message)
                self._arrived.set()
                self._reads.wait()
        except ConnectionClosed as closed:
            self.closed_with = closed.rcvd.code if closed.rcvd else None

    def _take_in(self, message: dict[str, Any]) -> None:
        name = message["type"]
        self.counts[name] = self.counts.get(name, 0) + 1
        if name == "GuiUpdateMessage" and message["uuid"] in self.elements:
            self.elements[message["uuid"]].update(message["updates"])
            if "data" in message["updates"]:
                self.on_plot(message["uuid"])
        elif name == "GuiRemoveMessage":
            self.elements.pop(message["uuid"], None)
        elif name == "RegisterCommandMessage":
            self.commands[message["props"]["label"]] = message["uuid"]
        elif name == "GuiSetPanelWidthMessage":
            self.dock = self.dock or message["width"] or 0
        elif name == "NotificationShowMessage":
            self.notifications.append(f"{message['props']['title']}: {message['props']['body']}")
        elif name == "FileTransferStartDownload":
            self._transfers[message["transfer_uuid"]] = message, []
        elif name == "FileTransferPart":
            self._take_in_part(message)
        elif name.startswith("Gui") and "props" in message:
            self.elements[message["uuid"]] = message["props"] | {"value": message.get("value"), "message": name}
        elif "props" in message and "name" in message:
            place = {"position": (0.0, 0.0, 0.0), "visible": True, "owner": message["owner"], "type": name}
            self.nodes[message["name"]] = message["props"] | place
        elif message.get("name") in self.nodes:
            self._take_in_node(self.nodes[message["name"]], message)
        elif name.startswith("LocalStorage") or name == "RunJavascriptMessage":
            self._use_storage(message)

    def _take_in_part(self, message: dict[str, Any]) -> None:
        start, parts = self._transfers[message["transfer_uuid"]]
        parts.append(message["content"])
        if len(parts) == start["part_count"]:
            self.downloads.append((start["filename"], b"".join(parts)))

    def _take_in_node(self, node: dict[str, Any], message: dict[str, Any]) -> None:
        if message["type"] == "RemoveSceneNodeMessage":
            del self.nodes[message["name"]]
        elif message["type"] == "SceneNodeUpdateMessage":
            node.update(message["updates"])
        else:
            node.update({key: message[key] for key in ("position", "wxyz", "visible", "bindings") if key in message})

    def _use_storage(self, message: dict[str, Any]) -> None:
        """Use the storages as the page does."""
        storage, name = self.storage, message["type"].removeprefix("LocalStorage").removesuffix("Message")
        if name == "GetItemRequest" and not storage.silent:
            value, error = (None, "denied") if storage.refused else (storage.shared.get(message["key"]), None)
            answer = {"value": value, "error": error, "request_uuid": message["request_uuid"]}
            self.send({"type": "LocalStorageGetItemResponseMessage", **answer})
        if storage.refused or storage.forgetful:
            return
        if name == "SetItem":
            storage.shared[message["key"]] = message["value"]
        elif name == "RemoveItem":
            storage.shared.pop(message["key"], None)
        elif name == "RunJavascript":
            for key, value in REMEMBERED.findall(message["source"]):
                storage.tab[key] = value
            for key, source in COPIED.findall(message["source"]):
                storage.shared[key] = storage.tab.get(source, "")


def _narrow_socket(port: int) -> socket.socket:
    """A connected socket that takes a few kilobytes before they are read."""
    narrow = socket.socket()
    narrow.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    narrow.connect(("127.0.0.1", port))
    return narrow
