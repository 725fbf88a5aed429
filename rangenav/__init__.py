"""Single-range-aided inertial navigation: the truth, the sensors, what is observable, and the observers that find it."""

__version__ = "0.1.0"
