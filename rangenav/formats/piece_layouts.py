"""How a path is divided into the 31 pieces that a Crazyflie holds: ramp in, the loop or the flight, ramp out.

A path that closes is divided over one period, which is flown again and again; another one over as much of its flight as
the pieces hold. Every way is tried from long pieces to short ones: what its pieces keep of the path's excitation is
for the certificate of the file to decide. The ramps carry no excitation, and get the fewest pieces that follow them.
"""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.formats import hermite, hover_ramps
from rangenav.formats.hover_ramps import HoverRamps
from rangenav.inputs import require
from rangenav.preset import Preset
from rangenav.results import result
from rangenav.signals import Flown, Polynomials, Signal, knots, polynomials
from rangenav.signals.waypoints import MinimumSnap

MAX_SEGMENTS = 31
"""Pieces of 132 bytes that fit the Crazyflie's trajectory memory of 4 kB."""
PER_TURN = (0.75, 1.0, 1.25, 1.5, 2.0, 2.5, 3.0)
"""Pieces for one period of the path's highest frequency, that are tried on a flight."""
LEAST_PER_TURN = 0.75
RAMP_PIECES = range(4, 14)
"""Numbers of pieces that are tried on each ramp."""
RAMP_FIT = 1e-4
"""m: the largest distance of the pieces of a ramp from it."""
SHORTEST_PIECE = 0.02
"""s: knots nearer than this count as one."""
SAMPLES = 101
SAME_YAW = 1e-6
"""rad, and rad/s to its powers."""


@result
class Layout:
    """A path with ramps, and the pieces that it is written as."""

    course: HoverRamps
    pieces: Polynomials
    ramp_pieces: int
    """Of each ramp."""
    loop: bool
    """Whether what lies between the ramps closes, and is flown again and again."""

    @property
    def middle(self) -> tuple[int, int]:
        """The first piece between the ramps, counted from 0, and their number."""
        return self.ramp_pieces, len(self.pieces.pieces) - 2 * self.ramp_pieces


def layouts(preset: Preset, *, ramp: float, once: bool) -> Iterator[Layout]:
    """The ways to divide a preset's path (z up), a loop's before a flight's, each from long pieces to short ones.

    once: no loop. Raises ValueError if there is no way: why, and what would help.
    """
    unchanged = _own_pieces(preset)
    looped = not once and loop_refusal(preset) is None
    if unchanged is not None and not looped:
        yield unchanged
        return
    count = 0
    for layout in _looped(preset, ramp) if looped else ():
        yield layout
        count += 1
    if count == 0:
        yield from _flown_once(preset, ramp, why_no_loop=None if once else loop_refusal(preset))


def loop_refusal(preset: Preset) -> str | None:
    """Why one period of a path cannot be flown again and again, as one clause; None if it can."""
    path, period = preset.path, preset.path.period
    if not period:
        return "the path does not repeat"
    if not hover_ramps.closes(path, period):
        return f"after its {period:.4g} s the path is somewhere else"
    if not _same_yaw(preset, period):
        return f"after the path's {period:.4g} s the yaw is another one"
    return None


def _same_yaw(preset: Preset, period: float) -> bool:
    """Whether the yaw and its rates are the same one period (s) later, up to whole turns."""
    turning = preset.angular_velocity
    if not isinstance(turning, Flown):
        return True
    t = np.linspace(0, period, SAMPLES)
    course = HoverRamps(path=preset.path, duration=period, ramp=0.0)
    early, late = (np.stack(hover_ramps.yaw(turning, course, at)) for at in (t, t + period))
    step = late - early
    step[0] -= 2 * np.pi * np.round(step[0, 0] / (2 * np.pi))
    return float(np.abs(step).max()) < SAME_YAW


def _own_pieces(preset: Preset) -> Layout | None:
    """The path's own pieces, if a file holds them and they rest at both ends."""
    own, path = None, preset.path
    if isinstance(path, MinimumSnap) and path.period is None:
        own = polynomials.from_minimum_snap(path)
    elif isinstance(path, Polynomials) and path.ends == "hold":
        own = path
    if own is None or len(own.pieces) > MAX_SEGMENTS:
        return None
    length = sum(piece.duration for piece in own.pieces)
    if length > preset.duration * (1 + 1e-9):
        return None
    course = hover_ramps.with_ramps(own, length, window=0.0)
    return None if course.ramp else Layout(course=course, pieces=own, ramp_pieces=0, loop=False)


def _looped(preset: Preset, ramp: float) -> Iterator[Layout]:
    path, period = preset.path, preset.path.period
    assert period
    course = hover_ramps.around_loop(path, period, ramp=ramp)
    ramp_pieces = _ramp_pieces(course)
    left = MAX_SEGMENTS - 2 * ramp_pieces
    least = LEAST_PER_TURN * period * path.bandwidth_until(preset.duration) / (2 * np.pi)
    for inner in _divisions(path, course.ramp / 2, period, left, least):
        yield _layout(preset, course, inner + course.ramp / 2, ramp_pieces, loop=True)


