"""The cascaded observer (paper, fig. 2): the Riccati observer's gravity estimate feeds the complementary filter.

`observe()` runs a whole record, `step()` takes one IMU sample at a time (on a vehicle, in a loop). Both call the same
compiled kernel and give the same numbers; `reference.observe()` is the same scheme in numpy. Everything that a caller
gives is checked before a kernel reads it: a ValueError says in one sentence what is wrong.
Exponentially stable is not monotone: from x̂ = 0 the position error first peaks.
"""

from rangenav.cascade.many_attitudes import (
    AttitudeInputs,
    attitude_errors,
    attitude_inputs,
    attitude_settling,
    attitudes,
)
from rangenav.cascade.one_sample import begin, checked_sample, checked_start, parameters, start, step
from rangenav.cascade.side_by_side import observe_each
from rangenav.cascade.values import Estimate, ObserverConfig, Sample, Start, State
from rangenav.cascade.whole_record import observe, ranges_at_imu_rate

__all__ = [
    "AttitudeInputs",
    "Estimate",
    "ObserverConfig",
    "Sample",
    "Start",
    "State",
    "attitude_errors",
    "attitude_inputs",
    "attitude_settling",
    "attitudes",
    "begin",
    "checked_sample",
    "checked_start",
    "observe",
    "observe_each",
    "parameters",
    "ranges_at_imu_rate",
    "start",
    "step",
]
