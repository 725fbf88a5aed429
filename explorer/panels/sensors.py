"""The Sensors tab: rates, noise and the seed of the noise."""

from typing import NamedTuple

from explorer.panels.controls import Dial, LogDial, Number
from explorer.panels.sheet import Section, Sheet
from rangenav.preset import Preset
from rangenav.sensors import Noise, Sensors


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

    def __init__(self, sheet: Sheet) -> None:
        self.section = section = Section(sheet)
        hint = (
            "Hz: how often a range d = |p − anchor| + noise arrives (paper, eq. 3); each is one correction by y = ½d²."
        )
        with section:
            self._range_rate = Dial(section, "range (Hz)", (1.0, 200.0), step=1.0, hint=hint)
        self._noise = _NoiseFolder(sheet)
        self._rates = section = Section(sheet, "IMU and magnetometer rates", expanded=False)
        with section:
            hint = "Hz: gyro and accelerometer, and with them the observer's step. Faster makes every change slower."
            self._imu_rate = Dial(section, "IMU (Hz)", (20.0, 1000.0), step=10.0, hint=hint)
            hint = "Hz: the magnetometer, read on the IMU's clock; it cannot be faster."
            self._mag_rate = Dial(section, "mag (Hz)", (1.0, 1000.0), step=1.0, hint=hint)
        hint = "The same seed gives the same noise to the last bit; another one another run. A whole number from 0."
        self._seed_section = section = Section(sheet)
        with section:
            self._seed = Number(section, "noise seed", step=1.0, hint=hint)

    def read(self) -> Chosen:
        """The sensors chosen. Raises Refused after saying why beside the control."""
        noise = self._noise.read()
        with self.section.catching():
            sensors = Sensors(
                imu_rate=self._imu_rate.read(),
                mag_rate=self._mag_rate.read(),
                range_rate=self._range_rate.read(),
                noise=noise,
            )
        with self._seed_section.catching():
            return Chosen(sensors, _whole("seed", self._seed.read()))

    def write(self, chosen: Chosen, base: Chosen) -> None:
        """Show sensors."""
        self._imu_rate.write(chosen.sensors.imu_rate, base.sensors.imu_rate)
        self._mag_rate.write(chosen.sensors.mag_rate, base.sensors.mag_rate)
        self._range_rate.write(chosen.sensors.range_rate, base.sensors.range_rate)
        self._noise.write(chosen.sensors.noise, base.sensors.noise)
        self._seed.write(float(chosen.seed), float(base.seed))

    def complain(self, sentence: str) -> None:
        """Say a sentence about sensors and motion together."""
        self._seed_section.complaint.say(sentence)


class _NoiseFolder:
    """Standard deviations per sample."""

    def __init__(self, sheet: Sheet) -> None:
        def dial(symbol: str, unit: str, limits: tuple[float, float], what: str) -> LogDial:
            hint = f"{symbol} ({unit or 1}): deviation of white noise per sample of the {what} (paper, eq. 2–3)."
            return LogDial(section, symbol, limits, hint=hint, unit=unit, zero_at_left=True)

        self._section = section = Section(sheet, "Noise")
        with section:
            self._range = dial("σ range", "m", (1e-3, 10.0), "range")
            self._gyro = dial("σ gyro", "rad/s", (1e-4, 1.0), "gyro")
            self._accel = dial("σ accel", "m/s²", (1e-3, 10.0), "accelerometer")
            self._mag = dial("σ mag", "", (1e-3, 1.0), "magnetometer, a unit vector; the paper prints σ² = 0.01")

    def read(self) -> Noise:
        with self._section.catching():
            return Noise(
                gyro=self._gyro.read(), accel=self._accel.read(), mag=self._mag.read(), range=self._range.read()
            )

    def write(self, noise: Noise, base: Noise) -> None:
        self._gyro.write(noise.gyro, base.gyro)
        self._accel.write(noise.accel, base.accel)
        self._mag.write(noise.mag, base.mag)
        self._range.write(noise.range, base.range)


def _whole(name: str, value: float) -> int:
    if not value.is_integer():  # also NaN and infinity
        raise ValueError(f"{name} must be a whole number, got {value:g}")
    return int(value)
