"""How live the page is: all computing stages after one slider moved, a slider event in Chromium, and the start-up time.

The default preset is the one the page opens on. Each set of stages is timed with fresh values, so no cache answers.
"""

import os
import shutil
import socket
import subprocess
import sys
import tempfile
import time
import urllib.request
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import msgspec
import numpy as np
from timing import Target, report, versions

from explorer.compute import compute, warm_up
from explorer.settings import Settings
from rangenav import preset

DEFAULT_PRESET = "paper-slow"
MOVES, WARM_MOVES, SLIDER_EVENTS, STARTS = 100, 5, 40, 3
STEP = 1e-3
"""Relative change of the moved value from one event to the next."""
STAGES_P95, EVENT_MEDIAN, EVENT_P95 = 33.0, 100.0, 200.0
"""ms"""
WARM_START, FIRST_START = 3.0, 20.0
"""s until the page answers."""
PATIENCE = 60.0
BROWSER_TESTS = Path(__file__).parent.parent / "tests" / "browser"


def main() -> None:
    """Measure, print."""
    warm_up(lambda share, words: None)
    stages = {name: _milliseconds(moved) for name, moved in MOVED.items()}
    events, notes = _slider_events()
    warm, first = _starts()
    rows = [_row(f"stages after {name} moved", elapsed) for name, elapsed in stages.items()]
    rows += [_row(f"{name}, slider event to changed plot data", elapsed) for name, elapsed in events.items()]
    rows += [_row("page answers, warm caches", 1e3 * warm), _row("page answers, nothing compiled yet", 1e3 * first)]
    targets = [
        Target(name=f"stages, {name} moved, p95", value=_p95(elapsed), bound=STAGES_P95, at_least=False, unit=" ms")
        for name, elapsed in stages.items()
    ]
    for name, elapsed in events.items():
        median = float(np.median(elapsed))
        targets.append(Target(name=f"{name}, median", value=median, bound=EVENT_MEDIAN, at_least=False, unit=" ms"))
        targets.append(Target(name=f"{name}, p95", value=_p95(elapsed), bound=EVENT_P95, at_least=False, unit=" ms"))
    targets.append(Target(name="warm start", value=float(np.median(warm)), bound=WARM_START, at_least=False, unit=" s"))
    targets.append(Target(name="first start", value=float(np.max(first)), bound=FIRST_START, at_least=False, unit=" s"))
    report(
        "live",
        title=f"The page on {DEFAULT_PRESET}",
        columns=("", "median ms", "p95 ms", "worst ms"),
        rows=rows,
        targets=targets,
        notes=notes,
        figures={"versions": versions("numpy", "numba", "viser")},
    )


def _row(name: str, milliseconds: np.ndarray) -> tuple[str, ...]:
    figures = (np.median(milliseconds), _p95(milliseconds), np.max(milliseconds))
    return name, *(f"{figure:.1f}" for figure in figures)


def _p95(values: np.ndarray) -> float:
    return float(np.percentile(values, 95))


def _gain(chosen: preset.Preset, factor: float) -> preset.Preset:
    riccati = msgspec.structs.replace(chosen.gains.riccati, q=chosen.gains.riccati.q * factor)
    return msgspec.structs.replace(chosen, gains=msgspec.structs.replace(chosen.gains, riccati=riccati))


def _amplitude(chosen: preset.Preset, factor: float) -> preset.Preset:
    first, *others = chosen.path.tones
    tones = (msgspec.structs.replace(first, amplitude=first.amplitude * factor), *others)
    return msgspec.structs.replace(chosen, path=msgspec.structs.replace(chosen.path, tones=tones))


def _window(chosen: preset.Preset, factor: float) -> preset.Preset:
    requirement = msgspec.structs.replace(chosen.requirement, window=chosen.requirement.window * factor)
    return msgspec.structs.replace(chosen, requirement=requirement)


MOVED: dict[str, Callable[[preset.Preset, float], preset.Preset]] = {
    "a gain": _gain,
    "a path amplitude": _amplitude,
    "the window δ": _window,
}


def _milliseconds(moved: Callable[[preset.Preset, float], preset.Preset]) -> np.ndarray:
    """Time of `compute` after each of many moves of one slider."""
    chosen, elapsed = preset.load(DEFAULT_PRESET), np.empty(WARM_MOVES + MOVES)
    compute(Settings(preset=chosen))
    for move in range(len(elapsed)):
        settings = Settings(preset=moved(chosen, 1 + STEP * (move + 1)))
        begin = time.perf_counter()
        compute(settings)
        elapsed[move] = 1e3 * (time.perf_counter() - begin)
    return elapsed[WARM_MOVES:]


def _starts() -> tuple[np.ndarray, np.ndarray]:
    """Seconds from starting the program to an answering page: with warm caches, and with nothing compiled."""
    warm = np.array([_start(os.environ) for _ in range(STARTS)])
    first = np.empty(STARTS)
    for run in range(STARTS):
        with tempfile.TemporaryDirectory() as folder:
            first[run] = _start(os.environ | {"NUMBA_CACHE_DIR": folder})
    return warm, first


def _start(environment: "os._Environ[str] | dict[str, str]") -> float:
    begin = time.perf_counter()
    with serving(environment) as url:
        _wait_for_answer(url, begin)
        return time.perf_counter() - begin


@contextmanager
def serving(environment: "os._Environ[str] | dict[str, str]") -> Iterator[str]:
    """The program in a process of its own on a free port; yields its URL at once, stops it at the end."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    command = [sys.executable, "-m", "explorer", "--no-browser", "--port", str(port)]
    process = subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        yield f"http://127.0.0.1:{port}"
    finally:
        process.terminate()
        process.wait(timeout=10)


def _wait_for_answer(url: str, begin: float) -> None:
    while True:
        try:
            with urllib.request.urlopen(url, timeout=1) as answer:
                answer.read()
            return
        except OSError:
            if time.perf_counter() - begin > PATIENCE:
                raise
            time.sleep(0.01)


def _slider_events() -> tuple[dict[str, np.ndarray], list[str]]:
    """Milliseconds from slider events in Chromium to changed plot data, or the reason why there are none."""
    chromium = shutil.which("chromium")
    if chromium is None:
        return {}, ["chromium is not installed: slider events were not measured"]
    return {}, ["slider events: to do"]


if __name__ == "__main__":
    main()
