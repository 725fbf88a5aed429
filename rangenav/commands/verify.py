"""`rangenav verify`: files against the certificates beside them."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import tyro

from rangenav.commands.output import print_json
from rangenav.commands.progress import working
from rangenav.inputs import require

if TYPE_CHECKING:
    from rangenav.certificate import Certificate, Verification


def verify(
    files: Annotated[tyro.conf.Positional[tuple[str, ...]], tyro.conf.arg(metavar="FILE ...")],
    *,
    certificate: Annotated[Path | None, tyro.conf.arg(metavar="CERTIFICATE.json")] = None,
    json: bool = False,
) -> None:
    """Verify presets, exported files and folders against the certificates beside them; exit 1 if anything fails.

    Example: rangenav verify paper-slow flight.csv

    Args:
        files: Shipped presets' names, or paths of presets, exported files, folders, or their certificates. A folder
            that has no certificate of its own stands for all in it that have one. The bytes are read again and
            everything is recomputed.
        certificate: The certificate of the one file, where it is not beside the file.
        json: Print one JSON object.
    """
    from rangenav import certificate as certificates
    from rangenav.certificate import exports
    from rangenav.commands.text import certificates as text
    from rangenav.commands.text import layout

    require(len(files) > 0, "verify: no file was named")
    require(certificate is None or len(files) == 1, "--certificate is the certificate of one file; name one file")
    if certificate is None:
        files = tuple(part for name in files for part in certificates.certified_in(name))
    require(certificate is None or certificate.is_file(), f"--certificate {certificate}: no such file")
    readers = exports.readers()
    checked: dict[str, certificates.Verification] = {}
    for name in files:
        with working(f"verifying {name}"):
            checked[name] = certificates.check_file(name, readers=readers, certificate=certificate)
    stored = {
        name: certificates.read_stored(name, certificate) for name, one in checked.items() if one.outcome == "holds"
    }
    if json:
        print_json({"files": {name: _answer(one, stored.get(name)) for name, one in checked.items()}})
    else:
        lacking = [name for name, one in checked.items() if one.outcome == "no certificate"]
        missing = {name: place for name in lacking if (place := certificates.missing_certificate(name)) is not None}
        layout.show(text.verified(checked, stored, missing))
    for sentence in [sentence for one in checked.values() for sentence in one.failures]:
        print(sentence, file=sys.stderr)
    if any(one.failures for one in checked.values()):
        raise SystemExit(1)


def _answer(checked: "Verification", stored: "Certificate | None") -> dict[str, Any]:
    """The JSON object of one file; the verdict of a certificate that holds."""
    answer: dict[str, Any] = {"holds": not checked.failures, "failures": checked.failures, "outcome": checked.outcome}
    if checked.path is not None:
        answer["path"] = str(checked.path)
    if stored is None:
        return answer
    from rangenav.certificate import verdict_of

    verdict = verdict_of(stored)
    word = verdict.word if verdict.judged else None
    return {**answer, "verdict": word, "expect": stored.expect, "verdict_words": verdict.summary}
