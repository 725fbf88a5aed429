"""A control in the browser's page: its identity, by which a style reaches it, and its place. Checked against viser
1.1.1."""

from typing import Any, Literal

import viser

Step = tuple[Literal["tab", "folder"], str]
"""A tab or a folder to be opened, by its label."""


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
