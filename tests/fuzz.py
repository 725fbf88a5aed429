"""Fuzzing: `python -m tests.fuzz --seconds 60 --target formula` throws strings at the library until the time is up.

A target is an ordinary function: a random generator in, nothing out; it fails by raising. What the library refuses, it
refuses with a ValueError of one line. Every case has a deadline, warnings are errors, and nothing may ever be run by
Python's exec or eval. A failing case is printed with its seed: `--seed N --cases 1` runs it alone.
"""

import argparse
import random
import struct
import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path

import msgspec
import numpy as np
from scipy.io import savemat

from rangenav import formats, motion, preset, record
from rangenav.certificate import files
from rangenav.formats import euroc, readback
from rangenav.formats.path_preset import as_preset
from rangenav.preset import Preset
from rangenav.signals import Flown, Formula, expressions, series
from tests.support.signal_examples import EXAMPLES
from tests.support.toml_fragments import TOML_FRAGMENTS

DEADLINE = 1.0
"""s; a case that takes longer hangs, as far as somebody typing is concerned."""
LEAST_CASES = {"formula": 100_000, "preset": 10_000, "importers": 10_000}
"""What a run of a minute or more must reach: fewer cases prove nothing."""
GRID = np.linspace(0, 10, 48)
WORDS = [
    *expressions.NAMES,
    *expressions.KINKED,
    "lambda",
    "import",
    "__import__",
    "exec",
    "eval",
    "t.real",
    "if",
    "for",
]
SIGNS = [
    "+",
    "-",
    "*",
    "/",
    "**",
    "(",
    ")",
    ",",
    ".",
    "^",
    "=",
    " ",
    "//",
    "%",
    "@",
    "[",
    "]",
    "{",
    "'",
    '"',
    "\\",
    "\n",
    ";",
    ":=",
]
NUMBERS = [
    "0",
    "1",
    "2",
    "3.5",
    "1e-9",
    "1e9",
    "1e308",
    "9" * 40,
    "0x1f",
    "1_0",
    "2j",
    ".5",
    "5.",
    "1e",
    "-7",
    "64",
    "65",
]
DAMAGES = [*TOML_FRAGMENTS, "[[path.points]]"]
DAMAGES += [
    'kind = "sum"',
    'kind = "flown"',
    'kind = "formula"\nx = "1/t"',
    "time = 1.0",
    "period = 3.0",
    'imu_unit = "density"',
    "[sensors.unmodelled]\nlever_arm = [0.1, 0.0, 1e9]",
    "[sensors.unmodelled]\ndropout_probability = 0.5",
    "-1",
    "0",
    "1e6",
    "\x00",
]
MAX_SIMULATED = 3000
"""Samples; presets that were accepted and are not longer are flown as well."""
MISPRINTS = [
    "nan",
    "inf",
    "1e999",
    "-1e308",
    "1e-320",
    "",
    ",",
    ",,",
    "\n",
    "\r",
    "\x00",
    "12:34.5",
    "1_0",
    "#",
    "# frame = z-up",
]
MISPRINTS += [
    "t",
    "gyro_x [deg/s]",
    "p_x",
    "9" * 400,
    "0",
    "1",
    "-1",
    "1.30503E+12",
    "é",
    " ",
    ";",
    "-",
    "1e9",
    "1e18",
    "\ufeff",
]
MISPRINTS += ["# gravity = 1e400 0 0", "# anchor = nan 0 0", "x^0", "timestamp", "\t", "1e300", "0.0,0.0,0.0,0.0"]
ANSWERS = {"gyro": "deg/s", "accel": "g", "mag": "uT", "frame": "z-up", "lines": "drop", "time": "ms", "range": "cm"}
RECORDS_SHARE = 0.15
"""Of the files that are damaged, exported ones that are read again."""
ROWS = 40
"""Of each file that is damaged: few enough to damage thousands."""


class ExecutionError(Exception):
    """Something asked Python to run text."""