def _flown_once(preset: Preset, ramp: float, *, why_no_loop: str | None) -> Iterator[Layout]:
    path, window, duration = preset.path, preset.requirement.window, preset.duration
    course = hover_ramps.with_ramps(path, duration, window=window, ramp=ramp)
    ramp_pieces = _ramp_pieces(course)
    left, total, begin = MAX_SEGMENTS - 2 * ramp_pieces, duration - course.ramp, course.ramp / 2
    turn = 2 * np.pi / path.bandwidth_until(duration) if path.period != 0 else np.inf
    tried: set[tuple[int, float]] = set()
    for inner in (
        *_own_divisions(path, begin, total, left, window),
        *_even_divisions(begin, total, left, window, turn),
    ):
        length = float(inner[-1] - inner[0])
        if (len(inner), length) not in tried:
            tried.add((len(inner), length))
            shorter = HoverRamps(path=path, duration=length + course.ramp, ramp=course.ramp)
            yield _layout(preset, shorter, inner + course.ramp / 2, ramp_pieces, loop=False)
    require(len(tried) > 0, _too_short(turn / PER_TURN[0], left, window, why_no_loop))


def _too_short(longest: float, left: int, window: float, why_no_loop: str | None) -> str:
    """That the pieces the format holds are too short for one window, and the ways out."""
    between = f"last {max(left, 0) * longest:.3g} s between the ramps" if left > 0 else "leave none between the ramps"
    no_loop = "" if why_no_loop is None else f", and {why_no_loop}, so that it is no loop"
    pieces = f"{MAX_SEGMENTS} pieces of at most {longest:.2g} s, as this path needs them, {between}"
    return f"{pieces}, less than its window of {window:g} s{no_loop}: it turns too fast for the format"


def _divisions(path: Signal, begin: float, length: float, left: int, least: float) -> Iterator[Float[Array, "k"]]:
    """Knots in the path's own time over a loop: at the path's own knots and between them, or evenly spaced."""
    own = _with_ends(path, begin, length)
    if knots.has_pieces(path) and len(own) - 1 <= left:
        yield from _parted(own, left)
        return
    for count in range(min(left, max(1, int(np.ceil(least)))), left + 1):
        yield np.linspace(begin, begin + length, count + 1)


def _own_divisions(path: Signal, begin: float, total: float, left: int, window: float) -> Iterator[Float[Array, "k"]]:
    """Knots over a flight at the path's own knots, as many as there are pieces, and between them."""
    if not knots.has_pieces(path) or left < 1:
        return
    own = _with_ends(path, begin, total)[: left + 1]
    if own[-1] - own[0] >= window:
        yield from _parted(own, left)


def _even_divisions(begin: float, total: float, left: int, window: float, turn: float) -> Iterator[Float[Array, "k"]]:
    """Evenly spaced knots over a flight, or over as much of it as the pieces hold."""
    for per_turn in PER_TURN:
        step = turn / per_turn
        length = min(total, left * step)
        if left >= 1 and length >= window * (1 - 1e-9):
            count = min(left, max(1, int(np.ceil(length / step - 1e-9)))) if np.isfinite(step) else 1
            yield np.linspace(begin, begin + length, count + 1)


def _with_ends(path: Signal, begin: float, length: float) -> Float[Array, "k"]:
    """The path's own knots from `begin` on, for a length (s), with both ends."""
    inside = knots.knots(path, begin + SHORTEST_PIECE, begin + length - SHORTEST_PIECE)
    return np.concatenate([[begin], inside, [begin + length]])


def _parted(own: Float[Array, "k"], left: int) -> Iterator[Float[Array, "n"]]:
    """The stretches between knots, then with the longest in halves, thirds …, until there are as many as pieces."""
    parts = np.ones(len(own) - 1, dtype=int)
    while parts.sum() <= left:
        ends = [np.linspace(a, b, n, endpoint=False) for a, b, n in zip(own[:-1], own[1:], parts, strict=True)]
        yield np.append(np.concatenate(ends), own[-1])
        parts[np.argmax(np.diff(own) / parts)] += 1


def _ramp_pieces(course: HoverRamps) -> int:
    """The least number of pieces that follow each ramp; the largest number that is tried if none does."""
    if course.ramp == 0:
        return 0
    for count in RAMP_PIECES:
        if all(_missed(course, begin, count) <= RAMP_FIT for begin in (0.0, course.duration)):
            return count
    return RAMP_PIECES[-1]


def _missed(course: HoverRamps, begin: float, count: int) -> float:
    """m: the largest distance of so many pieces from the ramp that begins at a time (s)."""
    at = np.linspace(0, course.ramp, count + 1)
    pieces = hermite.polynomials(at, np.stack([course(begin + at, order) for order in range(4)], axis=1))
    t = np.linspace(0, course.ramp, SAMPLES)
    return float(np.linalg.norm(pieces(t) - course(begin + t), axis=-1).max())


def _layout(preset: Preset, course: HoverRamps, inner: Array, ramp_pieces: int, *, loop: bool) -> Layout:
    """Pieces through knots in the file's time: those between the ramps, and evenly spaced ones on the ramps."""
    parts = [inner]
    if course.ramp:
        entry, leaving = (np.linspace(at, at + course.ramp, ramp_pieces + 1) for at in (0.0, course.duration))
        parts = [entry[:-1], inner, leaving[1:]]
    at = np.concatenate(parts)
    derivatives = np.stack([course(at, order) for order in range(4)], axis=1)
    turn = np.stack(hover_ramps.yaw(preset.angular_velocity, course, at), axis=1)
    pieces = hermite.polynomials(at, derivatives, yaw=turn)
    return Layout(course=course, pieces=pieces, ramp_pieces=ramp_pieces, loop=loop)
