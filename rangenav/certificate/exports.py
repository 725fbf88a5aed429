"""Certificates of exported files, recomputed from what was written, and the one gate that exports pass.

A format's row in `rangenav.formats.table` says which of these holds for its files:

preset    the file is judged as any preset
motion    the file holds a motion between two ramps: its own pieces are cut out and judged by the preset's world,
          sensors, requirement and vehicle
run       the file is a record of one run. A motion with its snap cannot be recovered from samples, so the preset in
          the certificate is judged, after every position in the file was compared with the preset's path
neither   there is no certificate

A file of a motion lasts one ramp longer than its path. It is steady from one ramp after its beginning to one ramp
before its end: the file's duration less the steady one is two ramps. If that part is a loop, its pieces are judged as a
path that repeats, so that windows reach over several loops.
"""

import re
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import assert_never, cast

import msgspec
import numpy as np

from rangenav import formats, provenance
from rangenav import preset as presets
from rangenav.axes import upright
from rangenav.certificate import advice, files, requirements
from rangenav.certificate.certify import READERS, FileContents, Reader, certify, read_preset
from rangenav.certificate.encoding import dumps
from rangenav.certificate.files import path_for, read_bytes
from rangenav.certificate.schema import Certificate, Loop, figure
from rangenav.formats import Format, readback, text
from rangenav.formats.sampled_rows import WHOLE
from rangenav.inputs import require
from rangenav.preset import Preset
from rangenav.signals import Flown, Polynomials, polynomials

ON_PATH = 1e-6
"""m; TUM has nine decimals, the others all digits, and stamps in nanoseconds cost 1e-9 of the speed."""
AT_REST = 1e-6
"""s; a ramp shorter than that is rounding of one that is not there."""
RECORDED = "the path of the run, on which every position in the file lies; of what was measured on it, nothing"
AT_KNOT = 1e-5
"""s; a loop's ends are stated to eight digits."""
CACHED = 4
TIME = re.compile(r"\bt\b")
"""The time in a formula."""


def readers() -> Mapping[str, Reader]:
    """How the bytes of every format that can be certified are read again."""
    certified_formats = {row.name: _reader(row) for row in formats.rows()}
    return {**READERS, **{name: reader for name, reader in certified_formats.items() if reader is not None}}


def _reader(row: Format) -> Reader | None:
    match row.certified_as:
        case "motion":
            return _steady(row)
        case "run":
            return _recorded(row)
        case "preset":
            return read_preset
        case "neither":
            return None
        case unknown:
            assert_never(unknown)


def certified(
    preset: Preset,
    form: str,
    path: Path,
    *,
    steady: tuple[float, float] | None = None,
    loop: bool = False,
    attitude: str = "flown",
) -> Certificate:
    """The certificate of the file or folder that a preset was exported to, from its bytes.

    `steady` says from when to when (s, in the file) the path runs at its own speed, `loop` whether that part is flown
    again and again, `attitude` which one was written. Raises ValueError for what cannot be read again.
    """
    row = formats.row(form)
    context, again = None if row.certified_as == "preset" else preset, None
    if row.certified_as == "motion":
        begin, end = cast("tuple[float, float]", steady)
        needed = preset.requirement.window + end - begin  # windows that begin anywhere in the loop
        flown = max(preset.duration, needed) if loop else end - begin
        again = Loop(begin=figure(begin), end=figure(end)) if loop else None
        context = _steady_context(upright(preset), begin, flown)
        if row.own_attitude and attitude == "preset":
            context = msgspec.structs.replace(context, angular_velocity=upright(preset).angular_velocity)
    return certify(read_bytes(path), source=path.name, form=form, context=context, loop=again, readers=readers())


def gate(preset: Preset, form: str = "preset") -> str | None:
    """Why a preset may not be exported in a format and what would help, one sentence; None if it may.

    What is to be flown must meet every requirement; of a preset and of a run it is enough that the preset is what it
    says it is, so that a hover can be studied.
    """
    if formats.row(form).gate == "claim" and certificate_of(preset).certified:
        return None
    return _refusal(preset)


@lru_cache(maxsize=CACHED)
def _refusal(preset: Preset) -> str | None:
    """Which requirements a preset misses and what would help, one sentence; None if it meets them."""
    issued = certificate_of(preset)
    refused = requirements.gate(issued)
    if refused is None:
        return None
    helps = advice.change(preset)
    return f"{refused}; {advice.SEARCH if helps is None else f'it would do to {helps}'}"


