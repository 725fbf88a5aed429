"""
Run the observer
================

The observer processes a whole record at once. The inputs are arrays of gyro, accelerometer, magnetometer and ranges.
The outputs are position, velocity, gravity and attitude, and the covariances of the first three.
"""

# %%
# The record of this example is a simulation of a shipped preset, with noise. Put your own arrays in its place. Write
# NaN where the magnetometer gave no sample.
import numpy as np

from rangenav import cascade, errors, preset, record
from rangenav.sensors import Measurements

chosen = preset.load("paper-slow")
simulated = record.run(chosen)
z = simulated.measurements
measurements = Measurements(time=z.time, gyro=z.gyro, accel=z.accel, mag=z.mag, range_time=z.range_time, range=z.range)
print(measurements)

# %%
# The observer needs the world (gravity, magnetic field, anchor), the rates and noise of the sensors, and its gains. The
# start is x̂ = 0 and R̂ = I. ``covariance`` holds three 3 × 3 blocks for each time: position, velocity, gravity.
config = cascade.ObserverConfig(world=chosen.world, sensors=chosen.sensors, gains=chosen.gains)
start = cascade.Start(state=np.zeros(13), rotation=np.eye(3))
estimate = cascade.observe(measurements, start, config)
print(estimate)

# %%
# A simulation knows the truth, so the error of the estimate is known. From x̂ = 0 the position error first grows, and
# then settles.
truth = simulated.truth
wrong = errors.of(estimate, truth=truth.state, rotation=truth.motion.rotation)
for second in (0, 2, 5, 10, 15, 20):
    k = int(np.searchsorted(estimate.time, second))
    sigma = np.linalg.norm(estimate.std[k, 4:7])  # the observer's own 1 σ of the position
    angle = np.degrees(wrong.attitude[k])
    print(f"{second:3d} s: position {wrong.position[k]:5.2f} m off (own σ {sigma:5.2f} m), attitude {angle:4.1f}° off")
