"""`rangenav certify`: what a preset's motion is proven and found to do, recomputed from the file's bytes."""

import sys
from pathlib import Path
from typing import Annotated

import tyro

from rangenav.commands.output import PresetName, print_json, require_place
from rangenav.commands.progress import working


def certify(
    preset: PresetName,
    *,
    output: Annotated[Path | None, tyro.conf.arg(aliases=["-o"], metavar="FILE.json")] = None,
    json: bool = False,
) -> None:
    """Certify a preset; exit 1 if it does not deliver what it promises.

    Example: rangenav certify paper-slow -o paper-slow.certificate.json

    Args:
        preset: A shipped preset's name or a path to a TOML file.
        output: Write the certificate here; NAME.certificate.json beside NAME.toml is where `verify` looks.
        json: Print the certificate as one JSON object.
    """
    from rangenav import certificate
    from rangenav import preset as presets
    from rangenav.certificate import advice
    from rangenav.commands.text import certificates as text
    from rangenav.commands.text import layout

    require_place("-o", output, ".json")
    with working(f"certifying {preset}"):
        issued = certificate.certify_file(preset)
    if output is not None:
        output.write_bytes(certificate.dumps(issued))
    if json:
        print_json(certificate.to_builtins(issued))
    else:
        helps = None if issued.meets else advice.change(presets.load(preset)) or advice.SEARCH
        layout.show(text.certified(issued, name=preset, written=output, helps=helps))
    if not issued.certified:
        missed = ", ".join(one.name for one in issued.checks if not one.met)
        short = [f"not certified; not met: {missed}"] if missed and not json else issued.failures
        for sentence in short:  # the report has the sentences
            print(f"{preset}: {sentence}", file=sys.stderr)
        raise SystemExit(1)
