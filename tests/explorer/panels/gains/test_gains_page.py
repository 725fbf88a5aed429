"""The Gains tab through viser's messages: units, schedule, stiffness, undesired equilibria, reload and undo."""

import math
from collections.abc import Iterator
from typing import Any

import msgspec
import pytest
from msgspec.structs import replace

from explorer.server import SessionServer
from explorer.storage.autosave import SavedWork
from rangenav.attitude import Schedule
from tests.support.waiting_visitor import Editing, newest
from tests.support.wire import Storage, Wire

pytestmark = pytest.mark.slow


NOT_SHOWN = "Not shown"

PAPER_UNITS, PHYSICAL_UNITS = "the paper's letters", "physical quantities"
STIFF = "▲ The attitude filter is stiff"


RANGE_NOISE, WEIGHT = "assumed range noise (m)", "range weight q (1/(m⁴ s))"


def _visitor(sessions: tuple[int, SessionServer], storage: Storage | None = None) -> Editing:
    tab = Wire(sessions[0], storage=storage)
    return Editing(tab, newest(sessions[1], tab))


@pytest.fixture
def page(sessions: tuple[int, SessionServer]) -> Iterator[Editing]:
    visitor = _visitor(sessions)
    yield visitor
    visitor.tab.close()


def _number(page: Editing, label: str) -> str:
    """What the box beside a slider shows."""
    return page.tab.value(f"{label}: number")


def test_switching_the_gain_units_draws_nothing_anew_and_is_no_step_to_undo(page: Editing):
    picture = page.session.picture
    page.set("show gains as", PHYSICAL_UNITS)
    page.tab.wait_for(lambda: _number(page, RANGE_NOISE) == "0.125", "the number")
    assert page.session.picture is picture
    assert page.session.history.depth == (0, 0)
    page.set("assumed range noise (m)", math.log10(0.25))
    q = page.settings.preset.gains.riccati.q
    assert page.settings.preset.gains == replace(
        picture.settings.preset.gains,  # type: ignore[union-attr]
        riccati=replace(picture.settings.preset.gains.riccati, q=q),  # type: ignore[union-attr]
    )
    page.set("show gains as", PAPER_UNITS)
    page.tab.wait_for(lambda: _number(page, WEIGHT) == f"{q:.4g}", "the number")
    assert page.settings.preset.gains.riccati.q == q
    assert page.session.history.depth == (1, 0)
    page.command("Undo")
    assert page.settings == picture.settings  # type: ignore[union-attr]
    assert page.session.dock.gains.units == "paper"
    page.set("show gains as", PHYSICAL_UNITS)
    page.command("Redo")
    assert page.session.dock.gains.units == "physical"
    assert page.settings.preset.gains.riccati.q == q
    page.tab.wait_for(lambda: _number(page, RANGE_NOISE) == "0.25", "the number")


def test_the_gain_units_and_the_gains_are_there_after_a_reload_to_the_last_bit(sessions: tuple[int, SessionServer]):
    storage = Storage()
    first = _visitor(sessions, storage)
    first.set("show gains as", PHYSICAL_UNITS)
    first.set("slowest time constant T (s)", 0.0)
    first.set("scheduled k1", True)
    first.set("smoothing time (s)", 0.5)
    first.set("scheduled k1", False)
    expected = first.settings
    first.tab.close()
    again = _visitor(sessions, storage)
    again.tab.wait_for(lambda: again.settings == expected, "the work")
    assert again.session.dock.gains.units == "physical"
    assert again.tab.value("show gains as") == PHYSICAL_UNITS
    again.tab.wait_for(lambda: _number(again, "slowest time constant T (s)") == "1", "the number")
    again.set("scheduled k1", True)
    assert again.settings.preset.gains.attitude.schedule == Schedule(memory=10**0.5)
    again.tab.close()


def test_work_saved_before_there_were_gain_units_opens(page: Editing):
    old = msgspec.json.encode({"opened": "paper", "settings": page.settings})
    assert msgspec.json.decode(old, type=SavedWork).language == "paper"


def test_another_path_leaves_the_gains_and_changes_the_physical_values(page: Editing):
    page.set("show gains as", PHYSICAL_UNITS)
    gains, before = page.settings.preset.gains, _number(page, RANGE_NOISE)
    page.set("anchor position (m)", [5.0, 0.0, 0.0])
    assert page.settings.preset.gains == gains
    page.tab.wait_for(lambda: _number(page, RANGE_NOISE) != before, "other words")
    page.set("preset", next(o for o in page.tab.elements[page.tab.find("preset")]["options"] if "(soft)" in o))
    page.tab.wait_for(lambda: page.settings.origin == "soft", "the preset")
    assert page.session.dock.gains.units == "physical"
    page.set("show gains as", PAPER_UNITS)
    assert page.settings.preset.gains == page.session.catalog.presets["soft"].gains


