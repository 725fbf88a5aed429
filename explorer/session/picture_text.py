"""What the 3-D picture shows, as a text for readers of the screen; written when nothing has moved for a moment."""

import html

import viser

from explorer.model import scene_text
from explorer.model.compute import Picture
from explorer.web.accessibility import spoken

REST = 0.6
"""s without a change, after which the text follows: a picture that plays would be spoken over and over."""
TEXT = '<div class="rn-unseen rn-answer" role="img" {} aria-label="3-D picture. {}"></div>'


class PictureText:
    """The text of one visitor's picture."""

    def __init__(self, gui: viser.GuiApi) -> None:
        self._handle = gui.add_html("")
        self._seen: tuple[Picture, float] | None = None
        self._due: float | None = None
        """When to write (s, monotonic); None if the text is that of what is shown."""

    def follow(self, picture: Picture, time: float | None, now: float) -> None:
        """Note what is shown, and at which moment (s) of the flight; None while it plays: a running picture has no
        text."""
        if time is None:
            self._seen = self._due = None
        elif self._seen is None or self._seen[0] is not picture or self._seen[1] != time:
            self._seen, self._due = (picture, time), now + REST

    def wait(self, now: float) -> float | None:
        """How long (s) until the text is due; None if it is written."""
        return None if self._due is None else max(0.0, self._due - now)

    def write_if_due(self, now: float) -> None:
        """Write the text, if nothing has moved for a moment."""
        if self._due is None or self._seen is None or now < self._due:
            return
        self._due = None
        said = spoken("picture", scene_text.spoken(*self._seen))
        content = TEXT.format(said, html.escape(scene_text.written(*self._seen)))
        if content != self._handle.content:
            self._handle.content = content