def formula(random: random.Random) -> None:
    """Text of any kind as a formula: refused in one line, or evaluated, bounded and found finite."""
    text = _formula_text(random)
    try:
        signal = Formula(x=text)
        value = signal(GRID, random.randrange(6))
    except ValueError as error:
        _check_sentence(str(error), "x: ")
        return
    assert np.isfinite(value).all(), text
    if random.random() < 0.05:
        order = random.randrange(6)
        try:
            largest = float(np.abs(signal(GRID, order)[:, 0]).max())
        except ValueError:
            return
        assert largest <= signal.bound(order) * (1 + 1e-12) or largest < 1e-290, text
        assert signal.period is None or signal.period >= 0
        assert signal.bandwidth_until(10.0) >= 0


def damaged_preset(random: random.Random) -> None:
    """A preset's file with a few places damaged: refused in one line, or read, written alike and flown."""
    text = random.choice(_texts())
    for _ in range(random.randint(1, 3)):
        start = random.randrange(len(text))
        text = text[:start] + _damage(random) + text[start + random.choice((0, 0, 1, 2, 5, 30)) :]
    try:
        p = preset.loads(text, source="x.toml")
    except ValueError as error:
        _check_sentence(str(error), "x.toml: ")
        return
    assert preset.loads(preset.dumps(p), source="x.toml") == p
    if p.duration * p.sensors.imu_rate <= MAX_SIMULATED and random.random() < 0.2:
        _fly(p)


def _fly(p: Preset) -> None:
    try:
        moved = motion.simulate(
            p.path,
            p.angular_velocity,
            world=p.world,
            initial_rotation=p.initial_rotation,
            duration=p.duration,
            rate=p.sensors.imu_rate,
        )
    except ValueError as error:
        _check_sentence(str(error), "")
        return
    assert np.isfinite(moved.snap).all()
    assert np.isfinite(moved.rotation).all()


def importers(random: random.Random) -> None:
    """A file of some format with places damaged: refused in one line, understood, or asked about; never for long."""
    if random.random() < RECORDS_SHARE:
        exported_record(random)
        return
    name, seeds = random.choice(_files())
    damaged = {key: _damaged(random, data, text=name != "mat") for key, data in seeds.items()}
    confirm = {key: ANSWERS[key] for key in ANSWERS if random.random() < 0.7}
    try:
        found = _parsed(name, damaged, confirm)
    except ValueError as error:
        _check_sentence(str(error), "x")
        return
    assert np.isfinite(found.duration)
    assert found.duration > 0
    try:
        formats.settled(found)
    except ValueError as error:
        _check_sentence(str(error), "x", longest=3000)  # one clause for each question
        return
    if found.flight is not None:
        assert np.isfinite(found.flight.gyro).all()
        assert np.isfinite(found.flight.accel).all()
        assert np.isfinite(found.flight.range).all()
        assert (np.diff(found.flight.time) > 0).all()
    elif random.random() < 0.2:
        try:
            as_preset(found)
        except ValueError as error:
            _check_sentence(str(error), "x")


def exported_record(random: random.Random) -> None:
    """An exported record with places damaged, as `verify` reads it again: positions, or refused in one line."""
    name, seeds = random.choice(_records())
    damaged = dict(seeds)
    file = random.choice(sorted(seeds))
    damaged[file] = _damaged(random, seeds[file], text=name in ("tum", "csv", "log", "euroc"))
    if random.random() < 0.05:
        damaged[random.choice(("../x", "a/b", "metadata.yaml", ".", "y"))] = b"z"
    try:
        time, position = readback.positions(damaged, formats.row(name), "x")
    except ValueError as error:
        _check_sentence(str(error), "x")
        return
    assert position.shape == (len(time), 3)
    assert np.isfinite(position).all()


def _check_sentence(said: str, start: str, *, longest: int = 400) -> None:
    assert said.startswith(start), said
    assert "\n" not in said, said
    assert len(said) < longest, said


def _formula_text(random: random.Random) -> str:
    kind = random.random()
    if kind < 0.35:
        return _grown(random, random.randint(0, 5))
    if kind < 0.65:
        text = _grown(random, random.randint(1, 4))
        for _ in range(random.randint(1, 3)):
            start = random.randint(0, len(text))
            text = text[:start] + random.choice((*SIGNS, *NUMBERS, *WORDS)) + text[start + random.choice((0, 1, 2)) :]
        return text
    if kind < 0.9:
        return "".join(random.choice((*SIGNS, *NUMBERS, *WORDS)) for _ in range(random.randint(0, 25)))
    if kind < 0.95:
        return "".join(chr(random.randrange(1, 0x2FFF)) for _ in range(random.randint(0, 30)))
    return random.choice(("(", "-", "sin(", "t**", "t+", "9", "1/", "+t")) * random.randint(1, 3000)


