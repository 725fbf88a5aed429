"""A small file cannot take much memory: what is unpacked, allocated or split is bounded by what really comes out."""

import io
import os
import struct
import tracemalloc
import zipfile
import zlib
from collections.abc import Callable
from functools import partial

import numpy as np
import pytest
from scipy.io import savemat

from rangenav import formats, preset
from rangenav.certificate import files
from rangenav.formats import archives, lines, mat5, readback, ros, text

MOST = 40_000_000
"""Bytes that Python may allocate for any refusal here."""


def refused(act: Callable[[], object], match: str) -> None:
    """Whether `act` is refused in one sentence, and for little memory."""
    tracemalloc.start()
    try:
        with pytest.raises(ValueError, match=match) as error:
            act()
        _, most = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert "\n" not in str(error.value)
    assert most < MOST


# --- zip archives


def zipped(method: int, content: bytes, name: str = "x.toml") -> bytes:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", method) as archive:
        archive.writestr(name, content)
    return packed.getvalue()


def everything(content: bytes, *, limit: int = 1_000_000) -> dict[str, bytes]:
    return archives.members(content, source="x.zip", wanted=lambda name: True, limit=limit)


@pytest.mark.parametrize("method", archives.METHODS)
def test_members_are_unpacked_whole_up_to_the_limit(method):
    assert everything(zipped(method, b"abc" * 1000), limit=3000) == {"x.toml": b"abc" * 1000}
    refused(lambda: everything(zipped(method, b"abc" * 1000), limit=2999), "unpacks to more than 2999 bytes")


