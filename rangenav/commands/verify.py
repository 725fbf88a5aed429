"""`rangenav verify`: files against the certificates beside them."""

import sys
from pathlib import Path
from typing import Annotated

import tyro

from rangenav.commands.output import print_json
from rangenav.inputs import require


def verify(
    files: Annotated[tyro.conf.Positional[tuple[str, ...]], tyro.conf.arg(metavar="FILE ...")], *, json: bool = False
) -> None:
    """Verify presets, exported files and folders against the certificates beside them; exit 1 if anything fails.

    Args:
        files: Shipped presets' names, or paths of presets, exported files, folders, or their certificates. The bytes
            are read again and everything is recomputed.
        json: Print one JSON object.
    """
    from rangenav import certificate
    from rangenav.certificate import exports

    require(len(files) > 0, "verify: no file was named")
    readers = exports.readers()
    failures = {name: certificate.verify_file(name, readers=readers) for name in files}
    if json:
        print_json({"files": {name: {"holds": not wrong, "failures": wrong} for name, wrong in failures.items()}})
    else:
        for name, wrong in failures.items():
            print(f"{'✕' if wrong else '✓'} {Path(name).name}")
    for sentence in [sentence for wrong in failures.values() for sentence in wrong]:
        print(sentence, file=sys.stderr)
    if any(failures.values()):
        raise SystemExit(1)
