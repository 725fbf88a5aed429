"""
Tune the observer
=================

A search finds gains for a preset: soon settled, exact afterwards, or between the two. What they are worth is judged on
records whose noise the search has not seen.
"""

# %%
# Two training records and 30 sets of gains take a second or two; for your own gains use more of both.
import math

from rangenav import preset, tune

chosen = preset.load("paper-slow")
tuned = tune.tune(chosen, runs=2, evaluations=30, steadiness=0.5)

# %%
# On as many records that were held out:
for name, point in (("before", tuned.held_out_before), ("after", tuned.held_out_after)):
    settled = f"position settled after {point.settle_position:.1f} s, attitude after {point.settle_attitude:.1f} s"
    steady = f"steady errors {point.steady_position:.3f} m and {math.degrees(point.steady_attitude):.2f}°"
    print(f"{name:6}: {settled}; {steady}")
print(f"random starts that converge: {tuned.starts_before:.0%} before, {tuned.starts_after:.0%} after")

# %%
# The gains are a value, and the preset with them is a file: ``preset.save(tuned.preset, "tuned.toml")``.
print(tuned.preset.gains.riccati)
print(tuned.preset.gains.attitude)
