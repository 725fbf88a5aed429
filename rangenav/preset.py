"""A preset holds every input of one run. It is a TOML file that is read and written without loss.

Errors name file, field and rule: `eight.toml: Expected `float`, got `str` - at `$.path.tones[0].frequency``.
"""

import difflib
import math
import re
import unicodedata
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any, Literal

import msgspec

from rangenav import toml_limits
from rangenav.gains import Gains, Guess
from rangenav.inputs import Input, Vec3, require, require_within
from rangenav.motion import World
from rangenav.observability import quadrature
from rangenav.provenance import Source
from rangenav.sensors import MODELLED, Effects, Sensors
from rangenav.signals import AngularVelocity, Flown, Signal, refuse_fallen, refuse_wild, refuse_work
from rangenav.vehicle import FREE, Vehicle

FORMAT_VERSION = 1
MIN_DURATION, MAX_DURATION = 0.5, 3600.0
MAX_SAMPLES = 2_000_000
"""Upper limit of duration × rate: more samples need more memory and time than the page has."""
MIN_WINDOW_SAMPLES = 4
"""The printed forms of the excitation are sums over the samples of a window; fewer samples describe no motion."""
WINDOWS = 600
"""An analysis evaluates about this many windows of a path, each at all its quadrature nodes."""
PATH_DERIVATIVES, TURNING_DERIVATIVES = 4, 1
"""Up to snap, and up to angular acceleration."""
MAX_BYTES = toml_limits.MAX_BYTES
MAX_TITLE, MAX_STORY = 80, 400
BLANK = "Zs"
"""Unicode's category of blanks, of which Python calls only one printable."""
NUMBER_ARRAY = re.compile(r"\[\n((?:    [-+.\deE]+,\n)+)\]")
"""An array that the TOML writer has spread over lines. No string matches, because its line ends are escaped."""
FOLDERS = (Path(__file__).parent / "presets", Path(__file__).parent.parent / "presets")
"""The presets' folder inside an installed wheel, and in a source tree."""


class Requirement(Input, frozen=True, kw_only=True):
    """What the motion must reach on every window."""

    window: float = 6.0
    """s, δ of the excitation, the Gramian and the predicted accuracy."""
    mu: float = 1.0
    """m²/s⁷: the least eigenvalue of ∫ p⁗ p⁗ᵀ over a window."""
    position_sigma: float = 0.5
    """m: predicted 1-σ position error at the end of a window; above it the verdict is "weak"."""

    def __post_init__(self) -> None:
        super().__post_init__()
        require_within("window", self.window, 0.05, MAX_DURATION, "s")
        require(self.mu > 0, f"mu must be positive, got {self.mu:g}")
        require(self.position_sigma > 0, f"position_sigma must be positive, got {self.position_sigma:g}")


