"""A signal that no editor can show, such as a sum as an angular velocity: it is described, and stays as it is."""

import html

from explorer.panels.motion.families import description
from explorer.widgets.form import Form
from explorer.widgets.section import Section
from rangenav.signals import AngularVelocity, Multisine

LINE = (
    '<div style="padding:0.1em 0.9em 0.6em;font-size:0.85em">Here: {}. It has no controls and is kept as it is; '
    "another family starts from what it does.</div>"
)


class FileSignalEditor:
    """The signal's description."""

    def __init__(self, form: Form) -> None:
        self._section = section = Section(form)
        self._signal: AngularVelocity = Multisine()
        with section:
            self._line = form.gui.add_html("")

    def refresh(self) -> None:
        """Nothing follows from a signal without controls."""

    def read(self) -> AngularVelocity:
        """The signal as it was written."""
        return self._signal

    def write(self, signal: AngularVelocity, base: AngularVelocity | None) -> None:
        """Show the description of a signal."""
        self._signal = signal
        self._line.content = LINE.format(html.escape(description(signal)))

    def show(self, visible: bool) -> None:
        """Show or hide it."""
        self._section.show(visible)
