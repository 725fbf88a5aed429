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
from functools import partial

import viser

from explorer.charts import GROUP_TITLES, Charts, plot_size
from explorer.model import compute
from explorer.model.compute import Picture
from explorer.model.glossary import COMPARE
from explorer.model.history import History
from explorer.model.playback import Playback
from explorer.model.settings import Settings
from explorer.panels import saved_page
from explorer.panels.address import Address
from explorer.panels.camera import CameraPanel
from explorer.panels.commands import Commands
from explorer.panels.dock import Dock
from explorer.panels.session_actions import SessionActions
from explorer.panels.timeline import TimelinePanel
from explorer.scene import Scene
from explorer.scene.drag_handles import DragHandles
from explorer.session.appearance import Appearance, set_theme
from explorer.session.display import Display
from explorer.session.export_tab import add_export_tab
from explorer.session.in_class import Alone, Part, Visit, part_in_class
from explorer.session.interaction import Interaction
from explorer.session.outgoing import Outgoing
from explorer.shared import Shared
from explorer.storage.autosave import Autosave
from explorer.storage.catalog import Catalog
from explorer.storage.work_files import StorageError
from explorer.web import connection, places
from explorer.web.access.visitors import Visitor
from explorer.web.door import Door
from explorer.web.frames import Flight, Frames
from explorer.web.identity import session_key
from explorer.web.values import accept_values_only
from explorer.widgets.complaint import InvalidInputError
from explorer.widgets.form import Form

PROGRESS_PERIOD = 0.1
"""s between two updates of the progress of the compilation."""
PAPER, FIRST_LESSON = "paper", 1
"""The preset of the paper's figures, and the lesson that a new visitor is led to."""

log = logging.getLogger(__name__)