class Preset(Input, frozen=True, kw_only=True):
    """Every input of one run."""

    version: Literal[1] = FORMAT_VERSION
    title: str
    story: str = ""
    """One sentence: what this motion teaches."""
    expect: Literal["observable", "weak", "unobservable"] = "observable"
    """What the preset claims: it meets the requirement; it meets all but the accuracy; it lacks excitation or rank."""
    duration: float = 20.0
    """s"""
    seed: int = 0
    initial_rotation: Vec3 = (0.0, 0.0, 0.0)
    """rad: R(0) as a rotation vector."""
    path: Signal
    """m, inertial frame."""
    angular_velocity: AngularVelocity
    """rad/s, body frame. With `kind = "flown"` the path determines the attitude, and initial_rotation is not used."""
    world: World = World()
    sensors: Sensors = Sensors()
    gains: Gains = Gains()
    guess: Guess = Guess()
    requirement: Requirement = Requirement()
    vehicle: Vehicle = FREE
    """The vehicle whose limits the motion must keep."""
    source: Source | None = None
    """The file that the path was imported from; None for a design, whose preset has no table [source]."""

    def __post_init__(self) -> None:
        super().__post_init__()
        refuse_title(self.title)
        require(len(self.story) <= MAX_STORY, f"story must have at most {MAX_STORY} characters, got {len(self.story)}")
        require_within("duration", self.duration, MIN_DURATION, MAX_DURATION, "s")
        require(0 <= self.seed < 2**53, f"seed must lie between 0 and 2^53, got {self.seed}")
        require(math.hypot(*self.initial_rotation) <= 2 * math.pi, "initial_rotation must be at most 2π rad long")
        samples = self.duration * max(self.sensors.imu_rate, self.sensors.range_rate)
        require(samples <= MAX_SAMPLES, f"duration × rate must not exceed {MAX_SAMPLES} samples, got {samples:.0f}")
        window = self.requirement.window
        require(window < self.duration, f"requirement.window must be shorter than the duration, got {window:g} s")
        count = window * self.sensors.imu_rate
        rule = f"requirement.window must be at least {MIN_WINDOW_SAMPLES} IMU samples long, got {count:g}"
        require(count >= MIN_WINDOW_SAMPLES, rule)
        self._refuse_unsuitable_signals()
        quadrature.refuse(self.path, window, self.duration)

    def _refuse_unsuitable_signals(self) -> None:
        try:
            self._refuse_unsuitable(self.path, PATH_DERIVATIVES)
        except ValueError as error:
            raise ValueError(f"path: {error}") from None
        try:
            self._refuse_unsuitable_turning()
        except ValueError as error:
            raise ValueError(f"angular_velocity: {error}") from None

    def _refuse_unsuitable(self, signal: Signal, highest: int) -> None:
        """Refuse a signal that is too much work, not finite, or too fast for the IMU."""
        rate, window = self.sensors.imu_rate, self.requirement.window
        refuse_work(signal, moments=self.duration * rate)
        refuse_wild(signal, duration=self.duration, rate=rate, highest=highest)
        fastest = signal.bandwidth_until(self.duration)
        rule = f"{fastest:g} rad/s is faster than the IMU can sample ({math.pi * rate:.0f} rad/s)"
        require(fastest < math.pi * rate, rule)
        refuse_work(signal, moments=self.duration * rate + WINDOWS * quadrature.count(signal, window, self.duration))

    def _refuse_unsuitable_turning(self) -> None:
        turning, rate = self.angular_velocity, self.sensors.imu_rate
        if isinstance(turning, Flown):
            refuse_fallen(turning, self.path, gravity=self.world.gravity, duration=self.duration, rate=rate)
        else:
            self._refuse_unsuitable(turning, TURNING_DERIVATIVES)


def refuse_title(title: str) -> None:
    """Raise ValueError unless a title can be shown on one line as it is: one rule, for files and for the page's box."""
    rule = f"title must have 1 to {MAX_TITLE} printable characters"
    require(len(title.strip()) > 0, f"{rule}, got {'blanks only' if title else 'none'}")
    require(len(title) <= MAX_TITLE, f"{rule}, got {len(title)}")
    strange = next((c for c in title if not c.isprintable() and unicodedata.category(c) != BLANK), "")
    place = f"got U+{ord(strange or ' '):04X} at character {title.find(strange) + 1}"
    require(not strange, f"{rule}, and no line end, control character or mark of writing direction: {place}")


def loads(text: str, *, source: str) -> Preset:
    """A preset from TOML text; errors start with `source`. Raises ValueError."""
    try:
        return toml_limits.decode(text, Preset)
    except ValueError as error:
        of_study = any(f"unknown field `{name}`" in str(error) for name in ("presets", "metrics", "parameters"))
        require(not of_study, f"{source}: a study, and no preset; rangenav study plan and run take it")
        raise ValueError(f"{source}: {error}") from None