def certificate_of(preset: Preset) -> Certificate:
    """The certificate of a preset, from the bytes of its file."""
    return certify(presets.dumps(preset).encode(), source="preset")


def write_certificate(certificate: Certificate, path: Path) -> Path:
    """Write a certificate where `verify` looks for that of a file or folder."""
    place = path_for(path)
    place.write_bytes(dumps(certificate))
    return place


def _steady_context(turned: Preset, begin: float, flown: float) -> Preset:
    """What the steady part of a file (from `begin` on, flown for so many seconds) is judged by: its body is flown along
    the path, at the yaw that was asked for.

    Where a body of its own angular velocity could not be flown so, it keeps that.
    """
    own, steady = turned.angular_velocity, msgspec.structs.replace(turned, duration=flown)
    if isinstance(own, Flown):
        later = Flown(yaw=TIME.sub(f"(t + {begin / 2!r})", own.yaw))  # of its ramp the path takes half the time
        return msgspec.structs.replace(steady, angular_velocity=later if begin else own)
    try:
        return msgspec.structs.replace(steady, angular_velocity=Flown())
    except ValueError:
        return steady


def _steady(row: Format) -> Reader:
    def read(content: bytes, source: str, context: Preset | None, loop: Loop | None) -> FileContents:
        if context is None:
            raise ValueError(f"{source}: its certificate says nothing of the world and the requirement")
        why = provenance.restriction(context.source, context.path)  # pieces put through a fit are a fit
        require(why is None, f"{source}: {why}")
        require(len(content) <= text.MAX_BYTES, f"{source}: larger than {text.MAX_BYTES} bytes")
        imported = formats.parse(content, row.name, source=source, confirm={}, part=WHOLE)
        require(imported.unjudged is None, f"{source}: {imported.unjudged}")
        path = cast(Polynomials, imported.path)
        if loop is not None:
            return FileContents(_replaced(context, _loop_of(path, loop, source), source), _looped(loop))
        ramp = max(0.0, (imported.duration - context.duration) / 2)
        try:
            part = polynomials.cut(path, ramp, context.duration)
        except ValueError as error:
            raise ValueError(f"{source}: {error}") from None
        steady = _replaced(context, part, source)
        covers = f"{ramp:.6g} s to {ramp + context.duration:.6g} s of the file, between its ramps, and no more"
        return FileContents(steady, covers if ramp > AT_REST else msgspec.UNSET)

    return read


def _replaced(context: Preset, path: Polynomials, source: str) -> Preset:
    try:
        return msgspec.structs.replace(context, path=path)
    except ValueError as error:
        raise ValueError(f"{source}: {error}") from None


def _looped(loop: Loop) -> str:
    return f"{loop.begin:.6g} s to {loop.end:.6g} s of the file, flown again and again without a pause; not its ramps"


def _loop_of(path: Polynomials, loop: Loop, source: str) -> Polynomials:
    """The pieces of the loop as they are in the file, repeated. Raises ValueError if it does not begin and end at
    knots."""
    ends = np.concatenate([[0.0], np.cumsum([piece.duration for piece in path.pieces])])
    first, last = (int(np.argmin(np.abs(ends - at))) for at in (loop.begin, loop.end))
    near = max(abs(ends[first] - loop.begin), abs(ends[last] - loop.end)) <= AT_KNOT
    require(near and first < last, f"{source}: no pieces begin and end where its certificate says that the loop does")
    return polynomials.loop(path, first, last - first)


def _recorded(row: Format) -> Reader:
    def read(content: bytes, source: str, context: Preset | None, loop: Loop | None) -> FileContents:
        if context is None:
            raise ValueError(f"{source}: its certificate does not say which preset it is a run of")
        parts = files.unpacked(content, source) if row.folder else {"": content}
        time, position = readback.positions(parts, row, source)
        path = upright(context).path if row.upright else context.path
        rule = f"{source}: its stamps do not lie within the {context.duration:g} s of the preset that is certified"
        require(time.min() >= -ON_PATH and time.max() <= context.duration + ON_PATH, rule)
        away = np.linalg.norm(path(time) - position, axis=-1)
        worst = int(np.argmax(away))
        message = f"at t = {time[worst]:.4g} s it is {away[worst]:.2g} m from the path of the preset that is certified"
        require(float(away[worst]) <= ON_PATH, f"{source}: {message}")
        return FileContents(context, RECORDED)

    return read
