"""Compared runs: drawn in every plot at the times of the picture, described in text, absent without a comparison."""

import dataclasses

import numpy as np
import pytest
from msgspec.structs import replace

from explorer.charts import Charts, comparison_curves, plot_list, plots, side_by_side
from explorer.charts.plot_size import PlotSize
from explorer.model import comparison, consistency, differences
from explorer.model import side_by_side as numbers
from explorer.model.comparison import Baseline, Comparison
from explorer.model.compute import Picture, compute
from explorer.model.settings import Printed, Settings
from explorer.panels.compare import text
from explorer.scene import Scene
from rangenav import comparison as estimators
from rangenav import ensemble, range_fit, record
from rangenav.gains import Gains
from rangenav.provenance import Source, fingerprint
from tests.support.pictures import astronomic, check_drawable, picture
from tests.support.sent_messages import Page

pytestmark = pytest.mark.slow


ALL = [plot for group in plot_list.GROUPS for plot in group.plots]
ERRORS = plot_list.GROUPS[0].plots


def altered(a: Picture, **changes: object) -> Picture:
    return compute(Settings(origin=a.settings.origin, preset=replace(a.preset, **changes)))


@pytest.fixture(scope="module")
def slow() -> Picture:
    return picture("paper-slow")


@pytest.fixture(scope="module")
def crowd(slow: Picture) -> Comparison:
    """A comparison with a pinned run, all other estimators and many seeds."""
    baselines = tuple(Baseline(name, comparison.run_baseline(name, slow)) for name in comparison.NAMES)
    return Comparison(pinned=picture("paper"), baselines=baselines, seeds=ensemble.seeds(slow.preset, 12))


def compared(plot: plots.Plot, example: Picture, shown: Comparison) -> tuple[plots.Plot, plots.Drawing]:
    return comparison_curves.with_comparison(plot, example, shown, comparison_curves.pinned(plot, shown.pinned, None))


def test_with_nothing_beside_a_plot_is_what_it_was(slow: Picture) -> None:
    for plot in ALL:
        same, drawing = compared(plot, slow, comparison.NOTHING)
        assert same is plot
        np.testing.assert_array_equal(drawing.drawn, plot.draw(slow).drawn)


@pytest.mark.parametrize("name", ["paper-slow", "paper", "circle", "hover", "soft"])
def test_every_plot_takes_in_a_run_of_any_other_motion_and_duration(name: str, slow: Picture) -> None:
    other = picture(name)
    for example, a in ((slow, other), (other, slow), (astronomic("hover"), other), (slow, astronomic("hover"))):
        for plot in ALL:
            more, drawing = compared(plot, example, Comparison(pinned=a))
            check_drawable(more, drawing)
            labels = [curve.label for curve in more.curves[len(plot.curves) :]]
            assert len(labels) == len(set(plot.pinned_curves) - set(plot.draw(a).hidden))
            assert all(label.startswith("A") for label in labels)
            own = plot.draw(example)
            assert drawing.axis[0] <= own.axis[0] < own.axis[1] <= drawing.axis[1]
            np.testing.assert_array_equal(drawing.values[:, : len(plot.curves)], own.values)


def test_a_run_pinned_beside_itself_lies_on_its_own_curves(slow: Picture) -> None:
    for plot in ALL:
        _, drawing = compared(plot, slow, Comparison(pinned=slow))
        first = len(plot.curves)
        for k, column in enumerate(column for column in plot.pinned_curves if column not in drawing.hidden):
            np.testing.assert_array_equal(drawing.drawn[:, first + k], drawing.drawn[:, column])


