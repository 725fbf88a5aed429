"""The certificate of a file, computed from its bytes and never from the object in memory that was written to the file.

The chain is bytes → preset (read again) → worst windows for μ, rank and predicted accuracy, limits, jumps → checks.
Each of the three figures says whether it is proven of every window or sampled, and on which interval. A number that
cannot be bounded is null, with the reason in a field next to it. Nothing in a certificate depends on the time or the
place of its computation.
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
from rangenav import analysis
from rangenav import preset as presets
from rangenav.certificate import motion_sections, requirements, sections, version_1
from rangenav.certificate.files import read_bytes
from rangenav.certificate.schema import VERSION, Artifact, Certificate, Loop, Tool
from rangenav.inputs import require
from rangenav.preset import Preset
from rangenav.proof import arguments, prove

CACHED = 8


@dataclass(frozen=True, eq=False)
class FileContents:
    """What was read from a file: the preset that is judged. The context completes a file that holds only a path."""

    preset: Preset
    covers: str | msgspec.UnsetType = msgspec.UNSET
    """Which part of the file the certificate covers; unset if it covers the whole file."""


Reader = Callable[[bytes, str, Preset | None, Loop | None], FileContents]
"""(bytes, name for errors, context, the loop that is flown again and again) → contents. Raises ValueError."""


def read_preset(content: bytes, source: str, context: Preset | None = None, loop: Loop | None = None) -> FileContents:
    """The contents of a preset's TOML file, which needs no context. Raises ValueError."""
    require(len(content) <= presets.MAX_BYTES, f"{source}: larger than {presets.MAX_BYTES} bytes, which no preset is")
    try:
        return FileContents(presets.loads(content.decode("utf-8"), source=source))
    except UnicodeDecodeError as error:
        raise ValueError(f"{source}: not UTF-8 text (byte {error.start})") from None


READERS: Mapping[str, Reader] = {"preset": read_preset}
"""The reader of each format; `exports.readers` adds the exchange formats."""


def certify(
    content: bytes,
    *,
    source: str,
    form: str = "preset",
    context: Preset | None = None,
    loop: Loop | None = None,
    readers: Mapping[str, Reader] = READERS,
    version: int = VERSION,
) -> Certificate:
    """The certificate of a file's bytes. Raises ValueError if the bytes cannot be read.

    source: the file's name in error messages. form: the file's format. context: for a file that holds only a path, the
    preset whose world, sensors, requirement and vehicle judge that path. loop: the part of the file that is flown again
    and again; None if the file is flown once. version: of the certificate; the first one is
    computed to verify an old certificate.
    """
    require(form in readers, f"{source}: files of the format {form!r} cannot be certified")
    contents = readers[form](content, source, context, loop)
    digest = hashlib.sha256(content).hexdigest()
    again = msgspec.UNSET if loop is None else loop
    artifact = Artifact(format=form, sha256=digest, bytes=len(content), covers=contents.covers, loop=again)
    context_text = msgspec.UNSET if context is None else presets.dumps(context)
    issued = _without_artifact(contents.preset)
    issued = issued if version == VERSION else version_1.as_version_1(contents.preset, issued)
    return msgspec.structs.replace(issued, artifact=artifact, context=context_text)


def certify_file(name_or_path: str | Path) -> Certificate:
    """The certificate of a shipped preset by its name, or of a preset file by its path. Raises ValueError."""
    path = presets.find(name_or_path)
    return certify(read_bytes(path), source=path.name)


@lru_cache(maxsize=CACHED)
def _without_artifact(preset: Preset) -> Certificate:
    """The certificate without its artifact, which is the same for every format that the preset is written in."""
    proof, needed = prove(*arguments(preset)), preset.requirement
    excitation = sections.excitation_section(proof.excitation, needed.mu)
    rank = sections.rank_section(proof)
    accuracy = sections.accuracy_section(preset, proof)
    limits, flyability = motion_sections.limits_section(preset)
    jumps = motion_sections.jumps_section(preset)
    checks = requirements.requirements(excitation, rank, accuracy, jumps, flyability, preset)
    failures = requirements.failures(
        checks, excitation, preset.expect, undetermined=accuracy.bound is None, rounded=proof.rounded
    )
    analysed = analysis.analyse(preset)
    judged = analysed.verdict
    return Certificate(
        title=preset.title,
        expect=preset.expect,
        certified=not failures,
        meets=all(check.met for check in checks),
        verdict=judged.word,
        caveats=analysed.caveats(preset) or msgspec.UNSET,
        verdict_reason=judged.reason or msgspec.UNSET,
        checks=checks,
        failures=failures,
        claim=sections.claim_section(preset, proof.excitation),
        excitation=excitation,
        rank=rank,
        accuracy=accuracy,
        limits=limits,
        vehicle=flyability,
        jumps=jumps,
        frame=motion_sections.frame_section(preset),
        source=motion_sections.source_section(preset),
        artifact=Artifact(format="", sha256="", bytes=0),
        tool=Tool(rangenav=rangenav.__version__, python=platform.python_version(), numpy=np.__version__),
    )
