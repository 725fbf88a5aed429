"""The plots: what is drawn is what was computed, and nothing that a plot could not show is sent to it."""

import dataclasses
import re
from typing import Any, cast

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace

from explorer.charts import Charts, comparison_curves, curves, markup, plot_list, plots
from explorer.charts.plot_size import PlotSize
from explorer.charts.plots import Plot
from explorer.model.compute import Picture, compute
from explorer.model.settings import Printed, Settings
from rangenav import preset
from rangenav.number_format import significant
from rangenav.sensors import Effects, Sensors
from rangenav.signals import Multisine, Tone
from rangenav.vehicle import CRAZYFLIE, FREE, HAND_HELD, Vehicle
from tests.support.pictures import astronomic, check_drawable, picture
from tests.support.sent_messages import Page

pytestmark = pytest.mark.slow


ALL = [plot for group in plot_list.GROUPS for plot in group.plots]
MOST_POINTS = 2 * curves.BUCKETS


def printed(name: str, switches: Printed) -> Picture:
    return compute(Settings(preset=preset.load(name), printed=switches))


def named(name: str) -> Plot:
    return next(plot for plot in ALL if plot.name == name)


@pytest.fixture(scope="module")
def slow() -> Picture:
    return picture("paper-slow")


def test_a_plot_says_that_it_is_computed_and_has_no_curve_before_the_first_picture(page: Page) -> None:
    for chart in Charts(page.client, PlotSize()).charts:
        assert all(np.isnan(curve).all() for curve in chart.handle.data[1:])
        assert "computing …" in chart.header.content
    shown = Charts(page.client, PlotSize())
    shown.draw(picture("paper-slow"))
    assert not any("computing …" in chart.header.content for chart in shown.charts if not chart.outdated)


