"""Numeric arrays of a MATLAB v5 file, read within limits: sizes are checked before data are unpacked or allocated.

A file is a 128-byte header and elements (type, size, data); a matrix element holds flags, sizes, a name and numbers.
Compressed elements are unpacked up to a limit. Cells, text and complex numbers are passed over; the fields of a struct
are read if it is named. scipy's reader does more and is the tests' witness, but damaged files can make it ask for any
amount of memory.
"""

import math
import struct
import zlib
from collections.abc import Iterator

import numpy as np
from numpy import ndarray as Array

from rangenav.inputs import require

HEADER = 128
MAX_UNPACKED = 160_000_000
"""Bytes that are unpacked, and of the arrays that are made of them (8 for each number), together."""
MAX_VARIABLES = 1000
COMPRESSED, MATRIX = 15, 14
NUMBERS = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
"""Element types of the numbers themselves."""
NUMERIC_CLASSES = range(6, 16)
"""double, single and the integers."""
STRUCT_CLASS = 2
COMPLEX = 0x08
MAX_NAME, MAX_DIMENSIONS, MAX_FIELDS = 63, 8, 100
TAG = 8
"""Bytes of type and size before an element."""


class _Budget:
    """How many bytes may still be unpacked or allocated."""

    def __init__(self, source: str) -> None:
        self.source, self.left = source, MAX_UNPACKED

    def spend(self, count: int) -> None:
        """Take bytes off, before they are allocated. Raises ValueError if there are not so many left."""
        self.left -= count
        require(self.left >= 0, f"{self.source}: more than {MAX_UNPACKED / 1e6:.0f} MB of numbers when it is unpacked")


def arrays(data: bytes, *, source: str) -> dict[str, Array]:
    """Every real numeric variable by its name, as floats. Raises ValueError for a damaged or truncated file."""
    variables: dict[str, Array] = {}
    order, budget = _order(data, source), _Budget(source)
    for body in _matrices(data, order, budget):
        name, values = _matrix(body, order, budget)
        if values is not None:
            variables[name] = values
    return variables


def fields(data: bytes, struct_name: str, *, source: str) -> dict[str, Array]:
    """Every real numeric field of one struct by its name, as floats. Raises ValueError, also if it is not there."""
    order, budget = _order(data, source), _Budget(source)
    for body in _matrices(data, order, budget):
        flag, _, name, at = _head(body, order, source)
        if name == struct_name and flag & 0xFF == STRUCT_CLASS:
            return _fields(body, at, order, budget)
    raise ValueError(f"{source}: no struct named {struct_name} in it")


def _order(data: bytes, source: str) -> str:
    require(len(data) > HEADER, f"{source}: too short for a .mat file")
    marker = data[126:128]
    require(marker in (b"IM", b"MI"), f"{source}: not a MATLAB v5 file (v7.3 is HDF5: save it with -v7 instead)")
    return "<" if marker == b"IM" else ">"


def _matrices(data: bytes, order: str, budget: _Budget) -> Iterator[memoryview]:
    """The body of each variable, unpacked."""
    at, count, source = HEADER, 0, budget.source
    while at + TAG <= len(data):
        kind, size = struct.unpack_from(order + "II", data, at)
        body = memoryview(data)[at + TAG : at + TAG + size]
        require(len(body) == size, f"{source}: cut short at byte {at}")
        at, count = at + TAG + size, count + 1
        require(count <= MAX_VARIABLES, f"{source}: more than {MAX_VARIABLES} variables")
        if kind == COMPRESSED:
            kind, body = _unpacked(body, order, budget)
        elif size % 8:
            at += 8 - size % 8
        if kind == MATRIX and len(body) > 0:
            yield body


def _unpacked(body: memoryview, order: str, budget: _Budget) -> tuple[int, memoryview]:
    """Type and content of a compressed element. What its tag says is subtracted first, and no more is unpacked."""
    unpacking, source = zlib.decompressobj(), budget.source
    try:
        tag = unpacking.decompress(body, TAG)
        require(len(tag) == TAG, f"{source}: a variable is cut short")
        kind, size = struct.unpack(order + "II", tag)
        budget.spend(size)
        content = unpacking.decompress(unpacking.unconsumed_tail, size) if size else b""  # 0 would mean no limit
    except zlib.error:
        raise ValueError(f"{source}: a compressed variable is damaged") from None
    require(len(content) == size, f"{source}: a variable is cut short")
    return kind, memoryview(content)


