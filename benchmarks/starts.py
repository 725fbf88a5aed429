"""Noise-matched gains from far starts: where do they end, and is the covariance true there?

    python benchmarks/starts.py [--starts 2000] [--seconds 150]

Each start has a guess up to 10 km and 1 km/s off, any attitude, an anchor up to 1 km away and noise of its own. A
quarter as many more are up to 100 m and 10 m/s off, with an anchor up to 100 m away: their guess is wrong, but not
plainly. A run ends well if e_BᵀP⁻¹e_B ≤ 36 at its end, with the position error in body axes. That n runs all do shows,
with 95 % confidence, that at most 3/n of all runs do not.
"""

import argparse
from typing import NamedTuple

import numpy as np
from msgspec.structs import replace
from scipy.spatial.transform import Rotation

from rangenav import cascade, consistency, model, preset, record
from rangenav.acquisition import COLLECTING, LOST, MATCHED
from rangenav.cascade import Estimate, ObserverConfig, Start
from rangenav.gains import Gains
from rangenav.preset import Preset

PRESETS = ("paper-slow", "lissajous", "soft", "barrel", "torus")
FAR = 36.0
EVERY = 40
"""Every so many samples of the last quarter count for the steady figures."""
MATCHED_GAINS = Gains(mode="noise-matched")


class Span(NamedTuple):
    """How far a guess is off: the longest of vectors that are uniform in length, in any direction."""

    offset: float
    """m"""
    speed: float
    """m/s"""
    anchor: float
    """m, of the anchor from the preset's."""


SPANS = ((Span(offset=1e4, speed=1e3, anchor=1e3), 1.0), (Span(offset=100.0, speed=10.0, anchor=100.0), 0.25))
"""With the share of the starts that each has."""


class Run(NamedTuple):
    """One start."""

    end: float
    """e_BᵀP⁻¹e_B at the end."""
    error: float
    """m, position, root mean square over the last quarter."""
    nees: float
    """Mean of e_BᵀP⁻¹e_B/3 over the last quarter."""
    nis: float
    started: float
    """s, when the matched gains that end the run began: 0 from the guess, NaN if other gains end it."""
    alarms: int
    lost: bool


def main() -> None:
    """Print a table with a row for each preset, and one of near starts for comparison."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--starts", type=int, default=2000)
    parser.add_argument("--seconds", type=float, default=150.0)
    asked = parser.parse_args()
    for span, share in SPANS:
        _table(span, -(-round(share * asked.starts) // len(PRESETS)), asked.seconds)
    print("\nthe presets themselves, from x̂ = 0, 20 seeds each")
    for name in PRESETS:
        chosen = replace(preset.load(name), duration=asked.seconds, gains=MATCHED_GAINS)
        print(_row(name, [_run(chosen, seed, None) for seed in range(20)]), flush=True)


def _table(span: Span, each: int, seconds: float) -> None:
    limits = f"{span.offset:g} m, {span.speed:g} m/s, anchor to {span.anchor:g} m"
    print(f"\n{each} starts on each preset, {seconds:g} s: {limits}")
    print(f"{'preset':<12} above 36  largest   NEES/3     NIS  begun at (latest)  alarms  lost  error (worst)")
    bad = 0
    for name in PRESETS:
        runs = [start(preset.load(name), span, seconds, seed) for seed in range(each)]
        bad += sum(not run.end <= FAR for run in runs)
        print(_row(name, runs), flush=True)
    bound = f"; at most {3 / (each * len(PRESETS)):.2%} do at 95 %" if bad == 0 else ""
    print(f"{bad} of {each * len(PRESETS)} runs end above {FAR:g}{bound}")


def start(of: Preset, span: Span, seconds: float, seed: int) -> Run:
    """One start on a preset, all of it drawn from the seed."""
    rng = np.random.default_rng([seed, 12])
    anchor = tuple(float(x) for x in np.asarray(of.world.anchor) + _vector(rng, span.anchor))
    moved = replace(of, world=replace(of.world, anchor=anchor), duration=seconds, gains=MATCHED_GAINS)
    return _run(moved, seed, (rng, span))


def _run(of: Preset, seed: int, drawn: tuple[np.random.Generator, Span] | None) -> Run:
    inputs = record.truth_inputs(of)
    truth, z = record.simulated(inputs), record.drawn(inputs, of.sensors, seed)
    first = truth.state[0]
    start = Start(state=np.zeros(model.STATES), rotation=np.eye(3))
    if drawn is not None:
        rng, span = drawn
        position = first[model.POSITION] + _vector(rng, span.offset)
        velocity = first[model.VELOCITY] + _vector(rng, span.speed)
        rotation = Rotation.from_quat(rng.standard_normal(4)).as_matrix()
        start = Start(state=model.lift(position, velocity, first[model.GRAVITY]), rotation=rotation)
    estimate = cascade.observe(z, start, ObserverConfig(world=of.world, sensors=of.sensors, gains=of.gains))
    return _judged(estimate, truth.state, len(z.range))


def _judged(estimate: Estimate, truth: np.ndarray, ranges: int) -> Run:
    n = len(estimate.time)
    part = np.append(np.arange(3 * n // 4, n - 1, EVERY), n - 1)
    error = (estimate.state - truth)[part, model.POSITION]
    nees = consistency.errors(error, estimate.covariance[part, 0])
    phase = np.asarray(estimate.phase)
    other = np.flatnonzero(phase != MATCHED)
    begun = 0 if len(other) == 0 else int(other[-1]) + 1
    return Run(
        end=float(nees[-1]),
        error=float(np.sqrt(np.mean(np.sum(error**2, axis=1)))),
        nees=float(np.mean(nees)) / 3,
        nis=float(np.nanmean(consistency.innovations(estimate.innovation[3 * ranges // 4 :]))),
        started=float(estimate.time[begun]) if begun < n else np.nan,
        alarms=int(np.sum((phase[:-1] == MATCHED) & (phase[1:] == COLLECTING))),
        lost=bool(phase[-1] == LOST),
    )


def _vector(rng: np.random.Generator, longest: float) -> np.ndarray:
    direction = rng.standard_normal(3)
    return longest * rng.random() * direction / np.linalg.norm(direction)


def _row(name: str, runs: list[Run]) -> str:
    end, error, nees, nis, started, alarms, lost = (np.array(column) for column in zip(*runs, strict=True))
    return (
        f"{name:<12} {np.sum(~(end <= FAR)):>8d} {end.max():>8.1f} {nees.mean():>8.2f} {nis.mean():>7.3f} "
        f"{np.median(started):>9.1f} s ({np.max(started):.1f}) {alarms.sum():>6d} {lost.sum():>5d} "
        f"{np.sqrt(np.mean(error**2)):>7.3g} m ({error.max():.3g})"
    )


if __name__ == "__main__":
    main()
