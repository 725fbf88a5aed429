"""
Tune the observer
=================

A search finds gains for a preset. The gains may settle fast, have small steady errors, or balance the two. Then the
gains are judged on records whose noise the search has not seen.
"""

# %%
# The search runs 30 sets of gains on two training records, which takes a second or two. Use more of both for your own
# gains: so small a search may improve one error and worsen another.
import math

from rangenav import preset, tune

chosen = preset.load("paper-slow")
tuned = tune.tune(chosen, runs=2, evaluations=30, steadiness=0.5)

# %%
# The gains before and after the search are compared on two held-out records.
for name, point in (("before", tuned.held_out_before), ("after", tuned.held_out_after)):
    settled = f"position settled after {point.settle_position:.1f} s, attitude after {point.settle_attitude:.1f} s"
    steady = f"steady errors {point.steady_position:.3f} m and {math.degrees(point.steady_attitude):.2f}°"
    print(f"{name:6}: {settled}; {steady}")
print(f"random starts that converge: {tuned.starts_before:.0%} before, {tuned.starts_after:.0%} after")

# %%
# ``tuned.preset`` is the preset with the new gains. ``preset.save(tuned.preset, "tuned.toml")`` writes it to a file.
print(tuned.preset.gains.riccati)
print(tuned.preset.gains.attitude)
