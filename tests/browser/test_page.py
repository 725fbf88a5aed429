"""The page in a real Chromium, served by the command as a user starts it."""

import math
import time

import numpy as np
import pytest
from playwright.sync_api import Browser

from rangenav import preset, record
from rangenav.signals import Multisine
from tests.browser.page import COARSE, Server, Visitor, quantile, until, until_still

ERROR_CURVE = "σ by P"
"""A curve that only the plots of errors have."""
NOT_SHOWN = "Not shown"


def test_the_url_is_printed_and_the_page_has_a_scene_plots_and_a_verdict(server: Server, visitor: Visitor):
    assert server.url.startswith("http://127.0.0.1:")
    assert {"/vehicle", "/path"} <= set(visitor.node_names())
    assert len(visitor.chart_labels()) >= 4
    time_axis, error, _ = visitor.chart_data(ERROR_CURVE)
    assert len(time_axis) > 100
    assert len({value for value in error if value is not None}) > 100
    visitor.wait_for_text("● observable")


def test_a_gain_slider_moved_by_the_keyboard_changes_the_errors(visitor: Visitor):
    visitor.tab("Gains")
    before = visitor.chart_data(ERROR_CURVE)[1]
    visitor.nudge("range weight q (1/(m⁴ s))", "ArrowLeft", times=5)
    until(lambda: visitor.chart_data(ERROR_CURVE)[1] != before, "another error curve")


def test_another_preset_changes_path_verdict_and_sliders(visitor: Visitor):
    visitor.tab("Presets")
    visitor.choose("preset", "(circle)")
    visitor.wait_for_text("✕ blind")
    visitor.wait_for_text("nothing excites z")
    visitor.tab("Motion")
    path = preset.load("circle").path
    assert isinstance(path, Multisine)
    circle = path.tones[0]
    visitor.wait_for_text(f"{circle.axis}: {circle.amplitude:.3g} m · sin({circle.frequency:.3g} t")


@pytest.mark.parametrize("moment", [3.0, 12.5])
def test_scrubbing_moves_the_vehicle_to_its_true_pose_of_that_moment(visitor: Visitor, moment: float):
    truth = record.run(preset.load("paper-slow")).truth.motion
    expected = truth.position[np.argmin(np.abs(truth.time - moment))]
    visitor.type_number("t (s)", f"{moment:g}")
    until(lambda: math.dist(visitor.node_position("/vehicle"), expected) < 0.01, f"the vehicle at {expected}")


def test_space_plays_and_the_vehicle_moves(visitor: Visitor):
    start = visitor.node_position("/vehicle")
    visitor.page.keyboard.press("Space")
    visitor.wait_for_text("playing")
    until(lambda: math.dist(visitor.node_position("/vehicle"), start) > 0.5, "movement")
    visitor.page.keyboard.press("Space")
    visitor.wait_for_text("paused")
    visitor.page.keyboard.press("Home")
    until(lambda: math.dist(visitor.node_position("/vehicle"), start) < 1e-3, "the start")


def test_an_arrow_key_steps_and_leaves_the_camera_alone(visitor: Visitor):
    camera = until_still(visitor.camera_position)  # the page turns to the path when it first draws
    visitor.page.keyboard.press("ArrowRight", delay=300)
    visitor.wait_for_text("paused")
    until(lambda: visitor.number("t (s)") != "0", "a step")
    assert visitor.camera_position() == pytest.approx(camera, abs=1e-6)


@pytest.mark.parametrize(
    ("text", "rule"), [("99999999999999999999", "seed must lie between"), ("-5", "seed must lie between")]
)
def test_nonsense_in_a_box_gets_a_sentence_and_the_picture_stays(visitor: Visitor, text: str, rule: str):
    before = visitor.chart_data(ERROR_CURVE)
    visitor.tab("Sensors")
    visitor.type_number("noise seed", text)
    visitor.wait_for_text(rule)
    visitor.wait_for_text(NOT_SHOWN)
    assert visitor.chart_data(ERROR_CURVE) == before
    visitor.type_number("noise seed", "7")
    visitor.wait_for_no_text(NOT_SHOWN)
    until(lambda: visitor.chart_data(ERROR_CURVE) != before, "the new seed's errors")


