"""The sentences and plots of the error dynamics: what fades, what does not, and what is not linear."""

import numpy as np
import pytest
from msgspec.structs import replace

from explorer.charts import convergence as charts
from explorer.model import convergence
from explorer.model.compute import compute
from explorer.model.settings import Settings
from rangenav import preset, record
from rangenav.gains import Gains


def test_the_settling_time_of_the_gains_stands_beside_the_one_of_the_run():
    p = preset.load("paper")
    run = record.run(p)
    settled, rate = convergence.sentences(convergence.convergence(p), run.summary)
    assert settled.startswith("Without noise the position error stays below 0.3 m from 1.7 s on. In this run it stays")
    assert "each period of 0.785 s multiplies it by 0.87" in rate


def test_a_blind_motion_has_no_rate_and_says_why():
    p = replace(preset.load("circle"), gains=Gains())
    settled, rate = convergence.sentences(convergence.convergence(p), record.run(p).summary)
    assert settled.startswith("Without noise the position error does not settle below 0.3 m.")
    assert rate == "No rate for good: P does not become periodic: on this motion some error does not fade."


@pytest.mark.parametrize("mode", ["constant", "noise-matched"])
def test_each_plot_has_a_column_for_each_curve_whether_the_error_is_linear_or_not(mode: str):
    p = preset.load("paper-slow")
    picture = compute(Settings(origin="paper-slow", preset=replace(p, gains=replace(p.gains, mode=mode))))
    for draw, columns in ((charts.noiseless, 3), (charts.contraction, 3), (charts.closed_loop, 2)):
        drawing = draw(picture)
        assert drawing.values.shape == (len(drawing.time), columns)
        assert np.isfinite(drawing.drawn).all()
        assert bool(drawing.hidden) == (mode == "noise-matched")
    said = charts.describe(picture)
    assert ("not linear" in said[0]) == (mode == "noise-matched")


def test_the_axis_of_the_eigenvalues_fits_the_flight_and_not_its_first_moment():
    """While P is large, an eigenvalue is thousands of times as fast as later: an axis for it would flatten the rest."""
    drawing = charts.closed_loop(compute(Settings(origin="paper-slow", preset=preset.load("paper-slow"))))
    later = np.abs(drawing.values[drawing.time > drawing.time[-1] / 2])
    assert np.abs(drawing.values).max() > 1e3 * later.max()
    assert later.max() <= drawing.axis[1] < 20 * later.max()
