"""A foreign file is read in a process of its own: with the same result, within limits, and it can be cancelled."""

import time
from pathlib import Path

import numpy as np
import pytest

from explorer.storage import import_file, import_process
from explorer.storage.import_file import ImportFile
from explorer.storage.import_process import Limits
from rangenav.progress import CancelledError
from tests.support.present import present

pytestmark = pytest.mark.slow
ANCHOR = (0.0, 0.0, 0.0)
FLIGHT = ImportFile(
    "flight.csv",
    "\n".join(
        [
            "t [s],gyro_x [rad/s],gyro_y [rad/s],gyro_z [rad/s],accel_x [m/s2],accel_y [m/s2],accel_z [m/s2]",
            *(f"{k / 50},{k % 7 / 70},0.1,{k % 3 / 30},0,{k % 5 / 50},9.81" for k in range(200)),
        ]
    ).encode(),
)
PATH = ImportFile(
    "pieces.csv",
    (
        ",".join(["duration", *(f"{axis}^{k}" for axis in ("x", "y", "z", "yaw") for k in range(8))])
        + "\n"
        + ",".join(["2.0", *(["0"] * 4 + ["0.1"] + ["0"] * 3) * 3, *["0"] * 8])
    ).encode(),
)


def read(file: ImportFile, format_name: str, **others):
    return import_process.read(file, format_name, {"frame": "z-up"}, ANCHOR, **{"cancelled": lambda: False, **others})


def test_what_was_read_there_is_what_would_have_been_read_here():
    confirm = {"frame": "z-up"}
    here = import_file.interpret(FLIGHT, "log", confirm, ANCHOR).result
    there = read(FLIGHT, "log").result
    assert (there.findings, there.questions, there.sha256) == (here.findings, here.questions, here.sha256)
    for name in ("time", "gyro", "accel", "range"):
        np.testing.assert_array_equal(getattr(present(there.flight), name), getattr(present(here.flight), name))
    path = read(PATH, "polynomial")
    assert path.preset == import_file.interpret(PATH, "polynomial", confirm, ANCHOR).preset
    assert path.preset is not None


def test_a_refusal_is_the_readers_own_sentence():
    for file, format_name in ((PATH, "log"), (FLIGHT, "mat"), (ImportFile("x.csv", b"\xff"), "tum")):
        with pytest.raises(ValueError, match=file.name) as here:
            import_file.interpret(file, format_name, {}, ANCHOR)
        with pytest.raises(ValueError, match=file.name) as there:
            import_process.read(file, format_name, {}, ANCHOR, cancelled=lambda: False)
        assert str(there.value) == str(here.value)


@pytest.mark.parametrize(
    ("limits", "sentence"),
    [
        (
            Limits(memory=1_000_000),
            "flight.csv: reading it takes more than 1 MB of memory or 10 s, the limits",
        ),
        (Limits(seconds=0), "flight.csv: reading it takes more than 300 MB of memory or 0 s, the limits of the page"),
        (Limits(answer=1000), "flight.csv: reading it takes more than 300 MB"),
    ],
    ids=["memory", "time", "answer"],
)
def test_a_file_that_takes_too_much_is_refused_in_a_sentence_with_both_limits(limits, sentence):
    long = ImportFile("flight.csv", FLIGHT.content + b"\n" * 900_000 + b"," * 5000)
    with pytest.raises(ValueError, match=f"^{sentence}"):
        read(long if limits.answer > 1000 else FLIGHT, "log", limits=limits)


def test_a_reading_that_is_cancelled_ends_its_process_at_once():
    began = time.monotonic()
    with pytest.raises(CancelledError):
        read(FLIGHT, "log", cancelled=lambda: True)
    assert time.monotonic() - began < 5
    children = Path("/proc/self/task")
    if children.exists():
        running = [p.read_text() for p in children.glob("*/children")]
        assert not any(_is_reader(pid) for pids in running for pid in pids.split())


def _is_reader(pid: str) -> bool:
    return b"import_process" in Path(f"/proc/{pid}/cmdline").read_bytes()
