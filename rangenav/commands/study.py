"""`rangenav study`: a study from a file, run on this machine or on a cluster, shown, exported, planned."""

import itertools
import logging
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import tyro

from rangenav.commands import study_files
from rangenav.commands.output import STOPPED, print_json
from rangenav.commands.progress import Say, describing, working
from rangenav.commands.study_files import FileName, StoreName
from rangenav.inputs import require
from rangenav.progress import CancelledError

if TYPE_CHECKING:
    from rangenav.studies.study import Study
    from rangenav.studies.tally import State

TRIAL = "timing a few points (compiles the first time)"


def plan(study: FileName, *, workers: int | None = None, json: bool = False) -> None:
    """Say what a study will take: points, runs, time and bytes. A few of its points are computed.

    Args:
        study: A shipped study's name or a path to a TOML file.
        workers: Processes that share the work, as for run; as many as this machine has cores by default.
        json: Print one JSON object.
    """
    from rangenav.commands import study_answers
    from rangenav.commands.text import layout
    from rangenav.commands.text import study as text
    from rangenav.studies import plan as planning
    from rangenav.studies import study as studies

    require(workers is None or workers >= 1, f"--workers must be 1 or more, got {workers}")
    of, count, cores = studies.load(study), workers or os.cpu_count() or 1, os.cpu_count() or 1
    taken = _refused(of, _store(study))
    with working(TRIAL, logged=True):
        planned, idle = planning.plan(of, workers=count), planning.without_effect(of)
        answer = study_answers.plan_report(of, planned, name=study, workers=count, cores=cores, without_effect=idle)
        answer |= {"store": str(_store(study, free=taken is not None)), "store_taken": taken}
    return print_json(answer) if json else layout.show(text.planned(answer))


def run(
    study: FileName,
    *,
    output: Annotated[Path | None, tyro.conf.arg(aliases=["-o"], metavar="STORE.zarr")] = None,
    workers: int | None = None,
    scheduler: Annotated[str | None, tyro.conf.arg(metavar="ADDRESS")] = None,
    dashboard: bool = False,
    json: bool = False,
) -> None:
    """Compute a study. Ctrl+C keeps what is done, and the same command goes on where it stopped.

    Args:
        study: A shipped study's name or a path to a TOML file.
        output: The store; the study's name with .zarr, in this folder, by default. If it is there, what is missing is
            computed.
        workers: Processes on this machine; as many as it has cores by default.
        scheduler: The address of a dask scheduler that runs already, such as tcp://10.0.0.1:8786.
        dashboard: Show the dashboard of dask at http://127.0.0.1:8787.
        json: Print one JSON object.
    """
    from rangenav.commands import study_answers
    from rangenav.commands.text import layout
    from rangenav.commands.text import study as text
    from rangenav.studies import study as studies

    of = studies.load(study)
    path = _store(study) if output is None else output
    require(workers is None or workers >= 1, f"--workers must be 1 or more, got {workers}")
    require(workers is None or scheduler is None, "--workers: a scheduler has its own workers")
    require(not dashboard or scheduler is None, "--dashboard: a scheduler has its own dashboard")
    began = time.monotonic()
    options = {"workers": workers or os.cpu_count() or 1, "scheduler": scheduler, "dashboard": dashboard}
    state = _computed(of, path, task=f"computing {Path(study).stem}", **options)
    answer = study_answers.run_report(of, state, store=path, seconds=time.monotonic() - began)
    return print_json(answer) if json else layout.show(text.computed(answer))


def show(store: StoreName, *, json: bool = False) -> None:
    """Show what a store holds: how much is done, where each metric is least and largest, what is invalid.

    Args:
        store: The store.
        json: Print one JSON object.
    """
    from rangenav.commands import study_answers
    from rangenav.commands.text import layout, study_store
    from rangenav.studies import store as stores

    with working(f"reading {store.name}"):
        answer = study_answers.show_report(stores.opened(store))
    return print_json(answer) if json else layout.show(study_store.shown(answer))


def _store(study: str, *, free: bool = False) -> Path:
    """The store of a study where none is named, in this folder; `free`: the first name of its kind that is free."""
    stem = Path(study).stem
    path = Path(f"{stem}.zarr")
    others = (Path(f"{stem}-{k}.zarr") for k in itertools.count(2))
    return next(one for one in others if not one.exists()) if free and path.exists() else path


def _refused(of: "Study", path: Path) -> str | None:
    """Why the study cannot be computed into a path, None if it can."""
    from rangenav.studies import running
    from rangenav.studies import store as stores

    if not path.exists():
        return None
    try:
        return running.refusal(stores.opened(path), of)
    except ValueError as error:
        return str(error)


Action = Annotated[
    Annotated[None, tyro.conf.subcommand("plan", constructor=plan)]
    | Annotated[None, tyro.conf.subcommand("run", constructor=run)]
    | Annotated[None, tyro.conf.subcommand("show", constructor=show)]
    | Annotated[None, tyro.conf.subcommand("export", constructor=study_files.export)]
    | Annotated[None, tyro.conf.subcommand("copy", constructor=study_files.copy)]
    | Annotated[None, tyro.conf.subcommand("preset", constructor=study_files.preset)],
    tyro.conf.arg(name=""),
]


def study(action: Action) -> None:
    """Compute maps and samples of many presets from a file: plan, run, show, export, copy or preset.

    Example: rangenav study run anchor-map

    Args:
        action: What to do.
    """


def _computed(of: "Study", path: Path, *, task: str, **options: Any) -> "State":
    """Compute a study into a store, and show how far it is; a stop ends the program with what is kept."""
    from rangenav.studies import running

    last: list[State] = []
    asked = threading.Event()
    try:
        with describing(task) as say:
            say(0.0, TRIAL)
            shown = _shown(of, say, last)

            def stopping() -> None:
                logging.getLogger("asyncio").setLevel(logging.CRITICAL)  # dask's connections end within a task
                asked.set()
                say(None, "stopping; the parts that are finished are kept")
                if not last:
                    raise KeyboardInterrupt

            with _stoppable(stopping):
                return running.run(of, path, **options, shown=shown, cancelled=asked.is_set)
    except (KeyboardInterrupt, CancelledError):
        print(f"{path}: {running.stopped(path)}", file=sys.stderr)
        raise SystemExit(STOPPED) from None


def _shown(of: "Study", say: Say, last: "list[State]") -> "Callable[[State], None]":
    """What says how far a study is, and keeps the last state in a list."""
    from rangenav.commands.text import study as text

    def shown(state: "State") -> None:
        last[:] = [state]
        say(state.done / state.parts, text.progress(state, of.watched, len(of.file.estimators)))

    return shown


@contextmanager
def _stoppable(stopping: Callable[[], None]) -> Iterator[None]:
    """SIGTERM, with which batch systems end a program, stops a study as Ctrl+C does; a second one changes nothing.

    `stopping` is called in the main thread, and may raise KeyboardInterrupt.
    """

    def stop(_number: int, _frame: object) -> None:
        for number in before:
            signal.signal(number, signal.SIG_IGN)
        stopping()

    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    for number, handler in before.items():
        if handler is not signal.SIG_IGN:  # a shell in the background ignores Ctrl+C
            signal.signal(number, stop)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
