"""The noise of the sensors: standard deviations per sample and, for gyro and accelerometer, noise densities.

density n (unit/√Hz)     standard deviation per sample σ = n √(IMU rate)
"""

from explorer.model.glossary import SENSING
from explorer.widgets.controls import Switch
from explorer.widgets.dial_control import DIGITS
from explorer.widgets.dials import LogDial
from explorer.widgets.form import Form
from explorer.widgets.section import Section
from rangenav.number_format import significant
from rangenav.sensors import Noise, Unit, in_unit

OTHER_UNIT: dict[Unit, tuple[Unit, str]] = {"sample": ("density", "/√Hz"), "density": ("sample", " per sample")}


class NoiseFolder:
    """Standard deviations per sample. Gyro and accelerometer have dials for noise densities as well."""

    def __init__(self, form: Form) -> None:
        def dial(key: str, limits: tuple[float, float]) -> LogDial:
            return LogDial(section, SENSING[key].caption, limits, hint=SENSING[key].hint, zero_at_left=True)

        self._section = section = Section(form, "Noise")
        with section:
            self._range = dial("range noise", (1e-3, 10.0))
            self.as_density = Switch(section, SENSING["density"].caption, hint=SENSING["density"].hint)
            self.groups: dict[Unit, Section] = {}
            self._gyro: dict[Unit, LogDial] = {}
            self._accel: dict[Unit, LogDial] = {}
            with self._group(form, "sample") as section:
                self._gyro["sample"] = dial("gyro noise", (1e-4, 1.0))
                self._accel["sample"] = dial("accel noise", (1e-3, 10.0))
            with self._group(form, "density") as section:
                self._gyro["density"] = dial("gyro density", (1e-6, 0.1))
                self._accel["density"] = dial("accel density", (1e-5, 1.0))
            section = self._section
            self.other_unit_line = form.gui.add_markdown("")
            self._mag = dial("mag noise", (1e-3, 1.0))
        self._unit: Unit = "sample"
        self._converted: tuple[Noise, float, Noise] | None = None

    def refresh(self, rate: float) -> None:
        """Show the noise in the unit chosen, and in the other one, for an IMU at `rate` (Hz).

        Raises InvalidInputError after showing the reason below the controls.
        """
        with self._section.catching():
            noise = self.read()
            chosen_unit: Unit = "density" if self.as_density.read() else "sample"
            if chosen_unit != self._unit:
                noise = self._in_unit(noise, chosen_unit, rate)
                self.show(noise)
            self._describe_other_unit(noise, rate)

    def read(self) -> Noise:
        """The noise on the dials on the page, in their unit. Raises InvalidInputError."""
        with self._section.checking():
            return Noise(
                gyro=self._gyro[self._unit].read(),
                accel=self._accel[self._unit].read(),
                mag=self._mag.read(),
                range=self._range.read(),
                imu_unit=self._unit,
            )

    def write(self, noise: Noise, base: Noise) -> None:
        """Show noise in its own unit; if the preset has the other unit, the dials cannot be reset to the preset."""
        unit, same_unit = noise.imu_unit, noise.imu_unit == base.imu_unit
        self.as_density.write(unit == "density", base.imu_unit == "density")
        self._gyro[unit].write(noise.gyro, base.gyro if same_unit else None)
        self._accel[unit].write(noise.accel, base.accel if same_unit else None)
        self._mag.write(noise.mag, base.mag)
        self._range.write(noise.range, base.range)
        self._show_unit(unit)

    def show(self, noise: Noise) -> None:
        """Show noise; what the controls are reset to stays as it was."""
        self.as_density.show(noise.imu_unit == "density")
        self._gyro[noise.imu_unit].show(noise.gyro)
        self._accel[noise.imu_unit].show(noise.accel)
        self._mag.show(noise.mag)
        self._range.show(noise.range)
        self._show_unit(noise.imu_unit)

    def _show_unit(self, shown: Unit) -> None:
        self._unit = shown
        for unit, group in self.groups.items():
            group.show(unit == shown)

    def _group(self, form: Form, unit: Unit) -> Section:
        self.groups[unit] = Section(form)
        return self.groups[unit]

    def _in_unit(self, noise: Noise, unit: Unit, rate: float) -> Noise:
        """The same noise in another unit. Converted back unchanged, it is the original to the last bit."""
        before, last = noise, self._converted
        noise = last[0] if last and last[1:] == (rate, noise) else in_unit(noise, unit, rate=rate)
        self._converted = (before, rate, noise)
        return noise

    def _describe_other_unit(self, noise: Noise, rate: float) -> None:
        """Show gyro and accelerometer noise in the other unit."""
        unit, name = OTHER_UNIT[noise.imu_unit]
        other = in_unit(noise, unit, rate=rate)
        gyro, accel = (significant(sigma, DIGITS) for sigma in (other.gyro, other.accel))
        line = f"at {rate:g} Hz: {gyro} rad/s{name}, {accel} m/s²{name}"
        if line != self.other_unit_line.content:
            self.other_unit_line.content = line
