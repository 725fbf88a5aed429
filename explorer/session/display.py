"""What one visitor sees: a picture is drawn in plots, controls and scene, and all of it follows the playhead.

draw(picture)      plots, verdict and marks of the controls in one batch; the scene in the same batch if the path is the
                   same, else in a second one
draw_details       when nothing has changed for a moment, because the details take as long to compute as all the rest;
                   then more windows are judged, and the verdict, which is the sampled windows' until then, is proven in
                   a job
animate            moves cursors and scene to the playhead; it computes nothing
frame              the same for a frame of a playing run, which may be dropped
"""

import threading
import time

import msgspec
import viser

from explorer.charts import Charts
from explorer.model.comparison import NOTHING, Comparison
from explorer.model.compute import Picture
from explorer.model.playback import Playback
from explorer.model.settings import Settings
from explorer.panels.dock import Dock
from explorer.panels.timeline import TimelinePanel
from explorer.scene import Scene
from explorer.scene.drag_handles import DragHandles
from explorer.session.picture_text import PictureText
from explorer.web.frames import Flight, Frames

HEAD_START = 0.003
"""s between plots and scene: a batch without scene nodes is shown at once, one with them waits for a rendered frame."""
VALUES_PERIOD = 0.2
"""s between two updates of what is read while the run plays: the legends and the status line."""
SETTLED = 0.3
"""s without a new picture, after which the details are drawn too."""


class Display:
    """The parts of one visitor's page that show a picture."""

    def __init__(
        self,
        client: viser.ClientHandle,
        dock: Dock,
        charts: Charts,
        scene: Scene,
        handles: DragHandles,
        timeline: TimelinePanel,
        playback: Playback,
        frames: Frames,
    ) -> None:
        self._frames, self._values_due = frames, 0.0
        self._client, self._dock, self._charts = client, dock, charts
        self._scene, self._handles, self._timeline, self._playback = scene, handles, timeline, playback
        self.picture: Picture | None = None
        """The picture on the page; None before the first one."""
        self._comparison, self._text = NOTHING, PictureText(client.gui)
        self._details_due: float | None = None
        """When to draw the details of the picture (s, monotonic); None if they are drawn."""

    def wait(self, now: float) -> float | None:
        """How long (s) until the details or the text of the picture are due; None if both are there."""
        details = None if self._details_due is None else max(0.0, self._details_due - now)
        return min((wait for wait in (details, self._text.wait(now)) if wait is not None), default=None)

    def show(self, picture: Picture) -> None:
        """Draw another picture: all of it, or the details alone if nothing but the twin was turned."""
        if self._only_twin_turned(picture.settings):
            self._draw_details(picture)
        else:
            self.draw(picture)

    def draw(self, picture: Picture) -> None:
        """Draw all of a picture, and what it is compared with; the details follow later."""
        self.picture = picture
        self._playback.fit(picture.preset.duration)
        self._comparison = comparison = self._dock.comparison(picture)
        with self._client.atomic():
            self._charts.draw(picture, comparison, time=self._playback.time)
            self._dock.draw(picture)
            self._timeline.draw(picture)
            self._dock.compare.draw(picture, comparison)
            self._dock.form.refresh()
            same_path = self._scene.shows_path_of(picture)
            if same_path:
                self._draw_scene(picture, comparison)
        if not same_path:
            self._client.flush()
            time.sleep(HEAD_START)
            with self._client.atomic():
                self._draw_scene(picture, comparison)
        self._details_due = time.monotonic() + SETTLED

    def _draw_scene(self, picture: Picture, comparison: Comparison) -> None:
        self._scene.draw(picture, comparison, dragging=self._handles.dragging)
        self.draw_handles()

    def redraw(self) -> None:
        """Draw the picture once more, on plots that were created anew."""
        if self.picture is not None:
            self.draw(self.picture)

    def draw_handles(self) -> None:
        """Move the drag handles to the chosen anchor and waypoints, even if no picture can be computed from them."""
        if self.picture is not None and self._scene.bounds is not None:
            self._handles.draw(self.picture.preset.world.anchor, self._dock.points, self._scene.bounds)

    def draw_details_if_due(self, now: float, wake: threading.Event) -> None:
        """Draw the details, and write the text of the picture, if nothing has changed for a moment and no change is
        waiting (`wake` is not set)."""
        self._text.write_if_due(now)
        if self._details_due is None or self.picture is None or now < self._details_due or wake.is_set():
            return
        self._details_due = None
        self._draw_details(self.picture)

    def animate(self, now: float) -> None:
        """Move everything to the playhead, exactly, by the queue of all messages."""
        if self.picture is None:
            return
        self._frames.finish()
        with self._client.atomic():
            self._move(self.picture, now, values=True)
        self._text.follow(self.picture, None if self._playback.playing else self._playback.time, now)

    def frame(self, now: float) -> Flight | None:
        """The frame of a playing run at a time (s, monotonic); None while the one before it waits."""
        if self.picture is None or not self._frames.ready:
            return None
        values = now >= self._values_due
        if values:
            self._values_due = now + VALUES_PERIOD
        with self._frames.collecting():
            self._move(self.picture, now, values=values)
        return self._frames.packed()

    def _move(self, picture: Picture, now: float, *, values: bool) -> None:
        self._scene.move(picture, self._playback.time)
        self._charts.cursor(picture, self._playback.time, values=values)
        self._timeline.write(now)

    def _draw_details(self, moved: Picture) -> None:
        self.picture = picture = moved.at_rest
        details = picture.details
        with self._client.atomic():
            self._timeline.draw(picture)
            self._dock.compare.draw(picture, self._comparison)
            self._dock.presets.draw_details(picture)
            self._dock.compare.draw_details(picture)
            self._dock.learn.draw_details(picture)
            self._dock.twin.draw(details.twin)
            self._charts.draw_details(picture)
            self._scene.draw_details(picture, details)
        self._dock.prove(picture)

    def _only_twin_turned(self, settings: Settings) -> bool:
        """Whether the turned twin is all that has changed since the details were drawn; it is then redrawn at once."""
        if self.picture is None or self._details_due is not None:
            return False
        return msgspec.structs.replace(self.picture.settings, twin_turn=settings.twin_turn) == settings
