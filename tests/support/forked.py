"""Programs as processes that have imported everything before they begin: each is forked from one that has.

An import of the library with dask takes a second of a processor, and a test of faults starts a process for each fault.
"""

import importlib
import logging
import multiprocessing
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing.context import ForkServerProcess
from pathlib import Path

IMPORTED = [
    "distributed.cli.dask_worker",
    "rangenav.commands.typed",
    "rangenav.commands.study",
    "rangenav.studies.tasks",
]


class Forked:
    """A program that runs as a process."""

    def __init__(self, process: ForkServerProcess, folder: Path) -> None:
        self._process, self._folder = process, folder

    def kill(self) -> None:
        """End it at once."""
        self._process.kill()

    def ended(self, seconds: float) -> tuple[int | None, str, str]:
        """Its exit code, and what it wrote to standard output and to standard error."""
        self._process.join(seconds)
        out, err = (_stream(self._folder, name).read_text() for name in ("out", "err"))
        return self._process.exitcode, out, err


@contextmanager
def forked(module: str, *arguments: object, folder: Path) -> Iterator[Forked]:
    """`python -m module arguments`, whose streams go to files in a folder; gone at the end."""
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(IMPORTED)
    folder.mkdir()
    process = context.Process(target=_run, args=(module, [str(one) for one in arguments], folder))
    process.start()
    try:
        yield Forked(process, folder)
    finally:
        process.kill()
        process.join()


def _stream(folder: Path, name: str) -> Path:
    return folder / f"{name}.txt"


class _StandardError:
    """What is standard error when a line is logged: the program may keep that for itself before dask is imported."""

    def write(self, text: str) -> None:
        sys.stderr.write(text)

    def flush(self) -> None:
        sys.stderr.flush()


def _run(module: str, arguments: list[str], folder: Path) -> None:
    for descriptor, name in ((1, "out"), (2, "err")):
        os.dup2(os.open(_stream(folder, name), os.O_WRONLY | os.O_CREAT), descriptor)
    for name in list(logging.root.manager.loggerDict):
        for handler in logging.getLogger(name).handlers:
            if isinstance(handler, logging.StreamHandler):
                handler.setStream(_StandardError())
    sys.argv = [module, *arguments]
    importlib.import_module(module).main()
