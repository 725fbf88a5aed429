"""What cures a refused export: a change of the preset, or another way to write it, that its certificate confirms.

A cure is tried before it is offered: the file is written, read again and certified. What is tried follows from the
refusal: a longer window or added tones where the ranges tell too little, a slower flight where a vehicle's limits are
broken, a loop, a longer flight, a shorter window or shorter ramps where the format holds too little of the path.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import msgspec

from rangenav import formats, provenance, signals
from rangenav.certificate import certified_export, exports, remedy, tone_search
from rangenav.certificate.certified_export import RefusedExportError
from rangenav.certificate.figures import figures, shortfall
from rangenav.certificate.tone_search import upwards
from rangenav.formats import ExportOptions, hover_ramps
from rangenav.inputs import require
from rangenav.preset import MAX_DURATION, Preset
from rangenav.progress import Cancelled, never
from rangenav.signals import Polynomials

MOST = 2
"""Cures that are searched for."""
SLOWER = (1.05, 1.1, 1.2, 1.35, 1.5, 2.0, 3.0)
LONGER, SHORTER = (1.25, 1.5, 2.0, 3.0), (0.8, 0.6, 0.4)
"""Of a window."""
LOOPED = 20.0
"""s, that a loop is flown at least."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Cure:
    """A change after which the export is certified."""

    text: str
    """What to do, in the imperative: the label of a button."""
    preset: Preset
    """The preset, changed."""
    format_name: str
    options: ExportOptions
    command: str
    """What is typed behind `rangenav`; NAME, OUT.csv and NEW.toml stand for the preset's name and the files."""


def cures(refused: RefusedExportError, *, most: int = MOST, cancelled: Cancelled = never) -> tuple[Cure, ...]:
    """The first cures of a refused export that their certificates confirm, the smallest change first; maybe none."""
    found: list[Cure] = []
    for cure in _candidates(refused):
        if cancelled() or len(found) == most:
            break
        if certified_export.refusal(cure.preset, cure.format_name, cure.options) is None:
            found.append(cure)
    return tuple(found)


def _candidates(refused: RefusedExportError) -> Iterator[Cure]:
    """What may cure a refusal, by what is missed."""
    preset, format_name, options, missed = refused.preset, refused.format_name, refused.options, refused.missed

    def cure(text: str, changed: Preset, flag: str) -> Cure:
        command = f"export NAME --to {format_name} {flag} -o OUT.csv"
        return Cure(text=text, preset=changed, format_name=format_name, options=options, command=command)

    if missed & {"source", "smooth"}:
        return  # what is not judged, or not flown, no other window or speed mends
    if missed & {"excitation", "rank", "accuracy"}:
        yield from (cure(f"set δ to {w:.3g} s", changed, f"--window {w:.6g}") for w, changed in _windows(preset))
        at = exports.certificate_of(preset).excitation.at
        added = None if "vehicle" in missed else tone_search.smallest_tones(preset, at)
        if added is not None:
            design = msgspec.structs.replace(added.preset, expect="observable")
            repairing = f"repair NAME --by tones --export {format_name} -o NEW.toml"
            yield replace(cure(f"add {remedy.described(added)}", design, ""), command=repairing)
        return
    if "pieces" in missed:
        for text, flag, changed in _fitted(preset, options):
            yield cure(text, changed, flag)
        yield from _other_ramps(preset, format_name, options, (0.5,))
    if "ramps" in missed:
        yield from _other_ramps(preset, format_name, options, (2.0, 4.0))
    if "vehicle" in missed and formats.row(format_name).own_attitude and options.attitude == "flown":
        yield replace(
            cure("write the preset's own attitude", preset, "--attitude preset"),
            options=replace(options, attitude="preset"),
        )
    yield from (cure(f"slow down {f:g}×", changed, f"--slower {f:g}") for f, changed in _slower(preset))
    if format_name != "reference":
        yield replace(
            cure("export it as reference", preset, ""),
            format_name="reference",
            command="export NAME --to reference -o OUT.csv",
        )


def _other_ramps(
    preset: Preset, format_name: str, options: ExportOptions, factors: tuple[float, ...]
) -> Iterator[Cure]:
    for factor in factors:
        ramp = float(f"{options.ramp * factor:.2g}")
        if hover_ramps.SHORTEST <= ramp <= hover_ramps.LONGEST:
            yield Cure(
                text=f"use ramps of {ramp:g} s",
                preset=preset,
                format_name=format_name,
                options=replace(options, ramp=ramp),
                command=f"export NAME --to {format_name} --ramp {ramp:g} -o OUT.csv",
            )


