"""How fast the page reacts: all stages after one move, a slider event in Chromium, a waypoint that is dragged through
the socket, and the start-up time.

The default preset is the one that the page opens with. Every set of stages is timed with new values, so that no cache
holds the answer. With `--load` stages and drags are measured once more on two cores of which another process keeps one
busy; slider events and start-up are then left out.
"""

import argparse
import contextlib
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from unittest import mock

import msgspec
import numpy as np
from timing import Target, missing, report, versions

from explorer.model import conversion
from explorer.model.compute import compile_kernels, compute
from explorer.model.settings import Settings
from rangenav import preset
from rangenav.signals import MinimumSnap, Multisine, Waypoints, waypoints
from tests.support.wire import Wire

DEFAULT_PRESET = "paper-slow"
MOVES, WARM_MOVES, SLIDER_EVENTS, STARTS = 100, 5, 40, 3
STEP = 1e-3
"""Relative change of the moved value from one event to the next."""
STAGES_P95, EVENT_MEDIAN, EVENT_P95 = 16.0, 100.0, 200.0
DRAG_P95, MIN_PICTURES = 100.0, 15.0
"""ms from a position that is sent to the picture of that position; and pictures per second during a drag."""
DRAG_RATE, DRAGS = 20.0, 100
"""Positions per second, as many as the browser sends at most; and positions in all."""
CURVES = ("waypoints", "closed waypoints", "minimum snap")
WARM, FIRST = "page answers, warm caches", "page answers, nothing compiled yet"
MAX_START = {WARM: 3.0, FIRST: 20.0}
"""s"""
QUIET, LOADED = "", ", another process busy"
BUSY = "while True: pass"
IN_SIGHT = "width=1366&height=768&plots=position+velocity+gravity+attitude&tabs=errors+motion"
"""What a browser reports of a window of this size at first: two tabs are open."""
SLIDERS = (("Gains", "range weight q (1/(m⁴ s))", "error"), ("Motion", "amplitude x (m)", "error"))
"""Tab, slider, and the curve whose plot has to change."""


def main(load: bool) -> None:
    """Measure, print. load: also with another process busy."""
    compile_kernels(lambda share, words: None)
    stages, (drags, pictures) = _stages(QUIET), _drags(QUIET)
    if load:
        with _busy():
            stages |= _stages(LOADED)
            loaded_drags, loaded_pictures = _drags(LOADED)
        drags, pictures = drags | loaded_drags, pictures | loaded_pictures
    reason = "asked for with --load are stages and drags" if load else missing("playwright") or _why_no_browser()
    events = {} if reason else _slider_events()
    starts = {} if reason else _starts()
    report(
        "live",
        title=f"The page on {DEFAULT_PRESET}",
        columns=("", "median", "p95", "worst"),
        rows=[_row(name, values, " ms") for name, values in (stages | drags | events).items()]
        + [_row(name, values, " s") for name, values in starts.items()],
        targets=_targets(stages, events, starts) + _drag_targets(drags, pictures),
        notes=[f"slider events and start-up were not measured: {reason}"] if reason else [],
        figures={
            "milliseconds": {name: _figures(values) for name, values in (stages | drags | events).items()},
            "pictures_per_second": pictures,
            "seconds": {name: _figures(values) for name, values in starts.items()},
            "versions": versions("numpy", "numba", "viser"),
        },
    )


@contextlib.contextmanager
def _busy() -> Iterator[None]:
    """Keep one of two cores busy with another process; the benchmark and what it starts use these two alone."""
    before = os.sched_getaffinity(0)
    first, *others = sorted(before)
    os.sched_setaffinity(0, {first, *others[:1]})
    other = subprocess.Popen([sys.executable, "-c", BUSY])
    os.sched_setaffinity(other.pid, {first})
    try:
        yield
    finally:
        other.kill()
        other.wait()
        os.sched_setaffinity(0, before)


