"""Types of arrays and of properties, each built once. Checked against viser 1.1.1.

viser compares the type of each property that is set with `NDArray[float16]`, `NDArray[float32]`, …, and builds these
types anew for every comparison: 11 µs for a number, and 52 µs for the data of a plot, of which less than one and six
remain. For every control and every node of the scene it evaluates the annotations of all properties anew: a third of
the time in which a page is built. Nothing else of a setter changes.
"""

from functools import cache, cached_property
from types import SimpleNamespace
from typing import Any, get_type_hints

import numpy.typing
from viser import _assignable_props_api


class _ArrayTypes:
    """`NDArray[…]` as numpy has it, from a cache."""

    @cache  # noqa: B019 - one instance, which lives as long as the program
    def __getitem__(self, scalar: Any) -> Any:
        return numpy.typing.NDArray[scalar]


@cache
def _types_of_properties(properties: type) -> dict[str, Any]:
    return get_type_hints(properties)


def build_once() -> None:
    """Let viser's setters use types that are built once."""
    _assignable_props_api.npt = SimpleNamespace(NDArray=_ArrayTypes())  # pyright: ignore[reportAttributeAccessIssue, reportPrivateImportUsage]
    handle: Any = _assignable_props_api.AssignablePropsBase
    handle._prop_hints = cached_property(lambda self: _types_of_properties(type(self._impl.props)))
    handle._prop_hints.__set_name__(handle, "_prop_hints")
