"""Mistakes in the controls of a session: each gets a sentence at its cause, and the last picture stays."""

import math
import threading
from collections.abc import Iterator

import pytest

from explorer.server import SessionServer
from tests.support.waiting_visitor import Editing, arrived, drawn, proven
from tests.support.wire import Wire

pytestmark = pytest.mark.slow


NOT_SHOWN = "Not shown"
SPEED = "speed (slower ⟷ faster)"


@pytest.fixture(scope="module")
def visitor(sessions: tuple[int, SessionServer]) -> Iterator[Editing]:
    """One visitor who makes all of the mistakes."""
    page = arrived(sessions)
    page.tab.wait_for_text("13 of 13")
    yield page
    page.tab.close()


@pytest.fixture
def standing(visitor: Editing) -> Iterator[Wire]:
    """The tab of the visitor; what corrects a mistake is taken over before the next one is made."""
    yield visitor.tab
    visitor.settle()


@pytest.mark.parametrize(
    ("label", "value", "sentence"),
    [
        ("amplitude x (m)", math.nan, "amplitude x (m) must be a finite number"),
        ("amplitude x (m)", 1e300, "amplitude must"),
        ("amplitude x (m): number", "1e300", "amplitude must"),
        ("amplitude x (m): number", "a lot", "amplitude x (m): “a lot” is not a number"),
        ("frequency ω (rad/s)", -3.0, "frequency must lie between 1e-6 and 10000 rad/s, got -3"),
        ("frequency ω (rad/s)", 900.0, "faster than the IMU can sample"),
        ("phase φ₀ (rad)", math.inf, "phase φ₀ (rad) must be a finite number"),
        (SPEED, 1e9, f"{SPEED} must be a number"),
        (f"{SPEED}: number", "20", f"{SPEED} must lie between 0.1 and 10, got 20"),
        (f"{SPEED}: number", "0", f"{SPEED} must lie between 0.1 and 10, got 0"),
        ("time window judged δ (s)", 25.0, "time window judged δ must be shorter than the duration"),
        ("time window judged δ (s)", math.nan, "time window judged δ (s) must be a finite number"),
        ("flight duration (s)", "1e9", "flight duration must lie between"),
        ("flight duration (s)", "", "flight duration (s): the box is empty"),
        ("ranges per second (Hz)", 0.0, "ranges per second must lie between"),
        ("IMU rate (Hz)", 1e12, "IMU rate must lie between"),
        ("magnetometer rate (Hz)", 900.0, "magnetometer rate must lie between 1 Hz and IMU rate"),
        ("range noise σ (m): number", "1e9", "range noise σ must be 0, or lie between 1e-9 and 1000"),
        ("gyro noise σ (rad/s)", math.nan, "gyro noise σ (rad/s) must be a finite number"),
        ("gyro noise σ (rad/s): number", "-1", "gyro noise σ must be 0, or lie between"),
        ("sensor set", "gold", "sensor set must be one of: paper, "),
        ("gyro bias (rad/s)", [math.inf, 0.0, 0.0], "gyro bias (rad/s), x: “inf” is not a number"),
        ("accelerometer bias (m/s²)", [1e30, 0.0, 0.0], "accelerometer bias must not be longer than 100 m/s²"),
        ("range bias (m)", 1e9, "range bias must lie between -1000 and 1000 m"),
        ("outliers (%)", 100.0, "outliers (%) must lie between 0 and 99.9, got 100"),
        ("outlier size (m)", -1.0, "outlier size must lie between"),
        ("drop-outs (%)", math.nan, "drop-outs (%) must be a finite number"),
        ("silent from (s)", -1.0, "silent from must lie between 0"),
        ("silent for (s)", math.inf, "silent for (s): “inf” is not a number"),
        ("lever arm (m)", [0.0, 0.0, 1e6], "lever arm must not be longer than 100 m"),
        ("noise seed", -1.0, "noise seed must lie between"),
        ("noise seed", 0.5, "noise seed must be a whole number"),
        ("noise seed", math.nan, "noise seed: “nan” is not a number"),
        ("range weight q (1/(m⁴ s))", 9.0, "range weight q must lie between 0.001 and 100000"),
        ("process noise V(p)", -9.0, "process noise V(p) must lie between"),
        ("initial variance P₀(g)", 9.0, "initial variance P₀(g) must lie between"),
        ("attitude gain k1 (1/s)", -9.0, "attitude gain k1 must lie between"),
        ("trust in gravity ρ2 (s⁴/m²)", 1e6, "trust in gravity ρ2 (s⁴/m²) must be a number"),
        ("kind of gains", "best", "kind of gains must be one of"),
        ("initial estimate x̂(0)", "", "initial estimate x̂(0) must be one of"),
        ("initial attitude error (°)", 900.0, "initial attitude error (°) must lie between -180 and 180, got 900"),
        ("axis of the attitude error", [0.0, 0.0, 0.0], "axis of the attitude error must not be the zero vector"),
        ("axis of the attitude error", [0.0, "", 0.0], "axis of the attitude error, y: the box is empty"),
        ("position offset (m)", [math.nan, 0.0, 0.0], "position offset (m), x: “nan” is not a number"),
        ("position offset (m)", [1e30, 0.0, 0.0], "position offset must not be longer than"),
        ("drift (m/s)", [0.0, 0.0, "1e999"], "drift (m/s), z: “1e999” is larger than any number"),
        ("preset", "nowhere", "preset must be one of"),
    ],
)
def test_nonsense_gets_a_sentence_and_the_last_picture_stays(standing: Wire, label: str, value: object, sentence: str):
    good, before = standing.value(label), proven(standing)
    standing.set(label, value)
    standing.wait_for_text(NOT_SHOWN)
    standing.wait_for_text(sentence.replace("&", "&amp;"))  # the sentence at the control may come a moment later
    assert drawn(standing) == before
    standing.set(label, good)
    standing.wait_for(lambda: NOT_SHOWN not in standing.text(), "the complaint to go")
    standing.wait_for(lambda: drawn(standing) == before, "the picture of the value from before")


