"""Whether something must be drawn anew: the inputs from which it was drawn are compared with those of another picture.

The stages of a picture are cached, so a stage that has not changed is the same object. Values of the settings are read
anew each time, and are compared by their contents.
"""

import msgspec

COMPARED = (msgspec.Struct, int, float, str, frozenset)
"""Values; everything else is compared by identity, since the contents of an array cost as much as its drawing."""


class Drawn:
    """The inputs from which something was drawn last."""

    def __init__(self) -> None:
        self._inputs: tuple[object, ...] | None = None

    def changed(self, *inputs: object) -> bool:
        """Whether an input differs from that of the last call; true at the first call, and after `forget`."""
        before, self._inputs = self._inputs, inputs
        return before is None or len(before) != len(inputs) or not all(map(_same, before, inputs))

    def forget(self) -> None:
        """Let the next call of `changed` return true."""
        self._inputs = None


def _same(a: object, b: object) -> bool:
    return a is b or (isinstance(a, COMPARED) and a == b)
