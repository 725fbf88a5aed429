"""Certificates of presets, computed one after the other in a thread of their own and kept by the bytes they are of.

A preset on the shelf has a badge; where no certificate lies beside its file, or one of other bytes, it is computed here
(some tenths of a second each) while the page works on. No viser here.
"""

import queue
import threading
from collections import OrderedDict
from collections.abc import Callable

from rangenav import certificate
from rangenav.certificate import Certificate

REMEMBERED = 400
"""Certificates, of some kilobytes each; more than the shipped presets and a full library."""
CertificateOrReason = Certificate | str
"""A certificate, or the sentence why there is none."""


class Certifier:
    """One per program, shared by all visitors."""

    def __init__(self) -> None:
        self._found: OrderedDict[bytes, CertificateOrReason] = OrderedDict()
        self._asked: dict[bytes, list[Callable[[], None]]] = {}
        self._queue: queue.SimpleQueue[bytes] = queue.SimpleQueue()
        self._lock = threading.Lock()
        self._working = False

    def find(self, content: bytes, wake: Callable[[], None]) -> CertificateOrReason | None:
        """What is known of these bytes; None at first, and `note` is called from another thread when there is more."""
        with self._lock:
            if content in self._found:
                self._found.move_to_end(content)
                return self._found[content]
            waiting = self._asked.setdefault(content, [])
            waiting.append(wake)
            if len(waiting) == 1:
                self._queue.put(content)
            if not self._working:
                self._working = True
                threading.Thread(target=self._work, name="certifying", daemon=True).start()
            return None

    def _work(self) -> None:
        while True:
            with self._lock:
                if self._queue.empty():
                    self._working = False
                    return
            content = self._queue.get()
            found = _certified(content)
            with self._lock:
                self._found[content] = found
                while len(self._found) > REMEMBERED:
                    self._found.popitem(last=False)
                notes = self._asked.pop(content, [])
            for wake in notes:
                wake()


def _certified(content: bytes) -> CertificateOrReason:
    try:
        return certificate.certify(content, source="this preset")
    except ValueError as error:
        return str(error)
    except Exception as error:  # whatever it is, others wait for theirs
        return f"it could not be certified ({type(error).__name__})"
