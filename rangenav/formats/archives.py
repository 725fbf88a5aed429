"""Members of a zip archive, unpacked within limits: what counts are the bytes that come out, not those it states.

zipfile bounds what it unpacks only for stored and deflated members: a member of 1 kB packed with bzip2 became 3 GB. So
other methods are refused, and names and members are counted before the archive's table of contents is read.
"""

import io
import zipfile
import zlib
from collections.abc import Callable

from rangenav.inputs import require, shortened

MAX_MEMBERS = 1000
MAX_NAME = 255
"""Characters of a member's name, as file systems have them."""
METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
ENTRY = b"PK\x01\x02"
"""The first bytes of each entry in the table of contents."""
ENCRYPTED = 0x1


def members(content: bytes, *, source: str, wanted: Callable[[str], bool], limit: int) -> dict[str, bytes]:
    """The members whose names are `wanted`, by name, of `limit` bytes together at most. Raises ValueError."""
    require(content.count(ENTRY) <= MAX_MEMBERS, f"{source}: more than {MAX_MEMBERS} files in one zip")
    unpacked: dict[str, bytes] = {}
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            for entry in archive.infolist():
                require(len(entry.filename) <= MAX_NAME, f"{source}: a name of more than {MAX_NAME} characters in it")
                if wanted(entry.filename):
                    require(entry.filename not in unpacked, f"{source}: two files of one name in it")
                    unpacked[entry.filename] = data = _unpacked(archive, entry, source, limit)
                    limit -= len(data)
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError, OSError) as error:
        raise ValueError(f"{source}: this zip cannot be read ({shortened(str(error))})") from None
    return unpacked


def _unpacked(archive: zipfile.ZipFile, entry: zipfile.ZipInfo, source: str, limit: int) -> bytes:
    name = "".join(c if c.isprintable() else "?" for c in entry.filename)[-40:]
    rule = f"{source}: {name} is packed by a method that is not read: pack it with deflate, as zip programs do"
    require(entry.compress_type in METHODS and not entry.flag_bits & ENCRYPTED, rule)
    with archive.open(entry) as member:
        data = member.read(limit + 1)
    require(len(data) <= limit, f"{source}: {name} unpacks to more than {limit} bytes")
    return data
