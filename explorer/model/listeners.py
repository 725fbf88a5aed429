"""Who is called when something has changed, from any thread."""

import threading
from collections.abc import Callable

Listener = Callable[[], None]
"""It may do nothing but set an event."""


class Listeners:
    """Listeners that come and go. Safe for threads."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._all: list[Listener] = []

    def add(self, listener: Listener) -> Listener:
        """Have a listener called after every change. Returns what ends that."""
        with self._lock:
            self._all.append(listener)

        def end() -> None:
            with self._lock:
                self._all.remove(listener)

        return end

    def call(self) -> None:
        """Something has changed."""
        with self._lock:
            listeners = self._all[:]
        for listener in listeners:
            listener()