def _fitted(preset: Preset, options: ExportOptions) -> Iterator[tuple[str, str, Preset]]:
    """(what to do, flag, the preset changed) where the format holds too little of the path for one window."""
    window, duration = preset.requirement.window, preset.duration
    looped = as_loop(preset)
    if looped is not None:
        yield f"loop it, {looped.path.period:.3g} s again and again", "--loop", looped
    needed = window + options.ramp
    if duration < needed <= MAX_DURATION:
        length = upwards(needed, 3)
        yield f"fly {length:g} s", f"--duration {length:g}", msgspec.structs.replace(preset, duration=length)
    for share in SHORTER:
        shorter = float(f"{share * window:.2g}")
        yield f"set δ to {shorter:g} s", f"--window {shorter:g}", with_window(preset, shorter)


def changed(
    preset: Preset,
    *,
    source: str,
    loop: bool = False,
    window: float | None = None,
    slower: float | None = None,
    duration: float | None = None,
) -> Preset:
    """The preset looped, judged over a window (s), flown so many times slower, and so long (s); None: as it is.

    Raises ValueError, starting with `source`, for a change that it does not take.
    """
    try:
        if loop:
            looped = as_loop(preset)
            require(looped is not None, "its path is not made of pieces that end where they begin: it is no loop")
            assert looped is not None
            preset = looped
        if slower is not None:
            preset = slowed(preset, slower)
        if duration is not None:
            preset = msgspec.structs.replace(preset, duration=duration)
        return preset if window is None else with_window(preset, window)
    except ValueError as error:
        raise ValueError(f"{source}: {error}") from None


def as_loop(preset: Preset) -> Preset | None:
    """The preset with its pieces flown again and again; None if they do not close."""
    path = preset.path
    if not isinstance(path, Polynomials) or path.ends != "hold":
        return None
    length = math.fsum(piece.duration for piece in path.pieces)
    if not hover_ramps.closes(path, length):
        return None
    flown = length * math.ceil(max(LOOPED, preset.requirement.window + length) / length)
    again = msgspec.structs.replace(path, ends="repeat")
    return msgspec.structs.replace(
        preset,
        path=again,
        duration=min(flown, MAX_DURATION),
        source=provenance.renamed(preset.source, path, again),
    )


def slowed(preset: Preset, factor: float) -> Preset:
    """The same geometry, so many times slower; a flight that does not repeat lasts longer. Raises ValueError."""
    longer = preset.duration * factor if preset.path.period is None else preset.duration
    return msgspec.structs.replace(preset, path=signals.slowed(preset.path, factor), duration=min(longer, MAX_DURATION))


def with_window(preset: Preset, window: float) -> Preset:
    """The preset judged over another window (s), and flown long enough for it if it repeats. Raises ValueError."""
    period = preset.path.period or 0.0
    duration = preset.duration if preset.path.period is None else max(preset.duration, window + period)
    return msgspec.structs.replace(
        preset, duration=duration, requirement=msgspec.structs.replace(preset.requirement, window=window)
    )


def _windows(preset: Preset) -> Iterator[tuple[float, Preset]]:
    """Longer windows with which the requirement is met on samples."""
    window, period = preset.requirement.window, preset.path.period
    loops = [k * period for k in range(1, 5) if k * period > window] if period else []
    for longer in sorted({*(float(f"{share * window:.2g}") for share in LONGER), *loops}):
        try:
            changed = with_window(preset, longer)
            if max(shortfall(figures(changed), changed).values()) <= 0:
                yield longer, changed
        except ValueError:
            continue


def _slower(preset: Preset) -> Iterator[tuple[float, Preset]]:
    """Slower flights that meet the requirement, and the vehicle's limits if the body is flown, on samples."""
    for factor in SLOWER:
        try:
            changed = slowed(preset, factor)
            flown = msgspec.structs.replace(changed, angular_velocity=signals.Flown())
            reached = figures(flown)
        except ValueError:
            continue
        if reached.worst_excess <= 0 and max(shortfall(reached, changed).values()) <= 0:
            yield factor, changed
