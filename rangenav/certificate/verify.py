"""Verification: read the bytes again, compute the certificate again, and compare it with the stored certificate.

Numbers may differ by rounding between processors and versions; the tolerances are stated here. Sentences are compared
together with the numbers in them. Both files may come from a stranger: whatever they hold, the answer is sentences.
"""

import hashlib
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import msgspec

from rangenav import preset as presets
from rangenav.certificate import encoding
from rangenav.certificate.certify import READERS, Reader, certify
from rangenav.certificate.files import file_of, path_for, read_bytes
from rangenav.certificate.schema import Certificate

RELATIVE = 1e-4
"""Figures agree to this share: eight digits are written, and the worst window may move by a share of 1e-6."""
ABSOLUTE = {
    "at": 1e-3,  # s: a grid of starts may round differently
    "direction": 1e-3,  # cosines
    "smallest_bound": 1e-11,
    "smallest_singular": 1e-11,  # rounding of rows is 1e-13 of a largest one of some tens
}
"""An absolute tolerance that is added, by key."""
LOOSE = {
    "floor": 0.5,  # an allowance, not a figure
    "smallest_bound": 0.1,  # which stretch is halved last may depend on rounding
    "starts": 0.1,  # points of a grid, whose refinement rounds upwards
    "windows": 0.1,  # likewise
    "remedy": 0.3,  # what a search ends with
}
"""Relative tolerances that replace the usual one, by key."""
IN_WORDS = 0.02
"""Numbers in sentences have three or four figures."""
UNCOMPARED = {"tool"}
"""Keys that are not compared: another version of the tool may verify."""
NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
SHOWN = 60
"""Characters of a value that a sentence quotes."""


Outcome = Literal["holds", "changed", "differs", "missed", "no certificate", "not read"]
"""changed: the file's bytes are not those that were certified; differs: the bytes are, but the certificate states what
they do not give; missed: both agree, on a preset that does not deliver what it promises."""


@dataclass(frozen=True, kw_only=True)
class Verification:
    """Whether a file is what its certificate says."""

    outcome: Outcome
    failures: tuple[str, ...] = ()
    """One sentence for each place where file and certificate disagree; empty if the certificate holds."""
    path: Path | None = None
    """The file or folder that was checked; None if none was found, or if bytes were checked and no file."""


def verify_file(name_or_path: str | Path, *, readers: Mapping[str, Reader] = READERS) -> tuple[str, ...]:
    """The sentences of `check_file`; empty if a file and its certificate agree."""
    return check_file(name_or_path, readers=readers).failures


def check_file(
    name_or_path: str | Path, *, readers: Mapping[str, Reader] = READERS, certificate: Path | None = None
) -> Verification:
    """Whether a file and its certificate agree.

    The file is a shipped preset's name, a preset, an exported file or folder whose format `readers` knows, or the
    certificate of any of these. certificate: the certificate's path, where it is not beside the file.
    """
    try:
        path, place = _pair(name_or_path, certificate)
        content = read_bytes(path)
        if not place.is_file():
            sentence = f"{path.name}: there is no certificate beside it ({place.name})"
            return Verification(outcome="no certificate", failures=(sentence,), path=path)
        stored = encoding.loads(read_bytes(place), source=place.name)
    except ValueError as error:
        return Verification(outcome="not read", failures=(str(error),))
    return replace(check(content, stored, source=path.name, readers=readers), path=path)


def missing_certificate(name_or_path: str | Path) -> Path | None:
    """Where the certificate of a file would lie, for a file that has none; None for any other name."""
    try:
        _, certificate = _pair(name_or_path, None)
    except ValueError:
        return None
    return None if certificate.is_file() else certificate


def verify(
    content: bytes, stored: Certificate, *, source: str, readers: Mapping[str, Reader] = READERS
) -> tuple[str, ...]:
    """The sentences of `check`; empty if a file's bytes and their certificate agree."""
    return check(content, stored, source=source, readers=readers).failures


def check(content: bytes, stored: Certificate, *, source: str, readers: Mapping[str, Reader] = READERS) -> Verification:
    """Whether a file's bytes and their certificate agree."""
    digest = hashlib.sha256(content).hexdigest()
    if digest != stored.artifact.sha256:
        sentence = f"{source}: its bytes are not those that were certified: SHA-256 {digest[:12]}… differs"
        return Verification(outcome="changed", failures=(sentence,))
    try:
        context = (
            None if stored.context is msgspec.UNSET else presets.loads(stored.context, source=f"{source}, context")
        )
        form, loop = stored.artifact.format, stored.artifact.loop or None
        computed = certify(
            content, source=source, form=form, context=context, loop=loop, readers=readers, version=stored.version
        )
    except ValueError as error:
        return Verification(outcome="not read", failures=(str(error),))
    differing = differences(stored, computed)
    failures = tuple(f"{source}: {sentence}" for sentence in (*differing, *computed.failures))
    outcome: Outcome = "differs" if differing else "missed" if failures else "holds"
    return Verification(outcome=outcome, failures=failures)


def differences(stored: Certificate, computed: Certificate) -> tuple[str, ...]:
    """A sentence for each place where two certificates differ by more than rounding; the tool is not compared."""
    return tuple(_differences(_compared(stored), _compared(computed), ""))


