"""Types of arrays, each built once. Checked against viser 1.1.1.

viser compares the type of each property that is set with `NDArray[float16]`, `NDArray[float32]`, …, and builds these
types anew for every comparison: 11 µs for a number, and 52 µs for the data of a plot, of which less than one and six
remain. Nothing else of a setter changes.
"""

from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy.typing
from viser import _assignable_props_api


class _ArrayTypes:
    """`NDArray[…]` as numpy has it, from a cache."""

    @cache  # noqa: B019 - one instance, which lives as long as the program
    def __getitem__(self, scalar: Any) -> Any:
        return numpy.typing.NDArray[scalar]


def build_once() -> None:
    """Let viser's setters use types that are built once."""
    _assignable_props_api.npt = SimpleNamespace(NDArray=_ArrayTypes())  # pyright: ignore[reportAttributeAccessIssue, reportPrivateImportUsage]
