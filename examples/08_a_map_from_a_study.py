"""
A map from a study
==================

Where may the anchor stand? A study computes the predicted accuracy over a grid of anchors and writes a zarr store.
Any program that reads zarr can open the store; here xarray does.
"""

# %%
# Load a study that comes with the library, and make it coarse: seven by seven anchors take a second. Its file names the
# preset, the two parameters with their ranges, and the metrics.
import tempfile
from pathlib import Path

import matplotlib
import matplotlib.pyplot as plt
import xarray
from distributed import Client
from matplotlib.colors import LogNorm
from msgspec.structs import replace

from rangenav.studies import plan, running, study

shipped = study.load("anchor-map")
coarse = tuple(replace(parameter, count=7) for parameter in shipped.file.parameters)
chosen = study.of_file(replace(shipped.file, parameters=coarse), shipped.bases)
print("points:", chosen.count, "in", plan.plan(chosen).parts, "parts")

# %%
# Compute it. ``running.run(chosen, path, workers=2)`` starts two processes; this small example has a dask client of one
# thread instead. If the program is stopped, the same call goes on where it stopped.
path = Path(tempfile.mkdtemp(prefix="rangenav-")) / "anchors.zarr"
with Client(processes=False, n_workers=1, threads_per_worker=1, dashboard_address=None) as client:
    state = running.run(chosen, path, client=client)
print("computed:", state.points, "points,", state.invalid, "of them invalid")

# %%
# Open the store. Dimensions, coordinates and units are those of the study, and its file is an attribute.
store = xarray.open_zarr(path).load()
sigma = store.sigma_lifted
best = sigma.where(store.flyable == 1).argmin(...)
place = {name: float(sigma[name][k]) for name, k in best.items()}
print(f"best anchor that the vehicle may fly at: {place}, {float(sigma[best]):.2f} {sigma.units}")

# %%
# Draw the map, with the requirement as a contour.
matplotlib.use("Agg")
required = chosen.bases[0].requirement.position_sigma
axes = sigma.T.plot(norm=LogNorm()).axes
sigma.T.plot.contour(ax=axes, levels=[required], colors="white")
axes.set_title(f"{store.attrs['title']}: at most {required:g} m inside the line")
plt.savefig(path.with_suffix(".png"))
print("drawn:", path.with_suffix(".png").stat().st_size > 10_000)