def test_side_by_side_both_runs_have_the_axes_of_each_other_and_their_own_values() -> None:
    blind, free = picture("circle"), picture("paper-slow")
    for plot in ALL:
        for a, b in ((blind, free), (free, blind)):
            first, second = side_by_side.on_same_axes(plot, a, b)
            assert first.axis == second.axis
            np.testing.assert_array_equal(first.time, second.time)
            np.testing.assert_array_equal(second.values, plot.draw(b).values)
            own = plot.draw(a)
            np.testing.assert_array_equal(first.values, comparison_curves.sampled_at(own.time, own.values, second.time))
            for drawing in (first, second):
                inside = np.isfinite(drawing.values) & (drawing.values > 0)
                if plot.log and plot.name in ("position", "excitation"):
                    np.testing.assert_array_equal(drawing.drawn[inside], drawing.values[inside])
                    assert (drawing.drawn[drawing.values == 0] < drawing.axis[0]).all()


def test_numbers_side_by_side_are_those_of_the_pictures(slow: Picture) -> None:
    circle = picture("circle")
    rows = {row.name: row[1:] for row in numbers.rows(slow, circle)}
    assert rows["verdict (as derived)"] == ("observable", "blind")
    assert rows["quantities determined"] == ("13 of 13", "11 of 13")
    assert rows["excitation condition"][0].startswith("✓ holds: derived μ")
    assert rows["excitation condition"][1].startswith("✕ fails: derived μ 0 m²/s⁷ (required: ")
    assert numbers.title(slow, circle) == slow.preset.title
    printed = compute(Settings(preset=slow.preset, printed=Printed(body_axes=True)))
    assert numbers.title(printed, slow).endswith(", as printed")
    assert numbers.title(slow, printed).endswith(", as derived")
    assert "holds: printed μ" in numbers.rows(printed, slow)[0].a


def test_what_a_plot_cannot_show_stays_outside_a_wider_axis() -> None:
    blind, free = picture("circle"), picture("paper-slow")
    for name in ("excitation", "predicted", "gramian"):
        plot = next(plot for plot in ALL if plot.name == name)
        for example, a in ((blind, free), (free, blind)):
            _, drawing = compared(plot, example, Comparison(pinned=a))
            zero, none = drawing.values == 0, drawing.values == np.inf
            assert (drawing.drawn[zero] < drawing.axis[0]).all()
            assert (drawing.drawn[none] > drawing.axis[1]).all()


def test_pinned_curves_are_computed_once(slow: Picture) -> None:
    pinned_drawing = comparison_curves.pinned(ERRORS[0], slow, None)
    assert comparison_curves.pinned(ERRORS[0], slow, pinned_drawing) is pinned_drawing
    assert comparison_curves.pinned(ERRORS[0], dataclasses.replace(slow), pinned_drawing) is not pinned_drawing
    assert comparison_curves.pinned(ERRORS[0], None, pinned_drawing) is None


def test_band_and_estimators_stand_in_the_error_plots_alone(slow: Picture, crowd: Comparison) -> None:
    for plot in ALL:
        more, drawing = compared(plot, slow, crowd)
        check_drawable(more, drawing)
        labels = {curve.label for curve in more.curves}
        assert ({"12 seeds", "EKF", "refined"} <= labels) == (plot in ERRORS)
        assert len(more.bands) == (plot in ERRORS)
        curve_styles = [(curve.dash, curve.width, curve.filled) for curve in more.curves if curve.label]
        assert len(set(curve_styles)) == len(curve_styles)


def test_the_band_is_the_ensembles_and_encloses_its_median(slow: Picture, crowd: Comparison) -> None:
    runs = crowd.seeds
    assert runs is not None
    more, drawing = compared(ERRORS[3], slow, crowd)
    ((upper, lower),) = more.bands
    high, low, median = drawing.values[:, upper], drawing.values[:, lower], drawing.values[:, upper - 1]
    assert (low <= median).all()
    assert (median <= high).all()
    ends = np.searchsorted(slow.motion.time, runs.time)
    np.testing.assert_allclose(median[ends], np.degrees(runs.band("attitude").median))


def test_an_estimator_at_work_has_its_place_but_no_curve(slow: Picture) -> None:
    more, drawing = compared(ERRORS[0], slow, Comparison(baselines=(Baseline("refined", None),)))
    assert more.curves[-1].label == "refined"
    assert np.isnan(drawing.drawn[:, -1]).all()
    assert drawing.axis == ERRORS[0].draw(slow).axis