def test_letters_in_a_box_are_no_number_and_change_nothing(visitor: Visitor):
    before = visitor.chart_data(ERROR_CURVE)
    visitor.tab("Sensors")
    visitor.beside("noise seed").locator("input").first.press_sequentially("NaN")
    time.sleep(0.5)
    assert visitor.chart_data(ERROR_CURVE) == before


def test_two_tabs_do_not_disturb_each_other(server: Server, browser: Browser, visitor: Visitor):
    other = Visitor(browser, server.url, density=COARSE)
    until(lambda: len(other.chart_data(ERROR_CURVE)[0]) > 3, "the plots of the other tab")
    before = other.chart_data(ERROR_CURVE)
    visitor.tab("Presets")
    visitor.choose("preset", "(hover)")
    visitor.wait_for_text("✕ blind")
    assert "● observable" in other.text()
    assert other.chart_data(ERROR_CURVE) == before
    other.close()
    visitor.choose("preset", "(paper)")
    visitor.wait_for_text("14.9 times the weight")


def test_a_reload_gives_a_new_session_that_works_on_the_same_preset(visitor: Visitor):
    visitor.tab("Presets")
    visitor.choose("preset", "(lissajous)")
    visitor.wait_for_text("1:2:3")
    visitor.wait_until_saved('"origin":"lissajous"')
    visitor.reload()
    visitor.tab("Gains")
    before = visitor.chart_data(ERROR_CURVE)[1]
    visitor.nudge("range weight q (1/(m⁴ s))", "ArrowLeft", times=5)
    until(lambda: visitor.chart_data(ERROR_CURVE)[1] != before, "another error curve")
    visitor.tab("Presets")
    visitor.wait_for_text("1:2:3")


def test_the_papers_figures_come_with_one_click(visitor: Visitor):
    visitor.tab("Presets")
    visitor.press("The paper's figures 3–5")
    visitor.wait_for_text("14.9 times the weight")
    errors = [labels for labels in visitor.chart_labels() if "error" in labels]
    assert len(errors) == 4


def test_the_download_is_the_preset_with_its_verdict(visitor: Visitor):
    visitor.tab("Presets")
    with visitor.page.expect_download() as coming:
        visitor.press("Download this preset")
    text = coming.value.path().read_text()
    assert coming.value.suggested_filename == "paper-slow.toml"
    assert text.startswith("# verdict: observable; rank 13 of 13")
    assert preset.loads(text, source="download") == preset.load("paper-slow")


def test_a_foreign_page_cannot_open_the_websocket(server: Server, browser: Browser):
    tab = browser.new_page()
    tab.route("http://evil.example/", lambda route: route.fulfill(body="<h1>evil</h1>", content_type="text/html"))
    tab.goto("http://evil.example/")
    outcome = tab.evaluate(
        """url => new Promise(done => {
            const socket = new WebSocket(url, ['viser-v1.1.1']);
            socket.onopen = () => done('open');
            socket.onerror = () => done('refused');
        })""",
        f"ws://127.0.0.1:{server.port}/",
    )
    assert outcome == "refused"
    tab.close()


def test_a_narrow_window_gets_one_column_of_plots_on_a_dense_screen(server: Server, browser: Browser):
    tab = Visitor(browser, server.url, width=1100, height=600, density=2)  # 2200 pixels of the screen
    until(lambda: 0 < len(tab.chart_labels()) <= 4, "one column of plots")
    tab.close()


def test_a_slider_shows_in_the_plots_at_once(visitor: Visitor):
    """The promise is 100 ms in the median; here only that nothing is grossly slower, as machines that test are busy."""
    visitor.tab("Gains")
    times = visitor.slider_to_plot("range weight q (1/(m⁴ s))", ERROR_CURVE, count=12)
    assert quantile(times, 0.5) < 1000
