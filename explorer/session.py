"""One visitor: a browser tab with its own controls, its own loop and its own clock. Latest wins, nothing queues up.

viser thread   a control was moved: wake.set()                 nothing else, ever
session loop   wake.wait(); wake.clear()                       clear BEFORE reading, so that no change is lost
               settings = dock.read()
               picture  = compute(settings)                    stages cached by their own inputs
               with client.atomic(): draw(picture)             plots and verdict as one, then the scene
playback       the same loop wakes at the frame rate and moves the scene and the cursors; it computes nothing
"""

import contextlib
import logging
import threading
import time
from collections.abc import Iterator

import msgspec
import viser

from explorer.charts import TITLES, Charts
from explorer.charts.details import look
from explorer.interaction import Interaction
from explorer.model import compute, palette
from explorer.model.compute import Picture
from explorer.model.history import History
from explorer.model.jobs import Jobs
from explorer.model.playback import Playback
from explorer.model.settings import Settings, effective
from explorer.panels.dock import WIDTH, Dock, Requests
from explorer.panels.export import ExportPanel, Sources
from explorer.panels.timeline import TimelinePanel
from explorer.scene import Scene
from explorer.scene.drag_handles import DragHandles
from explorer.shared import Shared
from explorer.storage import preset_file
from explorer.storage.autosave import Autosave
from explorer.storage.catalog import Catalog
from explorer.storage.work_files import StorageError
from explorer.web import viewport
from explorer.web.identity import session_key
from explorer.web.security import accept_values_only
from explorer.widgets.form import Form, InvalidInputError

PROGRESS_PERIOD = 0.1
HEAD_START = 0.003
"""s between plots and scene: a batch without scene nodes is shown at once, one with them waits for a rendered frame."""
REST = 0.3
"""s without another picture, after which what takes longer is drawn too."""
PAPER = "paper"

log = logging.getLogger(__name__)


