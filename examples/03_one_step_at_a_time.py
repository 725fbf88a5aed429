"""
One step at a time
==================

On a vehicle the samples come one by one. ``cascade.step`` takes a state and a sample, and returns the next state. The
states are equal, to the last bit, to the estimates that ``cascade.observe`` computes from the whole record.
"""

# %%
# ``samples`` stands for the driver of your sensors. It yields one IMU sample at a time, with the ranges that came since
# the previous IMU sample.
import time
from collections.abc import Iterator

import numpy as np

from rangenav import cascade, preset, record
from rangenav.cascade import Sample

chosen = preset.load("paper-slow")
z = record.run(chosen).measurements


def samples() -> Iterator[Sample]:
    """The record as it would arrive."""
    before = -np.inf
    for k, now in enumerate(z.time):
        new = (z.range_time > before) & (z.range_time <= now)
        yield Sample(now, z.gyro[k], z.accel[k], z.mag[k], z.range_time[new], z.range[new])
        before = now


# %%
# The loop calls ``step`` once for each sample. ``step`` does not change the state that it receives, so you can keep an
# old state, compare it, or step it again. ``state[4:7]`` is the position relative to the anchor, in body axes.
config = cascade.ObserverConfig(world=chosen.world, sensors=chosen.sensors, gains=chosen.gains)
start = cascade.Start(state=np.zeros(13), rotation=np.eye(3))
arriving = samples()
state = cascade.begin(next(arriving), start, config)
seconds = 0.0
for sample in arriving:
    began = time.perf_counter()
    state = cascade.step(state, sample)
    seconds += time.perf_counter() - began
    if round(state.time * 200) % 800 == 0:
        to_anchor = np.round(-state.state[4:7], 2)  # from the vehicle to the anchor, body axes
        print(f"{state.time:4.0f} s: the anchor is at {to_anchor} m, σ {np.linalg.norm(state.std[4:7]):.2f} m")
print(f"{1e6 * seconds / len(z.time):.0f} µs per step, checks included")

# %%
# An invalid sample raises ``ValueError`` with one sentence. The state stays usable.
try:
    cascade.step(state, Sample(state.time + 0.005, [0.0, 0.0], z.accel[-1], z.mag[-1], [], []))
except ValueError as error:
    print("refused:", error)

# %%
# Compare the last state with the estimate from the whole record.
whole = cascade.observe(z, start, config)
print("equal to observe():", np.array_equal(state.state, whole.state[-1]))