@pytest.mark.parametrize("method", [zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
def test_methods_that_the_unpacker_does_not_bound_are_refused(method):
    bomb = zipped(method, bytes(10_000_000))
    refused(lambda: everything(bomb), "^x.zip: x.toml is packed by a method that is not read")


def test_a_member_that_states_a_smaller_size_than_it_has_is_bounded_all_the_same():
    bomb = bytearray(zipped(zipfile.ZIP_DEFLATED, bytes(50_000_000)))
    at = bomb.index(archives.ENTRY)
    bomb[at + 24 : at + 28] = struct.pack("<I", 10)
    refused(lambda: everything(bytes(bomb)), "^x.zip: ")
    bomb[at + 24 : at + 28] = struct.pack("<I", 2**32 - 2)
    refused(lambda: everything(bytes(bomb)), "more than 1000000 bytes")


def test_members_are_counted_before_their_list_is_made():
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        for k in range(archives.MAX_MEMBERS + 1):
            archive.writestr(f"{k}", b"")
    refused(lambda: everything(packed.getvalue()), "more than 1000 files")
    refused(lambda: everything(zipped(zipfile.ZIP_STORED, b"", "x" * 300)), "a name of more than 255 characters")


def test_the_arrays_of_a_record_are_bounded_and_must_be_numbers():
    def arrays(position: np.ndarray) -> bytes:
        packed = io.BytesIO()
        np.savez_compressed(packed, time=np.zeros(2), position=position)
        return packed.getvalue()

    npz = formats.row("npz")
    for strange in (np.array(["a", "b"]), np.zeros((2, 3), dtype=complex), np.array(3.0)):
        refused(partial(readback.positions, {"": arrays(strange)}, npz, "x.npz"), r"^x\.npz: ")
    header = zipped(zipfile.ZIP_DEFLATED, npy_header((10**13, 3)), "position.npy")
    refused(lambda: readback.positions({"": header}, npz, "x.npz"), r"^x\.npz: cannot be read again")


def npy_header(shape: tuple[int, int]) -> bytes:
    """An .npy file that states a shape and holds no number."""
    written = io.BytesIO()
    np.lib.format.write_array_header_1_0(written, {"descr": "<f8", "fortran_order": False, "shape": shape})
    return written.getvalue()


# --- MATLAB

HEADER = b" " * 124 + b"\x00\x01IM"


def element(kind: int, body: bytes) -> bytes:
    return struct.pack("<II", kind, len(body)) + body + bytes(-len(body) % 8)


def variable(name: bytes, numbers: bytes, kind: int, dimensions: bytes) -> bytes:
    """A compressed variable of class double."""
    body = element(6, struct.pack("<II", 6, 0)) + element(5, dimensions) + element(1, name) + element(kind, numbers)
    packed = zlib.compress(element(14, body), 1)
    return struct.pack("<II", 15, len(packed)) + packed


def test_what_is_unpacked_counts_and_not_the_part_that_is_used(monkeypatch):
    monkeypatch.setattr(mat5, "MAX_UNPACKED", 4_000_000)
    small = variable(b"a", bytes(800_000), 9, struct.pack("<ii", 100_000, 1))
    assert sorted(mat5.arrays(HEADER + small * 2, source="x.mat")) == ["a"]
    refused(lambda: mat5.arrays(HEADER + small * 3, source="x.mat"), "more than 4 MB of numbers")
    tail = zlib.compress(struct.pack("<II", 14, 8) + bytes(50_000_000), 1)  # the slice that is used has 8 bytes
    refused(lambda: mat5.arrays(HEADER + struct.pack("<II", 15, len(tail)) + tail, source="x.mat"), "has no flags")


def test_a_large_variable_is_refused_before_it_is_unpacked():
    packed = zlib.compress(struct.pack("<II", 14, 250_000_000) + bytes(1000))
    bomb = HEADER + (struct.pack("<II", 15, len(packed)) + packed) * 40
    refused(lambda: mat5.arrays(bomb, source="x.mat"), "more than 160 MB of numbers")


def test_bytes_that_become_doubles_count_as_doubles_and_heads_are_short(monkeypatch):
    monkeypatch.setattr(mat5, "MAX_UNPACKED", 4_000_000)
    million = struct.pack("<ii", 1_000_000, 1)
    refused(lambda: mat5.arrays(HEADER + variable(b"a", bytes(1_000_000), 2, million), source="x"), "more than 4 MB")
    long = variable(b"a", bytes(8), 9, bytes(3_000_000))
    refused(lambda: mat5.arrays(HEADER + long, source="x"), "no sensible dimensions")
    named = variable(b"a" * 3_000_000, bytes(8), 9, struct.pack("<ii", 1, 1))
    refused(lambda: mat5.arrays(HEADER + named, source="x"), "name is damaged")


@pytest.mark.parametrize("compressed", [False, True])
def test_the_fields_of_a_struct_are_read_as_scipy_wrote_them(compressed):
    written, rows = io.BytesIO(), np.arange(12.0).reshape(4, 3)
    deep = {"time": rows[:, :1], "position": rows, "meta": {"text": "x"}, "count": np.array([[7]], dtype="u2")}
    savemat(written, {"other": 1.0, "run": deep}, do_compression=compressed)
    arrays = mat5.fields(written.getvalue(), "run", source="x.mat")
    assert sorted(arrays) == ["count", "position", "time"]
    np.testing.assert_array_equal(arrays["position"], rows)
    with pytest.raises(ValueError, match=r"^x\.mat: no struct named walk in it"):
        mat5.fields(written.getvalue(), "walk", source="x.mat")


# --- ROS


def mcap_chunk(compression: bytes) -> bytes:
    """An MCAP file of one chunk: stamps, sizes, the name of its compression, its records."""
    name = struct.pack("<I", len(compression)) + compression
    body = struct.pack("<QQQI", 0, 0, 2**40, 0) + name + struct.pack("<Q", 0)
    return b"\x89MCAP0\r\n" + b"".join(struct.pack("<BQ", op, len(part)) + part for op, part in ((1, b"xx"), (6, body)))


METADATA = b"compression_format: ''\ncompression_mode: ''\nstorage_identifier: sqlite3\n"


@pytest.mark.parametrize(
    "content",
    [
        {"": mcap_chunk(b"zstd")},
        {"": mcap_chunk(b"lz4")},
        {"metadata.yaml": METADATA.replace(b"format: ''", b"format: zstd"), "x.db3": b""},
        {"metadata.yaml": METADATA.replace(b"mode: ''", b'mode: "\\x66ile"'), "x.db3": b""},
        {"metadata.yaml": METADATA + b"? compression_mode\n: file\n", "x.db3": b""},
        {"metadata.yaml": METADATA + b"#" * 70_000, "x.db3": b""},
        {"metadata.yaml": METADATA, "x.mcap": b""},
    ],
)
def test_a_bag_with_compressed_parts_is_refused_before_any_is_unpacked(content):
    refused(lambda: readback.positions(content, formats.row("bag"), "x"), "^x: has compressed parts")


def test_a_bag_without_compressed_parts_passes():
    ros.refuse_compressed({"metadata.yaml": METADATA, "x.db3": b""}, "x")
    ros.refuse_compressed({"": mcap_chunk(b"")}, "x")


# --- text


@pytest.mark.parametrize(
    ("data", "match"),
    [
        (b"t,x\n" + b"\n" * 5_000_000, "more than 300 lines"),
        (b"t,x\r" + b"\r" * 5_000_000, "more than 300 lines"),
        (b"t,x\n" + b"a" * 5_000_000, "line 2: longer than 8192 characters"),
        (b"# a\n" * 200 + b"t,x\n", "more than 100 comments before the first row"),
        ("t,x\n# \U0001f600\n1,".encode() + b"2" * 5_000_000, "line 3: longer than"),
        (b"t,x\n1,2\n\xff,3", r"not UTF-8 text \(byte 8\)"),
        (b"t,x\n" + b'"\n",' * 1000, "line [0-9]*: quotes that are open for 20 lines"),
    ],
)
def test_lines_are_counted_and_measured_before_they_are_split(data, match, monkeypatch):
    monkeypatch.setattr(lines, "MAX_LINES", 300)
    monkeypatch.setattr(lines, "MAX_COMMENTS", 100)
    refused(lambda: text.table(data, source="x.csv"), match)


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_lines_end_as_any_system_ends_them(end):
    table = text.table(f"\ufefft,x{end}1,2{end}{end}3,4".encode(), source="x.csv")
    assert table.names == ("t", "x")
    np.testing.assert_array_equal(table.values, [[1, 2], [3, 4]])
    np.testing.assert_array_equal(table.lines, [2, 4])


@pytest.mark.parametrize("read", [files.read_bytes, preset.load, text.contents], ids=lambda read: read.__qualname__)
def test_what_is_no_file_is_not_read_for_it_may_never_end(read, tmp_path):
    os.mkfifo(tmp_path / "x.toml")
    refused(lambda: read(tmp_path / "x.toml"), "not a file")
