"""What the sessions of one server share: presets, saved work, the library, and the compilation of the kernels."""

import logging
import shutil
import threading
import time
from dataclasses import dataclass, field
from pathlib import Path

from explorer.model.classroom import Classroom
from explorer.model.turns import Places, Share
from explorer.storage.certifier import Certifier
from explorer.storage.library import Library
from explorer.storage.work_files import WorkFiles
from explorer.web.access.entrance import Entrance
from explorer.web.access.visitors import Role, Visitor
from explorer.web.clock import Clock
from explorer.web.identity import Slots
from explorer.web.metrics import Metrics
from rangenav.kernels import cache
from rangenav.preset import Preset

ESTIMATORS_DELAY = 3.0
"""s between the two compilations: the first pictures need no estimator, and must not wait for one."""
STUDENTS_ROOM, CLASS_ROOM = 10e6, 400e6
"""Bytes of the presets that one student may have saved, and that all students together may have saved or deleted."""
MAX_BROWSERS = 3
"""Browsers whose work is saved for one visitor of a class: one that forgets what it stored comes as another."""
log = logging.getLogger(__name__)


class Compilation:
    """The compilation of the kernels in a thread of its own; sessions read its progress."""

    def __init__(self, visited: threading.Event | None = None) -> None:
        """visited: set when somebody asks for the page; compiled kernels are loaded then, and take 150 MB."""
        self.fraction, self.stage = 0.0, "waiting"
        self.visited = visited or threading.Event()

    @property
    def done(self) -> bool:
        """Whether pictures can be computed now."""
        return self.fraction >= 1

    def start(self) -> None:
        """Start the thread, which does not delay the end of the program."""
        threading.Thread(target=self._run, name="compilation", daemon=True).start()

    def _run(self) -> None:
        if cache.complete():
            self.visited.wait()  # the browser takes longer to load the page than this the kernels
        from explorer.model import compute, details  # here, so that the page answers before these are imported

        try:
            compute.compile_kernels(self._progress)
            cache.note_complete()
        except Exception:
            log.exception("the kernels could not be compiled at the start; each will be compiled at its first use")
        self.fraction = 1.0
        self.visited.wait()
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
    entrance: Entrance | None = None
    """Who may come in; None where nobody but the people at this machine can reach the page."""
    classroom: Classroom = field(default_factory=Classroom)
    """What the teacher shows, and where the students are."""
    metrics: Metrics = field(default_factory=Metrics)
    clock: Clock = field(default_factory=Clock)
    """What draws the frames of the pages that play."""
    address: str = ""
    """The page's address as visitors type it, with a slash at its end."""
    compilation: Compilation
    places: Places = field(default_factory=Places)
    """The places for the long work of all visitors."""
    work_files: WorkFiles
    slots: Slots
    library: Library = field(default_factory=Library)
    class_folder: Path | None = None
    """Where each student's own presets lie until the class ends."""
    certifier: Certifier = field(default_factory=Certifier)
    _shares: dict[int, Share] = field(default_factory=dict)
    _browsers: dict[int, set[str]] = field(default_factory=dict)

    def share_of(self, visitor: Visitor | None) -> Share:
        """A visitor's share of the places for long work: one for all tabs of a visitor of a class, else one a tab."""
        if visitor is None:
            return self.places.share()
        return self._shares.setdefault(visitor.number, self.places.share())

    def keeps_work_of(self, visitor: Visitor | None, browser: str) -> bool:
        """Whether the work of a browser is saved. A visitor of a class has a few at most: a browser that comes as a new
        one at each reload would push out the work of others."""
        if visitor is None:
            return True
        browsers = self._browsers.setdefault(visitor.number, set())
        if len(browsers) < MAX_BROWSERS:
            browsers.add(browser)
        return browser in browsers

    def library_of(self, visitor: Visitor | None) -> Library:
        """The presets that a visitor has saved: students have their own, and do not see the teacher's."""
        if visitor is None or visitor.role is Role.TEACHER or self.class_folder is None:
            return self.library
        folder = self.class_folder / str(visitor.number)
        return Library(folder, rooms=((folder, STUDENTS_ROOM), (self.class_folder, CLASS_ROOM)))

    def forget_students(self) -> None:
        """Delete the presets that students have saved: the class is over."""
        for folder in () if self.class_folder is None else tuple(self.class_folder.iterdir()):
            shutil.rmtree(folder, ignore_errors=True)
