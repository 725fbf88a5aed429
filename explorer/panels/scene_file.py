"""The scene as a file: a picture (PNG) from the visitor's camera, and a short animation (GIF) from the playhead on.

The visitor's browser draws each picture. A job asks for them one by one and waits, so the page stays usable; for an
animation the session's loop moves the playhead before each.
"""

import io
import math
import threading
from collections.abc import Callable
from functools import partial

import numpy as np
import viser
from jaxtyping import UInt8
from numpy import ndarray as Array

from explorer.model.playback import Playback
from explorer.widgets.controls import Number
from explorer.widgets.form import Action, Form
from explorer.widgets.progress import ProgressPanel
from explorer.widgets.section import Section
from rangenav.inputs import require
from rangenav.progress import Cancelled, CancelledError, Progress

PICTURE, ANIMATION = "picture of the scene", "animation of the scene"
"""Names of the jobs."""
RATE = 10
"""Pictures per second of an animation, which runs as fast as the flight."""
SECONDS, MIN_SECONDS, MAX_SECONDS = 4.0, 0.2, 12.0
WIDTH, ANIMATION_WIDTH = 1920, 640
"""px; the greatest width of a picture, and of one in an animation."""
COLOURS, FREQUENT, PALETTE_FRAMES = 256, 160, 4
"""Of an animation, the most that a GIF has; how many of them are frequent ones; and from how many pictures they are
taken."""
PATIENCE = 20.0
"""s for the browser to draw one picture; without a graphics card it may take seconds."""
TOO_SLOW = f"the browser has not drawn the scene within {PATIENCE:g} s: is its tab in the background?"
PICTURE_HINT = "The scene as you see it, without the page around it, on a transparent background."
ANIMATION_HINT = f"A GIF from the moment shown, {RATE} pictures a second, as fast as the flight. The page shows each."
SECONDS_HINT = f"How much of the flight the animation shows, {MIN_SECONDS:g} to {MAX_SECONDS:g} s."
Frame = UInt8[Array, "h w c"]


class SceneFilePanel:
    """Two buttons, the length of the animation, and the progress."""

    def __init__(
        self,
        form: Form,
        client: viser.ClientHandle,
        playback: Playback,
        *,
        stem: Callable[[], str],
        download: Callable[[str, bytes], None],
    ) -> None:
        """`stem` is the beginning of the file's name, and `download` downloads a file."""
        self._form, self._client, self._playback = form, client, playback
        self._stem, self._download, self._jobs = stem, download, form.new_jobs()
        self._section = section = Section(form, "The scene as a file")
        with section:
            form.button("Scene as PNG", self._picture, hint=PICTURE_HINT)
            self._seconds = Number(section, "length of the animation (s)", hint=SECONDS_HINT)
            self._seconds.show(SECONDS)
            section.check(self._length)
            form.button("Animation as GIF", self._animation, hint=ANIMATION_HINT)
            self._progress = ProgressPanel(form, self._jobs)
        form.command("Scene as PNG", self._picture)
        form.command("Animation of the scene (GIF)", self._animation)

    def _picture(self) -> None:
        self._require_idle()
        name, size = f"{self._stem()}-scene.png", self._size(WIDTH)

        def work(progress: Progress, cancelled: Cancelled) -> bytes:
            return png(self._rendered(size, "png"))

        self._progress.start(PICTURE, work, partial(self._download, name), self._section.complaint.say)

    def _animation(self) -> None:
        self._require_idle()
        with self._section.catching():
            seconds = self._length()
        name, size = f"{self._stem()}-scene.gif", self._size(ANIMATION_WIDTH)
        began = self._playback.time
        times = moments(began, seconds, self._playback.duration)

        def work(progress: Progress, cancelled: Cancelled) -> bytes:
            frames = []
            try:
                for k, time in enumerate(times):
                    if cancelled():
                        raise CancelledError
                    self._show(time)
                    frames.append(self._rendered(size, "jpeg"))
                    progress((k + 1) / (len(times) + 1))
            finally:
                self._form.do(partial(self._playback.seek, began), step=False)
            return gif(frames)

        self._progress.start(ANIMATION, work, partial(self._download, name), self._section.complaint.say)

    def _length(self) -> float:
        """s, of the animation. Raises ValueError with the reason."""
        seconds = self._seconds.read()
        within = math.isfinite(seconds) and MIN_SECONDS <= seconds <= MAX_SECONDS
        require(within, f"length of the animation must be {MIN_SECONDS:g} to {MAX_SECONDS:g} s, got {seconds:g} s")
        return seconds

    def _require_idle(self) -> None:
        with self._section.catching():
            if self._jobs.running is not None:
                raise ValueError("the file before is still being drawn; one at a time")

    def _size(self, most: int) -> tuple[int, int]:
        """Height and width (px) of the scene in the browser, made smaller to this width."""
        camera = self._client.camera
        width = min(camera.image_width, most)
        return max(round(camera.image_height * width / max(camera.image_width, 1)), 1), max(width, 1)

    def _show(self, time: float) -> None:
        """Have the session's loop show a moment (s), and wait until the scene has moved there."""
        self._wait_for(partial(self._playback.seek, time))
        self._wait_for(lambda: None)  # the loop moves the scene after its actions, and before the next ones

    def _wait_for(self, action: Action) -> None:
        done = threading.Event()

        def act() -> None:
            try:
                action()
            finally:
                done.set()

        self._form.do(act, step=False)
        if not done.wait(PATIENCE):
            raise ValueError(TOO_SLOW)

    def _rendered(self, size: tuple[int, int], transport: str) -> Frame:
        """The scene, as the browser draws it. Raises ValueError if the browser does not answer."""
        try:
            return self._client.get_render(
                *size, transport_format="png" if transport == "png" else "jpeg", timeout=PATIENCE
            )
        except (TimeoutError, RuntimeError) as error:  # RuntimeError: the tab has left
            raise ValueError(TOO_SLOW) from error


def moments(begin: float, seconds: float, duration: float) -> list[float]:
    """The times (s) of the pictures of an animation that begins at a moment; it ends with the flight."""
    count = int(RATE * min(seconds, max(duration - begin, 0.0)) + 1e-9) + 1
    return [begin + k / RATE for k in range(count)]


def png(frame: Frame) -> bytes:
    """One picture as a file."""
    from PIL import Image

    buffer = io.BytesIO()
    Image.fromarray(frame).save(buffer, "PNG")
    return buffer.getvalue()


def gif(frames: list[Frame]) -> bytes:
    """Pictures as an animation, repeated for ever. All have one palette, so that what rests does not flicker: the
    frequent colours, for the pale shades, and some of all others, so that a thin line keeps its own."""
    from PIL import Image

    opaque = [np.ascontiguousarray(frame[..., :3]) for frame in frames]
    some = Image.fromarray(np.concatenate(opaque[:: max(len(opaque) // PALETTE_FRAMES, 1)]))
    methods = ((Image.Quantize.MEDIANCUT, FREQUENT), (Image.Quantize.MAXCOVERAGE, COLOURS - FREQUENT))
    chosen = [some.quantize(count, method=method).getpalette() or [] for method, count in methods]
    palette = Image.new("P", (1, 1))
    palette.putpalette(chosen[0][: 3 * FREQUENT] + chosen[1])
    first, *rest = (Image.fromarray(one).quantize(palette=palette, dither=Image.Dither.NONE) for one in opaque)
    buffer = io.BytesIO()
    first.save(buffer, "GIF", save_all=True, append_images=rest, duration=1000 // RATE, loop=0, optimize=False)
    return buffer.getvalue()
