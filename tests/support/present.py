"""A value that the library may leave out, where a test relies on it."""

from typing import TypeVar

Value = TypeVar("Value")


def present(value: Value | None) -> Value:
    """The value; the test fails here if there is none."""
    assert value is not None
    return value
