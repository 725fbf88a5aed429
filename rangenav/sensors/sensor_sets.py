"""Sets of sensors to choose from, each with the source of its figures.

A data sheet gives the noise of a chip at rest. The vibration of motors adds far more, and the bias that a calibration
leaves is in no data sheet. Such figures are ours, of a usual size, and marked as ours.
"""

import math

from rangenav.inputs import Input
from rangenav.sensors.effects import Effects
from rangenav.sensors.noise import Noise
from rangenav.sensors.suite import Sensors

DEGREE = math.pi / 180
MICRO_G = 9.81e-6


class SensorSet(Input, frozen=True, kw_only=True):
    """Sensors under a name."""

    name: str
    summary: str
    """One sentence: the source of the figures, and what the paper does not have."""
    sensors: Sensors


PAPER = SensorSet(
    name="paper",
    summary="The paper's: it prints only the magnetometer's variance, 0.01; the other figures are ours.",
    sensors=Sensors(range_rate=200.0),
)
UWB_GOOD = SensorSet(
    name="UWB in sight",
    summary="Ranges of an ultra-wideband radio that sees its anchor, 5 cm at 100 Hz; the paper's IMU and magnetometer.",
    # DW1000: ±10 cm by its maker; a calibrated pair in sight scatters by about half of that (ours)
    sensors=Sensors(range_rate=100.0, noise=Noise(range=0.05)),
)
UWB_NLOS = SensorSet(
    name="UWB behind obstacles",
    summary="That radio behind walls and people: ranges 15 cm too long, a tenth by half a metre more, some lost.",
    # in sight Gaussian, out of sight Gaussian and exponential: "Modeling distance and bandwidth dependency of TOA-based
    # UWB ranging error" (TU Delft); the sizes are ours
    sensors=Sensors(
        range_rate=100.0,
        noise=Noise(range=0.1),
        unmodelled=Effects(range_bias=0.15, outlier_probability=0.1, outlier_size=0.5, dropout_probability=0.05),
    ),
)
MEMS = SensorSet(
    name="consumer MEMS",
    summary="A phone's IMU by its data sheet (MPU-6050), with what a calibration at rest leaves of its biases.",
    sensors=Sensors(
        imu_rate=200.0,
        mag_rate=50.0,
        range_rate=50.0,
        noise=Noise(
            gyro=0.005 * DEGREE,  # PS-MPU-6000A rev. 3.4: 0.005 °/s/√Hz
            accel=400 * MICRO_G,  # the same: 400 µg/√Hz
            mag=0.02,  # ours: 1 µT of a field of 50 µT
            range=0.1,  # ours
            imu_unit="density",
        ),
        unmodelled=Effects(
            gyro_bias=(0.002, -0.001, 0.001),  # ours: 0.14 °/s; uncalibrated the sheet allows ±20 °/s
            accel_bias=(0.03, -0.02, 0.04),  # ours: 5 mg; uncalibrated the sheet allows ±50 mg, ±80 mg along z
        ),
    ),
)
CRAZYFLIE = SensorSet(
    name="Crazyflie-like",
    summary="A BMI088 by its data sheet, and ranges to one of eight Loco anchors; propellers would add far more noise.",
    sensors=Sensors(
        imu_rate=500.0,  # its firmware reads at 1000 Hz; as a density the noise is the same, and the page is quicker
        mag_rate=50.0,  # the 2.1 carries none: an added one, with the paper's noise
        range_rate=50.0,  # ours: some 400 messages a second among 8 anchors
        noise=Noise(
            gyro=0.014 * DEGREE,  # Bosch: 0.014 °/s/√Hz
            accel=175 * MICRO_G,  # Bosch: 175 µg/√Hz
            range=0.1,  # the DWM1000's ±10 cm; the firmware's own filter assumes 0.25 m
            imu_unit="density",
        ),
        unmodelled=Effects(
            gyro_bias=(0.0005, 0.0005, -0.0005),  # ours: the firmware averages it away before take-off
            accel_bias=(0.03, 0.02, -0.03),  # ours: 5 mg
            dropout_probability=0.15,  # bitcraze.io on TDoA 3: about 15% of packets collide at 400 a second
        ),
    ),
)
PERFECT = SensorSet(
    name="perfect",
    summary="No noise and nothing wrong: what remains is the observer's own convergence and its step.",
    sensors=Sensors(range_rate=200.0, noise=Noise(gyro=0.0, accel=0.0, mag=0.0, range=0.0)),
)
CATALOGUE = (PAPER, UWB_GOOD, UWB_NLOS, MEMS, CRAZYFLIE, PERFECT)
"""Every set, in the order of the menu."""
