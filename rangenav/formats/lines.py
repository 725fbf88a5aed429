"""The lines of a text file that may hold a table, read within limits: no line is decoded that is not asked for."""

import codecs
import io
from array import array
from collections.abc import Iterator
from functools import partial

from rangenav.inputs import require

MAX_LINE = 8_192
"""Characters; the widest format has 33 columns."""
MAX_LINES = 1_010_000
"""Of every kind, also empty ones and comments."""
MAX_ROW_LINES = 20
"""Lines of one row, which goes on in the next line where an entry in quotes is still open."""
MAX_COMMENTS = 1_000
"""Comments before the first row; later ones are not kept."""
COMMENT_MARKS = ("#", "%", "//")
BINARY = {
    b"ULog\x01\x12\x35": "a ULog of PX4",
    b"#ROSBAG": "a ROS bag",
    b"\x89MCAP0": "an MCAP file",
    b"SQLite format 3": "an SQLite file, as a ROS 2 bag is",
    b"\xa3\x95": "a DataFlash log of ArduPilot",
    b"\x89HDF": "an HDF5 file",
    b"PK\x03\x04": "a zip archive",
    b"\x1f\x8b": "a gzip archive",
}
"""First bytes of formats that hold no text, and what they are."""
CONVERT = {
    b"ULog\x01\x12\x35": "convert it to CSV: ulog2csv (of pyulog) writes a file for each of its topics; join those of "
    "the IMU, the magnetometer and the ranges by their stamps into one table",
    b"\xa3\x95": "convert it to CSV: mavlogdump.py (of pymavlink) writes one for each type of message; join those of "
    "the IMU, the compass and the ranges by their stamps into one table",
    b"PK\x03\x04": "unpack it, and read the file that is in it",
    b"\x1f\x8b": "unpack it, and read the file that is in it",
}
"""How to make a table of some of them."""
WINDOWS, AROUND = codecs.lookup("cp1252"), 20
"""An encoding that is common and is not read, and the bytes beside a wrong one that must be text in it."""
PART = 2**20
"""Bytes that are decoded at a time."""
Row = tuple[int, list[str]]
"""The number of the line at which a row begins, and its entries."""


class Lines:
    """The lines of a file that are neither empty nor comments, within limits, and their numbers."""

    def __init__(self, data: bytes, source: str) -> None:
        for first, kind in BINARY.items():
            how = CONVERT.get(first, "convert it to CSV")
            require(not data.startswith(first), f"{source}: {kind} is not read; {how}")
        self.source = source
        self.numbers = array("q")
        """The line number of every line that was given out."""
        self.comments: list[Row] = []
        """Line number and text of those before the first line that was given out."""
        self.underscored: set[int] = set()
        """The numbers of the lines with an underscore: float("1_0") is 10 to Python and a misprint to everybody."""
        self.in_row = 0
        """How many lines were given out since the last row ended."""
        self.rest = self._read(data)

    def _read(self, data: bytes) -> Iterator[str]:
        file, numbers = io.TextIOWrapper(io.BytesIO(data), encoding=encoding(data)), self.numbers
        try:
            for number, line in enumerate(iter(partial(file.readline, MAX_LINE + 2), ""), 1):  # no more is decoded
                if len(line) > MAX_LINE:
                    raise ValueError(f"{self.source}, line {number}: longer than {MAX_LINE} characters")
                if number > MAX_LINES:
                    raise ValueError(f"{self.source}: more than {MAX_LINES} lines")
                begin = line.lstrip()
                if not begin:
                    continue
                if begin.startswith(COMMENT_MARKS):
                    self._remember(number, begin)
                    continue
                numbers.append(number)
                self.in_row += 1
                if self.in_row > MAX_ROW_LINES:
                    raise ValueError(f"{self.source}, line {number}: quotes that are open for {MAX_ROW_LINES} lines")
                if "_" in line:
                    self.underscored.add(number)
                yield line
        except UnicodeError:
            _refuse_undecodable(data, self.source)

    def _remember(self, number: int, comment: str) -> None:
        if self.numbers:
            return
        rule = f"{self.source}: more than {MAX_COMMENTS} comments before the first row"
        require(len(self.comments) < MAX_COMMENTS, rule)
        self.comments.append((number, [comment.lstrip("#%/").strip()]))


def begins_with_mark(data: bytes) -> bool:
    """Whether a file begins with a byte order mark."""
    return data.startswith((codecs.BOM_UTF8, codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))


def encoding(data: bytes) -> str:
    """UTF-8, or UTF-16 if the file begins with its byte order mark."""
    return "utf-16" if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)) else "utf-8-sig"


def _other_encoding(data: bytes, byte: int) -> str:
    """What the byte is in Windows-1252, in which spreadsheets save on Windows, and what to do; empty if it is none."""
    around, _ = WINDOWS.decode(data[max(0, byte - AROUND) : byte + AROUND], "replace")
    character, _ = WINDOWS.decode(data[byte : byte + 1], "replace")
    if not character.isprintable() or not all(one.isprintable() or one.isspace() for one in around):
        return ""
    return f"; this byte is {character!r} in Windows-1252: save the file again with the encoding UTF-8"


def _refuse_undecodable(data: bytes, source: str) -> None:
    """Raise ValueError naming the first byte that is no text; a part is decoded at a time, for it may take four times
    as much memory as its bytes."""
    decoder = codecs.getincrementaldecoder(encoding(data))()
    for at in range(0, len(data), PART):
        left_over = len(decoder.getstate()[0])
        try:
            decoder.decode(data[at : at + PART], final=at + PART >= len(data))
        except UnicodeDecodeError as error:
            byte = at - left_over + error.start
            raise ValueError(f"{source}: not UTF-8 text (byte {byte}){_other_encoding(data, byte)}") from None
