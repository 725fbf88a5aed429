"""The details of a picture, their plots and their scene nodes: they show the results of the library."""

import html
import threading
from types import SimpleNamespace

import numpy as np
import pytest
import viser
from msgspec.structs import replace
from viser.transforms import SO3

from explorer.charts import Charts, markup, plot_list
from explorer.charts import details as drawings
from explorer.charts.cursor_values import window_at
from explorer.charts.plot_size import PlotSize
from explorer.charts.plot_tabs import OUTDATED
from explorer.model import details
from explorer.model.compute import compute
from explorer.model.settings import Settings
from explorer.panels.world.twin import TwinPanel
from explorer.scene.bounds import scene_bounds
from explorer.scene.excitation import LONGEST, THINNEST, ExcitationEllipsoid, weakest_label
from explorer.scene.labels import Labels
from explorer.scene.twin import TwinGhost
from explorer.widgets.complaint import InvalidInputError
from explorer.widgets.form import Form
from rangenav import preset, twin
from rangenav.analysis import sampled
from rangenav.inputs import Vec3
from rangenav.signals import Multisine, Tone
from rangenav.twin import Twin
from tests.support import own_loop
from tests.support.pictures import picture
from tests.support.refreshed import refreshed
from tests.support.sent_messages import Page

pytestmark = pytest.mark.slow


SLOW = preset.load("paper-slow")


def test_a_gain_leaves_the_depth_alone_and_the_path_does_not() -> None:
    before = details.details(SLOW)
    tuned = details.details(replace(SLOW, gains=replace(SLOW.gains, mode="noise-matched"), seed=7))
    moved = details.details(replace(SLOW, path=preset.load("soft").path))
    for part in ("spectrum", "horizon", "functions", "twin", "printed"):
        assert getattr(tuned, part) is getattr(before, part), part
        assert getattr(moved, part) is not getattr(before, part), part


def test_depth_is_about_the_analysis_own_windows() -> None:
    example = picture("circle")
    computed = details.details(example.preset)
    np.testing.assert_array_equal(computed.spectrum.eigenvalues, example.analysis.windows.gramian)
    assert computed.functions.start == example.analysis.gramian_at
    assert computed.functions.rank == example.analysis.rank
    assert len(computed.printed.least_printed) == len(example.analysis.windows.start)
    assert computed.printed.mu == 0.0


def test_a_turn_moves_the_twin_of_a_hover() -> None:
    p = preset.load("hover")
    usual, turned = details.details(p).twin, details.details(p, turn=(0.0, 0.0, 0.3)).twin
    assert isinstance(usual, Twin)
    assert isinstance(turned, Twin)
    assert turned.turn == (0.0, 0.0, 0.3) != usual.turn


@pytest.mark.parametrize(("time", "start"), [(-1.0, 0.0), (3.0, 3.0), (14.0, 14.0), (20.0, 14.0)])
def test_the_excitation_at_a_time_is_that_of_the_window_starting_there(time: float, start: float) -> None:
    computed = details.excitation_at(SLOW, time)
    assert computed.window == SLOW.requirement.window
    assert computed.start == pytest.approx(start, abs=0.5 * 14.0 / 100)


def test_the_frozen_time_ranks_are_given_once_python_control_is_imported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(details, "LOADED", threading.Event())
    assert details.frozen_summary(SLOW) == ""
    assert len(drawings.describe_depth(picture("paper-slow"))) == 2
    details.import_control()
    assert "rank 11 of 13 in body axes, 5 in turned axes" in details.frozen_summary(SLOW)
    assert len(drawings.describe_depth(picture("paper-slow"))) == 3
    assert len(drawings.describe_depth(picture("circle"))) == 4


# Plots


def test_the_scaled_spectrum_draws_nothing_below_its_tolerance_as_if_it_were_data() -> None:
    example = picture("circle")
    drawing, computed = drawings.scaled(example), details.details(example.preset).spectrum
    lost = computed.scaled[:, ::-1] <= computed.tolerance[:, None]
    assert lost.sum() == (13 - computed.rank).sum()
    assert (drawing.values[:, :13][lost] == -np.inf).all()
    assert (drawing.drawn >= computed.tolerance[:, None] * (1 - 1e-12)).all()
    assert drawing.axis[0] < computed.tolerance.min()
    assert (np.diff(np.where(np.isinf(drawing.values[:, :13]), 0.0, drawing.values[:, :13]), axis=1) >= 0).all()


