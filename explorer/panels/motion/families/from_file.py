"""A signal that only a file can bring, such as a sum as an angular velocity: it is named, and kept as it is."""

import html

from explorer.panels.motion.families import SignalSlot
from explorer.widgets.form import Form, Section
from rangenav.signals import Multisine, Sum, Turning

LABEL = "as in the file"
NAMES = {
    "Multisine": "sines",
    "Formula": "formulas",
    "Waypoints": "a curve through points",
    "MinimumSnap": "a minimum-snap curve",
    "Polynomials": "polynomials",
    "Flown": "flown",
}
LINE = (
    '<div style="padding:0.1em 0.9em 0.6em;font-size:0.85em">Here: {}. It has no controls and is kept as it is; '
    "another family starts from what it does.</div>"
)


class FileSignalEditor:
    """What there is, in words."""

    def __init__(self, form: Form, slot: SignalSlot) -> None:
        self._section = section = Section(form)
        self._signal: Turning = Multisine()
        with section:
            self._line = form.gui.add_html("")

    def read(self) -> Turning:
        """The signal as it was written."""
        return self._signal

    def write(self, signal: Turning, base: Turning | None) -> None:
        """Keep a signal."""
        self._signal = signal
        self._line.content = LINE.format(html.escape(description(signal)))

    def show(self, visible: bool) -> None:
        """Show or hide it."""
        self._section.show(visible)


def description(signal: Turning) -> str:
    """What kind of signal it is."""
    if isinstance(signal, Sum):
        return f"{description(signal.base)} plus {description(signal.wiggle)}"
    return NAMES[type(signal).__name__]
