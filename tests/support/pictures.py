"""Pictures of shipped presets, as the page computes them, and one whose estimate diverges."""

import dataclasses
from functools import lru_cache

import numpy as np

from explorer.charts.plots import Drawing, Plot
from explorer.model.compute import Picture, compute
from explorer.model.settings import Settings
from rangenav import preset


@lru_cache(maxsize=16)
def picture(name: str) -> Picture:
    """The picture of a shipped preset, as the page shows it when no hand moves."""
    return compute(Settings(preset=preset.load(name))).at_rest


def astronomic(name: str) -> Picture:
    """A picture whose estimate grows to 10¹⁷ m and is NaN at the end, with a covariance to match."""
    usual = picture(name)
    growth = np.geomspace(1.0, 1e17, len(usual.motion.time))
    growth[-100:] = np.nan
    estimate = dataclasses.replace(
        usual.estimate,
        state=usual.estimate.state * growth[:, None],
        covariance=usual.estimate.covariance * growth[:, None, None, None] ** 2,
        rotation=np.where(np.isnan(growth)[:, None, None], np.nan, usual.estimate.rotation),
    )
    errors = dataclasses.replace(usual.errors, position=usual.errors.position * growth)
    positions = usual.position_estimate * growth[:, None]
    return dataclasses.replace(usual, estimate=estimate, errors=errors, position_estimate=positions)


def check_drawable(plot: Plot, drawing: Drawing) -> None:
    """Check that a drawing is finite, or NaN to the end; positive on a log axis; with one column for each curve."""
    low, high = drawing.axis
    assert drawing.drawn.shape == drawing.values.shape == (len(drawing.time), len(plot.curves))
    assert np.isfinite([low, high]).all()
    assert low < high
    ended = np.isnan(drawing.drawn)
    assert np.array_equal(ended, np.maximum.accumulate(ended, axis=0)), f"{plot.name}: a line would bridge the gap"
    shown = drawing.drawn[~ended]
    assert np.isfinite(shown).all()
    if plot.log:
        assert (shown > 0).all()
        assert low > 0
    assert (np.diff(drawing.time) > 0).all()
