"""Long work says how far it is, and stops when its result is no longer wanted.

    result = work(..., progress=progress, cancelled=cancelled)

Whoever starts the work passes both functions. The work calls them from the caller's thread, unless it says otherwise.
Work whose results are cached by its arguments takes no function:

    with stopping(cancelled): result = work(...)

Such work calls `stop_if_unwanted` between its steps. What was stopped is not cached.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

Progress = Callable[[float], None]
"""Receives the share of the work that is done, 0 to 1."""
Cancelled = Callable[[], bool]
"""Says whether the result is no longer wanted."""


class CancelledError(Exception):
    """The work was cancelled before it was finished."""


def unheard(share: float) -> None:
    """A `Progress` for callers who do not show it."""


def never() -> bool:
    """A `Cancelled` for work that is not stopped."""
    return False


_unwanted: ContextVar[Cancelled] = ContextVar("unwanted", default=never)
"""Of this thread's work."""


@contextmanager
def stopping(cancelled: Cancelled) -> Iterator[None]:
    """Work in this block, in this thread, raises CancelledError soon after `cancelled` says so."""
    token = _unwanted.set(cancelled)
    try:
        yield
    finally:
        _unwanted.reset(token)


def stop_if_unwanted() -> None:
    """Raise CancelledError if the result of the work around is no longer wanted."""
    if _unwanted.get()():
        raise CancelledError
