"""
Observability of my own arrays
==============================

Samples of a motion in numpy arrays become a path. Then the library says what one range can tell of that motion:
the rank on sliding windows, the excitation, and a verdict where the data allow one.
"""

# %%
# A loop that never quite closes, sampled at 100 Hz. Put your own arrays here: seconds, and metres with z up.
import numpy as np

from rangenav import analysis
from rangenav.formats import path_preset, sampled_path
from rangenav.observability import excitation, spectrum

time = np.arange(0.0, 20.0, 0.01)
rate = np.array([1.2, 2.5, 3.3])  # rad/s, of x, y, z
size = np.array([1.5, 1.0, 0.5])  # m


def derivative(order: int) -> np.ndarray:
    """The derivative of this order of the position (n × 3)."""
    middle = np.array([0.0, 0.0, 1.5]) if order == 0 else 0.0
    return middle + size * rate**order * np.sin(np.outer(time, rate) + order * np.pi / 2)


# %%
# From positions alone the path is a smooth curve near the samples. A preset holds it together with the world: here an
# anchor half a metre from the origin. Every function of :mod:`rangenav.observability` takes the path; here 15 windows
# of 6 s.
fit = sampled_path.from_arrays(time, derivative(0), name="my flight")
mine = path_preset.as_preset(fit, anchor=(0.5, 0.0, 0.0))
start = np.linspace(0.0, mine.duration - 6.0, 15)
windows = spectrum.window_spectra(mine.path, mine.world.gravity, start, 6.0)
print(fit.fitted)
print("rank, of 13, on each window:", *windows.rank)

# %%
# But a curve near positions has a snap of its own, so its excitation says nothing about the flight: it is not judged.
print(analysis.analyse(mine).verdict)

# %%
# With the derivatives up to the snap, as a planner knows them, the path is the motion itself.
motion = sampled_path.from_arrays(
    time, derivative(0), velocity=derivative(1), acceleration=derivative(2), jerk=derivative(3), snap=derivative(4)
)
known = path_preset.as_preset(motion, anchor=(0.5, 0.0, 0.0))
for name, path in (("fitted to positions", mine.path), ("all derivatives", known.path)):
    print(f"least excitation, {name}: {excitation.eigenvalues(path, start, 6.0)[:, 0].min():.2f} m²/s⁷")

# %%
# So it is judged. How long must one fly? A window of 6 s has full rank, but half a metre takes nearly 10 s.
print(analysis.how_long(known).words)
for window in (6.0, 10.0):
    found = analysis.analyse(analysis.with_window(known, window, source="my flight"))
    print(f"{window:g} s: {found.verdict}, rank {found.rank}, predicted 1-σ position {found.lifted_end.position:.3g} m")
