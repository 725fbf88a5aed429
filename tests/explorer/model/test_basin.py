"""The basin of attraction: its colours and its globe against independent computations, and its section on the page."""

import math
import re
import time

import matplotlib
import numpy as np
import pytest
import viser
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from explorer.model import basin, palette
from explorer.model.comparison import Comparison
from explorer.panels.gains import basin as panel
from explorer.scene import Scene, view
from explorer.scene.basin import CORE, SIZE, TITLE, globe_centre
from explorer.scene.bounds import scene_bounds
from explorer.scene.view import view_direction
from rangenav import ensemble, preset
from rangenav.ensemble import Basin
from rangenav.progress import CancelledError
from tests.support.pictures import picture
from tests.support.sent_messages import Page
from tests.support.waiting_visitor import Editing

pytestmark = pytest.mark.slow


def basin_of(settle: list[float], *, angle: float = 3.0, final: list[float] | None = None) -> Basin:
    count = len(settle)
    return Basin(
        angle=angle,
        axis=ensemble.sphere(count),
        settle=np.array(settle),
        final=np.array(final if final is not None else [0.01] * count),
        time=np.linspace(0.0, 20.0, 5),
        attitude=np.zeros((count, 5)),
    )


seconds = st.floats(0.0, 1e3)


@given(st.lists(seconds | st.just(math.inf), min_size=1, max_size=60))
def test_colours_are_those_of_viridis_at_the_share_of_each_settling_time(settle: list[float]):
    """matplotlib's own table is the witness."""
    result, scale = basin_of(settle), matplotlib.colormaps["viridis"]
    colors = basin.colors(result).astype(float)
    finite = [value for value in settle if math.isfinite(value)]
    for value, color in zip(settle, colors, strict=True):
        if not math.isfinite(value):
            assert tuple(color) == palette.rgb(palette.NEVER_SETTLES)
            continue
        span = max(finite) - min(finite)
        share = (value - min(finite)) / span if span > 0 else 0.0
        assert np.abs(color - 255 * np.array(scale(1.0 - share))[:3]).max() < 20


def test_the_scale_darkens_evenly_and_the_sign_of_never_is_far_from_all_of_it():
    """Relative luminance by the sRGB standard: whoever sees no colours still sees the order."""
    colors = basin.on_scale(np.linspace(0.0, 1.0, 200)).astype(float)
    linear = np.where(colors <= 0.04045 * 255, colors / 255 / 12.92, ((colors / 255 + 0.055) / 1.055) ** 2.4)
    lightness = 116 * np.cbrt(linear @ [0.2126, 0.7152, 0.0722]) - 16
    steps = -np.diff(lightness)
    assert (np.diff(lightness[::10]) < 0).all()
    assert steps.mean() == pytest.approx((lightness[0] - lightness[-1]) / 199)
    assert lightness[0] - lightness[-1] > 70
    assert np.linalg.norm(colors - np.array(palette.rgb(palette.NEVER_SETTLES)), axis=1).min() > 80


def test_the_slowest_start_never_settles_if_there_is_one_such_and_then_ends_farthest_away():
    assert basin.slowest(basin_of([1.0, 7.0, 3.0])) == 1
    assert basin.slowest(basin_of([1.0, math.inf, 9.0, math.inf], final=[0.0, 0.2, 3.0, 0.1])) == 1


def test_equilibria_are_the_axes_whose_half_turns_the_filter_leaves_alone():
    """At R̃ = 2uuᵀ − I the correction ρ1 m × R̃ᵀm + ρ2 g × R̃ᵀg vanishes (paper, theorem); at other half turns not."""
    shown = picture("paper")
    gains, world = shown.preset.gains.attitude, shown.preset.world
    m, g = np.array(world.magnetic), np.array(world.gravity)

    def correction(axis: np.ndarray) -> float:
        turned = Rotation.from_rotvec(np.pi * axis).inv()
        sigma = gains.rho1 * np.cross(m, turned.apply(m)) + gains.rho2 * np.cross(g, turned.apply(g))
        return float(np.linalg.norm(sigma))

    for axis in basin.equilibria(shown):
        assert correction(axis) < 1e-9
    assert correction(np.array([1.0, 1.0, 1.0]) / math.sqrt(3)) > 0.1


# The globe


def globe(page: Page, result: Basin | None, name: str = "soft") -> Scene:
    scene = Scene(page.client, lambda: None)
    scene.draw(picture(name), Comparison(basin=result))
    return scene


def cloud(page: Page, name: str) -> viser.PointCloudHandle:
    handle = page.node(name)
    assert isinstance(handle, viser.PointCloudHandle)
    return handle


