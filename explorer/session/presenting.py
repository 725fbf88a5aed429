"""The teacher's page, shown to the class: its state, time, camera and the control that was moved last.

While the run plays nothing is sent from frame to frame: each page has a clock of its own, which was set once.
"""

import time

import numpy as np
import viser

from explorer.model.classroom import Camera, Classroom, Shown
from explorer.model.playback import Playback
from explorer.model.settings import Settings
from explorer.panels.dock import Dock
from rangenav.inputs import Vec3

JUMP = 0.25
"""s: the time is sent to the class anew if it differs by more from what the pages of the class show."""


class Presenter:
    """The part of a teacher's page that the class sees."""

    def __init__(self, client: viser.ClientHandle, dock: Dock, playback: Playback, classroom: Classroom) -> None:
        self._client, self._dock, self._playback, self._classroom = client, dock, playback, classroom
        self.presenting = False
        self._sent: Shown | None = None

    def present(self, on: bool) -> None:
        """Begin with what the controls say, or end. Raises InvalidInputError if they hold no valid input."""
        settings = self._dock.read() if on else None
        self.presenting, self._sent = on, None
        if settings is None:
            self._classroom.show(None)
        self.follow(settings)

    def go_on(self, settings: Settings) -> None:
        """Go on with a presentation whose page was closed; `settings` are those of the picture on this page."""
        self.presenting, self._sent = True, None
        self.follow(settings)

    def follow(self, settings: Settings | None) -> None:
        """Tell the class what has changed; `settings` are those of the picture on the page."""
        if not self.presenting or settings is None:
            return
        shown = self._shown(settings)
        if self._sent is None or not same(self._sent, shown):
            self._sent = shown
            self._classroom.show(shown)

    def _shown(self, settings: Settings) -> Shown:
        playback, camera = self._playback, self._client.camera
        return Shown(
            settings=settings,
            time=playback.time,
            at=time.monotonic(),
            playing=playback.playing,
            speed=playback.speed,
            loop=playback.loop,
            camera=Camera(position=_vector(camera.position), look_at=_vector(camera.look_at)),
            control=self._dock.form.last_moved,
        )


def same(sent: Shown, shown: Shown) -> bool:
    """Whether a page that was sent one state of the run shows the other by now."""
    expected = sent.time + (shown.at - sent.at) * sent.speed * sent.playing
    duration = shown.settings.preset.duration
    late = abs(expected % duration - shown.time % duration) if sent.playing else abs(expected - shown.time)
    kept = ("settings", "playing", "speed", "loop", "camera", "control")
    return all(getattr(sent, name) == getattr(shown, name) for name in kept) and late < (JUMP if sent.playing else 1e-9)


def _vector(value: np.ndarray) -> Vec3:
    x, y, z = (float(entry) for entry in value)
    return x, y, z
