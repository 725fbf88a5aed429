"""Certificates: what one range can tell of a file's motion, computed from the file's bytes.

certify(bytes)      the certificate of a file's bytes       gate(certificate)    None, or why it may not be exported
verdict_of(certificate)    the verdict that it states
verify_file(path)   one sentence for each place where a file and its certificate disagree
check_file(path)    the same, with what has happened: the file changed, a requirement is not met, …
"""

from rangenav.certificate.certify import READERS, FileContents, Reader, certify, certify_file, read_preset
from rangenav.certificate.encoding import dumps, loads, to_builtins
from rangenav.certificate.files import certified_in, path_for
from rangenav.certificate.requirements import gate, verdict_of
from rangenav.certificate.schema import Certificate
from rangenav.certificate.verify import (
    Outcome,
    Verification,
    check_file,
    differences,
    missing_certificate,
    read_stored,
    verify,
    verify_file,
)

__all__ = [
    "READERS",
    "Certificate",
    "FileContents",
    "Outcome",
    "Reader",
    "Verification",
    "certified_in",
    "certify",
    "certify_file",
    "check_file",
    "differences",
    "dumps",
    "gate",
    "loads",
    "missing_certificate",
    "path_for",
    "read_preset",
    "read_stored",
    "to_builtins",
    "verdict_of",
    "verify",
    "verify_file",
]
