"""`rangenav verify`: files against the certificates beside them."""

import sys
from typing import Annotated

import tyro

from rangenav.commands.output import print_json
from rangenav.commands.progress import working
from rangenav.inputs import require


def verify(
    files: Annotated[tyro.conf.Positional[tuple[str, ...]], tyro.conf.arg(metavar="FILE ...")], *, json: bool = False
) -> None:
    """Verify presets, exported files and folders against the certificates beside them; exit 1 if anything fails.

    Example: rangenav verify paper-slow flight.csv

    Args:
        files: Shipped presets' names, or paths of presets, exported files, folders, or their certificates. The bytes
            are read again and everything is recomputed.
        json: Print one JSON object.
    """
    from rangenav import certificate
    from rangenav.certificate import exports
    from rangenav.commands.text import certificates as text
    from rangenav.commands.text import layout

    require(len(files) > 0, "verify: no file was named")
    readers = exports.readers()
    failures: dict[str, tuple[str, ...]] = {}
    for name in files:
        with working(f"verifying {name}"):
            failures[name] = certificate.verify_file(name, readers=readers)
    if json:
        print_json({"files": {name: {"holds": not wrong, "failures": wrong} for name, wrong in failures.items()}})
    else:
        stored = {name: certificate.read_stored(name) for name, wrong in failures.items() if not wrong}
        missing = {name: place for name in failures if (place := certificate.missing_certificate(name)) is not None}
        layout.show(text.verified(failures, stored, missing))
    for sentence in [sentence for wrong in failures.values() for sentence in wrong]:
        print(sentence, file=sys.stderr)
    if any(failures.values()):
        raise SystemExit(1)
