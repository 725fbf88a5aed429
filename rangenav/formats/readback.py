"""The true positions in an exported record, read again from its bytes: what ties a file to the path it is a record of.

Each reader is the shortest way to stamps (s) and positions (m), and knows nothing of how they were written.
"""

import io
import tempfile
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from rangenav.arguments import NUMBERS
from rangenav.formats import archives, arrays, euroc, mat5, ros, text, tum
from rangenav.formats.format import Format, PositionReader, Samples
from rangenav.inputs import require

MAX_UNPACKED = 100_000_000
"""Bytes of the stamps and positions in an archive: two million of each take 64 MB."""


def positions(content: Mapping[str, bytes], form: Format, source: str) -> Samples:
    """Times (s) and positions (m) of a record; the content of a single file has the name "". Raises ValueError."""
    if form.positions is None:
        raise ValueError(f"{source}: no record is written as {form.name!r}")
    try:
        time, position = (_numbers(values) for values in form.positions(content, source))
    except Exception as error:  # readers of other libraries raise any exception, and do not name the file
        if isinstance(error, ValueError) and str(error).startswith(source):
            raise
        raise ValueError(f"{source}: cannot be read again as {form.name} ({type(error).__name__})") from None
    rule = f"{source}: its stamps or positions are no table of numbers"
    fits = time.ndim == 1 and position.shape == (len(time), 3) and len(time) > 0
    require(fits and bool(np.isfinite(time).all() and np.isfinite(position).all()), rule)
    return time, position


def _numbers(values: np.ndarray) -> np.ndarray:
    """The same, in double precision. Raises ValueError for an array of anything but real numbers."""
    require(values.dtype.kind in NUMBERS, "no numbers")
    return values.astype(float, copy=False)


def columns(*names: str) -> PositionReader:
    """The reader of a CSV file with these four columns: the time (s) and the position (m)."""

    def read(content: Mapping[str, bytes], source: str) -> Samples:
        values = text.columns(text.table(content[""], source=source), names)
        values = values[~np.isnan(values[:, 1])]  # a row of a log with a range only has no position
        return values[:, 0], values[:, 1:]

    return read


def tum_poses(content: Mapping[str, bytes], source: str) -> Samples:
    """The poses of a TUM file."""
    values = text.table(content[""], source=source, names=tum.NAMES).values
    return values[:, 0], values[:, 1:4]


def npz_arrays(content: Mapping[str, bytes], source: str) -> Samples:
    """The arrays `time` and `position` of an NPZ archive."""
    names = ("time.npy", "position.npy")
    packed = archives.members(content[""], source=source, wanted=lambda name: name in names, limit=MAX_UNPACKED)
    time, position = (np.load(io.BytesIO(packed[name]), allow_pickle=False) for name in names)
    return time, position


def mat_struct(content: Mapping[str, bytes], source: str) -> Samples:
    """The fields `time` and `position` of the struct in a .mat file."""
    held = mat5.fields(content[""], arrays.NAME, source=source)
    return held["time"][:, 0], held["position"]


def euroc_truth(content: Mapping[str, bytes], source: str) -> Samples:
    """The ground truth of a EuRoC folder."""
    name = f"mav0/{euroc.TRUTH}/data.csv"
    require(name in content, f"{source}: no {name} in it")
    time, position = euroc.truth(content[name], f"{source}/{name}")
    return time - euroc.FIRST, position


def ros_poses(content: Mapping[str, bytes], source: str) -> Samples:
    """The true poses of a bag or of an MCAP file."""
    ros.refuse_compressed(content, source)
    with tempfile.TemporaryDirectory(prefix="rangenav-") as temporary:
        folder = Path(temporary) / "bag"
        folder.mkdir()
        for name, data in content.items():
            file_name = "record.mcap" if name == "" else name
            require(file_name not in (".", "..") and "/" not in file_name, f"{source}: {name!r} is no file of a bag")
            (folder / file_name).write_bytes(data)
        time, position = ros.poses(folder / "record.mcap" if "" in content else folder)
    return time - ros.FIRST, position
