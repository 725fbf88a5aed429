"""Export through the gate: a preset is written in a format together with the certificate of the written bytes.

The command line and the page both export through `write`. Of a motion every way to write it is tried, from long pieces
to short ones; the first that its certificate confirms is the export. Without `uncertified` there is a file with a
certificate or no file at all, and the refusal names what would cure it. With `uncertified` a preset that misses its
requirement is written, too; the file's name then contains "uncertified", and there is no certificate.
"""

import shutil
import tempfile
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import msgspec

from rangenav import formats
from rangenav.certificate import exports, objection, ramp_limits
from rangenav.certificate.schema import Certificate
from rangenav.formats import ExportOptions, OutputFile
from rangenav.preset import MIN_WINDOW_SAMPLES, Preset

CACHED = 32
FINER_HELPS = {"excitation", "rank", "accuracy"}
"""Checks that shorter pieces may meet where longer ones do not."""
MIN_WINDOW = 0.05
"""s, of any preset."""
PIECES, RAMPS = frozenset({"pieces"}), frozenset({"ramps"})


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
        how = "flown again and again without a pause" if self.output.loop else "between its ramps, and no more"
        covered = f"any certificate covers {begin:g} s to {end:.6g} s of the file, {how}"
        return (covered if begin or self.output.loop else "no ramps", *self.output.notes)


class RefusedExportError(ValueError):
    """An export that was refused: the sentence says why, and the fields what was to be written; see `cures`."""

    def __init__(
        self, sentence: str, preset: Preset, format_name: str, options: ExportOptions, missed: frozenset[str]
    ) -> None:
        super().__init__(sentence)
        self.preset, self.format_name, self.options = preset, format_name, options
        self.missed = missed
        """Names of the certificate's checks that are missed; "pieces" where the format holds too little of the path,
        "ramps" where these are too much for the vehicle."""


def write(
    preset: Preset,
    format_name: str,
    output: Path,
    *,
    name: str,
    attitude: str = "flown",
    ramp: float = formats.RAMP,
    once: bool = False,
    uncertified: bool = False,
    otherwise: str,
) -> CertifiedExport:
    """Write a file or folder and its certificate.

    `name` is the preset's name in error messages; `otherwise` says how to write an uncertified file. attitude, ramp and
    once are those of `formats.ExportOptions`.

    Raises RefusedExportError, and leaves nothing written, if the gate refuses the preset or if what was written fails
    its certificate (unless `uncertified`); ValueError if the format cannot hold the preset at all.
    """
    options = formats.export_options(attitude=attitude, ramp=ramp, once=once)
    try:
        return _written(preset, format_name, output, options, uncertified=uncertified)
    except RefusedExportError as error:
        sentence = f"{name}: {error}; nothing was written ({otherwise})"
        raise RefusedExportError(sentence, preset, format_name, options, error.missed) from None
    except ValueError as error:
        named = str(error).startswith((f"{name}:", f"{format_name}:"))
        raise error if named else ValueError(f"{name}: {error}") from None


@lru_cache(maxsize=CACHED)
def refusal(preset: Preset, format_name: str, options: ExportOptions) -> RefusedExportError | None:
    """Why a preset cannot be exported in a format with a certificate; None if it can."""
    with tempfile.TemporaryDirectory(prefix="rangenav-") as folder:
        try:
            _written(preset, format_name, Path(folder) / "x", options, uncertified=False)
        except RefusedExportError as error:
            return error
        except ValueError as error:
            return RefusedExportError(str(error), preset, format_name, options, frozenset())
    return None


def _written(
    preset: Preset, format_name: str, output: Path, options: ExportOptions, *, uncertified: bool
) -> CertifiedExport:
    row = formats.row(format_name)
    if row.unsupported:
        raise ValueError(f"{format_name}: {row.unsupported}")
    try:
        _pass_gate(preset, format_name, options)
        if row.drafts is not None:
            return _first_certified(preset, format_name, output, options)
    except RefusedExportError as error:
        if not uncertified:
            raise
        return _marked(preset, format_name, output, options, str(error))
    written = formats.export(preset, format_name, output)
    if row.certified_as == "neither":
        reason = f"nothing in a file of {format_name} can be certified"
        return CertifiedExport(output=written, certificate=None, complaint=None, reason=reason)
    certificate = _certified_run(preset, format_name, output)
    return CertifiedExport(output=written, certificate=certificate, complaint=None)