def test_each_start_is_a_dot_along_its_axis_and_what_never_settles_is_larger_and_of_another_shape(page: Page):
    result = basin_of([1.0, math.inf, 4.0, 2.0])
    globe(page, result)
    settling, never = cloud(page, "/basin/settling"), cloud(page, "/basin/never")
    for handle, chosen in ((settling, [0, 2, 3]), (never, [1])):
        directions = handle.points / np.linalg.norm(handle.points, axis=1, keepdims=True)
        assert directions == pytest.approx(result.axis[chosen], abs=1e-6)
        assert (handle.colors == basin.colors(result)[chosen]).all()
    assert never.point_size > 1.5 * settling.point_size
    assert never.point_shape != settling.point_shape
    core = page.node("/basin/core")
    assert isinstance(core, viser.IcosphereHandle)
    assert float(np.linalg.norm(settling.points, axis=1).min()) > CORE * float(np.max(core.scale))


@pytest.mark.parametrize("name", list(preset.shipped()))
def test_the_globe_hides_nothing_of_a_path_and_is_in_view_as_the_camera_is_first_set(name: str):
    """Measured along the direction of the camera, as the globe appears on the page."""
    shown = picture(name)
    bounds, anchor = scene_bounds(shown), np.array(shown.preset.world.anchor)
    centre, towards = globe_centre(shown.motion.position, anchor, bounds), view_direction(bounds.up)
    offset = np.vstack([shown.motion.position, anchor]) - centre
    across = offset - np.outer(offset @ towards, towards)
    assert np.linalg.norm(across, axis=1).min() > 1.2 * SIZE * bounds.view_radius
    assert (
        np.linalg.norm(centre - bounds.view_centre) + TITLE * SIZE * bounds.view_radius
        < view.MARGIN * bounds.view_radius
    )


def test_it_is_hidden_before_and_after_and_nodes_are_made_once(page: Page):
    scene = globe(page, None)
    assert not page.node("/basin").visible
    before = len(page.messages)
    for result in (basin_of([1.0, 2.0]), basin_of([3.0] * 50), basin_of([math.inf] * 3)):
        scene.draw(picture("soft"), Comparison(basin=result))
        assert page.node("/basin").visible
    scene.draw(picture("soft"))
    assert not page.node("/basin").visible
    assert [message for message in page.messages[before:] if hasattr(message, "props")] == []
    assert np.isfinite(np.array(list(page.numbers()))).all()


def test_equilibria_are_named_at_both_ends(page: Page):
    globe(page, basin_of([1.0, 2.0]))
    names = [page.node(f"/basin/u{k}") for k in range(6)]
    assert all(isinstance(label, viser.LabelHandle) for label in names)
    assert {label.text for label in names} == {f"{sign}u{digit}" for sign in "+−" for digit in "₁₂₃"}  # type: ignore[attr-defined]
    for plus, minus in zip(names[::2], names[1::2], strict=True):
        assert plus.position == pytest.approx(-np.array(minus.position))


# The section


ANGLE = "attitude error of all starts (°)"


def compute(editing: Editing, axes: float = 40, angle: float = 179.0) -> Basin:
    """Compute a basin, and wait until it is shown."""
    editing.set("number of axes", axes)
    editing.set(ANGLE, angle)
    editing.press(panel.COMPUTE_LABEL)
    editing.tab.wait_for(lambda: editing.tab.nodes["/basin"]["visible"], "the globe")
    editing.settle()
    result = editing.session.dock.basin.computed
    assert result is not None
    return result[1]


def test_a_sphere_of_starts_is_shown_described_hidden_and_shown_again(editing: Editing):
    assert not editing.tab.nodes["/basin"]["visible"]
    result = compute(editing)
    page_text = re.sub(r"<[^>]+>", "", editing.tab.text())
    assert f"{np.isfinite(result.settle).sum()} of 40 starts at 179° settle" in page_text
    assert f"Median {np.median(result.settle):.3g} s" in page_text
    assert f"{result.settle.min():.3g} s{result.settle.max():.3g} s" in page_text  # both ends of the scale
    editing.press(panel.HIDE_LABEL)
    editing.tab.wait_for(lambda: not editing.tab.nodes["/basin"]["visible"], "no globe")
    editing.press(panel.SHOW_LABEL)
    editing.tab.wait_for(lambda: editing.tab.nodes["/basin"]["visible"], "the globe")


