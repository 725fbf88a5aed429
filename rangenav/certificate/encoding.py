"""The JSON of a certificate: the same bytes for the same certificate, and finite numbers only."""

import math
from typing import Any

import msgspec

from rangenav.certificate.schema import Certificate
from rangenav.inputs import shortened

MAX_BYTES = 200_000
"""Larger files are no certificates."""


def to_builtins(certificate: Certificate) -> dict[str, Any]:
    """Nested dicts and lists. Raises ValueError if a number is not finite: that is an error of ours."""
    entries = msgspec.to_builtins(certificate)
    _refuse_nonfinite(entries, "$")
    return msgspec.json.decode(msgspec.json.encode(entries))  # lists for tuples


def dumps(certificate: Certificate) -> bytes:
    """JSON, indented, ending in a line feed: the same bytes for the same certificate."""
    return msgspec.json.format(msgspec.json.encode(to_builtins(certificate)), indent=2) + b"\n"


def loads(content: bytes, *, source: str) -> Certificate:
    """A certificate from JSON; errors start with `source`. Raises ValueError with one sentence."""
    if len(content) > MAX_BYTES:
        raise ValueError(f"{source}: larger than {MAX_BYTES} bytes, which no certificate is")
    try:
        certificate = msgspec.json.decode(content, type=Certificate)
        _refuse_nonfinite(msgspec.to_builtins(certificate), "$")
    except (msgspec.DecodeError, ValueError) as error:
        raise ValueError(f"{source}: no certificate: {shortened(str(error))}") from None
    except RecursionError:
        raise ValueError(f"{source}: no certificate: nested too deeply") from None
    return certificate


def _refuse_nonfinite(value: Any, path: str) -> None:
    if isinstance(value, float) and not math.isfinite(value):
        raise ValueError(f"{path} is not finite")
    if isinstance(value, dict):
        for key, entry in value.items():
            _refuse_nonfinite(entry, f"{path}.{key}")
    if isinstance(value, list | tuple):
        for k, entry in enumerate(value):
            _refuse_nonfinite(entry, f"{path}[{k}]")
