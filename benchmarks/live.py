"""How live the page is: all computing stages after one slider moved, a slider event in Chromium, and the start-up time.

The default preset is the one the page opens on. Each set of stages is timed with fresh values, so no cache answers.
"""

import os
import tempfile
import time
from collections.abc import Callable
from unittest import mock

import msgspec
import numpy as np
from timing import Target, missing, report, versions

from explorer.compute import compute, warm_up
from explorer.settings import Settings
from rangenav import preset

if missing("playwright") is None:
    from tests.browser import page

DEFAULT_PRESET = "paper-slow"
MOVES, WARM_MOVES, SLIDER_EVENTS, STARTS = 100, 5, 40, 3
STEP = 1e-3
"""Relative change of the moved value from one event to the next."""
STAGES_P95, EVENT_MEDIAN, EVENT_P95 = 33.0, 100.0, 200.0
"""ms"""
WARM, FIRST = "page answers, warm caches", "page answers, nothing compiled yet"
LONGEST_START = {WARM: 3.0, FIRST: 20.0}
"""s"""
SLIDERS = (("Gains", "q", "error"), ("Motion", "A (m)", "error"))
"""Tab, slider, and the curve whose plot has to change."""


def main() -> None:
    """Measure, print."""
    warm_up(lambda share, words: None)
    stages = {f"stages, {name} moved": _milliseconds(moved) for name, moved in MOVED.items()}
    reason = missing("playwright") or page.why_not()
    events = {} if reason else _slider_events()
    starts = {} if reason else _starts()
    report(
        "live",
        title=f"The page on {DEFAULT_PRESET}",
        columns=("", "median", "p95", "worst"),
        rows=[_row(name, values, " ms") for name, values in (stages | events).items()]
        + [_row(name, values, " s") for name, values in starts.items()],
        targets=_targets(stages, events, starts),
        notes=[f"slider events and start-up were not measured: {reason}"] if reason else [],
        figures={
            "milliseconds": {name: _figures(values) for name, values in (stages | events).items()},
            "seconds": {name: _figures(values) for name, values in starts.items()},
            "versions": versions("numpy", "numba", "viser"),
        },
    )


def _targets(
    stages: dict[str, np.ndarray], events: dict[str, np.ndarray], starts: dict[str, np.ndarray]
) -> list[Target]:
    bounds = [(f"{name}, p95", _figures(values)["p95"], STAGES_P95, " ms") for name, values in stages.items()]
    bounds += [(f"{name}, median", _figures(values)["median"], EVENT_MEDIAN, " ms") for name, values in events.items()]
    bounds += [(f"{name}, p95", _figures(values)["p95"], EVENT_P95, " ms") for name, values in events.items()]
    bounds += [(name, _figures(values)["worst"], LONGEST_START[name], " s") for name, values in starts.items()]
    return [Target(name=n, value=value, bound=most, at_least=False, unit=unit) for n, value, most, unit in bounds]


def _figures(values: np.ndarray) -> dict[str, float]:
    return {"median": float(np.median(values)), "p95": float(np.percentile(values, 95)), "worst": float(np.max(values))}


def _row(name: str, values: np.ndarray, unit: str) -> tuple[str, ...]:
    return name, *(f"{figure:.3g}{unit}" for figure in _figures(values).values())


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


def _starts() -> dict[str, np.ndarray]:
    """Seconds from starting the program to an answering page: with warm caches, and with nothing compiled."""
    warm = [_start() for _ in range(STARTS)]
    first = []
    for _ in range(STARTS):
        with tempfile.TemporaryDirectory() as folder, mock.patch.dict(os.environ, {"NUMBA_CACHE_DIR": folder}):
            first.append(_start())
    return {WARM: np.array(warm), FIRST: np.array(first)}


def _start() -> float:
    with page.served() as server:
        return server.seconds_to_answer


def _slider_events() -> dict[str, np.ndarray]:
    """Milliseconds from slider events in Chromium to changed plot data, for one slider of each of two tabs."""
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
    main()
