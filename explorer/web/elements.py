"""A control in the browser's page: its identity, by which a style reaches it, and its place. Checked against viser
1.1.1.

viser names the element of a control by a random id. Within `of_kind` that id begins with a kind, so that one rule of
page.css reaches all controls of the kind. A rule of its own for each control would make a page of 60 numbers slow: at
every change the browser holds every element against every rule.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from importlib import import_module
from typing import Any, Literal

import viser

Kind = Literal["", "rn-slider-", "rn-box-number-", "rn-x-", "rn-box-y-", "rn-box-z-", "rn-free-"]
"""How page.css knows a slider with a box for its number, that box, the three boxes of a vector, and a box that is
open to a student whose page follows."""
_kind: ContextVar[Kind] = ContextVar("kind of the elements that are added", default="")
_gui_api: Any = import_module("viser._gui_api")
_random_id = _gui_api._make_uuid
_gui_api._make_uuid = lambda: _kind.get() + _random_id()
Step = tuple[Literal["tab", "folder"], str]
"""A tab or a folder to be opened, by its label."""


@contextmanager
def of_kind(kind: Kind) -> Iterator[None]:
    """The controls that are added in this context are of a kind."""
    token = _kind.set(kind)
    try:
        yield
    finally:
        _kind.reset(token)


def element_id(handle: viser.GuiInputHandle) -> str:
    """The id of the element of a slider, a number or a dropdown, and the `for` of the label of every control."""
    return handle._impl.uuid


def place_of(handle: Any) -> list[Step] | None:
    """The tabs and folders around a control, the outermost first; None if it or one of them is hidden or removed."""
    containers, steps = handle._impl.gui_api._container_handle_from_uuid, []
    if handle._impl.removed or not handle.visible:
        return None
    uuid = handle._impl.parent_container_id
    while uuid in containers and uuid != "root":
        container = containers[uuid]
        if isinstance(container, viser.GuiTabHandle):
            steps.append(("tab", container._label))
            container = container._parent
        elif container.visible:
            steps += [("folder", container.label)] if container.label else []
        else:
            return None
        uuid = container._impl.parent_container_id
    return steps[::-1]