def test_the_functions_are_drawn_over_their_peaks_and_read_as_they_are() -> None:
    example = picture("hover")
    drawing, computed = drawings.functions(example), details.details(example.preset).functions
    np.testing.assert_array_equal(drawing.values, computed.values)
    peaks = np.abs(drawing.drawn).max(axis=0)
    present = np.abs(computed.values).max(axis=0) > 0
    assert present.sum() == 7  # 1, τ, τ², τ³ and the three of D_z
    np.testing.assert_allclose(peaks[present], 1.0)
    np.testing.assert_array_equal(peaks[~present], 0.0)


def test_rank_and_sigma_by_length_stand_at_their_length_on_the_time_axis() -> None:
    example = picture("paper-slow")
    computed, rank, sigma = (
        details.details(example.preset).horizon,
        drawings.rank_by_length(example),
        drawings.sigma_by_length(example),
    )
    np.testing.assert_array_equal(rank.time, computed.length)
    np.testing.assert_array_equal(rank.values[:, :2], computed.rank)
    assert (rank.values[:, 2] == 13).all()
    assert sigma.values[0, 1] == np.inf  # blind, and drawn above the axis
    assert sigma.drawn[0, 1] > sigma.axis[1]
    assert sigma.values[-1, 0] == pytest.approx(computed.sigma[-1, 0])


@pytest.mark.parametrize("name", ["hover", "circle", "wiggle"])
def test_both_ranges_are_drawn_and_agree_while_the_twin_is_far_off(name: str) -> None:
    example = picture(name)
    ranges, apart = drawings.ranges(example), drawings.apart(example)
    assert ranges.hidden == apart.hidden == ()
    assert np.abs(ranges.values[:, 0] - ranges.values[:, 1]).max() <= twin.TOLERANCE
    assert apart.values[:, 1].max() <= twin.TOLERANCE
    assert np.sqrt(np.mean(apart.values[:, 0] ** 2)) > 0.99
    true = np.linalg.norm(example.motion.position - np.asarray(example.preset.world.anchor), axis=1)
    np.testing.assert_allclose(np.interp(example.motion.time, ranges.time, ranges.values[:, 0]), true, atol=1e-3)


def test_a_refused_twin_is_not_drawn_and_its_reason_is_given() -> None:
    example = picture("paper-slow")
    assert drawings.ranges(example).hidden == (1,)
    assert drawings.apart(example).hidden == (0, 1)
    sentence, _ = drawings.describe_twin(example)
    assert sentence.startswith("No twin: to first order, every offset and constant velocity")


def test_the_printed_certificate_stands_next_to_the_derived_one_whatever_is_switched_on() -> None:
    example = picture("circle")
    drawing, mu = drawings.certificates(example), example.preset.requirement.mu
    assert (drawing.values[:, 0] == 0).all()
    assert (drawing.drawn[:, 0] < drawing.axis[0]).all()
    assert (drawing.values[:, 3] > mu).all()
    assert drawing.axis[0] < mu < drawing.axis[1]
    assert drawings.describe_twin(example)[1].startswith("False certificate: ")
    both = drawings.phi(example)
    np.testing.assert_allclose(both.values[:, 0], np.linalg.norm(example.motion.snap, axis=1), rtol=1e-9)
    assert np.abs(both.values[:, 1] - both.values[:, 0]).max() > 0.1


