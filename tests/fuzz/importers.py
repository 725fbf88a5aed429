"""A short file of every format that is read, with places damaged."""

import tempfile
from collections.abc import Callable
from pathlib import Path
from random import Random

import msgspec
import numpy as np
from scipy.io import savemat

from rangenav import formats, preset, record
from rangenav.formats import euroc
from rangenav.formats.path_preset import as_preset
from tests.fuzz import damage, sentences

ANSWERS = {"gyro": "deg/s", "accel": "g", "mag": "uT", "frame": "z-up", "lines": "drop", "time": "ms", "range": "cm"}
ROWS = 40
"""Of each file that is damaged: few enough to damage thousands."""


def importer(name: str) -> Callable[[Random], None]:
    """The reader of one format."""

    def read(random: Random) -> None:
        _read(name, random)

    return read


def _read(name: str, random: Random) -> None:
    """A file with places damaged: refused in one line, understood, or asked about; never for long."""
    seeds = random.choice([seeds for written, seeds in files() if written == name])
    damaged = {key: damage.damaged(random, data, text=name != "mat") for key, data in seeds.items()}
    confirm = {key: ANSWERS[key] for key in ANSWERS if random.random() < 0.7}
    try:
        imported = _parsed(name, damaged, confirm)
    except ValueError as error:
        sentences.check(str(error), "x", longest=sentences.COLUMNS_NAMED)
        return
    assert np.isfinite(imported.duration)
    assert imported.duration > 0 or imported.questions  # with a question nothing may have been read yet
    try:
        formats.settled(imported)
    except ValueError as error:
        sentences.check(str(error), "x", longest=3000)  # one clause for each question
        return
    if imported.flight is not None:
        assert np.isfinite(imported.flight.gyro).all()
        assert np.isfinite(imported.flight.accel).all()
        assert np.isfinite(imported.flight.range).all()
        assert (np.diff(imported.flight.time) > 0).all()
    elif random.random() < 0.2:
        try:
            as_preset(imported)
        except ValueError as error:
            sentences.check(str(error), "x")


_FILES: list[tuple[str, dict[str, bytes]]] = []


def files() -> list[tuple[str, dict[str, bytes]]]:
    """A short file of every format that is read, in the dialects that are met."""
    if not _FILES:
        with tempfile.TemporaryDirectory() as folder:
            _FILES.extend(_written(Path(folder)))
        for name, seeds in _FILES:  # undamaged they are understood; and modules imported now are not run later
            imported = _parsed(name, seeds, {key: value for key, value in ANSWERS.items() if key != "time"})
            assert imported.questions == (), imported.questions
            if imported.path is not None:
                as_preset(imported)
    return _FILES


NAMES = ("reference", "polynomial", "tum", "log", "euroc", "mat")


def _parsed(name: str, data: dict[str, bytes], confirm: dict[str, str]) -> formats.ImportResult:
    if name == "euroc":
        return euroc.parse(data, source="x", confirm=confirm)
    return formats.parse(data[name], name, source="x", confirm=confirm)


def _written(folder: Path) -> list[tuple[str, dict[str, bytes]]]:
    soft = msgspec.structs.replace(preset.load("soft"), duration=16.0)
    for name in ("reference", "polynomial", "tum", "log", "euroc"):
        formats.export(soft, name, folder / name)
    made = [(name, {name: _head(folder / name, stride=25)}) for name in ("reference", "tum")]
    made += [(name, {name: _head(folder / name)}) for name in ("polynomial", "log")]
    sensors = {name: _head(folder / "euroc" / "mav0" / name / "data.csv") for name in euroc.HEADERS}
    foreign = [f"{k / 100},{k % 7},{k % 5},-1,0.01,0.02,0.99,20,{k % 3},-40" for k in range(ROWS)]
    header = ",".join(["Time (s)", *(f"{what} {a} ({u})" for what, u in DIALECT for a in "XYZ")])
    made.append(("log", {"log": "\n".join([header, *foreign]).encode()}))
    z = record.run(msgspec.structs.replace(soft, duration=13.0)).measurements
    arrays = {
        "imu_gyr": z.gyro,
        "imu_acc": z.accel,
        "imu_mag": 40 * z.mag,
        "opt_pos": z.gyro,
        "sampling_rate": [[200.0]],
    }
    arrays["opt_quat"] = np.tile([1.0, 0.0, 0.0, 0.0], (len(z.gyro), 1))
    for compressed in (False, True):
        short = {name: np.asarray(values)[:ROWS] for name, values in arrays.items()}
        savemat(folder / "x.mat", short, do_compression=compressed)
        made.append(("mat", {"mat": (folder / "x.mat").read_bytes()}))
    return [*made, ("euroc", sensors), ("euroc", {euroc.IMU: sensors[euroc.IMU]})]


DIALECT = (("Gyroscope", "deg/s"), ("Accelerometer", "g"), ("Magnetometer", "uT"))


def _head(file: Path, stride: int = 1) -> bytes:
    """The header and some rows, near enough to each other for the format."""
    lines = file.read_bytes().split(b"\n")
    return b"\n".join([lines[0], *lines[1::stride][: ROWS + 5]]) + b"\n"
