"""What real sensors do and the paper's model does not have: biases, outliers, drop-outs, an antenna beside the IMU.

    gyro ω + b + η     accel a + b + η     range |p + R r − p_anchor| + b + e + η, or none at all
Everything is off by default, and the observer knows nothing of any of it.
"""

import math

from rangenav.inputs import Input, Vec3, require, require_within

MAX_GYRO_BIAS = 10.0
"""rad/s; the worst MEMS gyro starts 0.4 rad/s off."""
MAX_ACCEL_BIAS = 100.0
"""m/s²"""
MAX_RANGE_ERROR = 1e3
"""m, of a bias or a mean outlier."""
MAX_LEVER_ARM = 100.0
"""m; no vehicle that a range of this kind guides is larger."""
MAX_BURST = 1e4
"""s; a burst beyond the end of the flight does nothing."""
UNKNOWN = "the paper's observer has no state for it"
UNITS = {"gyro_bias": "rad/s", "accel_bias": "m/s²", "lever_arm": "m"}


class Effects(Input, frozen=True, kw_only=True):
    """Effects of real sensors that are not in the paper; each constant over a flight, none by default."""

    gyro_bias: Vec3 = (0.0, 0.0, 0.0)
    """rad/s, body axes."""
    accel_bias: Vec3 = (0.0, 0.0, 0.0)
    """m/s², body axes."""
    range_bias: float = 0.0
    """m, of either sign; antenna delays make one."""
    outlier_probability: float = 0.0
    """The share of ranges with an excess e, each by itself."""
    outlier_size: float = 1.0
    """m, the mean of e: exponential and never negative, because a blocked or reflected signal can only come late."""
    dropout_probability: float = 0.0
    """The share of ranges that do not arrive, each by itself."""
    burst_start: float = 0.0
    """s"""
    burst_length: float = 0.0
    """s; from burst_start on for so long no range arrives."""
    lever_arm: Vec3 = (0.0, 0.0, 0.0)
    """m, body axes: from the IMU to the antenna, r."""

    def __post_init__(self) -> None:
        super().__post_init__()
        limits = {"gyro_bias": MAX_GYRO_BIAS, "accel_bias": MAX_ACCEL_BIAS, "lever_arm": MAX_LEVER_ARM}
        for name, limit in limits.items():
            size = math.hypot(*getattr(self, name))
            require(size <= limit, f"{name} must not be longer than {limit:g} {UNITS[name]}, got {size:g}")
        require_within("range_bias", self.range_bias, -MAX_RANGE_ERROR, MAX_RANGE_ERROR, "m")
        require_within("outlier_size", self.outlier_size, 0.0, MAX_RANGE_ERROR, "m")
        for name in ("outlier_probability", "dropout_probability"):
            value = getattr(self, name)
            require(0 <= value < 1, f"{name} must lie between 0 and 1, 1 excluded, got {value:g}")
        for name in ("burst_start", "burst_length"):
            require_within(name, getattr(self, name), 0.0, MAX_BURST, "s")

    @property
    def outliers(self) -> bool:
        """Whether some range may come out too long."""
        return self.outlier_probability > 0 and self.outlier_size > 0


MODELLED = Effects()
"""Nothing but what the paper has."""


def told(unmodelled: Effects) -> dict[str, str]:
    """What is on, by name, and what the observer makes of it: one sentence each."""
    u, said = unmodelled, {}
    if any(u.gyro_bias):
        said["gyro bias"] = f"{_vector(u.gyro_bias)} rad/s; {UNKNOWN}, so attitude and position keep an error"
    if any(u.accel_bias):
        said["accelerometer bias"] = f"{_vector(u.accel_bias)} m/s²; {UNKNOWN}, so position and velocity keep an error"
    if u.range_bias:
        said["range bias"] = f"{u.range_bias:g} m; {UNKNOWN}, so position keeps an error of its order or larger"
    if u.outliers:
        share = f"{100 * u.outlier_probability:g} of 100 ranges are too long, by {u.outlier_size:g} m on average"
        said["outliers"] = f"{share}; the paper's observer has no gate and believes each one"
    if u.dropout_probability:
        share = f"{100 * u.dropout_probability:g} of 100 ranges do not arrive"
        said["drop-outs"] = f"{share}; the paper has one at all times, here the IMU carries the estimate over a gap"
    if u.burst_length:
        span = f"no range from {u.burst_start:g} s to {u.burst_start + u.burst_length:g} s"
        said["burst"] = f"{span}; the IMU alone carries the estimate, whose error grows until ranges return"
    if any(u.lever_arm):
        arm = f"the antenna is {_vector(u.lever_arm)} m from the IMU; the paper has it in the IMU"
        said["lever arm"] = f"{arm}, so position keeps an error of the arm's order or larger"
    return said


def _vector(vector: Vec3) -> str:
    return "({:g}, {:g}, {:g})".format(*vector)
