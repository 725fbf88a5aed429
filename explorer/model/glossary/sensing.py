"""Terms of the sensors: rates, noise, and what the paper does not model."""

from explorer.model.glossary.term import Term

WHITE = "white noise, with this standard deviation at every sample"
SENSING = {
    "sensor set": Term(
        label="sensor set",
        meaning="Rates, noise and faults of known sensors; choosing one replaces everything below.",
    ),
    "range rate": Term(
        label="ranges per second",
        unit="Hz",
        meaning="How often a range arrives; each corrects the estimate once.",
        formula="d = |p − anchor| + noise, y = ½d²",
        place="paper, eq. 3",
        fields=("sensors.range_rate",),
    ),
    "imu rate": Term(
        label="IMU rate",
        unit="Hz",
        meaning="How often gyro and accelerometer are read: the step of the observer.",
        advice="A faster IMU takes longer to compute.",
        fields=("sensors.imu_rate",),
    ),
    "mag rate": Term(
        label="magnetometer rate",
        unit="Hz",
        meaning="How often the magnetometer is read, at most as often as the IMU.",
        fields=("sensors.mag_rate",),
    ),
    "range noise": Term(
        label="range noise σ",
        unit="m",
        meaning=f"The range has {WHITE}.",
        place="paper, eq. 3",
        fields=("sensors.noise.range", "noise range"),
    ),
    "gyro noise": Term(
        label="gyro noise σ",
        unit="rad/s",
        meaning=f"The gyro has {WHITE}.",
        place="paper, eq. 2",
        fields=("sensors.noise.gyro", "noise gyro"),
    ),
    "accel noise": Term(
        label="accelerometer noise σ",
        unit="m/s²",
        meaning=f"The accelerometer has {WHITE}.",
        place="paper, eq. 2",
        fields=("sensors.noise.accel", "noise accel"),
    ),
    "mag noise": Term(
        label="magnetometer noise σ",
        meaning=f"The magnetometer, a unit vector, has {WHITE}; the paper prints σ² = 0.01.",
        fields=("sensors.noise.mag", "noise mag"),
    ),
    "gyro density": Term(
        label="gyro noise density",
        unit="rad/s/√Hz",
        meaning="The gyro's noise as data sheets state it; a sample has the density times √(IMU rate).",
    ),
    "accel density": Term(
        label="accelerometer noise density",
        unit="m/s²/√Hz",
        meaning="The accelerometer's noise as data sheets state it; a sample has the density times √(IMU rate).",
    ),
    "density": Term(
        label="IMU noise as density",
        meaning="On: the IMU's noise is stated as in data sheets, and stays the same when its rate changes.",
        fields=("sensors.noise.imu_unit",),
    ),
    "seed": Term(
        label="noise seed",
        meaning="The same seed gives the same noise to the last bit, another seed another run; a whole number from 0.",
        fields=("seed",),
    ),
    "unmodelled": Term(
        label="biases, outliers, drop-outs",
        meaning="What real sensors do and the observer does not model; all are off in the paper.",
    ),
}
