"""Presets with places damaged, and texts that only look like TOML."""

from random import Random

import msgspec
import numpy as np

from rangenav import motion, preset
from rangenav.preset import Preset
from rangenav.signals import Flown
from tests.fuzz import sentences
from tests.support.signal_examples import EXAMPLES
from tests.support.toml_fragments import TOML_FRAGMENTS

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


def damaged_preset(random: Random) -> None:
    """A preset's file with a few places damaged: refused in one line, or read, written alike and flown."""
    text = random.choice(texts())
    for _ in range(random.randint(1, 3)):
        start = random.randrange(len(text))
        text = text[:start] + _damage(random) + text[start + random.choice((0, 0, 1, 2, 5, 30)) :]
    try:
        p = preset.loads(text, source="x.toml")
    except ValueError as error:
        sentences.check(str(error), "x.toml: ")
        return
    assert preset.loads(preset.dumps(p), source="x.toml") == p
    if p.duration * p.sensors.imu_rate <= MAX_SIMULATED and random.random() < 0.2:
        _fly(p)


PIECES = (
    *(
        "[",
        "]",
        "{",
        "}",
        "=",
        ",",
        ".",
        "#",
        "\n",
        " ",
        '"',
        "'",
        '"""',
        "'''",
        "\\",
        "a",
        "a.b",
        "a = 1",
        "x = [",
        "x = {",
    ),
    *("[[a]]", "[a.b]", '"a.b"', "9", "0x", "1.5", "true", "1979-05-27", "title = ", "\r\n", "\t", "é", "\x00"),
)
MAX_REPEATED = 30_000


def toml_like(random: Random) -> None:
    """Pieces of TOML, some of them thousands of times: refused in one line, soon and for little memory."""
    text = "".join(_repeated(random) for _ in range(random.randint(1, 12)))
    try:
        preset.loads(text, source="x.toml")
    except ValueError as error:
        sentences.check(str(error), "x.toml: ")
        return
    raise AssertionError(f"accepted: {text[:100]!r}")


def _repeated(random: Random) -> str:
    piece = "".join(random.choice(PIECES) for _ in range(random.choice((1, 1, 2, 3))))
    count = random.choice((1, 1, 1, 2, 5, 20, 300, random.randint(1, MAX_REPEATED)))
    if "%" in piece or random.random() < 0.1:
        return "".join(f"k{k:x}{piece}" for k in range(min(count, 3000)))
    return piece * count


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
        sentences.check(str(error), "")
        return
    assert np.isfinite(moved.snap).all()
    assert np.isfinite(moved.rotation).all()


def _damage(random: Random) -> str:
    kind = random.random()
    if kind < 0.5:
        return random.choice(DAMAGES)
    if kind < 0.8:
        return repr(
            random.choice((random.uniform(-1e3, 1e3), random.randint(-5, 2000), 10 ** random.uniform(-300, 300)))
        )
    return "".join(chr(random.randrange(1, 0x300)) for _ in range(random.randint(0, 4)))


_TEXTS: list[str] = []


def texts() -> list[str]:
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
