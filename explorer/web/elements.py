"""The identity of a control in the browser's page, by which a style reaches it. Checked against viser 1.1.1."""

import viser


def element_id(handle: viser.GuiInputHandle) -> str:
    """The id of the element of a slider, a number or a dropdown, and the `for` of the label of every control."""
    return handle._impl.uuid
