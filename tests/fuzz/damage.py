"""Files with places damaged: entries, lines and columns of text, numbers, bytes."""

import struct
from random import Random

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


def damaged(random: Random, data: bytes, *, text: bool) -> bytes:
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


def _edited(random: Random, lines: list[bytes]) -> list[bytes]:
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


def _number(random: Random) -> float:
    sizes = (0.0, 1.0, -1.0, 0.01, 9.81, 1e3, 1e6, 1e12, 1e-12, 1e-300, 1e19, 1e200, float("nan"))
    return random.choice(sizes) * random.choice((1.0, random.uniform(-2, 2)))


def _torn(random: Random, data: bytes) -> bytes:
    kind, start = random.random(), random.randrange(len(data) + 1)
    if kind < 0.4:
        return data[:start] + bytes(random.randrange(256) for _ in range(random.randint(0, 4))) + data[start + 4 :]
    if kind < 0.6:
        return data[:start] + struct.pack("<I", random.choice((0, 1, 14, 2**31 - 1, 2**32 - 1))) + data[start + 4 :]
    if kind < 0.8:
        return data[:start] + data[start + random.choice((1, 8, 100, 10_000)) :]
    return data[:start] + data[max(0, start - random.choice((8, 200))) :]