def dumps(preset: Preset) -> str:
    """TOML text that `loads` turns into an equal preset; each array of numbers stands on one line."""
    return NUMBER_ARRAY.sub(lambda match: "[" + ", ".join(match[1].replace(",", "").split()) + "]", _encoded(preset))


def _encoded(preset: Preset) -> str:
    """Keys that the first files did not have are left out at their defaults: old files are written as they were."""
    table = msgspec.to_builtins(preset)
    if preset.vehicle == FREE:
        del table["vehicle"]
    if preset.source is None:  # TOML has no null
        del table["source"]
    if preset.sensors.noise.imu_unit == "sample":
        del table["sensors"]["noise"]["imu_unit"]
    table["sensors"]["unmodelled"] = _used(preset.sensors.unmodelled)
    if not table["sensors"]["unmodelled"]:
        del table["sensors"]["unmodelled"]
    if preset.gains.attitude.schedule is None:
        del table["gains"]["attitude"]["schedule"]
    return msgspec.toml.encode(table).decode()


def _used(unmodelled: Effects) -> Mapping[str, Any]:
    """Effects that differ from their defaults; msgspec would omit a field only if it is the same object."""
    fields = ((name, getattr(unmodelled, name)) for name in unmodelled.__struct_fields__)
    return {name: value for name, value in fields if value != getattr(MODELLED, name)}


def load(name_or_path: str | Path) -> Preset:
    """A shipped preset by its name, or any preset by its path. Raises ValueError with one sentence."""
    path = Path(name_or_path)
    try:
        path = find(name_or_path)
        with path.open("rb") as file:
            content = file.read(MAX_BYTES + 1)  # no more, also of a file that states no size
        require(len(content) <= MAX_BYTES, f"{path.name}: larger than {MAX_BYTES} bytes, which no preset is")
        text = content.decode("utf-8")
    except UnicodeDecodeError as error:
        raise ValueError(f"{path.name}: not UTF-8 text (byte {error.start})") from None
    except OSError as error:
        raise ValueError(f"{path}: cannot be read: {error.strerror}") from None
    return _kept(text, path.name) if path.parent in FOLDERS else loads(text, source=path.name)


@lru_cache(maxsize=64)
def _kept(text: str, source: str) -> Preset:
    """A shipped preset, decoded once: a preset is a value that nobody changes."""
    return loads(text, source=source)


def with_window(preset: Preset, window: float, *, source: str) -> Preset:
    """The preset judged over another window (s). Raises ValueError, starting with `source`, if it does not fit."""
    try:
        requirement = msgspec.structs.replace(preset.requirement, window=window)
        return msgspec.structs.replace(preset, requirement=requirement)
    except ValueError as error:
        raise ValueError(f"{source}: {error}") from None


def save(preset: Preset, path: str | Path) -> None:
    """Write a preset as TOML."""
    Path(path).write_text(dumps(preset), encoding="utf-8")


def find(name_or_path: str | Path) -> Path:
    """The file behind a shipped name or a path. Raises ValueError naming the shipped presets if there is none."""
    path = Path(name_or_path)
    if path.suffix == ".toml" or path.parent != Path("."):
        require(path.exists(), f"{path}: no such file")
        require(path.is_file(), f"{path}: not a file")
        return path
    shipped = {file.stem: file for file in shipped_files()}
    near = difflib.get_close_matches(str(name_or_path), shipped, 1)
    meant = f"did you mean {near[0]}? Shipped" if near else "shipped"
    require(str(name_or_path) in shipped, f"{name_or_path}: no such preset; {meant} are {', '.join(shipped)}")
    return shipped[str(name_or_path)]


def shipped_files() -> list[Path]:
    """The files of all shipped presets, in alphabetical order."""
    folder = next((folder for folder in FOLDERS if folder.is_dir()), None)
    return sorted(folder.glob("*.toml")) if folder else []


def shipped() -> dict[str, Preset]:
    """All shipped presets by name."""
    return {file.stem: load(file) for file in shipped_files()}
