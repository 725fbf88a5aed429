"""The true positions in an exported record, read again from its bytes: what ties a file to the path it is a record of.

Each reader is the shortest way to stamps (s) and positions (m), and knows nothing of how they were written.
"""

import io
import tempfile
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.formats import euroc, ros, text, tum
from rangenav.inputs import require

MAX_UNPACKED = 1_000_000_000
"""Bytes that an archive may unpack to."""
Places = tuple[Float[Array, "n"], Float[Array, "n 3"]]
"""Stamps from the beginning of the run (s), positions (m)."""
UPRIGHT = ("bag", "mcap", "tum", "euroc")
"""Formats that are z-up whatever the preset is."""


def places(content: Mapping[str, bytes], form: str, source: str) -> Places:
    """Stamps and positions of a record; a format of one file has it under the name "". Raises ValueError."""
    require(form in READERS, f"{source}: no record is written as {form!r}")
    try:
        time, position = READERS[form](content, source)
    except Exception as error:  # readers of others raise what they like, and know no names
        if isinstance(error, ValueError) and str(error).startswith(source):
            raise
        raise ValueError(f"{source}: cannot be read again as {form} ({type(error).__name__})") from None
    rule = f"{source}: its stamps or positions are no table of numbers"
    fits = time.ndim == 1 and position.shape == (len(time), 3) and len(time) > 0
    require(fits and bool(np.isfinite(time).all() and np.isfinite(position).all()), rule)
    return time, position


def _table(content: Mapping[str, bytes], source: str, names: tuple[str, ...]) -> Places:
    values = text.columns(text.table(content[""], source=source), names)
    values = values[~np.isnan(values[:, 1])]  # rows of a log on which there is a range and no sample
    return values[:, 0], values[:, 1:]


def _tum(content: Mapping[str, bytes], source: str) -> Places:
    values = text.table(content[""], source=source, separator=None, names=tum.NAMES).values
    return values[:, 0], values[:, 1:4]


def _npz(content: Mapping[str, bytes], source: str) -> Places:
    with zipfile.ZipFile(io.BytesIO(content[""])) as archive:
        size = sum(entry.file_size for entry in archive.infolist())
        require(size <= MAX_UNPACKED, f"{source}: unpacks to {size} bytes")
    with np.load(io.BytesIO(content[""]), allow_pickle=False) as arrays:
        return arrays["time"], arrays["position"]


def _mat(content: Mapping[str, bytes], source: str) -> Places:
    from scipy.io import loadmat

    held = loadmat(io.BytesIO(content[""]), variable_names=["rangenav"])["rangenav"][0, 0]
    return held["time"][:, 0], held["position"]


def _euroc(content: Mapping[str, bytes], source: str) -> Places:
    name = f"mav0/{euroc.TRUTH}/data.csv"
    require(name in content, f"{source}: no {name} in it")
    time, position = euroc.truth(content[name], f"{source}/{name}")
    return time - euroc.FIRST, position


def _ros(content: Mapping[str, bytes], source: str) -> Places:
    with tempfile.TemporaryDirectory(prefix="rangenav-") as made:
        folder = Path(made) / "bag"
        folder.mkdir()
        for name, data in content.items():
            plain = "record.mcap" if name == "" else name
            require(plain not in (".", "..") and "/" not in plain, f"{source}: {name!r} is no file of a bag")
            (folder / plain).write_bytes(data)
        time, position = ros.poses(folder / "record.mcap" if "" in content else folder)
    return time - ros.FIRST, position


READERS: dict[str, Callable[[Mapping[str, bytes], str], Places]] = {
    "tum": _tum,
    "csv": lambda content, source: _table(content, source, ("t", "p_x", "p_y", "p_z")),
    "log": lambda content, source: _table(content, source, ("t [s]", "p_x [m]", "p_y [m]", "p_z [m]")),
    "npz": _npz,
    "mat": _mat,
    "euroc": _euroc,
    "bag": _ros,
    "mcap": _ros,
}
