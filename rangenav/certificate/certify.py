"""A certificate is computed from the bytes of a file, never from the object in memory that they were written from.

The chain is bytes → preset (read again) → bounds of μ, ranks, predicted accuracy, limits, jumps → checks. What cannot
be bounded says null and why; what is sampled says so. Nothing in it depends on when or where it was made.
"""

import hashlib
import platform
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import msgspec
import numpy as np

import rangenav
from rangenav import preset as presets
from rangenav import verdict
from rangenav.certificate import remedy, requirements, sections
from rangenav.certificate.files import read_bytes
from rangenav.certificate.schema import Artifact, Certificate, Tool
from rangenav.inputs import require
from rangenav.preset import Preset

CACHED = 8


@dataclass(frozen=True, eq=False)
class Held:
    """What the bytes of a file, and for what they do not hold its context, make."""

    preset: Preset
    covers: str | msgspec.UnsetType = msgspec.UNSET
    """What of the file is certified, where that is not all of it."""


Reader = Callable[[bytes, str, Preset | None], Held]
"""(bytes, name for errors, context) → what is held. Raises ValueError."""


def read_preset(content: bytes, source: str, context: Preset | None = None) -> Held:
    """A preset file holds everything; there is no context to it. Raises ValueError."""
    require(len(content) <= presets.MAX_BYTES, f"{source}: larger than {presets.MAX_BYTES} bytes, which no preset is")
    try:
        return Held(presets.loads(content.decode("utf-8"), source=source))
    except UnicodeDecodeError as error:
        raise ValueError(f"{source}: not UTF-8 text (byte {error.start})") from None


READERS: Mapping[str, Reader] = {"preset": read_preset}
"""How the bytes of each format are read again; whoever knows more formats hands over a larger table."""


def certify(
    content: bytes,
    *,
    source: str,
    form: str = "preset",
    context: Preset | None = None,
    readers: Mapping[str, Reader] = READERS,
) -> Certificate:
    """The certificate of a file's bytes; `source` names it in errors. Raises ValueError if they cannot be read.

    `context` is what a file that holds a path only is judged by: world, sensors, requirement, vehicle.
    """
    require(form in readers, f"{source}: files of the format {form!r} cannot be certified")
    held = readers[form](content, source, context)
    digest = hashlib.sha256(content).hexdigest()
    artifact = Artifact(format=form, sha256=digest, bytes=len(content), covers=held.covers)
    said = msgspec.UNSET if context is None else presets.dumps(context)
    return msgspec.structs.replace(_of(held.preset), artifact=artifact, context=said)


def certify_file(name_or_path: str | Path) -> Certificate:
    """The certificate of a shipped preset by its name, or of a preset file by its path. Raises ValueError."""
    path = presets.find(name_or_path)
    return certify(read_bytes(path), source=path.name)


@lru_cache(maxsize=CACHED)
def _of(preset: Preset) -> Certificate:
    """All but the artifact: one preset is written in many formats."""
    claim, excited = sections.excited(preset)
    rank = sections.ranked(preset, claim)
    predicted = sections.predicted(preset)
    limits, flying = sections.flown(preset)
    jumps = sections.jumped(preset)
    found = requirements.requirements(excited, rank, predicted, jumps, flying, preset)
    failed = requirements.failures(found, excited, preset.expect)
    meets = all(check.met for check in found)
    return Certificate(
        title=preset.title,
        expect=preset.expect,
        certified=not failed,
        meets=meets,
        verdict=verdict.judge(
            rank.rank,
            predicted.lifted.end.position,
            predicted.required,
            restriction=verdict.restriction(preset.path, preset.source, preset.duration),
        ).word,
        checks=found,
        failures=failed,
        remedy=msgspec.UNSET if meets else remedy.remedy(preset, excited.at) or msgspec.UNSET,
        claim=claim,
        excitation=excited,
        rank=rank,
        accuracy=predicted,
        limits=limits,
        vehicle=flying,
        jumps=jumps,
        frame=sections.frame(preset),
        source=sections.source(preset),
        artifact=Artifact(format="", sha256="", bytes=0),
        tool=Tool(rangenav=rangenav.__version__, python=platform.python_version(), numpy=np.__version__),
    )