class Session:
    """Made when a tab connects, stopped when it leaves."""

    def __init__(self, client: viser.ClientHandle, shared: Shared) -> None:
        self._client, self._shared = client, shared
        self._catalog = Catalog(shared.shipped, shared.library, shared.certifier)
        self._wake, self._stopped = threading.Event(), False
        self._picture: Picture | None = None
        self._rests_at: float | None = None
        self._history = History()
        self._autosave = Autosave(shared.work_files, shared.first, self._notify)
        self._playback = Playback(shared.shipped[shared.first].duration)
        self._thread = threading.Thread(target=self._run, name=f"session {client.client_id}", daemon=True)

    def start(self) -> None:
        """Build the page and serve it from this session's own thread."""
        accept_values_only(self._client)
        self._thread.start()

    def stop(self) -> None:
        """Let the thread end; what it holds is then free."""
        self._stopped = True
        self._wake.set()

    def _run(self) -> None:
        with self._reporting():
            self._build()
            self._wait_until_warm()
        self._wake.set()
        while not self._stopped:
            woken = self._wake.wait(self._patience(time.monotonic()))
            with self._reporting():
                if woken:
                    self._wake.clear()
                    self._react()
                self._animate()
                self._draw_later(time.monotonic())
                self._autosave.write(time.monotonic())
        self._leave()

    def _patience(self, now: float) -> float | None:
        """How long (s) to sleep if nothing happens: until the next frame, or until work should be written."""
        later = None if self._rests_at is None else max(0.0, self._rests_at - now)
        waits = [wait for wait in (self._playback.wait(now), self._autosave.wait(now), later) if wait is not None]
        return min(waits, default=None)

    def _leave(self) -> None:
        """Write what is left, and only then give the place in the browser to whoever comes next."""
        self._jobs.cancel()
        self._dock.compare.stop()
        if self._shared.slots.has(self._client.client_id):
            self._autosave.write(time.monotonic(), at_once=True)
        self._shared.slots.free(self._client.client_id)

    def _build(self) -> None:
        client = self._client
        client.gui.configure_theme(show_logo=False, show_share_button=False)
        client.gui.set_panel_label("rangenav")
        canvas = client.camera.image_width
        self._form, self._jobs = Form(client.gui, self._wake.set), Jobs(self._wake.set)
        requests = Requests(
            undo=self._undo,
            redo=self._redo,
            again=self._again,
            paper=self._paper,
            download=self._download,
            send=self._send,
        )
        self._dock = Dock(self._form, self._catalog, self._shared.first, requests, self._jobs)
        wide = viewport.width(client, canvas, WIDTH)
        narrow = viewport.is_narrow(wide)
        self._charts = Charts(client, narrow=narrow, wake=self._wake.set)
        with self._dock.tabs.add_tab("Export"):
            ExportPanel(self._form, TITLES, Sources(plan=self._charts.plan, settings=self._named, send=self._send))
        self._form.command("Show all curves", self._charts.show_all)
        self._timeline = TimelinePanel(self._form, self._playback, room=wide - WIDTH - self._charts.width)
        self._scene = Scene(client, self._wake.set)
        self._handles = DragHandles(client.scene, self._wake.set)
        self._form.command("Let go of the handle", self._handles.deselect, key="escape")
        self._interaction = Interaction(self._dock, self._charts, self._scene, self._handles, self._playback)
        self._restore()

    def _restore(self) -> None:
        """Show what this tab's visitor had; another preset asked for on the command line comes first, and undo then
        brings the work back."""
        try:
            kept = self._autosave.restore(session_key(self._client, self._shared.slots))
        except StorageError as reason:
            kept = self._notify(str(reason))
        if kept is None:
            return
        self._dock.gains.use_units(kept.language)
        settings = kept.settings
        if settings.origin not in self._catalog.presets:  # imported and not saved, or deleted meanwhile: it has no file
            origin = self._catalog.add_imported(settings.preset).origin
            settings = msgspec.structs.replace(settings, origin=origin, edition="")
        if kept.opened == self._shared.first or not self._shared.requested:
            self._dock.write(settings)
        self._history.record(settings, time.monotonic(), apart=True)

    def _wait_until_warm(self) -> None:
        while not (self._shared.compilation.done or self._stopped):
            self._dock.verdict.progress(self._shared.compilation.fraction, self._shared.compilation.what)
            time.sleep(PROGRESS_PERIOD)
        self._dock.verdict.progress(1.0, "ready")

    def _react(self) -> None:
        """Take in what the visitor did, and draw if that changes the picture."""
        shown = self._took_in()
        self._form.refresh()
        self._dock.progress.draw()
        self._dock.presets.refresh()
        if not shown:
            self._draw_handles()

    def _took_in(self) -> bool:
        """Whether what is chosen now could be shown; if not, the visitor has been told why."""
        began = time.monotonic()
        with contextlib.suppress(InvalidInputError), self._dock.catching():
            pressed = self._form.run_actions()
            self._jobs.deliver()
            hold = self._interaction.apply(self._picture)
            if self._dock.chosen_preset != self._dock.origin:
                self._open(self._dock.chosen_preset)
            settings = self._dock.read()
            self._dock.compare.read()
            shown = self._picture
            picture = shown if shown is not None and settings == shown.settings else compute.compute(settings)
            self._autosave.remember(settings, self._dock.gains.units)  # before it is drawn: the tab may be gone by then
            if picture is not shown:
                self._show(picture)
                chosen = self._history.now is not None and self._history.now.origin != settings.origin
                self._history.record(settings, began, shown=time.monotonic(), apart=pressed or chosen, hold=hold)
            elif self._dock.changed:
                self._draw(picture)
            return True
        return False

    def _show(self, picture: Picture) -> None:
        """Draw another picture, all of it or what is new of it."""
        if self._turned_twin(picture.settings):
            self._picture = picture
            self._draw_depth(picture)
        else:
            self._draw(picture)
        self._form.forget_answer()

    def _draw_handles(self) -> None:
        if self._picture is not None and self._scene.bounds is not None:
            anchor = self._picture.preset.world.anchor
            self._handles.draw(anchor, self._dock.points, self._scene.bounds)

    def _open(self, name: str) -> None:
        self._dock.presets.open(name)

    def _again(self) -> None:
        self._open(self._dock.origin)

    def _paper(self) -> None:
        self._open(PAPER)
        self._charts.show_paper_figures()

    def _undo(self) -> None:
        """One step back; what is not shown, because it cannot be or because it has only just come, is itself a step."""
        shown = self._history.now
        before = self._history.undo() if self._chosen() == shown else shown
        if before is not None:
            self._dock.write(before)
        else:
            self._end_of_history("Nothing to undo", "Steps are counted from when this page was opened or reloaded.")

    def _end_of_history(self, title: str, sentence: str) -> None:
        """A button that did nothing would look broken."""
        self._client.add_notification(title, sentence, auto_close_seconds=4)

    def _chosen(self) -> Settings | None:
        """What the controls say now, None if that is no valid input."""
        try:
            return self._dock.read()
        except (InvalidInputError, ValueError):
            return None

    def _redo(self) -> None:
        after = self._history.redo()
        if after is not None:
            self._dock.write(after)
        else:
            self._end_of_history("Nothing to redo", "Nothing has been undone since the last change.")

    def _download(self) -> None:
        name, settings = self._named()
        self._send(name, preset_file.document(settings))

    def _named(self) -> tuple[str, Settings]:
        """What is chosen, and the name of its file."""
        settings = self._dock.read()
        return preset_file.file_name(
            settings.origin, effective(settings), self._catalog.presets[settings.origin]
        ), settings

    def _send(self, name: str, content: bytes) -> None:
        self._client.send_file_download(name, content, save_immediately=True)

    def _draw(self, picture: Picture) -> None:
        self._picture = picture
        self._playback.fit(picture.preset.duration)
        beside = self._dock.comparison(picture)
        with self._client.atomic():
            self._charts.draw(picture, beside)
            self._charts.cursor(picture, self._playback.time)
            self._dock.draw(picture)
            self._dock.compare.draw(picture, beside)
        self._client.flush()
        time.sleep(HEAD_START)
        with self._client.atomic():
            self._scene.draw(picture, beside, dragging=self._handles.dragging)
            self._draw_handles()
        self._rests_at = time.monotonic() + REST

    def _draw_later(self, now: float) -> None:
        """When nothing has moved for a moment: what takes as long to find as all else together."""
        if self._rests_at is None or self._picture is None or now < self._rests_at or self._wake.is_set():
            return
        self._rests_at = None
        self._draw_depth(self._picture)

    def _draw_depth(self, picture: Picture) -> None:
        deep = look(picture)
        with self._client.atomic():
            self._dock.twin.draw(deep.twin)
            self._charts.draw_later(picture)
            self._scene.draw_later(picture, deep)

    def _turned_twin(self, settings: Settings) -> bool:
        """Whether that is all that has changed since the picture at rest: the twin then follows at once."""
        shown = None if self._picture is None else self._picture.settings
        resting = self._rests_at is None
        return (
            shown is not None and resting and msgspec.structs.replace(shown, twin_turn=settings.twin_turn) == settings
        )

    def _animate(self) -> None:
        """Move everything to the playhead."""
        if self._picture is None:
            return
        now = time.monotonic()
        self._playback.advance(now)
        with self._client.atomic():
            self._scene.move(self._picture, self._playback.time)
            self._charts.cursor(self._picture, self._playback.time)
            self._timeline.write(now)

    def _notify(self, sentence: str) -> None:
        """Something about keeping work, once."""
        self._client.add_notification("Your work", sentence, color=palette.NOTIFY_WARNING, auto_close_seconds=12)

    @contextlib.contextmanager
    def _reporting(self) -> Iterator[None]:
        """An error nobody foresaw: tell the visitor, keep the traceback for us, and go on."""
        try:
            yield
        except Exception:
            log.exception("session %s", self._client.client_id)
            self._playback.playing = False
            text = "Something went wrong on the server; what you see may be out of date. The log has the details."
            self._client.add_notification("⚠ Internal error", text, color=palette.NOTIFY_ERROR, auto_close_seconds=10)
