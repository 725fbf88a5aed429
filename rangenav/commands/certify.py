"""`rangenav certify`: what a preset's motion is proven and found to do, recomputed from the file's bytes."""

import sys
from pathlib import Path
from typing import Annotated

import tyro

from rangenav.commands.output import PresetName, print_json, print_table, require_place


def certify(
    preset: PresetName,
    *,
    output: Annotated[Path | None, tyro.conf.arg(aliases=["-o"], metavar="FILE.json")] = None,
    json: bool = False,
) -> None:
    """Certify a preset; exit 1 if it does not deliver what it promises.

    Args:
        preset: A shipped preset's name or a path to a TOML file.
        output: Write the certificate here; NAME.certificate.json beside NAME.toml is where `verify` looks.
        json: Print the certificate as one JSON object.
    """
    from rangenav import certificate

    require_place("-o", output, ".json")
    found = certificate.certify_file(preset)
    if output is not None:
        output.write_bytes(certificate.dumps(found))
    plain = certificate.plain(found)
    if json:
        print_json(plain)
    elif output is None:
        plain["checks"] = [{"words": f"{'✓' if one.met else '✕'} {one.name}: {one.words}"} for one in found.checks]
        print_table(f"{found.title}: {'certified' if found.certified else 'NOT certified'}, {found.verdict}", plain)
    if not found.certified:
        for sentence in found.failures:
            print(f"{preset}: {sentence}", file=sys.stderr)
        raise SystemExit(1)