def test_estimators_are_the_librarys_on_the_same_record(slow: Picture) -> None:
    result = {c.name: c for c in estimators.compare(record.run(slow.preset))}
    names: tuple[tuple[comparison.Name, str], ...] = (("EKF", estimators.EKF), ("refined", estimators.REFINEMENT))
    for name, full in names:
        ours = comparison.run_baseline(name, slow)
        np.testing.assert_array_equal(ours.errors.position, result[full].errors.position)


def test_charts_never_have_more_curves_than_data_and_come_back_to_what_they_were(
    page: Page, slow: Picture, crowd: Comparison
) -> None:
    charts = Charts(page.client, PlotSize(two_panels=True))
    for shown in (comparison.NOTHING, crowd, Comparison(pinned=slow), comparison.NOTHING):
        page.messages.clear()
        charts.draw(slow, shown)
        charts.draw_details(slow)
        assert len(page.updates("data")) >= len(ALL)
        for handle in (chart.handle for chart in charts.charts):
            assert len(handle.data) == len(handle.series)
            assert {len(array) for array in handle.data} == {len(handle.data[0])}
            for band in handle.bands or ():
                assert max(band["series"]) < len(handle.series)
    page.messages.clear()
    charts.draw(slow)
    charts.draw_details(slow)
    assert page.updates("series") == page.updates("bands") == page.updates("axes") == []


def test_a_is_in_the_scene_only_while_it_is_pinned(page: Page, slow: Picture, crowd: Comparison) -> None:
    def visible(*names: str) -> list[bool]:
        return [page.node(name).visible for name in names]

    pinned = crowd.pinned
    assert pinned is not None
    scene = Scene(page.client, lambda: None)
    scene.draw(slow)
    assert not any(visible("/pinned", "/pinned_path", "/pinned_trail", "/ekf_trail", "/refined_trail"))
    scene.draw(slow, crowd)
    scene.move(slow, 10.0)
    assert all(visible("/pinned", "/pinned_path", "/pinned_trail", "/ekf_trail", "/refined_trail"))
    k = int(np.argmin(np.abs(pinned.motion.time - 10.0)))
    assert page.node("/pinned").position == pytest.approx(pinned.position_estimate[k])
    scene.draw(slow, Comparison(pinned=slow))
    assert not any(visible("/pinned_path", "/ekf_trail", "/refined_trail"))  # the same motion needs no second path
    scene.draw(slow)
    assert not any(visible("/pinned", "/pinned_trail"))
    assert np.isfinite(list(page.numbers())).all()


def test_differences_name_the_choice_and_the_figures_that_moved(slow: Picture) -> None:
    assert differences.figures(slow, slow) == differences.choices(slow.preset, slow.preset) == []
    gains = replace(slow.preset.gains, riccati=replace(slow.preset.gains.riccati, q=1.0))
    b = altered(slow, gains=gains, seed=7)
    q = f"Range weight q: {slow.preset.gains.riccati.q:.4g} → 1"
    assert set(differences.choices(slow.preset, b.preset)) == {q, f"Noise seed: {slow.preset.seed} → 7"}
    sentences = differences.figures(slow, b)
    assert not any(
        sentence.startswith(("quantities", "excitation", "best error")) for sentence in sentences
    )  # gains change none of these
    before, after = slow.summary.steady_position, b.summary.steady_position
    (steady,) = (sentence for sentence in sentences if sentence.startswith("steady position error"))
    assert steady.startswith(f"steady position error {before:.3g} → {after:.3g} m (")


def test_differences_of_verdicts_and_of_what_never_comes(slow: Picture) -> None:
    sentences = differences.figures(slow, picture("circle"))
    assert sentences[0] == "observable → blind"
    assert any(sentence.startswith("quantities determined 13 → 11 of 13") for sentence in sentences)
    assert "position settled 7.92 s → not reached" in sentences
    assert differences.choices(slow.preset, picture("circle").preset)


