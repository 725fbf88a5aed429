"""Progress on stderr for what takes longer than a second; only on a terminal."""

import contextlib
import sys
import threading
from collections.abc import Callable, Iterator

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn

PATIENT = 1.0
"""s: what is done sooner shows no progress."""


@contextlib.contextmanager
def working(task: str) -> Iterator[None]:
    """Show that a task of unknown length is being worked on."""
    console = _terminal()
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
def describing(task: str) -> Iterator[Callable[[float, str], None]]:
    """The same with a text behind the bar: the function given takes the share that is done, and the text."""
    console = _terminal()
    if console is None:
        yield lambda _share, _words: None
        return
    columns = (TextColumn("{task.description}"), BarColumn(), TextColumn("{task.fields[words]}"))
    with Progress(*columns, console=console, transient=True) as bar:
        number = bar.add_task(task, total=1.0, words="")
        yield lambda share, words: bar.update(number, completed=share, words=words)


def _terminal() -> Console | None:
    """The real stderr, while the command's own is kept for messages; None if nobody watches it."""
    if sys.__stderr__ is None:
        return None
    console = Console(file=sys.__stderr__)
    return console if console.is_terminal and not console.is_dumb_terminal else None
