"""Export through the gate: a preset is written in a format together with the certificate of the written bytes.

The command line and the page both export through `write`. Without `uncertified` there is a file with a certificate or
no file at all. With `uncertified` a preset that misses its requirement is written, too; the file's name then contains
"uncertified", and there is no certificate.
"""

import shutil
from dataclasses import dataclass, replace
from pathlib import Path

from rangenav import formats
from rangenav.certificate import exports
from rangenav.formats import OutputFile
from rangenav.preset import Preset


@dataclass(frozen=True, eq=False, kw_only=True)
class CertifiedExport:
    """What was written, and its certificate."""

    output: OutputFile
    certificate: Path | None
    """The certificate's file; None if there is none."""
    complaint: str | None
    """Why the preset misses its requirement, None if it meets it; the file is then marked "uncertified"."""
    reason: str = ""
    """Why there is no certificate; empty if there is one."""

    @property
    def notes(self) -> tuple[str, ...]:
        """What a person should know about the file, one sentence each; first what the certificate covers."""
        if self.output.steady is None:
            return self.output.notes
        begin, end = self.output.steady
        covered = f"any certificate covers {begin:g} s to {end:.6g} s of the file, between its ramps, and no more"
        return (covered if begin else "no ramps", *self.output.notes)


def write(
    preset: Preset,
    format_name: str,
    output: Path,
    *,
    name: str,
    attitude: str = "flown",
    uncertified: bool = False,
    otherwise: str,
) -> CertifiedExport:
    """Write a file or folder and its certificate.

    `name` is the preset's name in error messages; `otherwise` says how to write an uncertified file.

    Raises ValueError, and leaves nothing written, if the gate refuses the preset (unless `uncertified`), if the format
    cannot hold it, or if what was written fails its certificate.
    """
    try:
        return _written(preset, format_name, output, name, attitude, uncertified=uncertified, otherwise=otherwise)
    except ValueError as error:
        named = str(error).startswith((f"{name}:", f"{format_name}:"))
        raise error if named else ValueError(f"{name}: {error}") from None


def _written(
    preset: Preset, format_name: str, output: Path, name: str, attitude: str, *, uncertified: bool, otherwise: str
) -> CertifiedExport:
    row = formats.row(format_name)
    complaint = None if row.unsupported else exports.gate(preset, format_name)
    if complaint is not None and not uncertified:
        raise ValueError(f"{name}: {complaint}; nothing was written ({otherwise})")
    if complaint is not None:
        written = formats.export(preset, format_name, formats.marked(output), attitude=attitude)
        marked = replace(written, notes=(f"UNCERTIFIED: {complaint}", *written.notes))
        return CertifiedExport(output=marked, certificate=None, complaint=complaint, reason=complaint)
    written = formats.export(preset, format_name, output, attitude=attitude)
    if row.certified_as == "neither":
        reason = f"nothing in a file of {format_name} can be certified"
        return CertifiedExport(output=written, certificate=None, complaint=None, reason=reason)
    certificate = _certify(preset, format_name, output, name=name, steady=written.steady, attitude=attitude)
    return CertifiedExport(output=written, certificate=certificate, complaint=None)


def _certify(
    preset: Preset, format_name: str, output: Path, *, name: str, steady: tuple[float, float] | None, attitude: str
) -> Path:
    """Write the certificate of the written bytes. Raises ValueError, and removes what was written, if it fails."""
    try:
        certificate = exports.certified(preset, format_name, output, steady=steady, attitude=attitude)
        if not certificate.certified:
            failures = "; ".join(certificate.failures)
            raise ValueError(f"{name}: as {format_name} it does not keep what it promises: {failures}")
        return exports.write_certificate(certificate, output)
    except BaseException:
        if output.is_dir():
            shutil.rmtree(output)
        else:
            output.unlink(missing_ok=True)
        raise