def _stages(condition: str) -> dict[str, np.ndarray]:
    """Milliseconds of all stages after a move of each kind."""
    moved = {f"stages, {name} moved{condition}": _milliseconds(move, _opened()) for name, move in MOVED.items()}
    return moved | {
        f"stages, one of 12 {name} moved{condition}": _milliseconds(_waypoint, _drawn(name)) for name in CURVES
    }


def _targets(
    stages: dict[str, np.ndarray], events: dict[str, np.ndarray], starts: dict[str, np.ndarray]
) -> list[Target]:
    bounds = [(f"{name}, p95", _figures(values)["p95"], STAGES_P95, " ms") for name, values in stages.items()]
    bounds += [(f"{name}, median", _figures(values)["median"], EVENT_MEDIAN, " ms") for name, values in events.items()]
    bounds += [(f"{name}, p95", _figures(values)["p95"], EVENT_P95, " ms") for name, values in events.items()]
    bounds += [(name, _figures(values)["worst"], MAX_START[name], " s") for name, values in starts.items()]
    return [Target(name=n, value=value, bound=most, at_least=False, unit=unit) for n, value, most, unit in bounds]


def _figures(values: np.ndarray) -> dict[str, float]:
    return {"median": float(np.median(values)), "p95": float(np.percentile(values, 95)), "worst": float(np.max(values))}


def _row(name: str, values: np.ndarray, unit: str) -> tuple[str, ...]:
    return name, *(f"{figure:.3g}{unit}" for figure in _figures(values).values())


def _gain(chosen: preset.Preset, factor: float) -> preset.Preset:
    riccati = msgspec.structs.replace(chosen.gains.riccati, q=chosen.gains.riccati.q * factor)
    return msgspec.structs.replace(chosen, gains=msgspec.structs.replace(chosen.gains, riccati=riccati))


def _amplitude(chosen: preset.Preset, factor: float) -> preset.Preset:
    assert isinstance(chosen.path, Multisine)
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


def _opened() -> preset.Preset:
    return preset.load(DEFAULT_PRESET)


def _drawn(name: str) -> preset.Preset:
    """The default preset flown through twelve points of its path: over the whole flight, or again and again."""
    chosen = _opened()
    curve = conversion.waypoints(chosen.path, chosen.duration)
    if name != "closed waypoints":
        times = np.linspace(0, chosen.duration, len(curve.points))
        points = tuple(msgspec.structs.replace(p, time=float(t)) for p, t in zip(curve.points, times, strict=True))
        curve = (MinimumSnap if name == "minimum snap" else Waypoints)(points=points)
    return msgspec.structs.replace(chosen, path=curve)


def _waypoint(chosen: preset.Preset, factor: float) -> preset.Preset:
    assert isinstance(chosen.path, Waypoints | MinimumSnap)
    x, y, z = chosen.path.points[3].value
    return msgspec.structs.replace(chosen, path=waypoints.move(chosen.path, 3, (x + factor - 1, y, z)))


def _drags(condition: str) -> tuple[dict[str, np.ndarray], dict[str, float]]:
    """A waypoint dragged as fast as a page tells it: ms until its picture is on the socket, and pictures a second."""
    from tests.browser import page

    elapsed, pictures = {}, {}
    for name in CURVES:
        with tempfile.TemporaryDirectory() as folder, mock.patch.dict(os.environ, {"RANGENAV_STATE": folder}):
            file = Path(folder) / "drag.toml"
            preset.save(_drawn(name), file)
            with page.served("--preset", str(file)) as server:
                times, rate = _drag(server.port)
        elapsed[f"drag, one of 12 {name}{condition}"], pictures[f"{name}{condition}"] = times, rate
    return elapsed, pictures