@pytest.mark.parametrize("two_panels", [False, True])
def test_sentences_stand_above_their_plots_once_nothing_moves(page: Page, two_panels: bool) -> None:
    charts, example = Charts(page.client, PlotSize(two_panels=two_panels)), picture("circle")
    charts.draw(example)
    wanted = markup.paragraphs(drawings.describe_twin(example))
    assert html.escape("the mirror image in the plane through the anchor with normal z") in wanted
    assert markup.paragraphs((OUTDATED,)) in page.updates("content")
    assert wanted not in page.updates("content")
    charts.draw_details(example)
    assert wanted in page.updates("content")
    page.messages.clear()
    charts.draw_details(example)
    assert wanted not in page.updates("content")
    charts.draw(picture("hover"))
    charts.draw_details(picture("hover"))
    assert markup.paragraphs(drawings.describe_twin(picture("hover"))) in page.updates("content")


def test_sentences_survive_when_tabs_are_made_anew(page: Page) -> None:
    charts, example = Charts(page.client, PlotSize()), picture("circle")
    charts.draw(example)
    page.messages.clear()
    charts.show_paper_figures()
    assert markup.paragraphs(drawings.describe_depth(example)) in page.updates("content")


def test_the_window_that_is_looked_at_is_a_band_over_every_plot_of_flight_time(page: Page) -> None:
    charts, example = Charts(page.client, PlotSize(two_panels=True)), picture("paper-slow")
    charts.draw(example)
    page.messages.clear()
    charts.cursor(example, 5.0)
    assert f"{markup.WINDOW_FROM}:0.25000;{markup.WINDOW_SPAN}:0.30000;" in page.live_style()
    assert window_at(example, 19.0) == pytest.approx((0.7, 0.3))  # the last window there is
    for group in plot_list.GROUPS:
        for plot in group.plots:
            top = markup.header(plot, height=100, hidden=())
            for edge in (markup.WINDOW_FROM, markup.WINDOW_SPAN):  # a window of the flight, on axes of flight time
                assert (f"var({edge}, 0)" in top) == (plot.x_name in ("t", "window start"))


# Scene


def test_the_twin_flies_where_its_range_is_the_true_one_in_the_true_attitude(page: Page) -> None:
    example = picture("circle")
    ghost, computed = (
        TwinGhost(page.scene, Labels(page.scene, page.client.camera), lambda: None),
        details.details(example.preset).twin,
    )
    ghost.draw(example, computed, scene_bounds(example))
    ghost.move(example, 3.2149)
    k = int(np.argmin(np.abs(example.motion.time - 3.2149)))
    position = np.asarray(page.node("/twin").position)
    anchor = np.asarray(example.preset.world.anchor)
    assert np.linalg.norm(position - anchor) == pytest.approx(np.linalg.norm(example.motion.position[k] - anchor))
    assert np.linalg.norm(position - example.motion.position[k]) == pytest.approx(3.0)
    assert SO3(page.node("/twin").wxyz).as_matrix() == pytest.approx(example.motion.rotation[k])
    assert page.node("/twin").visible
    assert page.node("/twin_path").visible
    ends = page.node("/twin_ranges").points  # type: ignore[attr-defined]
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=-1)
    assert lengths[0] == pytest.approx(lengths[1], rel=1e-6)


def test_without_a_twin_nothing_of_it_is_shown(page: Page) -> None:
    ghost = TwinGhost(page.scene, Labels(page.scene, page.client.camera), lambda: None)
    for name in ("circle", "paper-slow"):
        example = picture(name)
        ghost.draw(example, details.details(example.preset).twin, scene_bounds(example))
        ghost.move(example, 1.0)
    assert [page.node(name).visible for name in ("/twin", "/twin_path", "/twin_ranges")] == [False] * 3


def test_a_twin_off_the_stage_is_not_drawn_and_no_error(page: Page) -> None:
    example = picture("circle")
    p = replace(example.preset, world=replace(example.preset.world, anchor=(0.0, 0.0, 50.0)))
    ghost = TwinGhost(page.scene, Labels(page.scene, page.client.camera), lambda: None)
    ghost.draw(example, twin.twin(p), scene_bounds(example))
    ghost.move(example, 1.0)
    assert not page.node("/twin").visible
    assert not page.node("/twin_path").visible


def drag(ghost: TwinGhost, position: tuple) -> None:
    """A drag event as viser's loop delivers it."""
    own_loop.run(ghost._record_drag(SimpleNamespace(end_position=position)))  # type: ignore[arg-type]


