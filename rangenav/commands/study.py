"""`rangenav study`: a study from a file, run on this machine or on a cluster, shown, exported, planned."""

import logging
import os
import signal
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro

from rangenav.commands import study_files
from rangenav.commands.output import print_json
from rangenav.commands.progress import describing, working
from rangenav.commands.study_files import FileName, StoreName
from rangenav.inputs import require

if TYPE_CHECKING:
    from rangenav.studies.running import State

TRIAL = "timing a few points (compiles the first time)"
STOPPED = 130
"""The exit code of a program that Ctrl+C ended."""


def plan(study: FileName, *, json: bool = False) -> None:
    """Say what a study will take: points, runs, time and bytes. A few of its points are computed.

    Args:
        study: A shipped study's name or a path to a TOML file.
        json: Print one JSON object.
    """
    from rangenav.commands import study_answers
    from rangenav.commands.text import layout
    from rangenav.commands.text import study as text
    from rangenav.studies import plan as planning
    from rangenav.studies import study as studies

    of = studies.load(study)
    with working(TRIAL, logged=True):
        answer = study_answers.plan_report(of, planning.plan(of, workers=os.cpu_count() or 1), name=study)
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
    from rangenav.studies import running
    from rangenav.studies import study as studies

    of = studies.load(study)
    path = Path(f"{Path(study).stem}.zarr") if output is None else output
    require(workers is None or workers >= 1, f"--workers must be 1 or more, got {workers}")
    require(workers is None or scheduler is None, "--workers: a scheduler has its own workers")
    require(not dashboard or scheduler is None, "--dashboard: a scheduler has its own dashboard")
    began, last, count = time.monotonic(), [], workers or os.cpu_count() or 1
    try:
        with describing(f"computing {Path(study).stem}") as say:
            say(0.0, TRIAL)

            def shown(state: "State") -> None:
                last[:] = [state]
                say(state.done / state.parts, text.progress(state, of.watched))

            with _stoppable(lambda: say(None, "stopping; the parts that are finished are kept")):
                state = running.run(of, path, workers=count, scheduler=scheduler, dashboard=dashboard, shown=shown)
    except KeyboardInterrupt:
        logging.getLogger("asyncio").setLevel(logging.CRITICAL)  # dask's connections end in the middle of a task
        kept = running.kept(path, last[0].parts) if last else "nothing was computed yet"
        print(f"{path}: stopped; {kept}", file=sys.stderr)
        raise SystemExit(STOPPED) from None
    answer = study_answers.run_report(of, state, store=path, seconds=time.monotonic() - began)
    return print_json(answer) if json else layout.show(text.computed(answer))


def show(store: StoreName, *, json: bool = False) -> None:
    """Show what a store holds: how much is done, where each metric is least and largest, what is invalid.

    Args:
        store: The store.
        json: Print one JSON object.
    """
    from rangenav.commands import study_answers
    from rangenav.commands.text import layout
    from rangenav.commands.text import study as text
    from rangenav.studies import store as stores

    with working(f"reading {store.name}"):
        answer = study_answers.show_report(stores.opened(store))
    return print_json(answer) if json else layout.show(text.shown(answer))


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


@contextmanager
def _stoppable(stopping: Callable[[], None]) -> Iterator[None]:
    """SIGTERM, with which batch systems end a program, stops a study as Ctrl+C does; a second one changes nothing.

    `stopping` tells the person, because the workers take seconds to end.
    """

    def stop(_number: int, _frame: object) -> None:
        for number in before:
            signal.signal(number, signal.SIG_IGN)
        stopping()
        raise KeyboardInterrupt

    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    for number, handler in before.items():
        if handler is not signal.SIG_IGN:  # a shell in the background ignores Ctrl+C
            signal.signal(number, stop)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
