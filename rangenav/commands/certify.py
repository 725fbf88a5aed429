"""`rangenav certify`: what a preset's motion is proven and found to do, recomputed from the file's bytes."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import tyro
from rich.console import Console
from rich.text import Text

from rangenav.commands.output import PresetName, print_json, print_table, require_place

if TYPE_CHECKING:
    from rangenav.certificate import Certificate

SAID = {"format", "version", "title", "expect", "certified", "meets", "verdict", "checks", "failures", "remedy"}
"""What stands in the sentences above the table."""


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
        _print(found, plain)
    if not found.certified:
        for sentence in found.failures:
            print(f"{preset}: {sentence}", file=sys.stderr)
        raise SystemExit(1)


def _print(found: "Certificate", plain: dict[str, Any]) -> None:
    """For people: what was asked and whether it is met, for which windows, what would help; then every figure."""
    console, claim = Console(), found.claim
    console.print(Text(f"{found.title}: {'certified' if found.certified else 'NOT certified'}, {found.verdict}"))
    for one in found.checks:
        known = "" if one.proven else " (on samples)"
        console.print(Text(f"  {'✓' if one.met else '✕'} {one.name}{known}: {one.words}"))
    if found.expect != "observable":
        console.print(Text(f"  expected {found.expect}: {'it is' if found.certified else 'it is not'}"))
    if isinstance(found.remedy, str):
        console.print(Text(f"  to meet every requirement it would do to {found.remedy}"))
    bounded = "bounded" if found.excitation.lower is not None else "sampled"
    console.print(Text(f"  the excitation is {bounded} for windows of {claim.window:g} s from {claim.starts}"))
    print_table("figures", {key: value for key, value in plain.items() if key not in SAID})