class Session:
    """The page of one browser tab, from its connection to its end, with a thread of its own."""

    def __init__(self, client: viser.ClientHandle, shared: Shared, visitor: Visitor | None = None) -> None:
        """visitor: who has come in; None at this machine's own page."""
        self._visitor = visitor
        self._client, self.shared = client, shared
        self.catalog = Catalog(shared.shipped, shared.library_of(visitor), shared.certifier)
        self._wake, self._stopped = threading.Event(), False
        self._turn = threading.Lock()
        """Held by whoever draws: the session's loop, or the shared clock for a frame."""
        number = 0 if visitor is None else visitor.number
        self.form = Form(client.gui, self._wake.set, shared.share_of(visitor), number)
        self.jobs = self.form.new_jobs()
        self._in_class: Part = Alone()
        self._built = False
        """Whether the page is complete; it stays incomplete if the tab disconnects while the page is being built."""
        self.history = History()
        self._outgoing = Outgoing(client, self.catalog)
        self._autosave = Autosave(shared.work_files, shared.first, self._outgoing.notify_about_work)
        self._playback = Playback(shared.shipped[shared.first].duration)
        self.thread = threading.Thread(target=self._run, name=f"session {client.client_id}", daemon=True)

    @property
    def picture(self) -> Picture | None:
        """The picture on the page; None before the first one."""
        return self._display.picture if self._built else None

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
        with connection.may_close(self._client):
            with self._reporting():
                if not self._stopped:  # else the page was loaded again already, as when a key is held down
                    self._build()
                    self._wait_for_compilation()
            self._wake.set()
            if self._built:
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
                self._in_class.tick(None if self.picture is None else self.picture.settings)
                if woken or not self._playback.playing:
                    self._display.animate(now)
                self._display.draw_details_if_due(time.monotonic(), self._wake)
                self._autosave.write_aside(time.monotonic())
            self.shared.clock.follow(self)

    def _sleep(self, now: float) -> float | None:
        """The time (s) until the details or a write is due; None if neither is."""
        waits = (self._autosave.wait(now), self._display.wait(now), self.dock.learn.wait(now))
        return min((wait for wait in waits if wait is not None), default=None)

    @property
    def plays(self) -> bool:
        """Whether the run plays in a tab that is in front, as far as the browser has said: a hidden one gets none."""
        window = self._door.window if self._built else None
        return self._playback.playing and not self._stopped and not (window is not None and window.hidden)

    def frame(self, now: float) -> Flight | None:
        """Called by the shared clock: the frame at a time (s, monotonic); None while the session's loop is at work."""
        if not self._turn.acquire(blocking=False):
            return None
        try:
            with self._reporting():
                self._playback.advance(now)
                if self._playback.playing:
                    return self._display.frame(now)
                self._wake.set()  # the end of the run is drawn exactly
            return None
        finally:
            self._turn.release()

    def _leave(self) -> None:
        """Write the work that is not saved yet, and only then free the slot for the next tab."""
        for step in (self._remember_last_changes, self.form.cancel_jobs, self._in_class.end, self._write_last):
            with self._reporting():
                step()
        self.shared.slots.free(self._client.client_id)

    def _write_last(self) -> None:
        self._autosave.finish()
        if self.shared.slots.has(self._client.client_id):
            self._autosave.write(time.monotonic(), at_once=True)

    def _remember_last_changes(self) -> None:
        """Take over what was changed after the last picture began to be computed; nothing is drawn any more.

        Where the values do not fit together, the visitor has read why, and the last ones that did stay saved.
        """
        if self._built and not self._in_class.following:
            with contextlib.suppress(InvalidInputError, ValueError):
                self.form.touch()  # also a change that viser has not reported yet
                self._take_actions()
                self._remember(self.dock.read())

    def _remember(self, settings: Settings) -> None:
        """Have the settings and the view saved when that is due."""
        view = saved_page.view_of(self.dock, self.history, self._playback)
        self._autosave.remember(settings, self.dock.gains.units, view)

    def _build(self) -> None:
        client = self._client
        set_theme(client, dark=False)
        client.gui.set_panel_label("rangenav")
        self._door = Door(client, self._wake.set, welcome=self._is_welcomed)
        actions = SessionActions(
            restart_preset=self._restart_preset,
            show_paper_figures=self._show_paper_figures,
            show_side_by_side=lambda: self.charts.show_side_by_side(),
            download_preset=lambda: self._outgoing.download_preset(self.dock),
            send=self._outgoing.download,
            go_to=lambda label: self._commands.go_to_control(label),
            go_to_place=lambda place: self._commands.go_to_place(place),
            rewind=lambda: self._playback.seek(0.0),
            notify=self._outgoing.notify,
        )
        self.dock = Dock(self.form, self.catalog, self.shared.first, actions, self.jobs, self.history)
        if self._stopped:
            return
        timeline = TimelinePanel(self.form, self._playback)
        camera = client.camera
        first_size = plot_size(camera.image_width, camera.image_height)  # until the browser has reported its window
        self.charts = Charts(client, first_size, wake=self._wake.set)
        scene = Scene(client, self._wake.set)
        exporting = add_export_tab(client, self.dock, self.charts, scene, self._playback, self._outgoing, actions.go_to)
        self.form.command("Show all curves", self.charts.show_all_curves)
        camera_panel = CameraPanel(self.form, scene)
        handles = DragHandles(client.scene, scene.labels, self._wake.set)
        self.form.command("Close the large plot, let go of the handle", partial(self._escape, handles), key="escape")
        self._interaction = Interaction(self.dock, self.charts, scene, handles, self._playback)
        self._display = Display(
            client, self.dock, self.charts, scene, handles, timeline, self._playback, Frames(client)
        )
        visit = Visit(
            client=client,
            visitor=self._visitor,
            dock=self.dock,
            scene=scene,
            playback=self._playback,
            history=self.history,
            catalog=self.catalog,
            actions=actions,
            wake=self._wake.set,
        )
        self._in_class = part_in_class(visit, self.shared)
        self.dock.studies.follows = lambda: self._in_class.following
        self._appearance = Appearance(
            client, self.dock, self.charts, scene, self._display, in_class=self._visitor is not None
        )
        self._actions = self.dock.actions | timeline.actions | self.charts.actions | exporting.actions
        self._actions |= camera_panel.actions
        self._actions |= self._in_class.actions
        self._address = Address(
            client,
            self.dock,
            self.catalog,
            self._outgoing.notify,
            lesson=self.shared.lesson,
            record=lambda settings: self.history.record(settings, time.monotonic(), separate=True),
        )
        self._actions |= self._address.actions | {
            "learn": lambda: self.dock.learn.open_number(FIRST_LESSON),
            "go-tune": lambda: actions.go_to(COMPARE["tries"].caption),
        }
        self.form.command("Copy a link to this page", self._address.copy_link, step=False)
        with client.atomic():
            self._commands = commands = Commands(
                client, self.form, self._outgoing.notify, in_class=self._visitor is not None
            )
            commands.add_plots(GROUP_TITLES)
            commands.add_presets({name: p.title for name, p in self.shared.shipped.items()}, self._open)
            commands.add_lessons(self.dock.learn.titles, self.dock.learn.open_number)
        places.install(self._client, first=self._in_class.first_tab)
        self._built = True
        self._restore()

    @property
    def _is_welcomed(self) -> bool:
        """Whether a new visitor gets the card. In a class the teacher sees its tab at once, and leads the students."""
        return not (self.shared.requested or self.shared.lesson or self._visitor is not None)

    def _escape(self, handles: DragHandles) -> None:
        self.charts.close_large()
        handles.deselect()

    def _restore(self) -> None:
        """Show the work that this tab's visitor had. A preset that was requested on the command line is shown instead,
        and undo then brings the work back."""
        try:
            key = session_key(self._client, self.shared.slots)
            if key is not None and not self.shared.keeps_work_of(self._visitor, key.partition("-")[0]):
                raise StorageError("Your work is not kept: you have come with too many browsers.")
            work = self._autosave.restore(key)
        except StorageError as reason:
            self._outgoing.notify_about_work(str(reason))
            return
        if work is not None:
            requested = self.shared.requested and work.opened != self.shared.first
            saved_page.restore(work, self.dock, self.history, self._playback, self.catalog, as_a_step=requested)

    def _wait_for_compilation(self) -> None:
        compilation = self.shared.compilation
        while not (compilation.done or self._stopped):
            self._appearance.follow(self._door.window, guest=self._in_class.following)
            self.dock.verdict.progress(compilation.fraction, compilation.stage)
            time.sleep(PROGRESS_PERIOD)
        self.dock.verdict.progress(1.0, "ready")

    def _react(self) -> None:
        """Apply the changes of the visitor, and update the marks of the form."""
        self._appearance.follow(self._door.window, guest=self._in_class.following)
        self._address.follow(self._door.window)
        self._in_class.before()
        for name in self._door.take_events():
            action = self._actions.get(name) or self.dock.studies.action(name)
            if action is not None:
                self.form.do(action, away=True)
        applied = self._apply_changes()
        self.form.refresh()
        self.dock.draw_progress()
        self.dock.presets.refresh()
        self.dock.learn.check_again()
        self._appearance.follow(
            self._door.window, guest=self._in_class.following
        )  # a lesson may have been opened, or its prediction committed
        if not applied:
            self._display.draw_handles()
        self._in_class.after(None if self.picture is None else self.picture.settings)

    def _apply_changes(self) -> bool:
        """Compute and draw the chosen settings. Returns False after a complaint if no picture is possible."""
        began = time.monotonic()
        with contextlib.suppress(InvalidInputError), self.dock.catching():
            pressed, drag = self._take_actions()
            self._in_class.hold(self.dock)
            settings = self.dock.read()
            self.dock.compare.refresh()
            shown = self.picture
            picture = shown if shown is not None and settings == shown.settings else compute.compute(settings)
            if not self._in_class.following:
                self._remember(settings)  # before drawing: the tab may be gone by then
            if picture is not shown:
                self._display.show(picture)
                self.shared.metrics.picture(time.monotonic() - began)
                self.form.forget_answer()
                if not self._in_class.following:
                    opened = self.history.now is not None and self.history.now.origin != settings.origin
                    self.history.record(settings, began, shown=time.monotonic(), separate=pressed or opened, drag=drag)
            elif self.dock.changed:
                self._display.draw(picture)
            return True
        return False

    def _take_actions(self) -> tuple[bool, int | None]:
        """Do what the visitor has asked for by buttons, in the scene and in the menu of presets. Returns whether a
        button was pressed, and the number of the drag while a handle is held."""
        pressed = self.form.run_actions(before=self._refresh_before_action)
        with self._reporting(but=ValueError):  # a job's error must not hold up what was changed meanwhile
            self.form.deliver()
        drag = self._interaction.apply(self.picture)
        if self.dock.chosen_preset != self.dock.origin:
            self._open(self.dock.chosen_preset)
        self.dock.refresh()
        return pressed, drag

    def _refresh_before_action(self) -> None:
        """Read the controls, so that an action uses their values at the moment when it runs."""
        with contextlib.suppress(ValueError):  # an action that reads the settings raises it again
            self.dock.refresh()

    def _open(self, name: str) -> None:
        self.dock.presets.open(name)

    def _restart_preset(self) -> None:
        self._open(self.dock.origin)

    def _show_paper_figures(self) -> None:
        self._open(PAPER)
        self.charts.show_paper_figures()

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