def test_the_run_started_from_the_slowest_settles_when_its_dot_said_and_ctrl_z_takes_it_back(editing: Editing):
    result, before = compute(editing), editing.settings
    last = int(np.argmax(result.settle))
    editing.press("Start from the slowest")
    assert editing.settings.preset.guess.attitude_axis == pytest.approx(result.axis[last])
    assert math.degrees(editing.settings.preset.guess.attitude_angle) == pytest.approx(179.0)
    shown = editing.session.picture
    assert shown is not None
    assert shown.summary.settle_attitude_s == pytest.approx(result.settle[last], abs=0.006)  # one sample
    assert editing.tab.nodes["/basin"]["visible"]  # it belongs to these settings, whatever they start with
    editing.command("Undo")
    assert editing.settings == before


@pytest.mark.parametrize(
    ("label", "value"),
    [
        ("attitude gain k1 (1/s)", 0.3),
        ("speed (slower ⟷ faster)", 0.2),
        ("ranges per second (Hz)", 20.0),
        ("noise seed", 3.0),
    ],
)
def test_when_gains_path_or_sensors_change_it_is_removed_with_a_sentence(editing: Editing, label: str, value: float):
    compute(editing)
    editing.set(label, value)
    editing.tab.wait_for_text("The settings have changed: the globe belonged to others")
    editing.tab.wait_for(lambda: not editing.tab.nodes["/basin"]["visible"], "no globe")
    before = editing.settings
    editing.press("Start from the slowest")  # what no honest page could send
    assert editing.settings == before


def test_moving_the_window_keeps_it(editing: Editing):
    compute(editing)
    editing.set("time window judged δ (s)", 5.0)
    assert editing.tab.nodes["/basin"]["visible"]


def test_it_can_be_stopped_and_is_stopped_when_the_settings_change(editing: Editing, monkeypatch: pytest.MonkeyPatch):
    stops: list[bool] = []

    def endless(*_: object, progress, cancelled, **__: object):
        while not cancelled():
            progress(0.25)
            time.sleep(0.01)
        stops.append(True)
        raise CancelledError

    monkeypatch.setattr("rangenav.ensemble.basin", endless)
    editing.press(panel.COMPUTE_LABEL)
    editing.tab.wait_for_text("300 starts at 179°, 25 %")
    editing.tab.press("Stop")
    editing.tab.wait_for(lambda: len(stops) == 1 and editing.session.jobs.running is None, "the job to end")
    editing.press(panel.COMPUTE_LABEL)
    editing.tab.wait_for_text("300 starts at 179°, 25 %")
    editing.set("attitude gain k1 (1/s)", 0.3)
    editing.tab.wait_for(lambda: len(stops) == 2, "the job to end")
    editing.tab.wait_for_text("The settings changed while the starts ran")
    assert not editing.tab.nodes["/basin"]["visible"]


@pytest.mark.parametrize(
    ("label", "value", "sentence"),
    [
        ("number of axes", 0, "number of axes must be a whole number between 1 and"),
        ("number of axes", 2.5, "number of axes must be a whole number between 1 and"),
        ("number of axes", math.nan, "number of axes: “nan” is not a number"),
        ("number of axes", 1e300, "number of axes must be a whole number between 1 and"),
        (ANGLE, 200.0, f"{ANGLE} must lie"),
        (ANGLE, math.nan, f"{ANGLE} must be a finite"),
    ],
)
def test_nonsense_gets_a_sentence(editing: Editing, label: str, value: float, sentence: str):
    editing.set(label, value)
    editing.press(panel.COMPUTE_LABEL)
    editing.tab.wait_for_text(sentence)
    editing.tab.wait_for(lambda: editing.session.jobs.running is None, "no job")


def test_settings_that_cannot_be_shown_are_refused_in_the_section_of_the_starts(editing: Editing):
    editing.tab.set("flight duration (s)", 5.0)
    editing.tab.wait_for_text("Not shown")
    editing.tab.press(panel.COMPUTE_LABEL)
    sentence = "time window judged δ must be shorter than the duration"
    editing.tab.wait_for(lambda: editing.tab.text().lower().count(sentence) > 2, "the sentence in the section")
    assert editing.session.jobs.running is None


def test_the_text_names_the_starts_that_never_settle_with_their_sign():
    page_text = panel.basin_text(
        picture("soft"), basin_of([1.0, math.inf, math.inf, 2.0, math.inf], final=[0, 1.0, 2.0, 0, 0.5])
    )
    assert "<b>2 of 5</b>" in page_text
    assert "Half of them or more never do" in page_text
    assert f"<b>{math.degrees(2.0):.3g}°</b>" in page_text
    assert "◆</b> not settled in 20 s" in page_text


def test_a_half_turn_is_allowed_to_the_last_digit(editing: Editing):
    assert compute(editing, angle=180.0).angle == pytest.approx(math.pi, abs=1e-12)
