"""Certificates of presets are computed one after the other in a thread, and cached by the bytes of the preset's file.

Every preset in the catalog has a badge. If no stored certificate belongs to its bytes, the certificate is computed
here, in some tenths of a second, while the page works on.
"""

import queue
import threading
from collections import OrderedDict
from collections.abc import Callable

from rangenav import certificate
from rangenav.certificate import Certificate

MAX_CACHED = 400
"""Certificates, of some kilobytes each; more than the shipped presets and a full library."""
CertificateOrReason = Certificate | str
"""A certificate, or the sentence why there is none."""


class Certifier:
    """One per program, shared by all visitors."""

    def __init__(self) -> None:
        self._results: OrderedDict[bytes, CertificateOrReason] = OrderedDict()
        self._waiting: dict[bytes, list[Callable[[], None]]] = {}
        self._queue: queue.SimpleQueue[bytes] = queue.SimpleQueue()
        self._lock = threading.Lock()
        self._working = False

    def certificate(self, content: bytes, wake: Callable[[], None]) -> CertificateOrReason | None:
        """The certificate of these bytes, or None while it is being computed; `wake` is then called from another thread
        when it is ready."""
        with self._lock:
            if content in self._results:
                self._results.move_to_end(content)
                return self._results[content]
            waiting = self._waiting.setdefault(content, [])
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
            result = _certify(content)
            with self._lock:
                self._results[content] = result
                while len(self._results) > MAX_CACHED:
                    self._results.popitem(last=False)
                callbacks = self._waiting.pop(content, [])
            for wake in callbacks:
                wake()


def _certify(content: bytes) -> CertificateOrReason:
    try:
        return certificate.certify(content, source="this preset")
    except ValueError as error:
        return str(error)
    except Exception as error:  # others are waiting for their certificates
        return f"it could not be certified ({type(error).__name__})"