def _grown(random: random.Random, depth: int) -> str:
    """A formula that follows the grammar."""
    if depth == 0:
        return random.choice(("t", "t", "pi", "e", str(random.randint(0, 9)), f"{random.uniform(0, 20):.3g}"))
    inner = _grown(random, depth - 1)
    kind = random.random()
    if kind < 0.35:
        return f"{random.choice([*series.FUNCTIONS])}({inner})"
    if kind < 0.45:
        return f"({inner})**{random.choice(('2', '3', '-1', '0.5', '-2', '7', '1.5', 't'))}"
    if kind < 0.5:
        return f"-({inner})"
    return f"({inner}) {random.choice('+-*/')} ({_grown(random, random.randrange(depth))})"


def _damage(random: random.Random) -> str:
    kind = random.random()
    if kind < 0.5:
        return random.choice(DAMAGES)
    if kind < 0.8:
        return repr(
            random.choice((random.uniform(-1e3, 1e3), random.randint(-5, 2000), 10 ** random.uniform(-300, 300)))
        )
    return "".join(chr(random.randrange(1, 0x300)) for _ in range(random.randint(0, 4)))


_TEXTS: list[str] = []


def _texts() -> list[str]:
    """Every shipped preset, and every family of signals in one; short flights, so that they can be flown."""
    if not _TEXTS:
        soft = preset.load("soft")
        _TEXTS.extend(preset.dumps(p) for p in preset.shipped().values())
        requirement = msgspec.structs.replace(soft.requirement, window=4.0)
        for signal in EXAMPLES.values():
            p = msgspec.structs.replace(soft, path=signal, duration=10.0, requirement=requirement)
            _TEXTS.append(preset.dumps(p))
            _TEXTS.append(preset.dumps(msgspec.structs.replace(p, angular_velocity=Flown(yaw="sin(t)"))))
    return _TEXTS


_FILES: list[tuple[str, dict[str, bytes]]] = []


def _files() -> list[tuple[str, dict[str, bytes]]]:
    """A short file of every format that is read, in the dialects that are met."""
    if not _FILES:
        with tempfile.TemporaryDirectory() as folder:
            _FILES.extend(_written(Path(folder)))
        for name, seeds in _FILES:  # undamaged they are understood; and modules imported now are not run later
            found = _parsed(name, seeds, ANSWERS)
            assert found.questions == (), found.questions
            if found.path is not None:
                as_preset(found)
    return _FILES


_RECORDED: list[tuple[str, dict[str, bytes]]] = []


def _records() -> list[tuple[str, dict[str, bytes]]]:
    """A short record in every format that one is exported in."""
    if not _RECORDED:
        soft = preset.load("soft")
        slow = msgspec.structs.replace(soft.sensors, imu_rate=50.0, range_rate=10.0, mag_rate=10.0)
        requirement = msgspec.structs.replace(soft.requirement, window=1.5)
        short = msgspec.structs.replace(soft, duration=3.0, sensors=slow, requirement=requirement)
        with tempfile.TemporaryDirectory() as folder:
            for name in (row.name for row in formats.writable() if row.certified_as == "run"):
                path = Path(folder) / f"x-{name}"
                try:
                    formats.export(short, name, path)
                except ValueError as error:
                    if "rangenav[ros]" in str(error):  # it is not installed
                        continue
                    raise
                content = files.read_bytes(path)
                _RECORDED.append((name, files.unpacked(content, "x") if path.is_dir() else {"": content}))
        for name, seeds in _RECORDED:  # undamaged they are read
            assert len(readback.positions(seeds, formats.row(name), "x")[0]) > 100
    return _RECORDED


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


