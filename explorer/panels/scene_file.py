"""The scene as a file: a picture (PNG) from the visitor's camera, and a short animation (GIF) from the playhead on.

The visitor's browser draws each picture. A job asks for them one by one and waits, so the page stays usable; for an
animation the session's loop moves the playhead before each.
"""

import io
import math
import textwrap
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
import viser
from jaxtyping import UInt8
from numpy import ndarray as Array

from explorer.model.compute import Picture
from explorer.model.playback import Playback
from explorer.model.settings import PRINTED_LABELS
from explorer.widgets.controls import Number
from explorer.widgets.form import Action, Form
from explorer.widgets.progress import ProgressPanel
from explorer.widgets.section import Section
from rangenav.inputs import require
from rangenav.model import STATES
from rangenav.progress import Cancelled, CancelledError, Progress

if TYPE_CHECKING:
    from PIL import Image

PICTURE, ANIMATION = "picture of the scene", "animation of the scene"
"""Names of the jobs."""
RATE = 10
"""Pictures per second of an animation, which runs as fast as the flight."""
SECONDS, MIN_SECONDS, MAX_SECONDS = 4.0, 0.2, 12.0
WIDTH, ANIMATION_WIDTH = 1920, 640
"""px; the greatest width of a picture, and of one in an animation."""
COLOURS, FREQUENT, PALETTE_FRAMES = 256, 160, 4
"""Colours of an animation, as many as a GIF can have; how many of them are the frequent ones; and from how many
pictures these are taken."""
FONT_SHARE, LEAST_FONT, CHARACTER = 0.016, 11, 0.58
"""Size of the words below a picture by its width, the least (px), and the width of a character by its size."""
PATIENCE = 20.0
"""s for the browser to draw one picture; without a graphics card it may take seconds."""
TOO_SLOW = f"the browser has not drawn the scene within {PATIENCE:g} s: is its tab in the background?"
PICTURE_HINT = (
    "The scene as you see it, without the page around it, on a transparent background; a line below it says what it is."
)
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
        instruct: Callable[[bool], None],
    ) -> None:
        """`stem` is the beginning of the file's name, and `download` downloads a file. `instruct` switches what labels
        tell a visitor to do."""
        self._form, self._client, self._playback = form, client, playback
        self._instruct = instruct
        self._picture_shown: Picture | None = None
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

    def draw(self, picture: Picture) -> None:
        """Note the picture that the scene shows."""
        self._picture_shown = picture

    def _picture(self) -> None:
        self._require_idle()
        name, size = f"{self._stem()}-scene.png", self._size(WIDTH)
        words = "" if self._picture_shown is None else caption(self._picture_shown, self._playback.time)

        def work(progress: Progress, cancelled: Cancelled) -> bytes:
            with self._without_instructions():
                return png(self._rendered(size, "png"), words)

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
                with self._without_instructions():
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

    @contextmanager
    def _without_instructions(self) -> Iterator[None]:
        """Within it, labels only name what the picture shows."""
        self._wait_for(partial(self._instruct, False))
        try:
            yield
        finally:
            self._form.do(partial(self._instruct, True), step=False)

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


def caption(picture: Picture, time: float) -> str:
    """What a picture of the scene shows: the preset, the moment (s), whose formulas, and what can be seen."""
    settings = picture.settings
    printed = [PRINTED_LABELS[name] for name in PRINTED_LABELS if getattr(settings.printed, name)]
    formulas = f"as printed in the paper: {', '.join(printed)}" if printed else "as derived"
    verdict = picture.analysis.verdict.word if picture.analysis.verdict.judged else "not judged"
    title = picture.preset.title or settings.origin
    determined = f"{picture.analysis.rank} of {STATES} quantities determined"
    return f"{title}, t = {time:.2f} s, {formulas}. Verdict (as derived): {verdict}, {determined}."


def png(frame: Frame, words: str = "") -> bytes:
    """One picture as a file, with words on a white strip below it."""
    from PIL import Image

    picture, buffer = Image.fromarray(frame), io.BytesIO()
    if words:
        strip = _strip(words, picture.width, picture.mode)
        whole = Image.new(picture.mode, (picture.width, picture.height + strip.height))
        whole.paste(picture, (0, 0))
        whole.paste(strip, (0, picture.height))
        picture = whole
    picture.save(buffer, "PNG")
    return buffer.getvalue()


def _strip(words: str, width: int, mode: str) -> "Image.Image":
    """Words in lines of a width (px), black on white."""
    from matplotlib import get_data_path
    from PIL import Image, ImageDraw, ImageFont

    size = max(round(width * FONT_SHARE), LEAST_FONT)
    font = ImageFont.truetype(f"{get_data_path()}/fonts/ttf/DejaVuSans.ttf", size)
    lines = textwrap.wrap(words, max(int(width / (CHARACTER * size)), 1))
    strip = Image.new(mode, (width, round(1.4 * size * (len(lines) + 0.5))), "white")
    draw = ImageDraw.Draw(strip)
    for k, line in enumerate(lines):
        draw.text((size // 2, round(1.4 * size * (k + 0.25))), line, fill="black", font=font)
    return strip


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