@given(st.integers(2, 3000), st.integers(0, 2**32))
def test_decimation_keeps_both_extremes_of_every_curve(count: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    time, values = np.arange(count) / 200, rng.standard_normal((count, 3))
    x, y = curves.decimate(time, values)
    assert len(x) == len(y) <= MOST_POINTS
    assert (np.diff(x) > 0).all()
    assert y.min(axis=0) == pytest.approx(values.min(axis=0))
    assert y.max(axis=0) == pytest.approx(values.max(axis=0))
    assert set(np.unique(y)) <= set(np.unique(values))


def test_decimation_shows_a_spike_of_one_sample_within_a_pixel() -> None:
    time, values = np.arange(4001) / 200, np.zeros((4001, 1))
    values[1234] = 1.0
    x, y = curves.decimate(time, values)
    assert abs(x[np.argmax(y)] - time[1234]) < 20 / curves.BUCKETS


def test_a_curve_ends_at_its_first_nan() -> None:
    values = np.array([[1.0, 1.0], [np.nan, 2.0], [3.0, 3.0]])
    assert np.array_equal(curves.end_at_first_nan(values), [[1, 1], [np.nan, 2], [np.nan, 3]], equal_nan=True)


@given(st.floats(1e-30, 1e17), st.floats(1.0, 1e12))
def test_log_axis_holds_the_data_in_whole_decades_with_few_true_labels(low: float, ratio: float) -> None:
    axis = curves.decades(np.array([low, low * ratio, np.nan, -1.0, 0.0]))
    assert axis[0] <= low * (1 + 1e-12)
    assert axis[1] >= low * ratio * (1 - 1e-12)
    places, labels = curves.decade_ticks(axis)
    assert 1 <= len(places) == len(labels) <= curves.MAX_LABELS
    assert all(axis[0] * 0.99 <= place <= axis[1] * 1.01 for place in places)
    assert labels == [curves.decade_label(round(np.log10(place))) for place in places]


def test_labels_of_decades_and_numbers() -> None:
    assert [curves.decade_label(k) for k in (-12, -6, -2, 0, 3, 5)] == ["10⁻¹²", "10⁻⁶", "0.01", "1", "1000", "10⁵"]
    assert [significant(v) for v in (0.0, 0.01234, 12.34, 1234.0, 1.234e-7, -7.1e4, np.nan)] == [
        "0", "0.0123", "12.3", "1234", "1.23e-7", "-7.1e4", "–",
    ]  # fmt: skip


@pytest.mark.parametrize("name", [path.stem for path in preset.shipped_files()])
def test_every_plot_of_every_preset_is_drawable(name: str) -> None:
    example = picture(name)
    for plot in ALL:
        check_drawable(plot, plot.draw(example))


@pytest.mark.parametrize("name", ["hover", "paper-slow"])
def test_plots_of_an_astronomic_estimate_are_drawable(name: str) -> None:
    example = astronomic(name)
    for plot in ALL:
        check_drawable(plot, plot.draw(example))
    position = named("position").draw(example)
    assert np.nanmax(position.values[:, 0]) > 1e15  # the legend gives the number as it is
    assert np.isnan(position.drawn[-1]).all()  # and the curve ends where it is none


def test_eigenvalues_below_the_floor_say_so_and_run_along_it() -> None:
    example = picture("circle")
    drawing, windows = plots.gramian(example), example.analysis.windows
    below = windows.gramian <= windows.floor[:, None]
    assert below.any()
    assert (drawing.values[:, :13][below] == -np.inf).all()
    assert drawing.drawn[:, :13][below] == pytest.approx(np.broadcast_to(windows.floor[:, None], below.shape)[below])
    assert drawing.drawn[:, :13][~below] == pytest.approx(windows.gramian[~below])
    assert (drawing.drawn >= windows.floor[:, None]).all()
    assert drawing.axis[0] < windows.floor.min()


def test_an_excitation_of_rounding_noise_is_given_as_zero_and_lies_below_the_axis() -> None:
    drawing = plots.excitation(picture("circle"))
    assert (drawing.values[:, 0] == 0).all()
    assert (drawing.drawn[:, 0] < drawing.axis[0]).all()
    assert (drawing.values[:, 1:3] > 0).all()
    assert drawing.axis[0] < picture("circle").preset.requirement.mu < drawing.axis[1]


def test_a_blind_window_has_no_predicted_sigma() -> None:
    drawing = plots.predicted(picture("circle"))
    assert (drawing.values[:, 0] == np.inf).all()
    assert (drawing.drawn[:, 0] > drawing.axis[1]).all()
    assert np.isfinite(drawing.values[:, 1]).all()


def test_predicted_sigma_stands_next_to_the_error_at_the_same_windows_end() -> None:
    example = picture("paper-slow")
    drawing, windows = plots.predicted(example), example.analysis.windows
    k = len(windows.start) // 2
    at = np.argmin(np.abs(example.motion.time - (windows.start[k] + windows.window)))
    assert drawing.values[k, 2] in example.errors.position[at - 1 : at + 2]


def sensed(**effects: Any) -> Picture:
    """The slow path without range noise, with effects that the paper does not model."""
    p = preset.load("paper-slow")
    silent = msgspec.structs.replace(p.sensors.noise, range=0.0)
    return compute(
        Settings(preset=msgspec.structs.replace(p, sensors=Sensors(noise=silent, unmodelled=Effects(**effects))))
    )


def test_the_true_range_is_the_antennas() -> None:
    read = plots.distance(sensed(lever_arm=(0.3, 0.2, -0.4))).values
    np.testing.assert_array_equal(read[:, 0], read[:, 1])


def test_plots_of_a_flight_without_any_range_are_drawable_and_their_values_are_dashes(page: Page) -> None:
    example = sensed(burst_length=100.0)
    for plot in ALL:
        check_drawable(plot, plot.draw(example))
    charts = Charts(page.client, PlotSize(two_panels=True))
    charts.draw(example)
    page.messages.clear()
    charts.cursor(example, 5.0)
    assert '--distance-0:"–"' in page.live_style()


def test_printed_signal_is_shown_only_when_switched_on() -> None:
    assert plots.snap(picture("hover")).hidden == (4, 5, 6, 7)
    shown = plots.snap(printed("hover", Printed(excitation=True)))
    assert shown.hidden == ()
    assert (shown.values[:, 3] == 0).all()  # a hover has no snap
    assert shown.values[:, 7].max() > 0.1  # and the printed formula says it has
    assert plots.excitation(printed("hover", Printed(body_axes=True))).hidden == ()


def flown_by(name: str, by: Vehicle) -> Picture:
    return compute(Settings(preset=replace(preset.load(name), vehicle=by)))


def test_limits_of_the_vehicle_are_drawn_with_what_the_path_needs_and_are_hidden_where_it_has_none() -> None:
    example = flown_by("paper-slow", CRAZYFLIE)
    speed, effort = plots.speed(example), plots.effort(example)
    assert speed.hidden == effort.hidden == ()
    assert (speed.values[:, 1] == 8.3).all()
    assert effort.values[0, 2:] == pytest.approx([1.95 / 1.35, 10.0])
    assert plots.effort(flown_by("paper-slow", HAND_HELD)).hidden == (2,)
    assert plots.speed(flown_by("paper-slow", FREE)).hidden == (1,)
    assert plots.effort(flown_by("paper-slow", FREE)).hidden == (2, 3)


@given(st.floats(0.05, 1e3), st.floats(0.05, 1e3))
def test_a_limit_that_is_near_is_in_the_plot_and_one_far_away_does_not_flatten_the_curve(
    slow: Picture, speed: float, rate: float
) -> None:
    example = dataclasses.replace(slow, preset=replace(slow.preset, vehicle=Vehicle(name="a", speed=speed)))
    drawing = plots.speed(example)
    greatest = float(drawing.values[:, 0].max())
    assert drawing.axis[1] >= greatest
    assert (drawing.axis[1] >= speed) or speed >= plots.FLATTENING * greatest
    assert greatest >= drawing.axis[1] / (2 * plots.FLATTENING)
    check_drawable(named("speed"), drawing)
    both = Vehicle(name="b", thrust_to_weight=speed, body_rate=rate)
    check_drawable(
        named("effort"), plots.effort(dataclasses.replace(example, preset=replace(example.preset, vehicle=both)))
    )


def test_the_notes_are_read_without_unfolding_and_are_true(slow: Picture) -> None:
    for name in ("snap", "excitation", "gramian"):
        plot = named(name)
        folded = re.sub("<details>.*</details>", "", markup.header(plot, height=100, hidden=()))
        assert plot.definition.note in folded
        assert "Turning the body" in folded
    still = replace(slow.preset, angular_velocity=Multisine(tones=(Tone(axis="x", amplitude=0.5, frequency=1.0),)))
    other, windows = compute(Settings(preset=still)), slow.analysis.windows
    assert other.analysis.windows.excitation == pytest.approx(windows.excitation)
    assert other.analysis.windows.gramian == pytest.approx(windows.gramian, rel=1e-6, abs=windows.floor.max())
    before, after = plots.snap(slow).values, plots.snap(other).values
    assert after[:, 3] == pytest.approx(before[:, 3], rel=1e-9)
    assert not np.allclose(after[:, :3], before[:, :3])
    assert not np.allclose(np.linalg.norm(other.phi_printed, axis=1), np.linalg.norm(slow.phi_printed, axis=1))


def test_draw_sends_few_points_and_every_time_axis_spans_the_duration(page: Page) -> None:
    charts, example = Charts(page.client, PlotSize(two_panels=True)), picture("paper")
    page.messages.clear()
    charts.draw(example)
    assert len(page.updates("data")) == sum(len(group.plots) for group in plot_list.GROUPS if not group.slow)
    charts.draw_details(example)
    data = page.updates("data")
    assert len(data) == len(ALL)
    for arrays in data:
        assert len({len(array) for array in arrays}) == 1
        assert len(arrays[0]) <= MOST_POINTS
        assert arrays[0][0] >= 0
        assert arrays[0][-1] <= example.preset.duration
    assert [scales["x"]["range"] for scales in page.updates("scales")] == [(0.0, example.preset.duration)] * len(ALL)
    assert all(scales["x"]["time"] is False for scales in page.updates("scales"))


class _Reading:
    """A picture, or a part of its settings, that remembers which of its fields are read."""

    def __init__(self, of: object, name: str, read: set[str]) -> None:
        self._of, self._name, self._read = of, name, read

    def __getattr__(self, name: str) -> object:
        path, value = f"{self._name}{name}", getattr(self._of, name)
        if path in ("preset", "settings"):
            return _Reading(value, f"{path}.", self._read)
        self._read.add(path)
        return value


@pytest.mark.parametrize("printed", [Printed(), Printed(excitation=True, body_axes=True)], ids=["derived", "printed"])
def test_a_plot_reads_nothing_of_a_picture_but_the_inputs_that_it_names(printed: Printed) -> None:
    example = compute(Settings(preset=preset.load("hover"), printed=printed))
    for plot in ALL:
        if plot.inputs is not None:
            read: set[str] = set()
            plot.draw(cast(Picture, _Reading(example, "", read)))
            from_motion = {"motion", "phi", "phi_printed"}
            if {"preset.requirement", "settings.printed"} <= read:
                from_motion.add("printed_excitation")  # it is computed from these two and the motion
            assert read - from_motion <= set(plot.inputs), plot.name


def test_a_plot_whose_inputs_stay_is_not_sent_again(page: Page) -> None:
    charts, example = Charts(page.client, PlotSize(two_panels=True)), picture("paper-slow")
    charts.draw(example)
    page.messages.clear()
    charts.draw(dataclasses.replace(example))
    assert page.updates("data") == []


def test_only_data_is_sent_again_so_that_no_chart_is_rebuilt(page: Page) -> None:
    charts, example = Charts(page.client, PlotSize(two_panels=True)), picture("paper-slow")
    charts.draw(example)
    page.messages.clear()
    charts.draw(dataclasses.replace(example, errors=dataclasses.replace(example.errors)))
    assert len(page.updates("data")) == len(plot_list.ERRORS.plots) + 1  # and the predicted σ, beside the actual error
    assert page.updates("scales") == page.updates("axes") == page.updates("series") == []
    assert page.kinds() == {"GuiUpdateMessage"}


def test_cursor_is_one_small_message_and_the_values_there_are_another(page: Page) -> None:
    charts, example = Charts(page.client, PlotSize(two_panels=True)), picture("paper-slow")
    charts.draw(example)
    page.messages.clear()
    charts.cursor(example, 4.0, values=False)
    assert len(page.messages) == 1
    assert len(page.live_style()) < 100
    page.messages.clear()
    charts.cursor(example, 5.0)
    assert len(page.messages) == 2
    text = page.live_style()
    assert len(text) < 2500
    fraction = re.findall(r"--tcur:([\d.]+)", text)
    assert [float(f) for f in fraction] == pytest.approx([5.0 / example.preset.duration])
    k = int(np.argmin(np.abs(example.motion.time - 5.0)))
    shown_error = significant(example.errors.position[k])
    assert f'--position-0:"{shown_error}"' in text
    assert f"error <b>{shown_error} m</b>" in text
    distance = float(np.linalg.norm(example.motion.position[k] - example.preset.world.anchor))
    assert f"{significant(distance)} m from the anchor" in text


def test_a_window_is_read_only_while_it_can_start(page: Page) -> None:
    charts, example = Charts(page.client, PlotSize()), picture("circle")
    charts.draw(example)
    page.messages.clear()
    charts.cursor(example, 1.0)
    assert '--gramian-0:"< floor"' in page.live_style()
    assert '--predicted-0:"blind"' in page.live_style()
    page.messages.clear()
    charts.cursor(example, example.preset.duration)
    assert '--gramian-0:"–"' in page.live_style()
    assert '--position-0:"–"' not in page.live_style()


def test_cursor_variables_of_the_legend_are_those_that_are_assigned() -> None:
    for plot in ALL:
        html = markup.header(plot, height=100, hidden=())
        for i, curve in enumerate(plot.curves):
            assert (f"var({markup.variable(plot, i)}," in html) == bool(curve.label)
        assert plot.definition.equation in html


def test_every_curve_of_a_plot_differs_by_more_than_its_colour() -> None:
    for plot in ALL:
        styles = [(curve.dash, curve.width, curve.filled) for curve in plot.curves if curve.label]
        assert len(set(styles)) == len(styles), plot.name


def test_every_plot_has_a_name_and_a_title_of_its_own_a_unit_and_a_definition() -> None:
    assert len({plot.name for plot in ALL}) == len({plot.title for plot in ALL}) == len(ALL)
    assert len({plot.definition for plot in ALL}) == len({plot.draw for plot in ALL}) == len(ALL)
    for plot in ALL:
        assert re.fullmatch("[a-z]+(-[a-z]+)*", plot.name), "the name is part of files' names and of CSS variables"
        assert plot.unit, plot.name
        assert plot.definition.equation, plot.name
        assert plot.definition.meaning.endswith((".", "?")), plot.name


def test_every_curve_has_a_name_of_its_own_in_its_plots_file() -> None:
    for plot in ALL:
        names = [curve.name or curve.label for curve in plot.curves]
        assert all(names), plot.name
        assert len(set(names)) == len(names), plot.name


def test_every_plot_repeats_only_curves_it_has_for_the_pinned_run() -> None:
    for plot in ALL:
        assert all(plot.curves[column].label for column in plot.pinned_curves), plot.name
        assert len(plot.pinned_curves) <= len(comparison_curves.PINNED_DASHES), plot.name


def test_paper_figures_in_the_narrow_page_keep_one_tab_and_fill_the_new_ones(page: Page) -> None:
    charts, example = Charts(page.client, PlotSize()), picture("paper")
    charts.draw(example)
    page.messages.clear()
    charts.show_paper_figures()
    created = [message for message in page.messages if type(message).__name__ == "GuiUplotMessage"]
    assert len(created) == len(ALL) - len(plot_list.ERRORS.plots)
    assert len(page.updates("data")) == len(created)
