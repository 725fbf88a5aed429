"""Long work says how far it is, and stops when its result is no longer wanted.

    result = work(..., progress=progress, cancelled=cancelled)

Whoever starts the work passes both functions. The work calls them from the caller's thread, unless it says otherwise.
"""

from collections.abc import Callable

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
