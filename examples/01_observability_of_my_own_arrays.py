"""
Observability of my own arrays
==============================

Samples of a motion in numpy arrays become a path. Then the library computes what one range can determine on this
motion: the rank on sliding windows, the excitation, and a verdict where the data allow one.
"""

# %%
# The example is the sum of three sines, sampled at 100 Hz. Put your own arrays in their place: times in seconds, and
# positions in metres with z up.
import numpy as np

from rangenav import analysis, preset
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
# ``from_arrays`` fits a smooth curve near the positions. A preset combines this path with the world: here the anchor is
# half a metre from the origin. Every function of :mod:`rangenav.observability` accepts the path. Here the spectra of 15
# windows of 6 s are computed.
fit = sampled_path.from_arrays(time, derivative(0), name="my flight")
mine = path_preset.as_preset(fit, anchor=(0.5, 0.0, 0.0))
start = np.linspace(0.0, mine.duration - 6.0, 15)
windows = spectrum.window_spectra(mine.path, mine.world.gravity, start, 6.0)
print(fit.fitted)
print("rank, of 13, on each window:", *windows.rank)

# %%
# The snap of the fitted curve depends on the smoothing, so its excitation says nothing reliable about the flight.
# Therefore ``analyse`` does not judge a fitted path.
print(analysis.analyse(mine).verdict)

# %%
# A planner knows the derivatives up to the snap. With these derivatives the path is the motion itself. The two
# excitations agree here, because the samples of this example have no noise; the samples alone do not show that.
motion = sampled_path.from_arrays(
    time, derivative(0), velocity=derivative(1), acceleration=derivative(2), jerk=derivative(3), snap=derivative(4)
)
known = path_preset.as_preset(motion, anchor=(0.5, 0.0, 0.0))
for name, path in (("fitted to positions", mine.path), ("all derivatives", known.path)):
    print(f"least excitation, {name}: {excitation.eigenvalues(path, start, 6.0)[:, 0].min():.2f} m²/s⁷")

# %%
# The path with all derivatives is judged. A window of 6 s has full rank, but a predicted error of half a metre needs a
# window of nearly 10 s.
print(analysis.how_long(known).summary)
for window in (6.0, 10.0):
    result = analysis.analyse(preset.with_window(known, window, source="my flight"))
    sigma = result.lifted_end.position
    print(f"{window:g} s: {result.verdict}, rank {result.rank}, predicted 1-σ position {sigma:.3g} m")
