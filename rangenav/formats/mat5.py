"""Numeric arrays of a MATLAB v5 file, read within limits: sizes are checked before data are unpacked or allocated.

A file is a 128-byte header and elements (type, size, data); a matrix element holds flags, sizes, a name and numbers.
Compressed elements are unpacked up to a limit. Structs, cells, text and complex numbers are passed over. scipy's reader
does more and is the tests' witness, but damaged files can make it ask for any amount of memory.
"""

import struct
import zlib

import numpy as np
from numpy import ndarray as Array

from rangenav.inputs import require

HEADER = 128
MAX_UNPACKED = 256_000_000
"""Most bytes of all variables together."""
MAX_VARIABLES = 1000
COMPRESSED, MATRIX = 15, 14
NUMBERS = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
"""Element types of the numbers themselves."""
NUMERIC_CLASSES = range(6, 16)
"""double, single and the integers."""
COMPLEX = 0x08


def arrays(data: bytes, *, source: str) -> dict[str, Array]:
    """Every real numeric variable by its name, as floats. Raises ValueError for a damaged or truncated file."""
    require(len(data) > HEADER, f"{source}: too short for a .mat file")
    marker = data[126:128]
    require(marker in (b"IM", b"MI"), f"{source}: not a MATLAB v5 file (v7.3 is HDF5: save it with -v7 instead)")
    order = "<" if marker == b"IM" else ">"
    variables: dict[str, Array] = {}
    left, at, count = MAX_UNPACKED, HEADER, 0
    while at + 8 <= len(data):
        kind, size = struct.unpack_from(order + "II", data, at)
        body = memoryview(data)[at + 8 : at + 8 + size]
        require(len(body) == size, f"{source}: cut short at byte {at}")
        at, count = at + 8 + size, count + 1
        require(count <= MAX_VARIABLES, f"{source}: more than {MAX_VARIABLES} variables")
        if kind == COMPRESSED:
            body = memoryview(_unpacked(body, left, source))
            require(len(body) >= 8, f"{source}: a variable is cut short")
            kind, size = struct.unpack_from(order + "II", body)
            body = body[8 : 8 + size]
        elif size % 8:
            at += 8 - size % 8
        left -= len(body)
        require(left >= 0, f"{source}: more than {MAX_UNPACKED / 1e6:.0f} MB of numbers")
        if kind == MATRIX and len(body) > 0:
            name, values = _matrix(body, order, source)
            if values is not None:
                variables[name] = values
    return variables


def _unpacked(body: memoryview, limit: int, source: str) -> bytes:
    try:
        unpacking = zlib.decompressobj()
        unpacked = unpacking.decompress(body, limit + 1)
    except zlib.error:
        raise ValueError(f"{source}: a compressed variable is damaged") from None
    require(len(unpacked) <= limit, f"{source}: more than {MAX_UNPACKED / 1e6:.0f} MB of numbers")
    return unpacked


def _matrix(body: memoryview, order: str, source: str) -> tuple[str, Array | None]:
    """Name and numbers of one matrix element; no numbers if it is not real and numeric."""
    _, flags, at = _part(body, 0, order, source)
    require(len(flags) >= 8, f"{source}: a variable has no flags")
    flag = struct.unpack_from(order + "I", flags)[0]
    _, raw, at = _part(body, at, order, source)
    dimensions = np.frombuffer(raw[: len(raw) // 4 * 4], dtype=order + "i4").astype(int).tolist()
    _, letters, at = _part(body, at, order, source)
    name = bytes(letters).decode("ascii", errors="replace")[:63]
    require(name == "" or name.isidentifier(), f"{source}: a variable's name is damaged")
    if flag & 0xFF not in NUMERIC_CLASSES or flag >> 8 & COMPLEX:
        return name, None
    kind, numbers, _ = _part(body, at, order, source)
    shown = f"{source}: {name[:20]!r}"
    require(kind in NUMBERS, f"{shown} holds numbers of an unknown type {kind}")
    dtype = np.dtype(order + NUMBERS[kind])
    require(1 <= len(dimensions) <= 8 and all(size >= 0 for size in dimensions), f"{shown} has no sensible dimensions")
    product = 1
    for size in dimensions:
        product *= size
    require(product * dtype.itemsize == len(numbers), f"{shown} has {len(numbers)} bytes for {product} numbers")
    with np.errstate(invalid="ignore"):  # damaged bytes may be signalling NaNs; they become plain ones
        values = np.frombuffer(numbers, dtype=dtype).astype(float)
    values[np.isnan(values)] = np.nan
    return name, values.reshape(dimensions, order="F")


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
