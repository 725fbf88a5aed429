"""The Sensors tab: a set to start from, rates, noise and its seed, and what the paper does not model."""

import html
from typing import NamedTuple

import msgspec
import viser

from explorer.panels.controls import Choice, Complaint, Dial, LogDial, Note, Number, Switch, short
from explorer.panels.unmodelled import STYLE, UnmodelledFolder
from rangenav.preset import Preset
from rangenav.sensors import Noise, Sensors, Unit, given_as, words
from rangenav.sensors.catalogue import CATALOGUE

OWN = "own"
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

    def __init__(self, gui: viser.GuiApi, chosen: Chosen, note: Note) -> None:
        hint = "Rates, noise and faults of known sensors, to start from. Choosing one replaces all of them below."
        names = {name: name for name in SETS} | {OWN: "as set below"}
        self._set = Choice(gui, "sensor set", names, hint=hint, note=note)
        self._set_words = gui.add_html("")
        hint = (
            "Hz: how often a range d = |p − anchor| + noise arrives (paper, eq. 3); each is one correction by y = ½d²."
        )
        self._range_rate = Dial(gui, "range (Hz)", (1.0, 200.0), step=1.0, hint=hint, note=note)
        self._noise = _NoiseFolder(gui, note)
        with gui.add_folder("IMU and magnetometer rates", expand_by_default=False):
            hint = "Hz: gyro and accelerometer, and with them the observer's step. Faster makes every change slower."
            self._imu_rate = Dial(gui, "IMU (Hz)", (20.0, 1000.0), step=10.0, hint=hint, note=note)
            hint = "Hz: the magnetometer, read on the IMU's clock; it cannot be faster."
            self._mag_rate = Dial(gui, "mag (Hz)", (1.0, 1000.0), step=1.0, hint=hint, note=note)
        self._unmodelled = UnmodelledFolder(gui, note)
        hint = "The same seed gives the same noise to the last bit; another one another run. A whole number from 0."
        self._seed = Number(gui, "noise seed", step=1.0, hint=hint, note=note)
        self.complaint = Complaint(gui)
        self.write(chosen)

    def read(self) -> Chosen:
        """The sensors chosen. Raises Refused after saying why beside the control."""
        with self.complaint.catching():
            picked = self._set.read()
            if picked != self._shown and picked != OWN:
                self._show(SETS[picked].sensors)
            rates = Sensors(
                imu_rate=self._imu_rate.read(), mag_rate=self._mag_rate.read(), range_rate=self._range_rate.read()
            )
            seed = _whole("seed", self._seed.read())
        noise, unmodelled = self._noise.read(rates.imu_rate), self._unmodelled.read()
        with self.complaint.catching():
            sensors = msgspec.structs.replace(rates, noise=noise, unmodelled=unmodelled)
        if self._set.read() == picked:  # else the visitor has just picked another, which the next look will find
            self._name(sensors)
        self._unmodelled.tell(words(sensors))
        return Chosen(sensors, seed)

    def write(self, chosen: Chosen) -> None:
        """Show sensors."""
        self._show(chosen.sensors)
        self._name(chosen.sensors)
        self._unmodelled.tell(words(chosen.sensors))
        self._seed.write(float(chosen.seed))

    def _show(self, sensors: Sensors) -> None:
        self._imu_rate.write(sensors.imu_rate)
        self._mag_rate.write(sensors.mag_rate)
        self._range_rate.write(sensors.range_rate)
        self._noise.write(sensors.noise)
        self._unmodelled.write(sensors.unmodelled)

    def _name(self, sensors: Sensors) -> None:
        """Say which set the sensors are, if they are one."""
        self._shown = next((name for name, entry in SETS.items() if entry.sensors == sensors), OWN)
        self._set.write(self._shown)
        said = html.escape(SETS[self._shown].words) if self._shown in SETS else "None of the sets."
        self._set_words.content = f'<div style="{STYLE}">{said}</div>'


class _NoiseFolder:
    """Standard deviations per sample; gyro and accelerometer also as densities, each unit on dials of its own."""

    def __init__(self, gui: viser.GuiApi, note: Note) -> None:
        def dial(symbol: str, unit: str, limits: tuple[float, float], what: str) -> LogDial:
            hint = f"{symbol} ({unit or 1}): deviation of white noise per sample of the {what} (paper, eq. 2–3)."
            return LogDial(gui, symbol, limits, hint=hint, note=note, unit=unit, zero_at_left=True)

        def density(symbol: str, unit: str, limits: tuple[float, float], what: str) -> LogDial:
            hint = f"{symbol} ({unit}): density of the {what}'s white noise; per sample it is {symbol[0]}·√(IMU rate)."
            return LogDial(gui, symbol, limits, hint=hint, note=note, unit=unit, zero_at_left=True)

        with gui.add_folder("Noise"):
            self._range = dial("σ range", "m", (1e-3, 10.0), "range")
            hint = "On: gyro and accelerometer noise as data sheets give it, and kept when the IMU's rate changes."
            self._as_density = Switch(gui, "IMU noise as density", hint=hint, note=note)
            self._groups: dict[Unit, viser.GuiFolderHandle] = {}
            self._gyro: dict[Unit, LogDial] = {}
            self._accel: dict[Unit, LogDial] = {}
            with self._group(gui, "sample"):
                self._gyro["sample"] = dial("σ gyro", "rad/s", (1e-4, 1.0), "gyro")
                self._accel["sample"] = dial("σ accel", "m/s²", (1e-3, 10.0), "accelerometer")
            with self._group(gui, "density"):
                self._gyro["density"] = density("n gyro", "rad/s/√Hz", (1e-6, 0.1), "gyro")
                self._accel["density"] = density("n accel", "m/s²/√Hz", (1e-5, 1.0), "accelerometer")
            self._line = gui.add_markdown("")
            self._mag = dial("σ mag", "", (1e-3, 1.0), "magnetometer, a unit vector; the paper prints σ² = 0.01")
            self._complaint = Complaint(gui)
        self._unit: Unit = "sample"
        self._turned: tuple[Noise, float, Noise] | None = None

    def read(self, rate: float) -> Noise:
        """The noise chosen, for an IMU at `rate` (Hz)."""
        with self._complaint.catching():
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
                self.write(noise)
            self._tell(noise, rate)
        return noise

    def write(self, noise: Noise) -> None:
        """Show noise in the unit it was given."""
        self._unit = noise.imu_unit
        self._as_density.write(noise.imu_unit == "density")
        for unit, group in self._groups.items():
            group.visible = unit == noise.imu_unit
        self._gyro[noise.imu_unit].write(noise.gyro)
        self._accel[noise.imu_unit].write(noise.accel)
        self._mag.write(noise.mag)
        self._range.write(noise.range)

    def _group(self, gui: viser.GuiApi, unit: Unit) -> viser.GuiFolderHandle:
        self._groups[unit] = gui.add_folder(None, visible=unit == "sample")
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


def _whole(name: str, value: float) -> int:
    if not value.is_integer():  # also NaN and infinity
        raise ValueError(f"{name} must be a whole number, got {value:g}")
    return int(value)