def test_two_wrong_boxes_are_both_named_over_the_scene_and_no_slider_jumps(standing: Wire):
    before, typed = standing.value("range noise σ (m)"), standing.value("range noise σ (m): number")
    standing.set("range noise σ (m): number", "1e99")
    standing.set("flight duration (s)", "abc")
    wrong = ("Range noise σ must be 0, or lie between", "Flight duration (s): “abc” is not a number")

    def named() -> bool:
        shown = [str(p.get("content")) for p in standing.elements.values() if p.get("visible")]
        return any(NOT_SHOWN in text and all(sentence in text for sentence in wrong) for text in shown)

    standing.wait_for(named, "both sentences in one place")
    assert standing.value("range noise σ (m)") == before
    standing.set("flight duration (s)", "20")
    standing.set("range noise σ (m): number", "0.2")
    standing.wait_for(lambda: NOT_SHOWN not in standing.text(), "the complaint to go")
    standing.wait_for(lambda: standing.value("range noise σ (m)") != before, "the slider to follow")
    standing.set("range noise σ (m)", before)
    standing.wait_for(lambda: standing.value("range noise σ (m): number") == typed, "the number to follow")


def test_a_slider_follows_a_correction_that_comes_while_the_one_before_is_taken_over(
    visitor: Editing, standing: Wire, monkeypatch: pytest.MonkeyPatch
):
    slider, box = "range noise σ (m)", "range noise σ (m): number"
    before, typed = standing.value(slider), standing.value(box)
    standing.set(box, "1e99")
    standing.wait_for_text("Range noise σ must be 0, or lie between")
    form = visitor.session.form
    refresh, late = form.refresh, threading.Event()

    def refresh_late() -> None:
        """The box is corrected after it was read, and before its mark is made."""
        if not late.is_set():
            late.set()
            standing.set(box, "0.3")
            handle = form.gui._gui_input_handle_from_uuid[standing.find(box)]
            standing.wait_for(lambda: handle.value == "0.3", "the correction")
        refresh()

    monkeypatch.setattr(form, "refresh", refresh_late)
    standing.set("noise seed", "8")
    standing.wait_for(lambda: late.is_set() and NOT_SHOWN not in standing.text(), "the complaint to go")
    standing.wait_for(lambda: standing.value(slider) != before, "the slider to follow", timeout=10)
    corrected = standing.value(slider)
    standing.set(box, typed)
    standing.wait_for(lambda: standing.value(slider) != corrected, "the slider to follow back")
