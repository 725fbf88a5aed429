"""A recorded flight: what its windows, and the whole of it, tell of the position, and what the observers make of it.

    informative(flight, window=6.0, …)     the verdict on each window, from the IMU and the stamps of the ranges
    whole(flight, …)                       the verdict on the whole record, and the length of window that suffices
    observe(flight, world, …)              the observers' estimates
A record is checked first, by `record_checks`.
"""

from rangenav.logs.observers import ACCEL_DENSITY, GYRO_DENSITY, K1, Observed, observe, sensors_of
from rangenav.logs.sliding import informative
from rangenav.logs.whole import WholeRecord, whole
from rangenav.logs.windows import FEW, USUAL_NOISE, WORDS, Informative, RecordVerdict, WindowVerdict

__all__ = [
    "ACCEL_DENSITY",
    "FEW",
    "GYRO_DENSITY",
    "K1",
    "USUAL_NOISE",
    "WORDS",
    "Informative",
    "Observed",
    "RecordVerdict",
    "WholeRecord",
    "WindowVerdict",
    "informative",
    "observe",
    "sensors_of",
    "whole",
]
