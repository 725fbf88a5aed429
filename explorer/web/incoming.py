"""What a browser may send: the messages of viser's page, each with its own fields, and numbers that are numbers.

viser decodes a frame without looking at it: text, broken msgpack, an unknown message or a missing field ends in a
traceback, and a NaN is stored. Here every frame is held against a schema that is made of viser's own message types.
Values of controls may be anything: `values` and the panels look at them. Checked against viser 1.1.1.
"""

import math
from typing import Any, Union, get_type_hints

import msgspec
from viser import _messages
from viser.infra._messages import wire_field_names

LARGEST = 1e12
"""No number that a browser sends of the scene, the camera or a file is larger."""
UNIT, LEAST = (1.0, 0.0, 0.0, 0.0), 1e-3
"""The quaternion of no rotation, and the least length of one, and of the upward direction; the page sends 1."""
ANY_NUMBER = ("GuiUpdateMessage", "SceneNodeDragMessage")
"""Messages whose receivers look at their numbers: a drag may end far beyond the horizon, and is then released."""
EXPECTED: tuple[type[_messages.Message], ...] = (
    _messages.GuiUpdateMessage,
    _messages.GuiButtonHoldMessage,
    _messages.GuiFormDirtyMessage,
    _messages.GuiFormSubmitMessage,
    _messages.CommandTriggerMessage,
    _messages.FileTransferStartUpload,
    _messages.FileTransferPart,
    _messages.LocalStorageGetItemResponseMessage,
    _messages.GetRenderResponseMessage,
    _messages.ViewerCameraMessage,
    _messages.ScenePointerMessage,
    _messages.SceneNodeClickMessage,
    _messages.SceneNodeDragMessage,
    _messages.TransformControlsDragStartMessage,
    _messages.TransformControlsUpdateMessage,
    _messages.TransformControlsDragEndMessage,
    _messages.ShareUrlRequest,
    _messages.ShareUrlDisconnect,
)
"""What viser's page sends; some of it has no handler here, and is then ignored."""


def _schema(message: type[_messages.Message]) -> type[msgspec.Struct]:
    """A message with its fields as viser declares them. A field with a default may be left out."""
    hints = get_type_hints(message)
    fields: list[Any] = [
        (name, hints[name], getattr(message, name)) if hasattr(message, name) else (name, hints[name])
        for name in wire_field_names(message)
    ]
    name = message.__name__
    return msgspec.defstruct(name, fields, tag=name, tag_field="type", forbid_unknown_fields=True)


SCHEMAS = tuple(_schema(message) for message in EXPECTED)
DECODER = msgspec.msgpack.Decoder(Union[SCHEMAS])  # noqa: UP007 - a union that is made while the program runs


class _Named(msgspec.Struct):
    """A message of which only the name counts."""

    type: str = ""


def fault(frame: object) -> str | None:
    """What is wrong with a frame from a browser, without anything of its content; None for a frame that may be
    handled."""
    if not isinstance(frame, bytes):
        return "text in place of bytes"
    try:
        message = DECODER.decode(frame)
    except msgspec.ValidationError:
        name = _name(frame)
        return f"{name} without its fields, or with others" if name else "an unknown message"
    except (msgspec.DecodeError, RecursionError, ValueError):
        return "no msgpack"
    name = type(message).__name__
    if name in ANY_NUMBER:
        return None
    if not all(_usable(getattr(message, field)) for field in message.__struct_fields__):
        return f"{name} with a number that is none, or far too large"
    has_length = all(math.hypot(*getattr(message, field, UNIT)) > LEAST for field in ("wxyz", "up_direction"))
    if not (has_length and 0.0 < getattr(message, "fov", 1.0) < math.pi):
        return f"{name} with a rotation or an angle of view that is none"
    return None


def _name(frame: bytes) -> str:
    """The name of a message that viser's page sends; empty for another one, of which nothing is repeated."""
    try:
        name = msgspec.msgpack.decode(frame, type=_Named).type
    except (msgspec.DecodeError, RecursionError, ValueError):
        return ""
    return name if name in {message.__name__ for message in EXPECTED} else ""


def _usable(value: object) -> bool:
    """Whether all numbers in a field are finite, and not larger than any that the page sends."""
    if isinstance(value, tuple):
        return all(_usable(entry) for entry in value)
    return not isinstance(value, int | float) or (math.isfinite(value) and abs(value) <= LARGEST)
