"""Single-range-aided inertial navigation: the truth, the sensors, what is observable, and the observers."""

__version__ = "0.2.0"
