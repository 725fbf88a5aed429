"""Records for the tests: a preset, its truth, its measurements and a start, at chosen rates and noise."""

from dataclasses import dataclass

import numpy as np
from msgspec.structs import replace

from rangenav import cascade, errors, model, preset, record
from rangenav.cascade import Estimate, ObserverConfig, Start
from rangenav.gains import Gains
from rangenav.preset import Preset
from rangenav.record import Truth
from rangenav.sensors import Measurements, Noise, Sensors

SILENT = Noise(gyro=0.0, accel=0.0, mag=0.0, range=0.0)


@dataclass(frozen=True, eq=False, kw_only=True)
class Scene:
    """One record, ready for an observer."""

    preset: Preset
    truth: Truth
    measurements: Measurements
    start: Start

    def setting(self, gains: Gains | None = None, form: model.ModelForm = "derived") -> ObserverConfig:
        p = self.preset
        return ObserverConfig(world=p.world, sensors=p.sensors, gains=gains or p.gains, form=form)

    def observe(self, gains: Gains | None = None, form: model.ModelForm = "derived") -> Estimate:
        return cascade.observe(self.measurements, self.start, self.setting(gains, form))

    def errors(self, estimate: Estimate) -> errors.Errors:
        return errors.of(estimate, truth=self.truth.state, rotation=self.truth.motion.rotation)


def scene(
    name: str,
    *,
    duration: float,
    imu_rate: float = 200.0,
    range_rate: float = 200.0,
    mag_rate: float | None = None,
    noise: Noise | None = None,
    seed: int = 0,
    guess: str = "zero",
) -> Scene:
    """A shipped preset with other rates and another duration."""
    p = preset.load(name)
    sensors = Sensors(
        imu_rate=imu_rate, range_rate=range_rate, mag_rate=mag_rate or imu_rate, noise=noise or p.sensors.noise
    )
    window = min(p.requirement.window, duration / 2)
    p = replace(
        p,
        duration=duration,
        sensors=sensors,
        seed=seed,
        guess=replace(p.guess, state=guess),
        requirement=replace(p.requirement, window=window),
    )
    truth, z = record.simulated(record.truth_inputs(p)), record.measured(record.truth_inputs(p), sensors, seed)
    start = cascade.start(p.guess, state=truth.state[0], rotation=truth.motion.rotation[0], world=p.world)
    return Scene(preset=p, truth=truth, measurements=z, start=start)


def without_ranges(z: Measurements, lost: np.ndarray) -> Measurements:
    """The record with some of its ranges dropped."""
    return Measurements(
        time=z.time, gyro=z.gyro, accel=z.accel, mag=z.mag, range_time=z.range_time[~lost], range=z.range[~lost]
    )
