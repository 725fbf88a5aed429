"""What real sensors do and the paper's model does not have: biases, outliers, drop-outs, a lever arm of the antenna.

    gyro ω + b + η     accel a + b + η     range |p + R r − p_anchor| + b + e + η, or no range at all
Every effect is off by default, and the observer knows nothing of any effect.

An effect is one field of `Effects` with its row (an `Effect`), and one line in `measuring` where it acts. Limits, page,
preset files, the sentences beside the verdict and the tests follow from the row.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Annotated

from rangenav import fields
from rangenav.fields import NumberField
from rangenav.inputs import Input, Vec3

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


@dataclass(frozen=True, eq=False, kw_only=True)
class Effect(NumberField):
    """What the program has to know of one field of `Effects`."""

    name: str = ""
    """What sentences call the effect; empty for a field that only shapes another one."""
    text: Callable[["Effects"], str] | None = None
    """What the effect does and what the observer makes of it, a clause; empty if the effect is off all the same."""
    shapes: str = ""
    """The field whose effect this field shapes: while that field is zero, this one does nothing."""
    body_vector: bool = False
    """Whether it is a vector in body axes, which turns where the axes are named anew."""
    predicted: bool = False
    """Whether the predicted accuracy takes account of it."""


class Effects(Input, frozen=True, kw_only=True):
    """Effects of real sensors that are not in the paper; each constant over a flight, none by default."""

    gyro_bias: Annotated[
        Vec3,
        Effect(
            label="gyro bias",
            unit="rad/s",
            limits=(0.0, MAX_GYRO_BIAS),
            step=0.001,
            hint="A constant error of the gyro, in body axes; the observer has no state for it (not in the paper).",
            name="gyro bias",
            text=lambda e: f"{_vector(e.gyro_bias)} rad/s; {UNKNOWN}, so attitude and position keep an error",
            body_vector=True,
        ),
    ] = (0.0, 0.0, 0.0)
    """rad/s, body axes."""
    accel_bias: Annotated[
        Vec3,
        Effect(
            label="accelerometer bias",
            unit="m/s²",
            limits=(0.0, MAX_ACCEL_BIAS),
            step=0.01,
            hint="A constant error of the accelerometer, in body axes; the observer has no state for it (not in the "
            "paper).",
            name="accelerometer bias",
            text=lambda e: f"{_vector(e.accel_bias)} m/s²; {UNKNOWN}, so position and velocity keep an error",
            body_vector=True,
        ),
    ] = (0.0, 0.0, 0.0)
    """m/s², body axes."""
    range_bias: Annotated[
        float,
        Effect(
            label="range bias",
            unit="m",
            limits=(-MAX_RANGE_ERROR, MAX_RANGE_ERROR),
            step=0.01,
            hint="A constant error of every range, of either sign, as antenna delays make it (not in the paper).",
            name="range bias",
            text=lambda e: f"{e.range_bias:g} m; {UNKNOWN}, so position keeps an error of its order or larger",
        ),
    ] = 0.0
    """m, of either sign; antenna delays make one."""
    outlier_probability: Annotated[
        float,
        Effect(
            label="outliers",
            unit="",
            limits=(0.0, 1.0),
            excluded=True,
            step=0.1,
            dial=(0.0, 50.0),
            percent=True,
            hint="The share of ranges that come out too long; the observer has no gate (not in the paper).",
            name="outliers",
            text=lambda e: _outliers(e),
        ),
    ] = 0.0
    """The share of ranges with an excess e; whether one range has it does not depend on the others."""
    outlier_size: Annotated[
        float,
        Effect(
            label="outlier size",
            unit="m",
            limits=(0.0, MAX_RANGE_ERROR),
            step=0.1,
            hint="The mean excess of an outlier, exponential and never negative, as behind an obstacle.",
            shapes="outlier_probability",
        ),
    ] = 1.0
    """m, the mean of e: exponential and never negative, because a blocked or reflected signal can only come late."""
    dropout_probability: Annotated[
        float,
        Effect(
            label="drop-outs",
            unit="",
            limits=(0.0, 1.0),
            excluded=True,
            step=0.1,
            dial=(0.0, 90.0),
            percent=True,
            hint="The share of ranges that do not arrive, each independently; the paper has a range at all times.",
            name="drop-outs",
            text=lambda e: (
                f"{100 * e.dropout_probability:g} of 100 ranges do not arrive; "
                "the paper has one at all times, here the IMU carries the estimate over a gap"
            ),
            predicted=True,
        ),
    ] = 0.0
    """The share of ranges that do not arrive; whether one range is lost does not depend on the others."""
    burst_start: Annotated[
        float,
        Effect(
            label="silent from",
            unit="s",
            limits=(0.0, MAX_BURST),
            step=0.5,
            hint="When a silence begins, in which no range arrives; the next box says how long it lasts.",
            shapes="burst_length",
        ),
    ] = 0.0
    """s: when the burst of losses begins."""
    burst_length: Annotated[
        float,
        Effect(
            label="silent for",
            unit="s",
            limits=(0.0, MAX_BURST),
            step=0.5,
            hint="How long no range arrives; 0 is no silence. The paper has a range at all times.",
            name="burst",
            text=lambda e: (
                f"no range from {e.burst_start:g} s to {e.burst_start + e.burst_length:g} s; "
                "the IMU alone carries the estimate, whose error grows until ranges return"
            ),
        ),
    ] = 0.0
    """s: from burst_start on no range arrives for so long."""
    lever_arm: Annotated[
        Vec3,
        Effect(
            label="lever arm",
            unit="m",
            limits=(0.0, MAX_LEVER_ARM),
            step=0.01,
            hint="From the IMU to the antenna in body axes, r; the range is |p + R r − anchor|. In the paper r = 0.",
            name="lever arm",
            text=lambda e: (
                f"the antenna is {_vector(e.lever_arm)} m from the IMU; the paper has it in the IMU, "
                "so position keeps an error of the arm's order or larger"
            ),
            body_vector=True,
        ),
    ] = (0.0, 0.0, 0.0)
    """m, body axes: from the IMU to the antenna, r."""

    def __post_init__(self) -> None:
        super().__post_init__()
        fields.check(self)

    @property
    def outliers(self) -> bool:
        """Whether some range may come out too long."""
        return self.outlier_probability > 0 and self.outlier_size > 0


@cache
def rows() -> Mapping[str, Effect]:
    """The row of every field, in the order of the fields. Raises TypeError for a field without one."""
    return fields.of_all(Effects, Effect)


MODELLED = Effects()
"""Nothing but what the paper has."""


def sentences(effects: Effects) -> dict[str, str]:
    """What every effect that is on does, and what the observer makes of it: a clause for each, by the effect's name."""
    clauses = {
        row.name: row.text(effects)
        for field, row in rows().items()
        if row.text is not None and _nonzero(getattr(effects, field))
    }
    return {name: clause for name, clause in clauses.items() if clause}


def unpredicted(effects: Effects) -> tuple[str, ...]:
    """The names of those effects that are on and that the predicted accuracy leaves out."""
    predicted = {row.name for row in rows().values() if row.predicted}
    return tuple(name for name in sentences(effects) if name not in predicted)


def _nonzero(value: float | Vec3) -> bool:
    return any(value) if isinstance(value, tuple) else value != 0


def _outliers(effects: Effects) -> str:
    if not effects.outliers:
        return ""
    share, size = 100 * effects.outlier_probability, effects.outlier_size
    outliers = f"{share:g} of 100 ranges are too long, by {size:g} m on average"
    return f"{outliers}; the paper's observer has no gate and believes each one"


def _vector(vector: Vec3) -> str:
    return "({:g}, {:g}, {:g})".format(*vector)
