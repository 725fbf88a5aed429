"""Progress on stderr for what takes longer than a second: on a terminal as it goes on, in a log a line now and then.

A log gets lines of a study only, which may take hours: the first one after half a minute, and then the rarer the longer
it takes.
"""

import contextlib
import sys
import threading
import time
from collections.abc import Callable, Iterator

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn
from rich.table import Column

PATIENT = 1.0
"""s: what is done sooner shows no progress."""
WIDTH = 12
"""Columns of a bar that has a text behind it."""
LINE_EVERY, LINES = 30.0, 20
"""s between two lines of a log; after ten minutes, this share of the time so far."""
Say = Callable[[float | None, str], None]
"""Takes the share that is done, None for no other one, and a text."""


@contextlib.contextmanager
def working(task: str, *, logged: bool = False) -> Iterator[None]:
    """Show that a task of unknown length is being worked on; `logged`: also in a log, once."""
    console = _terminal()
    if console is None and logged:
        with _Log(task) as log:
            log.say("")
            yield
        return
    if console is None:
        yield
        return
    status = console.status(f"{task} …")
    timer = threading.Timer(PATIENT, status.start)
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
        timer.join()
        status.stop()


@contextlib.contextmanager
def counting(task: str) -> Iterator[Callable[[float], None]]:
    """Show how far a task has come: the function given takes the share that is done, 0 to 1."""
    console = _terminal()
    if console is None:
        yield lambda _share: None
        return
    with Progress(console=console, transient=True) as bar:
        number = bar.add_task(task, total=1.0)
        yield lambda share: bar.update(number, completed=share)


@contextlib.contextmanager
def describing(task: str) -> Iterator[Say]:
    """The same with a text behind the bar, and in a log."""
    console = _terminal()
    if console is None:
        with _Log(task) as log:
            yield lambda _share, words: log.say(words)
        return
    words = TextColumn("{task.fields[words]}", table_column=Column(ratio=1, overflow="fold"))  # folded, and not cut
    columns = (TextColumn("{task.description}"), BarColumn(WIDTH), words)
    with Progress(*columns, console=console, transient=True, expand=True) as bar:
        number = bar.add_task(task, total=1.0, words="")
        yield lambda share, words: bar.update(number, completed=share, words=words)


class _Log:
    """The newest text of a task as a line of stderr, now and then, while it is worked on."""

    def __init__(self, task: str) -> None:
        self._task, self._words, self._ended = task, "", threading.Event()
        self._thread = threading.Thread(target=self._write, daemon=True)

    def say(self, words: str) -> None:
        """The newest text; it is written when the next line is due."""
        self._words = words

    def __enter__(self) -> "_Log":
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ended.set()
        self._thread.join()

    def _write(self) -> None:
        began = time.monotonic()
        while not self._ended.wait(max(LINE_EVERY, (time.monotonic() - began) / LINES)):
            print(": ".join(filter(None, (self._task, self._words))), file=sys.__stderr__, flush=True)


def _terminal() -> Console | None:
    """The real stderr, while the command's own is kept for messages; None if nobody watches it."""
    if sys.__stderr__ is None:
        return None
    console = Console(file=sys.__stderr__)
    return console if console.is_terminal and not console.is_dumb_terminal else None