def test_a_drag_is_stored_until_it_is_taken_and_only_if_it_is_a_position(page: Page) -> None:
    notes: list[None] = []
    ghost = TwinGhost(page.scene, Labels(page.scene, page.client.camera), lambda: notes.append(None))
    assert ghost.take_drag() is None
    for hostile in ((float("nan"), 0.0, 0.0), (0.0, float("inf"), 0.0), (1e30, 0.0, 0.0)):
        drag(ghost, hostile)
    assert ghost.take_drag() is None
    assert not notes
    drag(ghost, (1.0, 2.0, 3.0))
    drag(ghost, (3.0, 2.0, 1.0))
    assert ghost.take_drag() == (3.0, 2.0, 1.0)
    assert ghost.take_drag() is None
    assert len(notes) == 2


def test_a_twin_says_whether_it_may_be_dragged(page: Page) -> None:
    ghost, label = TwinGhost(page.scene, Labels(page.scene, page.client.camera), lambda: None), "/twin/label"
    for name, text in (("hover", "evil twin, drag it"), ("circle", "evil twin")):
        example = picture(name)
        ghost.draw(example, details.details(example.preset).twin, scene_bounds(example))
        assert page.node(label).text == text  # type: ignore[attr-defined]


def _nothing() -> None:
    """Do nothing: the `wake` of a section without a session."""


@pytest.fixture
def panel(page: Page) -> TwinPanel:
    return TwinPanel(Form(page.gui, _nothing))


def test_the_numbers_of_a_twin_turn_it_as_a_drag_does(panel: TwinPanel) -> None:
    p = preset.load("hover")
    usual = details.details(p).twin
    assert isinstance(usual, Twin)
    panel.draw(usual)
    assert refreshed(panel) is None  # what is shown of the usual twin is no choice of the visitor's
    assert panel.angle.read() == pytest.approx(np.pi / 2)
    panel.axis.show((0.0, 2.0, 0.0))
    panel.angle.show(np.radians(50.0))
    turn = refreshed(panel)
    assert turn == pytest.approx((0.0, np.radians(50.0), 0.0))
    panel.draw(details.details(p, turn=turn).twin)
    assert refreshed(panel) == turn
    dragged = twin.turn_towards(p, (1.0, 2.0, -0.5), time=0.0)
    panel.write(dragged)
    panel.draw(details.details(p, turn=dragged).twin)
    assert refreshed(panel) == dragged
    assert panel.angle.read() == pytest.approx(np.linalg.norm(dragged))
    panel.use_default()
    assert refreshed(panel) is None


def test_the_angle_of_the_twin_of_going_back_and_forth_counts_about_its_one_axis_and_passes_through_nothing(
    panel: TwinPanel,
) -> None:
    back_and_forth = Multisine(offset=(0.0, 2.0, -1.0), tones=(Tone(axis="x", amplitude=1.5, frequency=1.0),))
    p = replace(preset.load("line"), path=back_and_forth)
    computed = details.details(p).twin
    assert isinstance(computed, Twin)
    axis = computed.axis
    assert axis is not None
    for angle in (-2.0, 0.0, 1.0):
        panel.draw(computed)
        panel.angle.show(angle)
        turn = refreshed(panel)
        assert turn == pytest.approx(angle * np.array(axis))
        computed = details.details(p, turn=turn).twin
        assert isinstance(computed, Twin)
        panel.draw(computed)
        assert panel.axis.read() == pytest.approx(axis)
        assert panel.angle.read() == pytest.approx(angle)


@pytest.mark.parametrize("axis", [(0.0, 0.0, 0.0), (float("nan"), 0.0, 1.0), (float("inf"), 0.0, 1.0)])
def test_an_axis_that_points_nowhere_is_refused_and_the_turn_stays(panel: TwinPanel, axis: Vec3) -> None:
    computed = details.details(preset.load("hover"), turn=(0.0, 0.0, 0.5)).twin
    panel.write((0.0, 0.0, 0.5))
    panel.draw(computed)
    panel.axis.show(axis)
    with pytest.raises(InvalidInputError):
        refreshed(panel)
    panel.axis.show((0.0, 0.0, 1.0))
    assert refreshed(panel) == pytest.approx((0.0, 0.0, 0.5))


