"""A complaint: the sentence below some controls that says why their values cannot be used."""

import html
import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import viser

from explorer.model import palette
from explorer.model.glossary import in_labels

ALERT = f"color:{palette.ERROR};font-weight:600;font-size:0.85em;line-height:1.4;padding:0.2em 0.8em 0.6em"
ALERT += ";overflow-wrap:anywhere"
EDGE = f'div:has(> p > label[for="{{}}"]) + div input{{{{border-color:{palette.ERROR} !important}}}}'
COLUMN = re.compile(r"\(column (\d+)\)$")
EXCERPT = 48
"""Characters of a long text shown around the column of a complaint."""


class Complaint:
    """One sentence below the controls that caused it."""

    def __init__(self, gui: viser.GuiApi, *, order: float | None = None) -> None:
        self._boxes: tuple[str, ...] = ()
        self._sentence = ""
        self._line = gui.add_html("", visible=False, order=order)

    @property
    def content(self) -> str:
        """The HTML that is shown; empty while there is nothing to complain about."""
        return self._line.content if self._line.visible else ""

    def say(self, sentence: str, *, text: str = "", more: Sequence[str] = (), boxes: Sequence[str] = ()) -> None:
        """Show a sentence, marked by a sign as well as a colour, and `more` sentences below it, one line each.

        With a `text`, show an excerpt of it that points at the column which the sentence names. `boxes` are the ids of
        the text boxes that get a red edge meanwhile.
        """
        self._boxes, self._sentence = tuple(boxes), sentence
        sentence, more = in_labels(sentence), [in_labels(line) for line in more]
        lines = "".join(f'<div style="font-weight:400;padding-left:1em">• {html.escape(line)}</div>' for line in more)
        alert = f"⚠ {html.escape(sentence)}{pointer(text, sentence)}{lines}"
        edges = "".join(EDGE.format(box) for box in boxes)
        shown = f'<div role="alert" style="{ALERT}">{alert}</div>{f"<style>{edges}</style>" if edges else ""}'
        if shown != self._line.content:
            self._line.content = shown
        self._line.visible = True

    def says(self, sentence: str) -> bool:
        """Whether a sentence is shown."""
        return self._line.visible and self._sentence == sentence

    def is_about(self, box: str) -> bool:
        """Whether the sentence that is shown is about the text box of an id."""
        return self._line.visible and box in self._boxes

    def clear(self) -> None:
        """Hide the sentence."""
        self._line.visible = False

    def remove(self) -> None:
        """Remove the complaint from the page."""
        self._line.remove()


class InvalidInputError(Exception):
    """The chosen values are no valid input. Its cause is the ValueError that says why; `refresh` shows that."""

    def __init__(self, complaint: Complaint | None = None, text: str = "") -> None:
        """`complaint` is the one below the control, if one is the cause; the reason may name a column of the `text`."""
        super().__init__()
        self.complaint, self.text = complaint, text
        self.others: tuple[str, ...] = ()
        """Why other controls hold no valid input either."""


class ReasonsError(ValueError):
    """Several values that cannot be used, each with its reason. As a sentence it is the first."""

    def __init__(self, reasons: Sequence[str]) -> None:
        """reasons: one at least."""
        super().__init__(reasons[0])
        self.reasons = tuple(reasons)


def all_of(*reads: Callable[[], Any]) -> list[Any]:
    """What each of these reads. Raises ReasonsError with the reasons of all that raise ValueError."""
    values: list[Any] = []
    reasons: list[str] = []
    for read in reads:
        try:
            values.append(read())
        except ValueError as error:
            reasons += reasons_of(error)
    if reasons:
        raise ReasonsError(reasons)
    return values


def reasons_of(error: BaseException | None) -> tuple[str, ...]:
    """The reasons that an error names, the first one first."""
    return error.reasons if isinstance(error, ReasonsError) else (str(error),)


class Refusals:
    """The errors of steps that are all taken although some fail, so that the reason of each is shown."""

    def __init__(self) -> None:
        self._errors: list[InvalidInputError | ValueError] = []

    @contextmanager
    def collecting(self) -> Iterator[None]:
        """Keep the InvalidInputError or ValueError of a step."""
        try:
            yield
        except (InvalidInputError, ValueError) as error:
            self._errors.append(error)

    def raise_first(self) -> None:
        """Raise the first error that was kept, with the reasons of the others; do nothing if none was."""
        if not self._errors:
            return
        first, *others = self._errors
        if isinstance(first, InvalidInputError):
            first.others += tuple(reason for error in others for reason in _reasons(error))
        raise first


def _reasons(error: InvalidInputError | ValueError) -> tuple[str, ...]:
    """Why controls hold no valid input."""
    if isinstance(error, InvalidInputError):
        return (*reasons_of(error.__cause__), *error.others)
    return reasons_of(error)


def pointer(text: str, sentence: str) -> str:
    """An excerpt of the text with a caret below the column that the sentence names, as HTML; empty if it names none."""
    named = COLUMN.search(sentence)
    if named is None or not text:
        return ""
    column = min(int(named[1]), len(text) + 1)
    first = max(0, column - 1 - EXCERPT // 2)
    line = "".join(c if c.isprintable() else "·" for c in text[first : first + EXCERPT])
    style = "margin:0.3em 0 0;font-weight:400;overflow-x:auto"
    return f'<pre style="{style}">{html.escape(line)}\n{" " * (column - 1 - first)}^</pre>'
