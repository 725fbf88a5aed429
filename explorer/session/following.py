"""A student's page in a class: it follows what the teacher shows, or works on a copy, or on the student's own work.

own work ──teacher presents──▶ following ◀──follow──▶ copy: what was shown, to work on
    ▲                              │                  │
    └────────── back ──────────────┴──────────────────┘      the own work, as it was
"""

import time
from collections.abc import Callable

import msgspec

from explorer.lessons import course
from explorer.lessons.screens import screens
from explorer.model.classroom import Classroom, Member, Shown
from explorer.model.history import History
from explorer.model.learning import PREDICTION
from explorer.model.playback import Playback
from explorer.model.settings import Settings
from explorer.panels import saved_page
from explorer.panels.classroom.student import StudentPanel
from explorer.panels.dock import Dock
from explorer.scene import Scene
from explorer.storage.catalog import Catalog
from explorer.widgets.complaint import InvalidInputError
from explorer.widgets.form import Action
from explorer.widgets.page import Page

SENT, LESSON = "Your teacher sent this to all", "Your teacher opened a lesson for all"
UNDO = "Ctrl+Z brings back what was here before."


class Follower:
    """What one student's page does in the class."""

    def __init__(
        self,
        number: int,
        classroom: Classroom,
        dock: Dock,
        scene: Scene,
        playback: Playback,
        history: History,
        catalog: Catalog,
        panel: StudentPanel,
        *,
        notify: Callable[[str, str], None],
        go_to: Callable[[str], None],
        open_tab: Callable[[str], None],
    ) -> None:
        """number: the visitor's. go_to brings the control with a label into sight, open_tab a tab to the front."""
        self._number, self._classroom, self._dock, self._scene = number, classroom, dock, scene
        self._playback, self._history, self._catalog, self._panel = playback, history, catalog, panel
        self._notify, self._go_to, self._open_tab = notify, go_to, open_tab
        self._wants = True
        self._own: Settings | None = None
        """The student's own work while the page follows; None while it does not."""
        self._kept: Settings | None = None
        """The student's own work while a copy is on the page, or was before the page followed again."""
        self._own_time = 0.0
        self._held: Settings | None = None
        """What the teacher shows, as this page calls it."""
        self._seen: Shown | None = None
        self._named: dict[str, str] = {}
        """The names that the teacher's own presets have here: each is offered once, and not again at each change."""

    @property
    def following(self) -> bool:
        """Whether the page shows what the teacher shows."""
        return self._own is not None

    @property
    def actions(self) -> dict[str, Action]:
        """What the buttons of the bar do, by the names that they send."""
        return {"class-follow": self._follow, "class-copy": self._copy, "class-back": self._back}

    def apply(self) -> None:
        """Do what the teacher asks for, before the controls are read."""
        state = self._classroom.state
        request = self._classroom.take_request(self._number)
        if request is not None:
            self._end(back=True)
            if request.settings is not None:
                if self._dock.learn.lesson is not None:
                    self._dock.learn.close()
                self._dock.write(self._as_here(request.settings))
                self._notify(SENT, UNDO)
            if request.lesson is not None:
                opened = self._dock.learn.lesson
                # a student who is on its third screen already stays there
                if opened is None or opened.number != request.lesson:
                    self._dock.learn.open_number(request.lesson)
                self._open_tab("Learn")
                self._notify(LESSON, "Leaving it gives back what was here before.")
        if state.shown is None:
            self._wants, self._kept = True, None
            self._end(back=True)
        elif self._wants or state.frozen:
            self._show(state.shown)
        self._dock.learn.hold_answer(state.answers_wait)
        self._panel.draw(
            presented=state.shown is not None,
            following=self.following,
            frozen=state.frozen,
            copied=self._kept is not None,
        )

    def hold(self, page: Page) -> None:
        """Put back what the teacher shows, if the student has moved a control meanwhile."""
        if self._held is not None and self.following and page.read() != self._held:
            page.write(self._held)

    def look(self) -> None:
        """Look at the scene as the teacher does; after the picture was drawn."""
        if self.following and self._seen is not None and self._seen.camera is not None:
            self._scene.look_from(self._seen.camera)

    def report(self) -> None:
        """Say to the class where this page is."""
        learn, opened = self._dock.learn, self._dock.learn.lesson
        learning, titles = learn.learning, {lesson.name: lesson.header.title for lesson in course().lessons}
        self._classroom.report(
            self._number,
            Member(
                name=self._panel.name,
                following=self.following,
                copies=self._kept is not None and not self.following,
                lesson=titles.get(learning.lesson, ""),
                screen=learning.screen,
                screens=0 if opened is None else len(screens(opened)),
                predictions={
                    titles[one.lesson]: one.answer
                    for one in learning.answers
                    if one.question == PREDICTION and one.lesson in titles
                },
                passed=frozenset(titles[name] for name in learning.passed if name in titles),
            ),
        )

    def _show(self, shown: Shown) -> None:
        if self._own is None:
            self._own, self._own_time = self._chosen(), self._playback.time
            self._seen = self._held = None
        before, self._seen = self._seen, shown
        if shown is before:
            return
        if before is None or shown.settings != before.settings:
            self._held = self._as_here(shown.settings)
            self._dock.write(self._held)
        self._playback.fit(shown.settings.preset.duration)
        self._playback.restore(shown.time, shown.speed, loop=shown.loop)
        if shown.playing:
            self._playback.toggle(shown.at)
        if shown.control and (before is None or shown.control != before.control):
            self._go_to(shown.control)

    def _follow(self) -> None:
        self._wants = True

    def _back(self) -> None:
        if self._classroom.state.frozen:
            return
        kept, self._kept = self._kept, None
        self._stop_following(back=True)
        if kept is not None:
            self._dock.write(kept)

    def _copy(self) -> None:
        if not self._classroom.state.frozen:
            self._kept = self._kept or self._own
            self._stop_following(back=False)

    def _stop_following(self, *, back: bool) -> None:
        self._wants = False
        self._end(back=back)

    def _end(self, *, back: bool) -> None:
        """Stop following. Show the student's own work again, or keep what was shown as a step after it."""
        own, held, self._own, self._held = self._own, self._held, None, None
        if own is None:
            return
        if back:
            self._dock.write(own)
            self._playback.seek(self._own_time)
        elif held is not None:
            self._history.record(held, time.monotonic(), separate=True)

    def _as_here(self, settings: Settings) -> Settings:
        """The same settings; a preset of the teacher's own is offered here, too."""
        named = self._named.get(settings.origin)
        if named is not None:
            return msgspec.structs.replace(settings, origin=named, edition="")
        (same,) = saved_page.with_presets([settings], self._catalog)
        if same.origin != settings.origin:
            self._named[settings.origin] = same.origin
        return same

    def _chosen(self) -> Settings | None:
        """The student's own work; the last valid one, if a control holds no valid input now."""
        try:
            return self._dock.read()
        except (InvalidInputError, ValueError):
            return self._history.now
