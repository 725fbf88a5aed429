"""The Sensors tab: a sensor set to start from, rates, noise and its seed, and effects that the paper does not model."""

import html
from typing import NamedTuple

import msgspec

from explorer.model.glossary import SENSING
from explorer.panels.sensors.effects import STYLE, EffectsFolder
from explorer.panels.sensors.noise import NoiseFolder
from explorer.widgets.controls import Choice, Number
from explorer.widgets.dials import Dial
from explorer.widgets.form import Form
from explorer.widgets.section import Section
from rangenav.preset import Preset
from rangenav.sensors import MIN_RANGE_RATE, Sensors, effect_sentences
from rangenav.sensors.sensor_sets import CATALOGUE

CUSTOM = "own"
RATES = "IMU and magnetometer rates"
SENSOR_SETS = {entry.name: entry for entry in CATALOGUE}


class SensorChoice(NamedTuple):
    """The part of a preset that this tab sets."""

    sensors: Sensors
    seed: int

    @staticmethod
    def of(preset: Preset) -> "SensorChoice":
        """The part of a preset that this tab shows."""
        return SensorChoice(preset.sensors, preset.seed)


class SensorsPanel:
    """All controls of the sensors."""

    def __init__(self, form: Form) -> None:
        self._section = section = Section(form)
        names = {name: name for name in SENSOR_SETS} | {CUSTOM: "as set below"}
        with section:
            self.sensor_set = Choice(section, SENSING["sensor set"].caption, names, hint=SENSING["sensor set"].hint)
            self.set_text = form.gui.add_html("")
            self.range_rate = _rate_dial(section, "range rate", (MIN_RANGE_RATE, 200.0), step=0.1)
        self.noise = NoiseFolder(form)
        self._rates_section = section = Section(form, RATES, expanded=False)
        with section:
            self.imu_rate = _rate_dial(section, "imu rate", (20.0, 1000.0), step=10.0)
            self.mag_rate = _rate_dial(section, "mag rate", (1.0, 1000.0), step=1.0)
        self._rate_dials = {"range_rate": self.range_rate, "imu_rate": self.imu_rate, "mag_rate": self.mag_rate}
        self.effects = EffectsFolder(form)
        self._seed_section = section = Section(form)
        with section:
            self._seed = Number(section, SENSING["seed"].caption, hint=SENSING["seed"].hint)
        self._shown_set = CUSTOM

    def refresh(self) -> None:
        """Show the set just picked, or the name of the set that the sensors equal, and describe the effects.

        Raises InvalidInputError after showing the reason below the control.
        """
        with self._section.catching():
            picked = self.sensor_set.read()
            if picked != self._shown_set and picked != CUSTOM:
                self._show(SENSOR_SETS[picked].sensors)
            rates = self._rates()
        self.noise.refresh(rates.imu_rate)
        self.effects.refresh()
        with self._section.catching():
            sensors = self._sensors()
        self._describe_rates(sensors)
        if self.sensor_set.read() == picked:  # else the visitor has just picked another set; the next refresh shows it
            self._show_set_name(sensors)
        self.effects.describe(effect_sentences(sensors))
        with self._seed_section.catching():
            self.read()

    def read(self) -> SensorChoice:
        """The sensors chosen. Raises InvalidInputError."""
        sensors = self._sensors()
        with self._seed_section.checking():
            return SensorChoice(sensors, _whole_number("seed", self._seed.read()))

    def write(self, choice: SensorChoice, base: SensorChoice) -> None:
        """Show sensors."""
        for name, dial in self._rate_dials.items():
            dial.write(getattr(choice.sensors, name), getattr(base.sensors, name))
        for name, folder in (("noise", self.noise), ("unmodelled", self.effects)):
            folder.write(getattr(choice.sensors, name), getattr(base.sensors, name))
        self.sensor_set.write(_set_of(choice.sensors), _set_of(base.sensors))
        self._describe_rates(choice.sensors)
        self._show_set_name(choice.sensors)
        self.effects.describe(effect_sentences(choice.sensors))
        self._seed.write(float(choice.seed), float(base.seed))

    def complain(self, sentence: str) -> None:
        """Show an error that concerns the sensors together with the motion."""
        self._seed_section.complaint.say(sentence)

    def clear(self) -> None:
        """Hide the error that concerns the sensors together with the motion."""
        self._seed_section.complaint.clear()

    def _rates(self) -> Sensors:
        """The rates chosen, with the usual noise."""
        return Sensors(imu_rate=self.imu_rate.read(), mag_rate=self.mag_rate.read(), range_rate=self.range_rate.read())

    def _sensors(self) -> Sensors:
        """The rates, the noise and the effects chosen."""
        with self._section.checking():
            rates = self._rates()
        noise, unmodelled = self.noise.read(), self.effects.read()
        with self._section.checking():
            return msgspec.structs.replace(rates, noise=noise, unmodelled=unmodelled)

    def _show(self, sensors: Sensors) -> None:
        for name, dial in self._rate_dials.items():
            dial.show(getattr(sensors, name))
        self.noise.show(sensors.noise)
        self.effects.show(sensors.unmodelled)

    def _describe_rates(self, sensors: Sensors) -> None:
        """Say in the folded heading what is inside."""
        self._rates_section.caption(f"{RATES}: {sensors.imu_rate:g} Hz, {sensors.mag_rate:g} Hz")

    def _show_set_name(self, sensors: Sensors) -> None:
        """Show the name and the description of the set that the sensors equal, if any."""
        self._shown_set = _set_of(sensors)
        self.sensor_set.show(self._shown_set)
        text = (
            html.escape(SENSOR_SETS[self._shown_set].summary)
            if self._shown_set in SENSOR_SETS
            else "Values of your own."
        )
        self.set_text.content = f'<div style="{STYLE}">{text}</div>'


def _rate_dial(section: Section, key: str, limits: tuple[float, float], *, step: float) -> Dial:
    return Dial(section, SENSING[key].caption, limits, step=step, hint=SENSING[key].hint)


def _set_of(sensors: Sensors) -> str:
    return next((name for name, entry in SENSOR_SETS.items() if entry.sensors == sensors), CUSTOM)


def _whole_number(name: str, value: float) -> int:
    if not value.is_integer():  # also NaN and infinity
        raise ValueError(f"{name} must be a whole number, got {value:g}")
    return int(value)