def test_where_nothing_can_be_turned_there_is_nothing_to_turn_it_with(panel: TwinPanel) -> None:
    for name, shown in (("circle", False), ("hover", True), ("lissajous", False)):
        panel.draw(details.details(preset.load(name)).twin)
        assert panel.section.visible == shown
        assert refreshed(panel) is None


def test_the_ellipsoid_has_the_proportions_of_the_excitation_and_its_arrow_the_weakest_axis(page: Page) -> None:
    example = picture("lissajous")
    shown, bounds, computed = (
        ExcitationEllipsoid(page.scene, Labels(page.scene, page.client.camera)),
        scene_bounds(example),
        details.excitation_at(example.preset, 2.0),
    )
    shown.draw(example, computed, bounds)
    handle = page.node("/excitation")
    scale = np.array(handle.scale)  # type: ignore[attr-defined]
    assert scale[2] == pytest.approx(LONGEST * bounds.radius)
    np.testing.assert_allclose(scale / scale[2], computed.semi_axes / computed.semi_axes[2], rtol=1e-9)
    assert SO3(handle.wxyz).as_matrix() == pytest.approx(computed.axes)
    arrow = SO3(page.node("/weakest").wxyz).as_matrix()[:, 0]
    assert abs(arrow @ computed.weakest) == pytest.approx(1.0)
    label = page.scene.get_handle_by_name("/weakest/label")
    assert isinstance(label, viser.LabelHandle)
    assert label.text == weakest_label(computed) == f"weakest: x, μ = {computed.eigenvalues[0]:.3g}"
    assert scene_bounds(example).contains(np.asarray(handle.position))


def test_a_flat_excitation_is_a_disc_and_none_at_all_is_hidden(page: Page) -> None:
    example, resting = picture("circle"), picture("hover")
    shown, bounds = ExcitationEllipsoid(page.scene, Labels(page.scene, page.client.camera)), scene_bounds(example)
    shown.draw(example, details.excitation_at(example.preset, 0.0), bounds)
    scale = np.array(page.node("/excitation").scale)  # type: ignore[attr-defined]
    assert scale[0] == pytest.approx(THINNEST * scale[2])
    assert weakest_label(details.excitation_at(example.preset, 0.0)) == "no snap along z"
    shown.draw(resting, details.excitation_at(resting.preset, 0.0), scene_bounds(resting))
    assert not page.node("/excitation").visible
    assert not page.node("/weakest").visible
    shown.draw(example, details.excitation_at(example.preset, 0.0), bounds)
    assert page.node("/excitation").visible
    shown.hide()
    assert not page.node("/excitation").visible


def test_an_unchanged_ellipsoid_sends_nothing(page: Page) -> None:
    example = picture("lissajous")
    shown, bounds = ExcitationEllipsoid(page.scene, Labels(page.scene, page.client.camera)), scene_bounds(example)
    shown.draw(example, details.excitation_at(example.preset, 2.0), bounds)
    page.messages.clear()
    shown.draw(example, details.excitation_at(example.preset, 2.001), bounds)
    assert page.messages == []


def test_a_picture_at_rest_has_the_windows_of_the_library_and_one_that_moves_has_a_third_of_them():
    moving = compute(Settings(preset=replace(preset.load("lissajous"), duration=19.5)))  # of no other test
    resting, reference = moving.at_rest, sampled(moving.preset)
    assert resting is moving.at_rest is resting.at_rest
    assert 3 * len(moving.analysis.windows.start) <= len(reference.windows.start) + 2
    assert resting.analysis is reference
    assert (moving.analysis.rank, moving.analysis.verdict.word) == (reference.rank, reference.verdict.word)
    assert moving.analysis.mu == pytest.approx(reference.mu, rel=0.05)  # starts 0.1 s apart, of a period of seconds
    assert len(moving.printed_excitation) == len(moving.analysis.windows.start)
    assert len(resting.printed_excitation) == len(reference.windows.start)
    assert (resting.estimate, resting.motion) == (moving.estimate, moving.motion)
