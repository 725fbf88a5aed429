"""One visitor: a browser tab with its own controls, its own loop and its own clock. The latest change counts.

viser's thread  a control was moved: wake.set()                nothing else, ever
session's loop  wake.wait(); wake.clear()                      clear BEFORE reading, so that no change is lost
                dock.refresh(); settings = dock.read()
                picture = compute(settings)                    stages cached by their own inputs
                with client.atomic(): draw(picture)            plots and verdict in one batch, then the scene
playback        the clock of all sessions moves the scene and the cursors while the loop rests; it computes nothing
"""

import contextlib
import logging
import threading
import time
from collections.abc import Iterator

import viser

from explorer.charts import Charts
from explorer.model import compute
from explorer.model.compute import Picture
from explorer.panels.dock import Dock
from explorer.session.own_work import OwnWork
from explorer.session.page import VisitorPage
from explorer.shared import Shared
from explorer.web import connection
from explorer.web.access.visitors import Visitor
from explorer.web.frames import Flight
from explorer.web.values import accept_values_only
from explorer.widgets.complaint import InvalidInputError

PROGRESS_PERIOD = 0.1
"""s between two updates of the progress of the compilation."""

log = logging.getLogger(__name__)


class Session:
    """The page of one browser tab, from its connection to its end, with a thread of its own."""

    def __init__(self, client: viser.ClientHandle, shared: Shared, visitor: Visitor | None = None) -> None:
        """visitor: who has come in; None at this machine's own page."""
        self._client, self.shared = client, shared
        self._wake, self._stopped = threading.Event(), False
        self._turn = threading.Lock()
        """Held by whoever draws: the session's loop, or the shared clock for a frame."""
        self._page = page = VisitorPage(client, shared, visitor, self._wake.set)
        self.catalog, self.form, self.jobs, self.history = page.catalog, page.form, page.jobs, page.history
        self._outgoing, self._playback = page.outgoing, page.playback
        self._work = OwnWork(client, page, shared, visitor)
        self.thread = threading.Thread(target=self._run, name=f"session {client.client_id}", daemon=True)

    @property
    def dock(self) -> Dock:
        """All controls of the page; there once the page is built."""
        return self._page.dock

    @property
    def charts(self) -> Charts:
        """All plots of the page; there once the page is built."""
        return self._page.charts

    @property
    def picture(self) -> Picture | None:
        """The picture on the page; None before the first one."""
        return self._page.display.picture if self._page.built else None

    @property
    def works(self) -> bool:
        """Whether a search or an export runs for this visitor."""
        return self.form.works

    def start(self) -> None:
        """Build the page and serve it from this session's own thread."""
        accept_values_only(self._client)
        self.thread.start()

    def stop(self) -> None:
        """Let the thread end; it saves the work and frees the slot of the tab."""
        self._stopped = True
        self._wake.set()

    def _run(self) -> None:
        with connection.may_close(self._client.gui):
            with self._reporting():
                if not self._stopped:  # else the page was loaded again already, as when a key is held down
                    self._page.build(disconnected=lambda: self._stopped)
                    if self._page.built:
                        self._work.restore()
                    self._wait_for_compilation()
            self._wake.set()
            if self._page.built:
                self._serve()
            self._leave()

    def _serve(self) -> None:
        while True:
            woken = self._wake.wait(self._sleep(time.monotonic()))
            if self._stopped:
                return
            with self._turn, self._reporting():
                now = time.monotonic()
                self._playback.advance(now)
                if woken:
                    self._wake.clear()
                    self._react()
                self.dock.learn.play_if_due(now)
                self._page.in_class.tick(None if self.picture is None else self.picture.settings)
                if woken or not self._playback.playing:
                    self._page.display.animate(now)
                self._page.display.draw_details_if_due(time.monotonic(), self._wake)
                self._work.write_if_due(time.monotonic())
            self.shared.clock.follow(self)

    def _sleep(self, now: float) -> float | None:
        """The time (s) until the details or a write is due; None if neither is."""
        waits = (self._work.wait(now), self._page.display.wait(now), self.dock.learn.wait(now))
        return min((wait for wait in waits if wait is not None), default=None)

    @property
    def plays(self) -> bool:
        """Whether the run plays in a tab that is in front, as far as the browser has said: a hidden one gets none."""
        window = self._page.door.window if self._page.built else None
        return self._playback.playing and not self._stopped and not (window is not None and window.hidden)

    def frame(self, now: float) -> Flight | None:
        """Called by the shared clock: the frame at a time (s, monotonic); None while the session's loop is at work."""
        if not self._turn.acquire(blocking=False):
            return None
        try:
            with self._reporting():
                self._playback.advance(now)
                if self._playback.playing:
                    return self._page.display.frame(now)
                self._wake.set()  # the end of the run is drawn exactly
            return None
        finally:
            self._turn.release()

    def _leave(self) -> None:
        """Write the work that is not saved yet, and only then free the slot for the next tab."""
        for step in (
            self._remember_last_changes,
            self.form.cancel_jobs,
            self._page.in_class.end,
            self._work.write_last,
        ):
            with self._reporting():
                step()
        self.shared.slots.free(self._client.client_id)

    def _remember_last_changes(self) -> None:
        """Take over what was changed after the last picture began to be computed; nothing is drawn any more.

        Where the values do not fit together, the visitor has read why, and the last ones that did stay saved.
        """
        if self._page.built and not self._page.in_class.following:
            with contextlib.suppress(InvalidInputError, ValueError):
                self.form.touch()  # also a change that viser has not reported yet
                self._take_actions()
                self._work.remember(self.dock.read())

    def _wait_for_compilation(self) -> None:
        compilation = self.shared.compilation
        while not (compilation.done or self._stopped):
            self._page.follow_window()
            self.dock.verdict.progress(compilation.fraction, compilation.stage)
            time.sleep(PROGRESS_PERIOD)
        self.dock.verdict.progress(1.0, "ready")

    def _react(self) -> None:
        """Apply the changes of the visitor, and update the marks of the form."""
        self._page.follow_window()
        self._page.address.follow(self._page.door.window)
        self._page.in_class.before()
        for name in self._page.door.take_events():
            action = self._page.actions.get(name) or self.dock.studies.action(name)
            if action is not None:
                self.form.do(action, away=True)
        applied = self._apply_changes()
        self.form.refresh()
        self.dock.draw_progress()
        self.dock.presets.refresh()
        self.dock.learn.check_again()
        self._page.follow_window()  # a lesson may have been opened, or its prediction committed
        if not applied:
            self._page.display.draw_handles()
        self._page.in_class.after(None if self.picture is None else self.picture.settings)

    def _apply_changes(self) -> bool:
        """Compute and draw the chosen settings. Returns False after a complaint if no picture is possible."""
        began = time.monotonic()
        with contextlib.suppress(InvalidInputError), self.dock.catching():
            pressed, drag = self._take_actions()
            self._page.in_class.hold(self.dock)
            settings = self.dock.read()
            self.dock.compare.refresh()
            shown = self.picture
            picture = shown if shown is not None and settings == shown.settings else compute.compute(settings)
            if not self._page.in_class.following:
                self._work.remember(settings)  # before drawing: the tab may be gone by then
            if picture is not shown:
                self._page.display.show(picture)
                self.shared.metrics.picture(time.monotonic() - began)
                self.form.forget_answer()
                if not self._page.in_class.following:
                    opened = self.history.now is not None and self.history.now.origin != settings.origin
                    self.history.record(settings, began, shown=time.monotonic(), separate=pressed or opened, drag=drag)
            elif self.dock.changed:
                self._page.display.draw(picture)
            return True
        return False

    def _take_actions(self) -> tuple[bool, int | None]:
        """Do what the visitor has asked for by buttons, in the scene and in the menu of presets. Returns whether a
        button was pressed, and the number of the drag while a handle is held."""
        with self._client.atomic():  # controls that are built anew come together with their values
            pressed = self.form.run_actions(before=self._refresh_before_action)
            with self._reporting(but=ValueError):  # a job's error must not hold up what was changed meanwhile
                self.form.deliver()
            drag = self._page.interaction.apply(self.picture)
            if self.dock.chosen_preset != self.dock.origin:
                self._page.open(self.dock.chosen_preset)
            self.dock.refresh()
        return pressed, drag

    def _refresh_before_action(self) -> None:
        """Read the controls, so that an action uses their values at the moment when it runs."""
        with contextlib.suppress(ValueError):  # an action that reads the settings raises it again
            self.dock.refresh()

    @contextlib.contextmanager
    def _reporting(self, but: type[Exception] | tuple[()] = ()) -> Iterator[None]:
        """After an unforeseen error log the traceback, notify the visitor, and go on; raise errors of one type."""
        try:
            yield
        except but:
            raise
        except Exception:
            log.exception("session %s", self._client.client_id)
            self._playback.playing = False
            self.shared.metrics.error()
            self._outgoing.notify_of_error()
