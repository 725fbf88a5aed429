"""A report for a person: the answer on the first line, with a sign, then a few named groups of lines; 80 columns.

paper-slow   ✓ observable in every window of 6 s
what can be seen   rank 13 of 13 lifted, 9 of 9 nonlinear
"""

import os
import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console
from rich.text import Text

from rangenav.commands.text.lines import COLUMNS, CONTINUED, folded_command, wrapped
from rangenav.verdict import Sign

NAMES = 19
"""Columns of a group's name and the space after it."""
NEXT = "next"
COLORS = {"✓": "green", "✗": "red", "!": "yellow", "?": "cyan"}


@dataclass(frozen=True, kw_only=True)
class Group:
    """What answers one question."""

    name: str
    lines: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class Report:
    """One command's answer."""

    subject: str
    """What the answer is about: a preset's or a file's name."""
    sign: Sign
    answer: str
    title: str = ""
    """The preset's title; empty if it has none."""
    groups: tuple[Group, ...]


def group(name: str, *lines: str | Iterable[str] | None) -> tuple[Group, ...]:
    """A group of the lines that say something; nothing at all if none does."""
    said: list[str] = []
    for line in lines:
        said += [line] if isinstance(line, str) else list(line or ())
    kept = tuple(line for line in said if line)
    return (Group(name=name, lines=kept),) if kept else ()


def next_commands(*commands: str) -> tuple[Group, ...]:
    """What a person may type next, one command a line."""
    return group(NEXT, *(f"rangenav {command}" for command in commands))


def rendered(report: Report, columns: int = COLUMNS) -> list[str]:
    """The lines of a report, wrapped to so many columns."""
    lines = [*head_lines(report, columns), *([report.title] if report.title else [])]
    lines += [""] if report.groups and report.groups[0].name != NEXT else []
    for one in report.groups:
        name = one.name
        if name == NEXT:
            lines.append("")
        for text in one.lines:
            fold = folded_command if one.name == NEXT else wrapped
            for part in fold(text, columns - NAMES):
                lines.append(f"{name:<{NAMES}}{part}")
                name = ""
    return lines


def head_lines(report: Report, columns: int) -> list[str]:
    """The answer: one line, or more if it is long."""
    return wrapped(f"{report.subject}   {report.sign} {report.answer}", columns, CONTINUED)


def show(report: Report) -> None:
    """Print a report on stdout; in colour and bold on a terminal, unless NO_COLOR is set."""
    console = Console(highlight=False)
    columns = min(COLUMNS, console.width) if console.is_terminal else COLUMNS
    head = len(head_lines(report, columns))
    for number, line in enumerate(rendered(report, columns)):
        text = Text(line)
        if console.no_color:
            pass
        elif number < head:
            start = len(report.subject) + 3 if number == 0 else 0
            text.stylize("bold", 0, start)
            text.stylize(f"bold {COLORS[report.sign]}", start)
        elif number == head and report.title:
            text.stylize("dim")
        else:
            text.stylize("cyan", 0, NAMES)
            for mark in re.finditer(r"(?:^|(?<=\s))[✓✗](?=\s)", line):
                text.stylize(COLORS[mark.group()], *mark.span())
        console.print(text, soft_wrap=True)


def subject(name: str | os.PathLike[str]) -> str:
    """A preset or a file as a report names it: without its folders."""
    return Path(name).name or str(name)


def argument(name: str | os.PathLike[str]) -> str:
    """The same as it must be typed again: quoted if it has blanks."""
    text = str(name)
    return f"'{text}'" if " " in text else text


def met(reached: bool) -> str:
    """Whether a requirement is met, with its sign."""
    return "✓ met" if reached else "✗ not met"
