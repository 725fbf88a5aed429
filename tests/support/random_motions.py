"""Random presets of every kind of motion, with requirements close to what the motion reaches."""

import math
from collections.abc import Callable

import msgspec
import numpy as np

from rangenav import analysis
from rangenav.motion import World
from rangenav.motion_analysis import Windows
from rangenav.observability import accuracy
from rangenav.preset import Preset, Requirement
from rangenav.sensors import Noise, Sensors
from rangenav.signals import Formula, MinimumSnap, Multisine, Signal, Sum, Tone, Waypoint, Waypoints, polynomials
from rangenav.signals.multisine import LETTERS

Random = np.random.Generator


def _tones(rng: Random, *, slowest: float = 0.8, fastest: float = 8.0, count: int = 5) -> Multisine:
    return Multisine(
        tones=tuple(
            Tone(
                axis=LETTERS[k % 3],
                amplitude=float(rng.uniform(0.2, 2.0)),
                frequency=float(np.exp(rng.uniform(math.log(slowest), math.log(fastest)))),
                phase=float(rng.uniform(-3, 3)),
            )
            for k in range(count)
        )
    )


def _beats(rng: Random, duration: float) -> Multisine:
    """Two near tones on each axis, which cancel somewhere in the flight."""
    size, gap = float(rng.uniform(0.5, 2.0)), 2 * math.pi / duration * float(rng.uniform(0.8, 1.6))
    tones = []
    for axis in LETTERS:
        w, phase = float(rng.uniform(2, 8)), float(rng.uniform(-3, 3))
        for sign, v in ((1, w), (-1, w + gap)):
            tones.append(Tone(axis=axis, amplitude=sign * size, frequency=v, phase=phase))
    return Multisine(tones=tuple(tones))


def _nearly_planar(rng: Random) -> Multisine:
    path, share = _tones(rng, count=6), float(10 ** rng.uniform(-6, -2))
    return Multisine(
        tones=tuple(
            msgspec.structs.replace(t, amplitude=t.amplitude * (share if t.axis == "z" else 1.0)) for t in path.tones
        )
    )


def _planar(rng: Random) -> Multisine:
    return Multisine(tones=tuple(tone for tone in _tones(rng, count=6).tones if tone.axis != "z"))


def _points(rng: Random, duration: float) -> tuple[Waypoint, ...]:
    count = int(rng.integers(8, 20))
    time = np.linspace(0, duration, count)
    return tuple(
        Waypoint(time=float(t), value=(float(x), float(y), float(z)))
        for t, (x, y, z) in zip(time, rng.uniform(-2, 2, (count, 3)), strict=True)
    )


def _pausing(rng: Random, duration: float) -> Formula:
    """Tones whose size falls to nothing for some seconds."""
    at, length = float(rng.uniform(0.2, 0.8) * duration), float(rng.uniform(0.5, 3.0))
    dip = f"(1 - exp(-(((t - {at!r})/{length!r})*((t - {at!r})/{length!r}))**4))"
    a, b, c = (float(w) for w in rng.uniform(2, 8, 3))
    return Formula(x=f"{dip}*sin({a!r}*t)", y=f"{dip}*cos({b!r}*t)", z=f"{dip}*sin({c!r}*t + 1)")


def _aliased(rng: Random, rate: float) -> Multisine:
    """Tones that turn by whole turns, or nearly so, between two ranges."""
    near = float(rng.choice([0.0, 1e-9, 1e-3]))
    return Multisine(
        tones=tuple(
            Tone(
                axis=axis,
                amplitude=float(rng.uniform(0.3, 1.5)),
                frequency=2 * math.pi * rate * (k + near),
                phase=float(rng.uniform(-3, 3)),
            )
            for k, axis in enumerate(LETTERS, start=1)
        )
    )