def test_a_fit_has_no_verdict_to_differ_from(slow: Picture) -> None:
    source = Source(
        file="flight.tum",
        sha256=64 * "0",
        format="tum",
        derivatives="fit",
        unjudged="it was sampled",
        path_sha256=fingerprint(slow.preset.path),
    )
    assert differences.figures(altered(slow, source=source), picture("circle"))[0] == "not judged → blind"


@pytest.mark.parametrize("mode", ["constant", "noise-matched"])
def test_agreement_is_what_its_definition_says(mode: str, slow: Picture) -> None:
    example = altered(slow, gains=Gains(mode=mode))  # pyright: ignore[reportArgumentType]
    result, part = consistency.of_run(example), example.motion.time >= 0.75 * example.preset.duration
    truth = record.simulated(record.truth_inputs(example.preset)).state
    error, P = (example.estimate.state - truth)[part, 4:7], example.estimate.covariance[part, 0]
    nees = [e @ np.linalg.inv(p) @ e for e, p in zip(error, P, strict=True)]
    assert result.nees == pytest.approx(np.mean(nees), rel=1e-6)
    value, variance = example.estimate.innovation[example.measurements.range_time >= 0.75 * example.preset.duration].T
    assert result.nis == pytest.approx(np.mean(value**2 / variance))
    assert result.achieved == pytest.approx(np.sqrt(np.mean(np.sum(error**2, axis=1))), rel=0.01)
    if mode == "constant":
        assert result.nees < 1.5  # the shipped gains are far too cautious about the noise that there is


def test_a_blind_run_has_no_predicted_sigma_in_the_table() -> None:
    example = picture("circle")
    result = consistency.of_run(example)
    assert np.isnan(result.lifted)
    assert "not determined" in text.consistency(result, None, 0, matched=False)


def test_what_visitors_type_is_escaped(slow: Picture) -> None:
    named = dataclasses.replace(slow, settings=replace(slow.settings, origin="<img src=x onerror=alert(1)>"))
    html_text = text.differences(named, named, ["<b>"], ["<i>"])
    assert "<img" not in html_text
    assert "<li><b>" not in html_text


def test_seeds_that_never_settle_are_said_so_without_a_unit(slow: Picture, crowd: Comparison) -> None:
    assert crowd.seeds is not None
    never = dataclasses.replace(crowd.seeds, settle_position=np.full(12, np.inf))
    html_text = text.seeds(slow, never, "")
    assert "never – never<" in html_text
    assert "0 of 12 settle" in html_text


def test_every_run_that_is_compared_has_the_fit_of_its_ranges_in_the_text(slow: Picture, crowd: Comparison) -> None:
    assert crowd.seeds is not None
    counts = range_fit.counted(list(crowd.seeds.fit), blind=False)
    assert f"On their ranges: {counts}." in text.seeds(slow, crowd.seeds, "")
    shown = text.baselines(slow, crowd.baselines, [])
    for name, candidate in crowd.baselines:
        assert candidate is not None
        fit = candidate.summary.fit.statement(blind=False, predicted=slow.analysis.lifted_end.position)
        assert (f"<b>{name}</b>, on its ranges: {fit}" in shown) == (name == "EKF")
    own = slow.summary.fit.summary(blind=False)
    assert f"<b>cascade</b>, on its ranges: {own} (constant gains); predicted position ±" in shown
    blind = picture("circle")
    said = blind.summary.fit.summary(blind=True)
    assert f"on its ranges: {own} → {said}" in differences.figures(slow, blind)


def test_a_curve_switched_off_takes_its_bands_edges_along_and_none_that_comes_later(
    page: Page, slow: Picture, crowd: Comparison
) -> None:
    charts = Charts(page.client, PlotSize(two_panels=True))
    charts.draw(slow, Comparison(seeds=crowd.seeds))
    chart = charts.charts[0]
    chart.toggle(2)  # the median
    assert [line.get("show", True) for line in chart.handle.series[1:]] == [True, True, False, False, False]
    charts.draw(slow, Comparison(pinned=slow))
    assert [line.get("show", True) for line in chart.handle.series[1:]] == [True, True, True]
