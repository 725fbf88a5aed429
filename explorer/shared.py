"""What the sessions of one server share: presets, saved work, the library, and the compilation of the kernels."""

import logging
import threading
import time
from dataclasses import dataclass, field

from explorer.storage.certifier import Certifier
from explorer.storage.library import Library
from explorer.storage.work_files import WorkFiles
from explorer.web.identity import Slots
from rangenav.preset import Preset

AFTERTHOUGHT = 3.0
"""s: the first pictures are drawn before the processor is given to what nobody has asked for yet."""
log = logging.getLogger(__name__)


class Compilation:
    """How far the compilation has come; sessions look at it until it is done."""

    def __init__(self) -> None:
        self.fraction, self.what = 0.0, "waiting"

    @property
    def done(self) -> bool:
        """Whether pictures can be computed now."""
        return self.fraction >= 1

    def start(self) -> None:
        """Begin, in a thread that does not keep the program alive."""
        threading.Thread(target=self._run, name="warming", daemon=True).start()

    def _run(self) -> None:
        from explorer.model import compute  # here, so that the page answers before numpy's heavier friends are loaded

        try:
            compute.compile_kernels(self._progress)
        except Exception:
            log.exception("the kernels could not be compiled ahead; they will be when first used")
        self.fraction = 1.0
        from explorer.model import details

        details.import_control()  # a second that no picture need wait for: only the frozen-time test does
        time.sleep(AFTERTHOUGHT)
        try:
            compute.compile_estimators()
        except Exception:
            log.exception("the estimators beside the cascade could not be compiled ahead")

    def _progress(self, fraction: float, what: str) -> None:
        self.fraction, self.what = min(fraction, 0.99), what  # done only when the last kernel has returned


@dataclass(frozen=True, kw_only=True)
class Shared:
    """What all sessions share."""

    shipped: dict[str, Preset]
    first: str
    """The preset that a new visitor sees."""
    requested: bool
    """Whether it was asked for on the command line."""
    compilation: Compilation
    work_files: WorkFiles
    slots: Slots
    library: Library = field(default_factory=Library)
    certifier: Certifier = field(default_factory=Certifier)