def _damaged(random: random.Random, data: bytes, *, text: bool) -> bytes:
    """Entries and lines of text replaced, doubled, swapped, columns rescaled; numbers of a .mat; at times any bytes."""
    for _ in range(random.choice((1, 1, 1, 2, 3))):
        if random.random() < 0.2:
            data = _torn(random, data)
        elif text:
            data = b"\n".join(_edited(random, data.split(b"\n")))
        else:
            start = random.randrange(max(1, len(data) // 8)) * 8
            data = data[:start] + struct.pack("<d", _number(random)) + data[start + 8 :]
    return data


def _edited(random: random.Random, lines: list[bytes]) -> list[bytes]:
    k, other, kind = random.randrange(len(lines)), random.randrange(len(lines)), random.random()
    separator = b"," if any(b"," in line for line in lines) else b" "
    entries = lines[k].split(separator)
    column = random.randrange(len(entries))
    if kind < 0.5:
        entry = random.choice(MISPRINTS).encode() if random.random() < 0.4 else repr(_number(random)).encode()
        lines[k] = separator.join([*entries[:column], entry, *entries[column + 1 :]])
    elif kind < 0.6:
        lines.insert(other, lines[k])
    elif kind < 0.7:
        lines[k], lines[other] = lines[other], lines[k]
    elif kind < 0.8:
        del lines[min(k, other) : min(k, other) + random.choice((1, 1, 5, len(lines)))]
    else:  # one column of every row: in other units, all alike, or empty
        factor = random.choice((b"e3", b"e-3", b"e-9", b"e9", None, b""))
        for j, line in enumerate(lines):
            row = line.split(separator)
            if j and column < len(row) and row[column]:
                row[column] = b"0.5" if factor is None else row[column] + factor if factor else b""
                lines[j] = separator.join(row)
    return lines


def _number(random: random.Random) -> float:
    sizes = (0.0, 1.0, -1.0, 0.01, 9.81, 1e3, 1e6, 1e12, 1e-12, 1e-300, 1e19, 1e200, float("nan"))
    return random.choice(sizes) * random.choice((1.0, random.uniform(-2, 2)))


def _torn(random: random.Random, data: bytes) -> bytes:
    kind, start = random.random(), random.randrange(len(data) + 1)
    if kind < 0.4:
        return data[:start] + bytes(random.randrange(256) for _ in range(random.randint(0, 4))) + data[start + 4 :]
    if kind < 0.6:
        return data[:start] + struct.pack("<I", random.choice((0, 1, 14, 2**31 - 1, 2**32 - 1))) + data[start + 4 :]
    if kind < 0.8:
        return data[:start] + data[start + random.choice((1, 8, 100, 10_000)) :]
    return data[:start] + data[max(0, start - random.choice((8, 200))) :]


ALL = "all"
TARGETS: dict[str, Callable[[random.Random], None]] = {
    "formula": formula,
    "preset": damaged_preset,
    "importers": importers,
}


def run(target: str, *, seconds: float, cases: int | None = None, seed: int = 0) -> int:
    """Run a target until the time is up or the cases are done; returns how many were run. Raises what a case raised."""
    sys.addaudithook(_refuse_execution)
    _texts()
    if target == "importers":
        _files()
        _records()
    began, count = time.perf_counter(), 0
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        while time.perf_counter() - began < seconds and count != cases:
            started = time.thread_time()
            _watch["on"] = True
            try:
                TARGETS[target](random.Random(seed + count))
            except BaseException:
                print(f"{target}: case --seed {seed + count} --cases 1 failed", file=sys.stderr)
                raise
            finally:
                _watch["on"] = False
            took = time.thread_time() - started
            assert took < DEADLINE, f"{target}: case --seed {seed + count} took {took:.2f} s"
            count += 1
    return count


_watch = {"on": False}


def _refuse_execution(event: str, arguments: tuple[object, ...]) -> None:
    if _watch["on"] and event == "exec":
        raise ExecutionError(f"Python was asked to run {arguments!r}")


def main() -> None:
    """Parse the command line, run one target, say how far it came."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--target", choices=(*sorted(TARGETS), ALL), default=ALL)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--cases", type=int, default=None)
    parser.add_argument("--seed", type=int, default=0)
    chosen = parser.parse_args()
    for target in TARGETS if chosen.target == ALL else (chosen.target,):
        began = time.perf_counter()
        count = run(target, seconds=chosen.seconds, cases=chosen.cases, seed=chosen.seed)
        print(f"{target}: {count} cases in {time.perf_counter() - began:.1f} s, none failed", flush=True)
        if chosen.cases is None and chosen.seconds >= 60 and count < LEAST_CASES[target]:
            sys.exit(f"{target}: a run must reach {LEAST_CASES[target]} cases")


if __name__ == "__main__":
    main()
