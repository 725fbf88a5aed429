"""Certificates: what a file's motion lets one range tell, recomputed from its bytes and held against its claim.

certify(bytes)      the certificate of a file's bytes       gate(certificate)    None, or why it may not be exported
verify_file(path)   what is wrong with a file and the certificate beside it, a sentence each
"""

from rangenav.certificate.certify import READERS, Held, Reader, certify, certify_file, read_preset
from rangenav.certificate.files import beside
from rangenav.certificate.requirements import gate
from rangenav.certificate.schema import Certificate, dumps, loads, plain
from rangenav.certificate.verify import differences, read_beside, verify, verify_file

__all__ = [
    "READERS",
    "Certificate",
    "Held",
    "Reader",
    "beside",
    "certify",
    "certify_file",
    "differences",
    "dumps",
    "gate",
    "loads",
    "plain",
    "read_beside",
    "read_preset",
    "verify",
    "verify_file",
]
