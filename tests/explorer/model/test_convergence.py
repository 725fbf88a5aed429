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
    assert rate.startswith("There is no rate in the long run: P does not become periodic: on this motion some error")


def test_of_two_runs_the_sentences_say_which_settles_sooner_and_which_fades_faster():
    paper, blind = (convergence.convergence(replace(preset.load(name), gains=Gains())) for name in ("paper", "circle"))
    weak = replace(preset.load("paper"), gains=Gains(riccati=replace(Gains().riccati, q=50.0)))
    slow = convergence.convergence(weak)
    assert paper is not None
    assert slow is not None
    assert slow.dynamics.settle_s is None or slow.dynamics.settle_s > (paper.dynamics.settle_s or 0.0)
    settles, fades = convergence.which_is_faster(slow, paper)
    assert settles.startswith("Without noise B settles ")
    assert settles.endswith((" sooner.", "the other one does not."))
    assert fades.endswith(" times as fast in B.")
    assert convergence.which_is_faster(paper, slow)[1] == fades.replace("in B.", "in A.")
    assert convergence.which_is_faster(blind, paper) == (
        "Without noise B settles and the other one does not.",
        "In the long run the slowest part of an error fades in B only.",
    )
    assert convergence.which_is_faster(paper, paper) == (
        "Without noise A and B settle at the same time.",
        "In the long run the slowest part of an error fades equally fast in A and B.",
    )
    assert convergence.which_is_faster(None, paper) == ()


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