def _drag(port: int) -> tuple[np.ndarray, float]:
    """Places sent at a steady rate: how long each waited for a picture that shows it or a later one."""
    tab = Wire(port)
    tab.wait_for_text("of 13</b>, nonlinear")
    tab.set("page", IN_SIGHT)
    handle = "/handles/waypoint4"
    tab.wait_for(lambda: handle in tab.nodes, "a handle")
    time.sleep(2)
    home = tuple(tab.nodes[handle]["position"])
    box, sent, drawn = tab.find("position of the point (m)"), [], []
    tab.on_plot = lambda uuid: drawn.append((uuid, time.perf_counter(), float(tab.elements[box]["value"])))
    tab.drag_message(handle, "start", home, home)
    began, place = time.perf_counter(), home
    for k in range(DRAGS):
        place = (home[0] + 0.004 * (k + 1), home[1], home[2])
        sent.append((time.perf_counter(), place[0]))
        tab.drag_message(handle, "update", home, place)
        time.sleep(max(0.0, began + (k + 1) / DRAG_RATE - time.perf_counter()))
    tab.drag_message(handle, "end", home, place)
    time.sleep(1)
    tab.close()
    plots = [uuid for uuid, _, _ in drawn]
    one = max(set(plots), key=plots.count)  # stands for all that are drawn with it; the box says which place they show
    pictures = [(moment, shown) for uuid, moment, shown in drawn if uuid == one]
    waits = [1e3 * (next(m for m, shown in pictures if shown > x - STEP) - moment) for moment, x in sent]
    during = [moment for moment, _ in pictures if began < moment < sent[-1][0]]
    return np.array(waits), len(during) / (sent[-1][0] - began)


def _drag_targets(drags: dict[str, np.ndarray], pictures: dict[str, float]) -> list[Target]:
    result = [(f"{name}, p95", _figures(values)["p95"], DRAG_P95, " ms", False) for name, values in drags.items()]
    result += [(f"pictures, 12 {name}", rate, MIN_PICTURES, " a second", True) for name, rate in pictures.items()]
    return [Target(name=n, value=v, bound=b, at_least=least, unit=unit) for n, v, b, unit, least in result]


def _milliseconds(moved: Callable[[preset.Preset, float], preset.Preset], chosen: preset.Preset) -> np.ndarray:
    """Time of `compute` after each of many moves."""
    elapsed = np.empty(WARM_MOVES + MOVES)
    compute(Settings(preset=chosen))
    for move in range(len(elapsed)):
        settings = Settings(preset=moved(chosen, 1 + STEP * (move + 1)))
        begin = time.perf_counter()
        compute(settings)
        elapsed[move] = 1e3 * (time.perf_counter() - begin)
    return elapsed[WARM_MOVES:]


def _why_no_browser() -> str | None:
    """A sentence if there is no Chromium here, None if there is; needs playwright, as all that drives the page does."""
    from tests.browser import page

    return page.why_not()


def _starts() -> dict[str, np.ndarray]:
    """Seconds from starting the program to an answering page: with warm caches, and with nothing compiled."""
    warm = [_start() for _ in range(STARTS)]
    first = []
    for _ in range(STARTS):
        with tempfile.TemporaryDirectory() as folder, mock.patch.dict(os.environ, {"NUMBA_CACHE_DIR": folder}):
            first.append(_start())
    return {WARM: np.array(warm), FIRST: np.array(first)}


def _start() -> float:
    from tests.browser import page

    with page.served() as server:
        return server.seconds_to_answer


def _slider_events() -> dict[str, np.ndarray]:
    """Milliseconds from slider events in Chromium to changed plot data, for one slider of each of two tabs."""
    from tests.browser import page

    elapsed = {}
    with page.served("--preset", DEFAULT_PRESET) as server, page.chromium() as browser:
        for tab, slider, curve in SLIDERS:
            visitor = page.Visitor(browser, server.url)
            visitor.tab(tab)
            times = visitor.slider_to_plot(slider, curve, WARM_MOVES + SLIDER_EVENTS)
            elapsed[f"slider {slider}"] = np.array(times[WARM_MOVES:])
            visitor.close()
    return elapsed


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--load", action="store_true", help="stages and drags, also with another process busy")
    main(parser.parse_args().load)
