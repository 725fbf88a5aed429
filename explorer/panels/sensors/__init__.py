"""The Sensors tab: a set to start from, rates, noise and its seed, and what the paper does not model."""

import html
from typing import NamedTuple

import msgspec

from explorer.panels.sensors.effects import STYLE, EffectsFolder
from explorer.widgets.controls import Choice, Dial, LogDial, Number, Switch, short
from explorer.widgets.form import Form, Section
from rangenav.preset import Preset
from rangenav.sensors import Noise, Sensors, Unit, effect_sentences, given_as
from rangenav.sensors.sensor_sets import CATALOGUE

OWN = "own"
RATES = ("imu_rate", "mag_rate", "range_rate")
SETS = {entry.name: entry for entry in CATALOGUE}
OTHER_UNIT: dict[Unit, tuple[Unit, str]] = {"sample": ("density", "/√Hz"), "density": ("sample", " per sample")}


class Chosen(NamedTuple):
    """What this tab decides."""

    sensors: Sensors
    seed: int

    @staticmethod
    def of(preset: Preset) -> "Chosen":
        """The part of a preset that this tab shows."""
        return Chosen(preset.sensors, preset.seed)


class SensorsPanel:
    """All controls of the sensors."""

    def __init__(self, form: Form) -> None:
        self._section = section = Section(form)
        hint = "Rates, noise and faults of known sensors, to start from. Choosing one replaces all of them below."
        names = {name: name for name in SETS} | {OWN: "as set below"}
        with section:
            self._set = Choice(section, "sensor set", names, hint=hint)
            self._set_words = form.gui.add_html("")
        hint = (
            "Hz: how often a range d = |p − anchor| + noise arrives (paper, eq. 3); each is one correction by y = ½d²."
        )
        with section:
            self._range_rate = Dial(section, "range (Hz)", (1.0, 200.0), step=1.0, hint=hint)
        self._noise = _NoiseFolder(form)
        self._rates = section = Section(form, "IMU and magnetometer rates", expanded=False)
        with section:
            hint = "Hz: gyro and accelerometer, and with them the observer's step. Faster makes every change slower."
            self._imu_rate = Dial(section, "IMU (Hz)", (20.0, 1000.0), step=10.0, hint=hint)
            hint = "Hz: the magnetometer, read on the IMU's clock; it cannot be faster."
            self._mag_rate = Dial(section, "mag (Hz)", (1.0, 1000.0), step=1.0, hint=hint)
        self._unmodelled = EffectsFolder(form)
        hint = "The same seed gives the same noise to the last bit; another one another run. A whole number from 0."
        self._seed_section = section = Section(form)
        with section:
            self._seed = Number(section, "noise seed", step=1.0, hint=hint)
        self._shown = OWN

    def read(self) -> Chosen:
        """The sensors chosen. Raises Refused after saying why beside the control."""
        with self._section.catching():
            picked = self._set.read()
            if picked != self._shown and picked != OWN:
                self._show(SETS[picked].sensors)
            rates = Sensors(
                imu_rate=self._imu_rate.read(), mag_rate=self._mag_rate.read(), range_rate=self._range_rate.read()
            )
        noise, unmodelled = self._noise.read(rates.imu_rate), self._unmodelled.read()
        with self._section.catching():
            sensors = msgspec.structs.replace(rates, noise=noise, unmodelled=unmodelled)
        if self._set.read() == picked:  # else the visitor has just picked another, which the next look will find
            self._name(sensors)
        self._unmodelled.tell(effect_sentences(sensors))
        with self._seed_section.catching():
            return Chosen(sensors, _whole("seed", self._seed.read()))

    def write(self, chosen: Chosen, base: Chosen) -> None:
        """Show sensors."""
        for dial in RATES:
            getattr(self, f"_{dial}").write(getattr(chosen.sensors, dial), getattr(base.sensors, dial))
        for name, folder in (("noise", self._noise), ("unmodelled", self._unmodelled)):
            folder.write(getattr(chosen.sensors, name), getattr(base.sensors, name))
        self._set.write(_set_of(chosen.sensors), _set_of(base.sensors))
        self._name(chosen.sensors)
        self._unmodelled.tell(effect_sentences(chosen.sensors))
        self._seed.write(float(chosen.seed), float(base.seed))

    def complain(self, sentence: str) -> None:
        """Say a sentence about sensors and motion together."""
        self._seed_section.complaint.say(sentence)

    def clear(self) -> None:
        """Nothing is wrong with sensors and motion together."""
        self._seed_section.complaint.clear()

    def _show(self, sensors: Sensors) -> None:
        for dial in RATES:
            getattr(self, f"_{dial}").show(getattr(sensors, dial))
        self._noise.show(sensors.noise)
        self._unmodelled.show(sensors.unmodelled)

    def _name(self, sensors: Sensors) -> None:
        """Say which set the sensors are, if they are one."""
        self._shown = _set_of(sensors)
        self._set.show(self._shown)
        said = html.escape(SETS[self._shown].summary) if self._shown in SETS else "None of the sets."
        self._set_words.content = f'<div style="{STYLE}">{said}</div>'