SIZES: tuple[tuple[float, float, float, float, float], ...] = (
    (0.4, 0.5, 1.25, 1.5, 3.0),
    (0.5, 0.02, 0.4, 0.95, 1.7),
    (0.1, 2.0, 30.0, 0.9, 1.3),
)
"""How often; the predicted error in diameters of the largest sphere on which a range leaves the position, from and to;
the required one in predicted ones, from and to. Near the sphere, which then decides; within it, where the requirement
decides; outside. The worst window has up to twice the error of the one from which these are taken."""
LEAST_NOISE, MOST_NOISE = 1e-6, 10.0
"""m, of a range; where no such noise gives the error, the motion is as weak or as good as it is."""
KINDS: dict[str, Callable[[Random], tuple[Signal, float, float, float]]] = {
    "tones": lambda rng: (_tones(rng), 20.0, float(rng.uniform(3, 8)), 50.0),
    "beats": lambda rng: (_beats(rng, 40.0), 40.0, float(rng.uniform(2.5, 6)), 50.0),
    "slow": lambda rng: (_tones(rng, slowest=0.04, fastest=0.4), 300.0, float(rng.uniform(60, 120)), 2.0),
    "few ranges": lambda rng: (_tones(rng), 30.0, float(rng.uniform(4, 8)), float(rng.uniform(2, 6))),
    "aliased": lambda rng: (_aliased(rng, 1.0), 60.0, 20.0, 1.0),
    "nearly planar": lambda rng: (_nearly_planar(rng), 15.0, float(rng.uniform(4, 7)), 50.0),
    "planar": lambda rng: (_planar(rng), 15.0, float(rng.uniform(4, 7)), 50.0),
    "short windows": lambda rng: (_tones(rng, slowest=4.0, fastest=30.0), 10.0, float(rng.uniform(0.5, 1.5)), 100.0),
    "waypoints": lambda rng: (Waypoints(points=_points(rng, 24.0)), 24.0, float(rng.uniform(4, 10)), 25.0),
    "minimum snap": lambda rng: (MinimumSnap(points=_points(rng, 24.0)), 24.0, float(rng.uniform(4, 10)), 25.0),
    "polynomials": lambda rng: (
        polynomials.from_minimum_snap(MinimumSnap(points=_points(rng, 24.0))),
        24.0,
        float(rng.uniform(4, 10)),
        25.0,
    ),
    "formula": lambda rng: (_pausing(rng, 60.0), 60.0, float(rng.uniform(3, 6)), 50.0),
    "sum": lambda rng: (
        Sum(base=Waypoints(points=_points(rng, 24.0)), wiggle=_tones(rng, count=3)),
        24.0,
        float(rng.uniform(4, 8)),
        25.0,
    ),
}
"""Of each kind: path, duration (s), window (s), and the rate of the ranges (Hz)."""


def _predicted(p: Preset, windows: Windows) -> float:
    """σ (m) of the evenly spaced window that is the worst if ranges come at all times; 1 m if it is undetermined."""
    k = int(np.argmax(np.nan_to_num(windows.sigma_lifted, nan=np.inf)))
    start, rate = float(windows.start[k]), p.sensors.range_rate
    first, last = math.ceil(start * rate - 1e-9), math.floor((start + windows.window) * rate + 1e-9)
    noise = {"rate": rate, "sigma": p.sensors.sigma.range, "share": p.sensors.arriving}
    of = accuracy.of_held(p.path, p.world, start, windows.window, first=first, last=last, **noise)
    return of.lifted_end.position if math.isfinite(of.lifted_end.position) else 1.0


def random_preset(kind: str, seed: int) -> Preset:
    """A preset whose required μ and σ are near those of the worst sampled window, above or below them.

    The noise of its ranges is such that σ is near, within or outside the sphere on which one range leaves the position.
    """
    rng = np.random.default_rng([seed, *kind.encode()])
    path, duration, window, rate = KINDS[kind](rng)
    anchor = tuple(float(a) for a in rng.uniform(-3, 3, 3))
    p = Preset(
        title=f"{kind} {seed}",
        duration=duration,
        path=path,
        angular_velocity=Multisine(),
        world=World(gravity=(0.0, 0.0, float(rng.choice([-9.81, 9.81]))), anchor=(anchor[0], anchor[1], anchor[2])),
        sensors=Sensors(range_rate=rate, noise=Noise(range=0.1)),
        requirement=Requirement(window=window, mu=1e-3, position_sigma=1.0),
    )
    seen = analysis.sampled(p)
    sigma = _predicted(p, seen.windows)
    _, least, most, lowest, highest = SIZES[int(rng.choice(len(SIZES), p=[size[0] for size in SIZES]))]
    wanted = 2 * seen.farthest * float(np.exp(rng.uniform(math.log(least), math.log(most))))
    noise = float(np.clip(0.1 * wanted / sigma, LEAST_NOISE, MOST_NOISE))  # σ is nearly proportional to it
    needed = Requirement(
        window=window,
        mu=max(1e-9, seen.mu * float(rng.uniform(0.5, 1.1))),
        position_sigma=sigma * noise / 0.1 * float(rng.uniform(lowest, highest)),
    )
    sensors = msgspec.structs.replace(p.sensors, noise=msgspec.structs.replace(p.sensors.noise, range=noise))
    return msgspec.structs.replace(p, requirement=needed, sensors=sensors)
