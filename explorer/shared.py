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

ESTIMATORS_DELAY = 3.0
"""s between the two compilations: the first pictures need no estimator, and must not wait for one."""
log = logging.getLogger(__name__)


class Compilation:
    """The compilation of the kernels in a thread of its own; sessions read its progress."""

    def __init__(self) -> None:
        self.fraction, self.stage = 0.0, "waiting"

    @property
    def done(self) -> bool:
        """Whether pictures can be computed now."""
        return self.fraction >= 1

    def start(self) -> None:
        """Start the thread, which does not delay the end of the program."""
        threading.Thread(target=self._run, name="compilation", daemon=True).start()

    def _run(self) -> None:
        from explorer.model import compute, details  # here, so that the page answers before these are imported

        try:
            compute.compile_kernels(self._progress)
        except Exception:
            log.exception("the kernels could not be compiled at the start; each will be compiled at its first use")
        self.fraction = 1.0
        details.import_control()
        time.sleep(ESTIMATORS_DELAY)
        try:
            compute.compile_estimators()
        except Exception:
            log.exception("the estimators of the Compare tab could not be compiled at the start")

    def _progress(self, fraction: float, stage: str) -> None:
        self.fraction, self.stage = min(fraction, 0.99), stage  # 1 only when the last kernel has been compiled


@dataclass(frozen=True, kw_only=True)
class Shared:
    """What all sessions share."""

    shipped: dict[str, Preset]
    first: str
    """The preset that a new visitor sees."""
    requested: bool
    """Whether that preset was requested on the command line."""
    lesson: str = ""
    """The number of the lesson that was requested on the command line; empty if none was."""
    compilation: Compilation
    work_files: WorkFiles
    slots: Slots
    library: Library = field(default_factory=Library)
    certifier: Certifier = field(default_factory=Certifier)
