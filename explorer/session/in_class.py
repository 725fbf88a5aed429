"""A session's part in a class: the teacher's page presents, a student's follows; at this machine's own page there is
none."""

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Protocol

import viser

from explorer.lessons import course
from explorer.model.classroom import RETURN
from explorer.model.history import History
from explorer.model.playback import Playback
from explorer.model.settings import Settings
from explorer.panels.classroom import ClassActions, ClassPanel, OverScene
from explorer.panels.classroom.student import StudentPanel
from explorer.panels.dock import Dock
from explorer.panels.session_actions import SessionActions
from explorer.scene import Scene
from explorer.session.following import Follower
from explorer.session.presenting import Presenter
from explorer.shared import Shared
from explorer.storage.catalog import Catalog
from explorer.web import keys
from explorer.web.access.names import name_of
from explorer.web.access.visitors import Role, Visitor
from explorer.widgets.form import Action
from explorer.widgets.page import Page


@dataclass(frozen=True, kw_only=True)
class Visit:
    """The parts of one visitor's page that a class touches."""

    client: viser.ClientHandle
    visitor: Visitor | None
    """None at this machine's own page."""
    dock: Dock
    scene: Scene
    playback: Playback
    history: History
    catalog: Catalog
    actions: SessionActions
    wake: Callable[[], None]
    """Called from any thread when the class has changed."""


class Part(Protocol):
    """What the session's loop has done in the class."""

    @property
    def following(self) -> bool:
        """Whether the page shows somebody else's work, which is not remembered as the visitor's own."""
        ...

    @property
    def first_tab(self) -> str:
        """The tab that is in front at first, by its label; empty for the first one."""
        ...

    @property
    def actions(self) -> dict[str, Action]:
        """What the page's own buttons do, by the names that they send."""
        ...

    def before(self) -> None:
        """Before the controls are read."""
        ...

    def hold(self, page: Page) -> None:
        """After they were read, and before anything is drawn."""
        ...

    def after(self, settings: Settings | None) -> None:
        """After the picture of these settings was drawn, if anything was."""
        ...

    def tick(self, settings: Settings | None) -> None:
        """In each round of the loop, also in those that draw a frame alone."""
        ...

    def end(self) -> None:
        """The visitor has left."""
        ...


class Alone:
    """No class."""

    following, first_tab = False, ""

    @property
    def actions(self) -> dict[str, Action]:
        return {}

    def before(self) -> None: ...
    def hold(self, page: Page) -> None: ...
    def after(self, settings: Settings | None) -> None: ...
    def tick(self, settings: Settings | None) -> None: ...
    def end(self) -> None: ...


class TeachersPart:
    """The Class tab, and the presentation."""

    following, first_tab = False, "Class"

    def __init__(self, visit: Visit, shared: Shared) -> None:
        assert shared.entrance is not None, "a class has an entrance"
        dock, actions = visit.dock, visit.actions
        self._classroom, self._came = shared.classroom, time.monotonic()
        self._presenter = Presenter(visit.client, dock, visit.playback, shared.classroom)
        lessons = {lesson.number: lesson.header.title for lesson in course().lessons}
        bar, card, predictions = (visit.client.gui.add_html("") for _ in range(3))
        over_scene = OverScene(bar=bar, card=card, predictions=predictions)
        with dock.tabs.add_tab("Class"):
            self._panel = ClassPanel(
                dock.form,
                dock,
                shared.entrance,
                shared.classroom,
                ClassActions(
                    present=self._presenter.present,
                    notify=actions.notify,
                    send=actions.send,
                    forget=shared.forget_students,
                ),
                over_scene,
                address=shared.address,
                lessons=lessons,
            )
        self.actions: dict[str, Action] = self._panel.actions
        self._panel.refresh()
        visit.client.camera.on_update(lambda _: visit.wake() if self._presenter.presenting else None)
        self._end = (shared.entrance.on_change(visit.wake), shared.classroom.listen(visit.wake))

    def before(self) -> None: ...
    def hold(self, page: Page) -> None: ...

    def after(self, settings: Settings | None) -> None:
        left = self._classroom.state.left
        if left is not None and settings is not None and self._came > left - RETURN:  # the page was loaded again
            self._presenter.go_on(settings)
        self._presenter.follow(settings)
        self._panel.refresh()

    def tick(self, settings: Settings | None) -> None:
        self._presenter.follow(settings)

    def end(self) -> None:
        if self._presenter.presenting:  # another tab of the teacher's may present
            self._classroom.leave(time.monotonic())
            ending = threading.Timer(RETURN, lambda: self._classroom.end_if_left(time.monotonic()))
            ending.daemon = True
            ending.start()
        for end in self._end:
            end()


class StudentsPart:
    """The bar over the scene, the name, and the following."""

    first_tab = ""

    def __init__(self, visit: Visit, shared: Shared, number: int) -> None:
        dock, actions = visit.dock, visit.actions
        bar = visit.client.gui.add_html("")
        with dock.tabs.add_tab("Class"):
            panel = StudentPanel(dock.form, visit.client, bar, name_of(number))
        dock.learn.keep_answers()
        self._follower = Follower(
            number,
            shared.classroom,
            dock,
            visit.scene,
            visit.playback,
            visit.history,
            visit.catalog,
            panel,
            notify=actions.notify,
            go_to=actions.go_to,
            open_tab=partial(keys.go_to_tab, visit.client),
        )
        self._entrance, self._classroom, self._number = shared.entrance, shared.classroom, number
        self._end = shared.classroom.listen(visit.wake)

    @property
    def following(self) -> bool:
        return self._follower.following

    @property
    def actions(self) -> dict[str, Action]:
        return self._follower.actions

    def before(self) -> None:
        self._follower.apply()

    def hold(self, page: Page) -> None:
        self._follower.hold(page)

    def after(self, settings: Settings | None) -> None:
        self._follower.look()
        if self._inside:  # a class that is over is forgotten
            self._follower.report()
            if not self._inside:  # it ended meanwhile
                self._classroom.forget(self._number)

    @property
    def _inside(self) -> bool:
        return self._entrance is not None and self._entrance.has(self._number)

    def tick(self, settings: Settings | None) -> None: ...

    def end(self) -> None:
        self._end()


def part_in_class(visit: Visit, shared: Shared) -> Part:
    """The part of a visitor; it adds a tab to the dock."""
    visitor = visit.visitor
    if visitor is None or shared.entrance is None:
        return Alone()
    if visitor.role is Role.TEACHER:
        return TeachersPart(visit, shared)
    return StudentsPart(visit, shared, visitor.number)
