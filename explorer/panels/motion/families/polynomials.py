"""Polynomials: one piece per line, as in uav_trajectories files. Jumps at the knots are named below the text."""

import html
from typing import Literal

from explorer.model import palette
from explorer.panels.motion.families.editor import SignalSlot
from explorer.panels.motion.families.table import Table
from explorer.widgets.controls import Choice, Text
from explorer.widgets.form import Form
from explorer.widgets.section import Section
from rangenav.signals import Piece, Polynomials, polynomials
from rangenav.signals.polynomials import Coefficients

AXES = ("x", "y", "z", "yaw")
COLUMNS = ("duration", *(f"{axis}^{power}" for axis in AXES for power in range(8)))
MAX_TEXT = 900_000
"""Characters: 2000 pieces with all their digits."""
MAX_JUMPS = 4
ENDS: dict[Literal["hold", "repeat"], str] = {"hold": "hold: it stays where it is", "repeat": "repeat: it begins anew"}


class PolynomialsEditor:
    """The pieces as text, and what the signal does after the last piece."""

    def __init__(self, form: Form, slot: SignalSlot) -> None:
        self._pieces: tuple[Piece, ...] = ()
        self._text_of_pieces, self._formatted = "", self._pieces
        """The text of the pieces, and the pieces for which it was written."""
        self._section = section = Section(form)
        with section:
            hint = "After the last piece the signal holds where it is, or begins anew."
            self._ends = Choice(section, "at the end", ENDS, hint=hint)
            hint = (
                f"One piece per line, as in a uav_trajectories file: its duration (s), then eight ascending "
                f"coefficients in its own time for x, y, z ({slot.unit}) and yaw (rad). A header line may stay."
            )
            self._text = Text(section, "pieces", hint=hint, longest=MAX_TEXT, lines=True)
            self._jumps = form.gui.add_html("", visible=False)

    def refresh(self) -> None:
        """Name the jumps at the knots. Raises InvalidInputError after showing the reason below the text."""
        with self._section.catching():
            signal, self._text_of_pieces = self._typed()
        self._pieces = signal.pieces
        self._show_jumps(polynomials.complaints(signal))

    def read(self) -> Polynomials:
        """The pieces as typed. Raises InvalidInputError."""
        signal, _ = self._typed()
        return signal

    def write(self, signal: Polynomials, base: Polynomials | None) -> None:
        """Show pieces."""
        self._pieces = self._formatted = signal.pieces
        self._text_of_pieces = TABLE.format(signal.pieces)
        self._text.write(self._text_of_pieces, TABLE.format(base.pieces) if base else None)
        self._ends.write(signal.ends, base and base.ends)

    def show(self, visible: bool) -> None:
        """Show or hide it."""
        self._section.show(visible)

    def _typed(self) -> tuple[Polynomials, str]:
        """The signal as typed, and the text of its pieces."""
        with self._section.checking():
            text = _without_header(self._text.read())
            pieces = self._pieces if text == self._text_of_pieces else TABLE.parse(text, self._formatted)
            return Polynomials(pieces=pieces, ends=self._ends.read()), text

    def _show_jumps(self, jumps: tuple[str, ...]) -> None:
        """Name the jumps at the knots. A jump is no error, for a file may have one; but no vehicle can fly it."""
        more = len(jumps) - MAX_JUMPS
        lines = [f"▲ {html.escape(line)}" for line in jumps[:MAX_JUMPS]]
        lines += [f"… and {more} more"] if more > 0 else []
        style = f"font-size:0.85em;padding:0.1em 0.9em 0.6em;color:{palette.JUMP_NOTICE}"
        content = f'<div style="{style}">{"<br>".join(lines)}</div>'
        if content != self._jumps.content:
            self._jumps.content = content
        self._jumps.visible = bool(lines)


def _without_header(text: str) -> str:
    """The lines without the header, if the first one is a header, and without commas at their ends."""
    lines = text.split("\n")
    if lines and lines[0].lower().startswith("duration"):
        lines[0] = ""
    return "\n".join(line.rstrip().rstrip(",") for line in lines)


def _piece(cells: list[float]) -> Piece:
    x, y, z, yaw = (tuple(cells[1 + 8 * k : 9 + 8 * k]) for k in range(4))
    return Piece(duration=cells[0], x=_coefficients(x), y=_coefficients(y), z=_coefficients(z), yaw=_coefficients(yaw))


def _coefficients(values: tuple[float, ...]) -> Coefficients:
    a, b, c, d, e, f, g, h = values
    return a, b, c, d, e, f, g, h


def _cells(piece: Piece) -> list[float]:
    return [piece.duration, *piece.x, *piece.y, *piece.z, *piece.yaw]


TABLE = Table(COLUMNS, _piece, _cells)