def read_stored(name_or_path: str | Path, certificate: Path | None = None) -> Certificate:
    """The stored certificate of a file, or of a shipped preset by its name. Raises ValueError."""
    _, place = _pair(name_or_path, certificate)
    return encoding.loads(read_bytes(place), source=place.name)


def _pair(name_or_path: str | Path, certificate: Path | None) -> tuple[Path, Path]:
    """A file and its certificate, by the name of either. Raises ValueError."""
    path = Path(name_or_path)
    if certificate is not None:
        return _existing(path), certificate
    owner = file_of(path)
    if owner is not None and owner.exists():
        return owner, path
    if path.suffix == ".json" and path.is_file() and not path_for(path).is_file():
        return _certified_by(path), path
    if owner is not None:
        raise ValueError(f"{path.name}: there is no {owner.name} beside it that could be verified")
    path = _existing(path)
    return path, path_for(path)


def _existing(path: Path) -> Path:
    """The file of a path, or of a shipped preset's name."""
    if path.suffix or path.parent != Path(".") or path.is_dir():
        if not path.exists():
            raise ValueError(f"{path}: no such file")
        return path.resolve() if path.name in ("", "..") else path
    return presets.find(path)


def _certified_by(certificate: Path) -> Path:
    """The file that a certificate of any name was made from: beside it, or a shipped preset.

    A file beside it that has its name, or that of the shipped preset with the stated bytes, comes first, whatever its
    bytes are; then the bytes decide; then the title. A shipped preset is taken only where there is no such file.
    """
    stored = encoding.loads(read_bytes(certificate), source=certificate.name)
    shipped = [file for file in presets.shipped_files() if _has_bytes(file, stored)]
    for name in (certificate.with_suffix(".toml").name, *(file.name for file in shipped)):
        if certificate.with_name(name).is_file():
            return certificate.with_name(name)
    near = [file for file in sorted(certificate.parent.iterdir()) if file.is_file()]
    same = [file for file in near if _has_bytes(file, stored)]
    titled = [] if same else [file for file in near if file.suffix == ".toml" and _title(file) == stored.title]
    for file in (*same, *titled, *shipped):
        return file
    raise ValueError(
        f"{certificate.name}: no file beside it and no shipped preset has the bytes that it certifies (SHA-256 "
        f"{stored.artifact.sha256[:12]}…); name the file: rangenav verify FILE --certificate {certificate.name}"
    )


def _has_bytes(file: Path, stored: Certificate) -> bool:
    same_size = file.stat().st_size == stored.artifact.bytes
    return same_size and hashlib.sha256(read_bytes(file)).hexdigest() == stored.artifact.sha256


def _title(preset: Path) -> str | None:
    """The title of a preset's file; None for a file that is none."""
    try:
        return presets.load(preset).title
    except ValueError:  # the limits of size and depth are checked there, before anything is parsed
        return None


def _compared(certificate: Certificate) -> dict[str, Any]:
    return {key: value for key, value in encoding.to_builtins(certificate).items() if key not in UNCOMPARED}


def _differences(stored: Any, computed: Any, path: str) -> Iterator[str]:
    """A sentence for each place where the stored certificate is not the one found."""
    if isinstance(stored, dict) and isinstance(computed, dict):
        for key in [*stored, *(key for key in computed if key not in stored)]:
            place = f"{path}.{key}".lstrip(".")
            if key in stored and key in computed:
                yield from _differences(stored[key], computed[key], place)
            else:
                yield f"{place} {'is not found again' if key in stored else 'is missing'}"
    elif isinstance(stored, list) and isinstance(computed, list) and len(stored) == len(computed):
        for k, (one, other) in enumerate(zip(stored, computed, strict=True)):
            yield from _differences(one, other, f"{path}[{k}]")
    elif not _same(stored, computed, path.rsplit(".", 1)[-1].split("[")[0]):
        yield f"{path} is {_quoted(stored)} in the certificate, found again as {_quoted(computed)}"


def _same(stored: Any, computed: Any, key: str) -> bool:
    numbers = [value for value in (stored, computed) if isinstance(value, int | float) and not isinstance(value, bool)]
    if len(numbers) == 2:
        if isinstance(stored, int) and isinstance(computed, int) and key not in LOOSE:
            return stored == computed
        return _close(stored, computed, LOOSE.get(key, RELATIVE), ABSOLUTE.get(key, 0.0))
    if isinstance(stored, str) and isinstance(computed, str) and key not in ("sha256", "context"):
        return _same_sentence(stored, computed, LOOSE.get(key, IN_WORDS))
    return type(stored) is type(computed) and stored == computed


def _close(one: float, other: float, share: float, slack: float) -> bool:
    return one == other or abs(one - other) <= share * max(abs(one), abs(other)) + slack


def _same_sentence(one: str, other: str, share: float) -> bool:
    """The same sentence, with numbers that agree to a share of them."""
    if NUMBER.sub("#", one) != NUMBER.sub("#", other):
        return False
    pairs = zip(NUMBER.findall(one), NUMBER.findall(other), strict=True)
    return all(_close(float(a), float(b), share, IN_WORDS) for a, b in pairs)


def _quoted(value: Any) -> str:
    text = " ".join(str(value).split())
    return text if len(text) <= SHOWN else text[: SHOWN - 1] + "…"
