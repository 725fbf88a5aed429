"""
Judge a recorded flight
=======================

In which parts of a flight could one range determine the position, and how large is the error of the observer? The first
answer needs gyro and accelerometer only. The second answer needs magnetometer and ranges as well.
"""

# %%
# The log of this example is a simulation of a shipped preset, written into a temporary folder. The log is a CSV file
# with one column for each quantity, and the unit in the name of the column. Put the path of your own log in its place.
import tempfile
from pathlib import Path

import numpy as np

from rangenav import formats, logs, preset, record_checks

log = Path(tempfile.mkdtemp(prefix="rangenav-")) / "flight.csv"
chosen = preset.load("barrel")
formats.export(chosen, "log", log)

# %%
# The library never guesses a unit. If the file does not state a unit, ``settled`` raises ``ValueError`` with the
# question. Answer the question with ``formats.read(log, "log", confirm={"gyro": "deg/s"})``.
#
# The record is checked as well: each sensor against the others, gravity, the field, and the truth. What contradicts the
# record is one more question; ``unjudged`` says why a record is not judged that was taken against the evidence.
read = formats.settled(record_checks.checked(formats.read(log, "log"), confirm={}))
for finding in read.findings:
    print(finding)
flight = read.flight
if flight is None:
    raise SystemExit("the file holds a path and no recorded flight")

# %%
# Judge the whole record first, then windows of 12 s and of 6 s: this motion needs the longer windows.
whole = logs.whole(flight, range_sigma=0.1, requirement=0.15, noise=None, restriction=read.unjudged)
print(f"{whole.verdict}: {whole.summary}")
for window in (12.0, 6.0):
    judged = logs.informative(
        flight, window=window, range_sigma=0.1, requirement=0.15, noise=None, restriction=read.unjudged
    )
    print(f"{judged.verdict}: {judged.summary}")

# %%
# Run the observer on the same record. If the file has a true position, the error of the observer is known.
sensors = logs.sensors_of(flight, range_sigma=0.1)
observed = logs.observe(flight, chosen.world, sensors=sensors)
print("last position:", np.round(observed.position[-1], 2), "m")
if observed.position_error is not None:
    for quarter, part in enumerate(np.array_split(observed.position_error, 4), start=1):
        print(f"quarter {quarter}: position error {np.sqrt(np.nanmean(part**2)):.2f} m (rms)")
