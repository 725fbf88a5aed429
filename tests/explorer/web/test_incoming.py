"""What viser's page sends is handed on; a frame of any other form has a reason that repeats nothing of it."""

import math
from typing import Any

import msgspec
import pytest
from viser import _messages

from explorer.web import incoming
from tests.support.wire import CAMERA

DRAG = {
    "type": "SceneNodeDragMessage",
    "phase": "end",
    "name": "/waypoint",
    "instance_index": None,
    "start_position": (0, 0, 0),
    "start_screen_pos": (0.5, 0.5),
    "end_position": (math.nan, math.inf, 1e300),
    "end_screen_pos": (0.5, 0.5),
    "button": "left",
    "modifier": None,
    "owner": "",
}
VALUE = {"type": "GuiUpdateMessage", "uuid": "a", "updates": {"value": math.nan}}
STORED = {"type": "LocalStorageGetItemResponseMessage", "value": None, "error": None, "request_uuid": "r"}
SECRET = "somebody's text"


@pytest.mark.parametrize("message", [CAMERA, DRAG, VALUE, STORED, CAMERA | {"position": (1, 2, 3)}])
def test_what_the_page_sends_has_no_fault(message: dict[str, Any]) -> None:
    frame = msgspec.msgpack.encode(message)
    assert incoming.fault(frame) is None
    _messages.Message.deserialize(frame)  # viser reads it, too


@pytest.mark.parametrize(
    ("sent", "reason"),
    [
        (SECRET, "text in place of bytes"),
        (b"", "no msgpack"),
        (b"\xc1" + SECRET.encode(), "no msgpack"),
        (b"\x91" * 200_000, "an unknown message"),
        ([SECRET], "an unknown message"),
        ({"no": SECRET}, "an unknown message"),
        ({"type": SECRET}, "an unknown message"),
        ({"type": 7}, "an unknown message"),
        ({"type": "SceneNodeMessage", "name": SECRET}, "an unknown message"),
        ({"type": "CommandTriggerMessage"}, "CommandTriggerMessage without its fields, or with others"),
        (CAMERA | {"excluded_self_client": 1}, "ViewerCameraMessage without its fields, or with others"),
        (CAMERA | {"fov": SECRET}, "ViewerCameraMessage without its fields, or with others"),
        (CAMERA | {"position": (1.0, 2.0)}, "ViewerCameraMessage without its fields, or with others"),
        (VALUE | {"updates": SECRET}, "GuiUpdateMessage without its fields, or with others"),
        (CAMERA | {"look_at": (0.0, 0.0, math.nan)}, "ViewerCameraMessage with a number that is none, or far too"),
        (CAMERA | {"wxyz": (0.0, 0.0, 0.0, 0.0)}, "ViewerCameraMessage with a rotation or an angle of view that is"),
        (CAMERA | {"fov": 0.0}, "ViewerCameraMessage with a rotation or an angle of view that is none"),
        (CAMERA | {"image_width": 2**60}, "ViewerCameraMessage with a number that is none, or far too large"),
    ],
)
def test_another_frame_has_a_reason_that_repeats_nothing_of_it(sent: Any, reason: str) -> None:
    frame = sent if isinstance(sent, str | bytes) else msgspec.msgpack.encode(sent)
    said = incoming.fault(frame)
    assert said is not None
    assert said.startswith(reason)
    assert SECRET not in said
