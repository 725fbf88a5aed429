"""Sentences and small tables below controls, as HTML with all text escaped."""

import html
from collections.abc import Iterable, Sequence

from rangenav.number_format import unbroken

NOTE = '<div style="padding:0 0.9em 0.5em;font-size:0.85em;line-height:1.4;overflow-wrap:anywhere">{}</div>'
CELL = '<{0} style="text-align:left;padding:0.1em 0.6em 0.1em 0;vertical-align:top;overflow-wrap:normal">{1}</{0}>'


def escaped(sentence: str) -> str:
    """A sentence as HTML: escaped, and with each unit on the line of its number."""
    return html.escape(unbroken(sentence))


def bullets(sentences: Iterable[str]) -> str:
    """One line for each sentence."""
    return "".join(f"<div>• {escaped(sentence)}</div>" for sentence in sentences)


def folded(summary: str, sentences: Iterable[str]) -> str:
    """Sentences that open with a click on their summary."""
    return f"<details><summary>{html.escape(summary)}</summary>{bullets(sentences)}</details>"


def upper_first(label: str) -> str:
    """A label that begins with a capital, as those of buttons do."""
    return f"{label[:1].upper()}{label[1:]}"


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table with a row of column names."""
    lines = [_row("th", head) if head else "", *(_row("td", row) for row in rows)]
    return f'<table style="border-collapse:collapse;font-variant-numeric:tabular-nums">{"".join(lines)}</table>'


def _row(kind: str, cells: Sequence[str]) -> str:
    return f"<tr>{''.join(CELL.format(kind, escaped(cell)) for cell in cells)}</tr>"