def _head(body: memoryview, order: str, source: str) -> tuple[int, list[int], str, int]:
    """Flags, dimensions and name of a matrix element, and where its content begins."""
    _, flags, at = _part(body, 0, order, source)
    require(len(flags) >= 8, f"{source}: a variable has no flags")
    _, raw, at = _part(body, at, order, source)
    require(len(raw) <= 4 * MAX_DIMENSIONS, f"{source}: a variable has no sensible dimensions")
    dimensions = np.frombuffer(raw[: len(raw) // 4 * 4], dtype=order + "i4").astype(int).tolist()
    _, letters, at = _part(body, at, order, source)
    require(len(letters) <= MAX_NAME, f"{source}: a variable's name is damaged")
    name = bytes(letters).decode("ascii", errors="replace")
    require(name == "" or name.isidentifier(), f"{source}: a variable's name is damaged")
    return struct.unpack_from(order + "I", flags)[0], dimensions, name, at


def _matrix(body: memoryview, order: str, budget: _Budget) -> tuple[str, Array | None]:
    """Name and numbers of one matrix element; no numbers if it is not real and numeric."""
    source = budget.source
    flag, dimensions, name, at = _head(body, order, source)
    if flag & 0xFF not in NUMERIC_CLASSES or flag >> 8 & COMPLEX:
        return name, None
    kind, numbers, _ = _part(body, at, order, source)
    shown = f"{source}: {name[:20]!r}"
    require(kind in NUMBERS, f"{shown} holds numbers of an unknown type {kind}")
    dtype = np.dtype(order + NUMBERS[kind])
    require(len(dimensions) >= 1 and all(size >= 0 for size in dimensions), f"{shown} has no sensible dimensions")
    product = math.prod(dimensions)
    require(product * dtype.itemsize == len(numbers), f"{shown} has {len(numbers)} bytes for {product} numbers")
    budget.spend(8 * product)
    with np.errstate(invalid="ignore"):  # damaged bytes may be signalling NaNs; they become plain ones
        values = np.frombuffer(numbers, dtype=dtype).astype(float)
    values[np.isnan(values)] = np.nan
    return name, values.reshape(dimensions, order="F")


def _fields(body: memoryview, at: int, order: str, budget: _Budget) -> dict[str, Array]:
    """The numeric fields of a struct: the length of a name, all names, and one matrix for each."""
    source = budget.source
    _, raw, at = _part(body, at, order, source)
    require(len(raw) == 4, f"{source}: a struct is damaged")
    length = struct.unpack_from(order + "i", raw)[0]
    _, letters, at = _part(body, at, order, source)
    sensible = 0 < length <= MAX_NAME + 1 and len(letters) <= length * MAX_FIELDS
    require(sensible, f"{source}: a struct is damaged")
    found: dict[str, Array] = {}
    for begin in range(0, len(letters), length):
        field = bytes(letters[begin : begin + length]).split(b"\0")[0].decode("ascii", errors="replace")
        kind, matrix, at = _part(body, at, order, source)
        if kind == MATRIX and len(matrix) > 0:
            _, values = _matrix(matrix, order, budget)
            if values is not None:
                found[field] = values
    return found


def _part(body: memoryview, at: int, order: str, source: str) -> tuple[int, memoryview, int]:
    """(type, data, start of the next part); a part of at most four bytes has its data in its tag."""
    require(at + 8 <= len(body), f"{source}: a variable is cut short")
    kind, size = struct.unpack_from(order + "II", body, at)
    if kind >> 16:
        size, kind, begin, end = kind >> 16, kind & 0xFFFF, at + 4, at + 8
        require(size <= 4, f"{source}: a variable is damaged")
    else:
        begin = at + 8
        end = begin + size + (-size) % 8
    require(begin + size <= len(body), f"{source}: a variable is cut short")
    return kind, body[begin : begin + size], end