def _pass_gate(preset: Preset, format_name: str, options: ExportOptions) -> None:
    """Raise RefusedExportError if the preset may not be exported in the format at all."""
    complaint = exports.gate(preset, format_name)
    if complaint is not None:
        issued = exports.certificate_of(preset)
        missed = frozenset(check.name for check in issued.checks if not check.met)
        short = objection.in_short(issued)
        sentence = complaint if short is None else f"{short} ({complaint})"
        raise RefusedExportError(sentence, preset, format_name, options, missed)


def _marked(preset: Preset, format_name: str, output: Path, options: ExportOptions, complaint: str) -> CertifiedExport:
    """The finest file that the format can hold, under a name that says that it is uncertified."""
    row, place = formats.row(format_name), formats.marked(output)
    if row.drafts is None:
        written = formats.export(preset, format_name, place)
    else:
        try:
            *_, finest = row.drafts(preset, options)
        except ValueError:  # the format holds less than one window: then as much as it holds
            *_, finest = row.drafts(_any_window(preset), options)
        written = finest(place)
    strays = () if written.unfit is None else (written.unfit,)
    notes = (f"UNCERTIFIED: {complaint}", *strays, *written.notes)
    return CertifiedExport(
        output=replace(written, notes=notes), certificate=None, complaint=complaint, reason=complaint
    )


def _any_window(preset: Preset) -> Preset:
    """The preset with the shortest window that a preset may have."""
    shortest = max(MIN_WINDOW, MIN_WINDOW_SAMPLES / preset.sensors.imu_rate)
    requirement = msgspec.structs.replace(preset.requirement, window=shortest)
    return msgspec.structs.replace(preset, requirement=requirement)


def _first_certified(preset: Preset, format_name: str, output: Path, options: ExportOptions) -> CertifiedExport:
    """The first way to write a motion that its certificate confirms. Raises RefusedExportError: why the finest fails.

    After each refusal twice as many ways are skipped as before, but never the finest."""
    drafts = formats.row(format_name).drafts
    assert drafts is not None
    failure, missed = "", PIECES
    try:
        every, step, k = list(drafts(preset, options)), 1, 0
        while k < len(every):
            written = every[k](output)
            failure, missed = written.unfit or _lacks_excitation(written, preset), PIECES
            if failure is None:
                issued = _certified(preset, format_name, output, written, options)
                ramps = ramp_limits.broken(preset, written) if issued.certified else None
                if ramps is not None:
                    failure, missed = ramps, RAMPS
                    break
                if issued.certified:
                    certificate = exports.write_certificate(issued, output)
                    return CertifiedExport(output=written, certificate=certificate, complaint=None)
                failure = f"as {format_name} it does not keep what it promises: {'; '.join(issued.failures)}"
                missed = frozenset(check.name for check in issued.checks if not check.met)
                if not missed & FINER_HELPS:
                    break
                k, step = (k if k == len(every) - 1 else min(k + step, len(every) - 1) - 1), 2 * step
            k += 1
    except ValueError as error:
        failure, missed = str(error), PIECES
    except BaseException:
        _remove(output)
        raise
    _remove(output)
    raise RefusedExportError(failure or "", preset, format_name, options, missed)


def _lacks_excitation(written: OutputFile, preset: Preset) -> str | None:
    """Why no certificate is worth computing, as one clause: on samples the file lacks excitation already."""
    reached, needed = written.figures.get("mu"), preset.requirement.mu
    if reached is None or reached >= needed:
        return None
    pieces = f"{written.figures['pieces']} pieces"
    return f"of the excitation {pieces} keep {reached:.3g} m²/s⁷, and {needed:.3g} are required"


def _certified(
    preset: Preset, format_name: str, output: Path, written: OutputFile, options: ExportOptions
) -> Certificate:
    return exports.certified(
        preset, format_name, output, steady=written.steady, loop=written.loop, attitude=options.attitude
    )


def _certified_run(preset: Preset, format_name: str, output: Path) -> Path:
    """Write the certificate of the written bytes. Raises ValueError, and removes what was written, if it fails."""
    try:
        certificate = exports.certified(preset, format_name, output)
        if not certificate.certified:
            failures = "; ".join(certificate.failures)
            raise ValueError(f"as {format_name} it does not keep what it promises: {failures}")
        return exports.write_certificate(certificate, output)
    except BaseException:
        _remove(output)
        raise


def _remove(output: Path) -> None:
    if output.is_dir():
        shutil.rmtree(output)
    else:
        output.unlink(missing_ok=True)
