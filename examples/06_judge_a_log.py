"""
Judge a recorded flight
=======================

Was a flight informative, and what does the observer make of it? The first answer needs gyro and accelerometer only,
the second magnetometer and ranges as well.
"""

# %%
# A log to begin with, written into a temporary folder from a shipped preset: a CSV file with a column for each quantity
# and its unit. Put the path of your own log in its place.
import tempfile
from pathlib import Path

import numpy as np

from rangenav import formats, logs, preset

log = Path(tempfile.mkdtemp(prefix="rangenav-")) / "flight.csv"
chosen = preset.load("barrel")
formats.export(chosen, "log", log)

# %%
# Units are never guessed: what the file leaves open is a question, and ``settled`` raises until it is answered
# (``formats.read(log, "log", confirm={"gyro": "deg/s"})``).
read = formats.settled(formats.read(log, "log"))
for finding in read.findings:
    print(finding)
flight = read.flight
if flight is None:
    raise SystemExit("the file holds a path and no recorded flight")

# %%
# Windows of 12 s and of 6 s: this motion needs the longer ones.
for window in (12.0, 6.0):
    judged = logs.informative(flight, window=window, range_sigma=0.1, requirement=0.15, noise=None)
    print(f"{judged.verdict}: {judged.words}")

# %%
# The observer on the same record. Where the file has a true position, the error is known.
sensors = logs.sensors_of(flight, range_sigma=0.1)
observed = logs.observe(flight, chosen.world, sensors=sensors)
print("the vehicle is at last at", np.round(observed.position[-1], 2), "m")
if observed.position_error is not None:
    for quarter, part in enumerate(np.array_split(observed.position_error, 4), start=1):
        print(f"quarter {quarter}: position error {np.sqrt(np.nanmean(part**2)):.2f} m (rms)")