@pytest.mark.parametrize(
    ("label", "value", "sentence"),
    [
        (RANGE_NOISE, -3.0, "assumed range noise asks for q = "),
        (RANGE_NOISE, math.nan, f"{RANGE_NOISE} must be a finite number"),
        ("assumed accelerometer noise (m/s²)", 200.0, "assumed accelerometer noise must lie between 1e-30 and 1e30"),
        (
            "assumed gyro noise (rad/s)",
            2.0,
            "assumed gyro noise with position drift factor asks for process noise V(p) = ",
        ),
        ("position drift factor", -9.0, "assumed gyro noise with position drift factor asks for process noise V(p) = "),
        ("velocity drift factor", 8.0, "velocity drift factor with both sigmas asks for process noise V(v) = "),
        ("initial position error ± (m)", 2.0, "initial ξ factor with the boxes asks for initial variance P₀(ξ) = "),
        ("initial ξ factor", -math.inf, "initial ξ factor must be a finite number"),
        ("slowest time constant T (s)", -6.0, "slowest time constant T asks for k1 = "),
        ("gravity over magnetometer weight", 6.0, "which must lie between"),
        ("show gains as", "in Latin", "show gains as must be one of"),
        ("misalignment at half way", 0.7, ""),
    ],
)
def test_nonsense_in_a_physical_value_gets_a_sentence_and_the_picture_stays(
    page: Editing, label: str, value: Any, sentence: str
):
    page.set("show gains as", PHYSICAL_UNITS)
    good, before = page.tab.value(label), page.settings
    page.set(label, value)
    if not sentence:  # a dial of what is switched off decides nothing
        assert page.settings == before
        return
    page.tab.wait_for_text(NOT_SHOWN)
    page.tab.wait_for(lambda: len(page.refusals()) == 2, "the sentence below the control and in the verdict")
    assert any(sentence in text for text in page.refusals()), page.refusals()
    assert page.settings == before
    page.set(label, good)
    page.wait_until_accepted()
    assert page.settings == before


def test_a_schedule_is_switched_on_edited_and_off_and_undo_goes_back_through_it(page: Editing):
    page.set("scheduled k1", True)
    assert page.settings.preset.gains.attitude.schedule == Schedule()
    page.tab.wait_for(lambda: page.tab.text().count("at k1 = ") == 2, "both ends")
    page.set("final k1 (1/s)", -1.0)
    assert page.settings.preset.gains.attitude.schedule == Schedule(steady=0.1)
    page.set("scheduled k1", False)
    assert page.settings.preset.gains.attitude.schedule is None
    page.set("scheduled k1", True)
    assert page.settings.preset.gains.attitude.schedule == Schedule(steady=0.1)
    for _ in range(4):
        page.command("Undo")
    assert page.settings.preset == page.session.catalog.presets["paper-slow"]
    page.tab.wait_for(lambda: page.tab.text().count("at k1 = ") == 1, "one k1")


def test_stiffness_is_warned_of_while_it_lasts(page: Editing):
    assert STIFF not in page.tab.text()
    page.set("trust in gravity ρ2 (s⁴/m²)", 0.0)
    page.tab.wait_for_text(STIFF)
    page.tab.wait_for_text("lower k1 or ρ2, or sample faster")
    page.set("show gains as", PHYSICAL_UNITS)
    page.tab.wait_for_text(
        "raise the slowest time constant T or lower the gravity over magnetometer weight, or sample faster"
    )
    page.set("gravity over magnetometer weight", 0.0)
    page.tab.wait_for(lambda: STIFF not in page.tab.text(), "no warning")


def test_the_three_undesired_equilibria_are_started_from_by_their_buttons_and_undone(page: Editing):
    page.tab.wait_for_text("The start is <b>90°</b> from the nearest")
    before = page.settings.preset.guess
    for ending in ("between m and g", "in their plane, across it", "across both m and g"):
        label = next(p["label"] for p in page.tab.elements.values() if str(p.get("label")).endswith(ending))
        page.press(label)
        guess = page.settings.preset.guess
        assert guess.attitude_angle == math.pi
        assert page.session.picture.errors.attitude[0] == pytest.approx(math.pi, abs=1e-6)  # type: ignore[union-attr]
        page.tab.wait_for_text("The start is <b>0°</b> from the nearest")
        page.press("almost: 1° off the nearest of these")
        almost = page.settings.preset.guess
        assert almost.attitude_axis == guess.attitude_axis
        assert math.degrees(almost.attitude_angle) == pytest.approx(179.0, rel=1e-12)
        page.tab.wait_for_text("The start is <b>1°</b> from the nearest")
        page.command("Undo")
        assert page.settings.preset.guess == guess
        page.command("Undo")
        assert page.settings.preset.guess == before


def test_noise_matched_gains_say_so_and_keep_q_and_v_for_later(page: Editing):
    noise = page.session.dock.gains.paper_dials.noise
    riccati = page.settings.preset.gains.riccati
    page.set("kind of gains", "noise-matched (outside it)")
    page.tab.wait_for_text("own dials are not shown")
    assert not noise.visible
    assert page.settings.preset.gains.riccati == riccati
    page.set("kind of gains", "constant (the paper's theorem)")
    assert noise.visible
    assert page.settings.preset == page.session.catalog.presets["paper-slow"]