class _NoiseFolder:
    """Standard deviations per sample; gyro and accelerometer also as densities, each unit on dials of its own."""

    def __init__(self, form: Form) -> None:
        def dial(symbol: str, unit: str, limits: tuple[float, float], what: str) -> LogDial:
            hint = f"{symbol} ({unit or 1}): deviation of white noise per sample of the {what} (paper, eq. 2–3)."
            return LogDial(section, symbol, limits, hint=hint, unit=unit, zero_at_left=True)

        def density(symbol: str, unit: str, limits: tuple[float, float], what: str) -> LogDial:
            hint = f"{symbol} ({unit}): density of the {what}'s white noise; per sample it is {symbol[0]}·√(IMU rate)."
            return LogDial(section, symbol, limits, hint=hint, unit=unit, zero_at_left=True)

        self._section = section = Section(form, "Noise")
        with section:
            self._range = dial("σ range", "m", (1e-3, 10.0), "range")
            hint = "On: gyro and accelerometer noise as data sheets give it, and kept when the IMU's rate changes."
            self._as_density = Switch(section, "IMU noise as density", hint=hint)
            self._groups: dict[Unit, Section] = {}
            self._gyro: dict[Unit, LogDial] = {}
            self._accel: dict[Unit, LogDial] = {}
            with self._group(form, "sample") as section:
                self._gyro["sample"] = dial("σ gyro", "rad/s", (1e-4, 1.0), "gyro")
                self._accel["sample"] = dial("σ accel", "m/s²", (1e-3, 10.0), "accelerometer")
            with self._group(form, "density") as section:
                self._gyro["density"] = density("n gyro", "rad/s/√Hz", (1e-6, 0.1), "gyro")
                self._accel["density"] = density("n accel", "m/s²/√Hz", (1e-5, 1.0), "accelerometer")
            section = self._section
            self._line = form.gui.add_markdown("")
            self._mag = dial("σ mag", "", (1e-3, 1.0), "magnetometer, a unit vector; the paper prints σ² = 0.01")
        self._unit: Unit = "sample"
        self._turned: tuple[Noise, float, Noise] | None = None

    def read(self, rate: float) -> Noise:
        """The noise chosen, for an IMU at `rate` (Hz)."""
        with self._section.catching():
            noise = Noise(
                gyro=self._gyro[self._unit].read(),
                accel=self._accel[self._unit].read(),
                mag=self._mag.read(),
                range=self._range.read(),
                imu_unit=self._unit,
            )
            wanted: Unit = "density" if self._as_density.read() else "sample"
            if wanted != self._unit:
                noise = self._turn(noise, wanted, rate)
                self.show(noise)
            self._tell(noise, rate)
        return noise

    def write(self, noise: Noise, base: Noise) -> None:
        """Show noise in the unit it was given; dials of the other unit have nothing to be held against."""
        unit, alike = noise.imu_unit, noise.imu_unit == base.imu_unit
        self._as_density.write(unit == "density", base.imu_unit == "density")
        self._gyro[unit].write(noise.gyro, base.gyro if alike else None)
        self._accel[unit].write(noise.accel, base.accel if alike else None)
        self._mag.write(noise.mag, base.mag)
        self._range.write(noise.range, base.range)
        self._bring_forward(unit)

    def show(self, noise: Noise) -> None:
        """Show noise; what the preset says stays what it was."""
        self._as_density.show(noise.imu_unit == "density")
        self._gyro[noise.imu_unit].show(noise.gyro)
        self._accel[noise.imu_unit].show(noise.accel)
        self._mag.show(noise.mag)
        self._range.show(noise.range)
        self._bring_forward(noise.imu_unit)

    def _bring_forward(self, shown: Unit) -> None:
        self._unit = shown
        for unit, group in self._groups.items():
            group.show(unit == shown)

    def _group(self, form: Form, unit: Unit) -> Section:
        self._groups[unit] = Section(form)
        return self._groups[unit]

    def _turn(self, noise: Noise, unit: Unit, rate: float) -> Noise:
        """The same noise in the other unit; switched back with nothing changed it is the old one to the last bit."""
        before, back = noise, self._turned
        noise = back[0] if back and back[1:] == (rate, noise) else given_as(noise, unit, rate=rate)
        self._turned = (before, rate, noise)
        return noise

    def _tell(self, noise: Noise, rate: float) -> None:
        """What gyro and accelerometer noise are in the other unit."""
        unit, name = OTHER_UNIT[noise.imu_unit]
        other = given_as(noise, unit, rate=rate)
        line = f"at {rate:g} Hz: {short(other.gyro)} rad/s{name}, {short(other.accel)} m/s²{name}"
        if line != self._line.content:
            self._line.content = line


def _set_of(sensors: Sensors) -> str:
    return next((name for name, entry in SETS.items() if entry.sensors == sensors), OWN)


def _whole(name: str, value: float) -> int:
    if not value.is_integer():  # also NaN and infinity
        raise ValueError(f"{name} must be a whole number, got {value:g}")
    return int(value)
