"""
Run the observer
================

A whole record at once: gyro, accelerometer, magnetometer and ranges in arrays go in, position, velocity, gravity and
attitude with their covariances come out.
"""

# %%
# A record to begin with: a shipped preset is simulated and measured with noise. Put your own arrays in its place; where
# the magnetometer gave no sample, write NaN.
import numpy as np

from rangenav import cascade, errors, preset, record
from rangenav.sensors import Measurements

chosen = preset.load("paper-slow")
simulated = record.run(chosen)
z = simulated.measurements
measurements = Measurements(time=z.time, gyro=z.gyro, accel=z.accel, mag=z.mag, range_time=z.range_time, range=z.range)
print(measurements)

# %%
# The observer knows the world, the rates and noise of the sensors, and its gains. It starts from nothing: x̂ = 0, R̂ = I.
config = cascade.ObserverConfig(world=chosen.world, sensors=chosen.sensors, gains=chosen.gains)
start = cascade.Start(state=np.zeros(13), rotation=np.eye(3))
estimate = cascade.observe(measurements, start, config)
print(estimate)

# %%
# The truth of a simulation says how good that is. From nothing the error first grows, then it settles.
truth = simulated.truth
wrong = errors.of(estimate, truth=truth.state, rotation=truth.motion.rotation)
for second in (0, 2, 5, 10, 15, 20):
    k = int(np.searchsorted(estimate.time, second))
    sigma = np.linalg.norm(estimate.std[k, 4:7])  # the observer's own 1 σ of the position
    angle = np.degrees(wrong.attitude[k])
    print(f"{second:3d} s: position {wrong.position[k]:5.2f} m off (own σ {sigma:5.2f} m), attitude {angle:4.1f}° off")
