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

PAPER_UNITS, PHYSICAL_UNITS = "in the paper's letters", "in physical words"
STIFF = "▲ The attitude filter is stiff"


def _visitor(sessions: tuple[int, SessionServer], storage: Storage | None = None) -> Editing:
    tab = Wire(sessions[0], storage=storage)
    return Editing(tab, newest(sessions[1], tab))


@pytest.fixture
def page(sessions: tuple[int, SessionServer]) -> Iterator[Editing]:
    visitor = _visitor(sessions)
    yield visitor
    visitor.tab.close()


def _label(page: Editing, label: str) -> str:
    return page.tab.elements[page.tab.find(label)]["label"]


def test_switching_the_gain_units_draws_nothing_anew_and_is_no_step_to_undo(page: Editing):
    picture = page.session.picture
    page.set("show gains as", PHYSICAL_UNITS)
    page.tab.wait_for(lambda: _label(page, "noise σ of range") == "noise σ of range = 0.125 m", "the words")
    assert page.session.picture is picture
    assert page.session.history.depth == (0, 0)
    page.set("assumed range noise (m)", math.log10(0.25))
    q = page.settings.preset.gains.riccati.q
    assert page.settings.preset.gains == replace(
        picture.settings.preset.gains,  # type: ignore[union-attr]
        riccati=replace(picture.settings.preset.gains.riccati, q=q),  # type: ignore[union-attr]
    )
    page.set("show gains as", PAPER_UNITS)
    page.tab.wait_for(lambda: _label(page, "q").startswith(f"q = {q:.4g}"), "the letter")
    assert page.settings.preset.gains.riccati.q == q
    assert page.session.history.depth == (1, 0)
    page.command("Undo")
    assert page.settings == picture.settings  # type: ignore[union-attr]
    assert page.session.dock.gains.units == "paper"
    page.set("show gains as", PHYSICAL_UNITS)
    page.command("Redo")
    assert page.session.dock.gains.units == "physical"
    assert page.settings.preset.gains.riccati.q == q
    page.tab.wait_for(lambda: _label(page, "noise σ of range").endswith("= 0.25 m •"), "the word, marked")


def test_the_gain_units_and_the_gains_are_there_after_a_reload_to_the_last_bit(sessions: tuple[int, SessionServer]):
    storage = Storage()
    first = _visitor(sessions, storage)
    first.set("show gains as", PHYSICAL_UNITS)
    first.set("slowest time constant T (s)", 0.0)
    first.set("k1 falls as the directions agree", True)
    first.set("smoothing time (s)", 0.5)
    first.set("k1 falls as the directions agree", False)
    expected = first.settings
    first.tab.close()
    again = _visitor(sessions, storage)
    again.tab.wait_for(lambda: again.settings == expected, "the work")
    assert again.session.dock.gains.units == "physical"
    assert again.tab.value("show gains as") == PHYSICAL_UNITS
    again.tab.wait_for(lambda: _label(again, "slowest time T").startswith("slowest time T = 1 s"), "the word")
    again.set("k1 falls as the directions agree", True)
    assert again.settings.preset.gains.attitude.schedule == Schedule(memory=10**0.5)
    again.tab.close()


def test_work_saved_before_there_were_gain_units_opens(page: Editing):
    old = msgspec.json.encode({"opened": "paper", "settings": page.settings})
    assert msgspec.json.decode(old, type=SavedWork).language == "paper"


def test_another_path_leaves_the_gains_and_changes_the_physical_values(page: Editing):
    page.set("show gains as", PHYSICAL_UNITS)
    gains, before = page.settings.preset.gains, _label(page, "noise σ of range")
    page.set("anchor position (m)", [5.0, 0.0, 0.0])
    assert page.settings.preset.gains == gains
    page.tab.wait_for(lambda: _label(page, "noise σ of range") != before, "other words")
    page.set("preset", next(o for o in page.tab.elements[page.tab.find("preset")]["options"] if "(soft)" in o))
    page.tab.wait_for(lambda: page.settings.origin == "soft", "the preset")
    assert page.session.dock.gains.units == "physical"
    page.set("show gains as", PAPER_UNITS)
    assert page.settings.preset.gains == page.session.catalog.presets["soft"].gains


@pytest.mark.parametrize(
    ("label", "value", "sentence"),
    [
        ("noise σ of range", -3.0, "noise σ of range asks for q = "),
        ("noise σ of range", math.nan, "log10 of noise σ of range must be a number"),
        ("noise σ of accel", 200.0, "noise σ of accel must lie between 1e-30 and 1e+30"),
        ("noise σ of gyro", 2.0, "noise σ of gyro with position factor asks for v.position = "),
        ("position factor", -9.0, "noise σ of gyro with position factor asks for v.position = "),
        ("velocity factor", 8.0, "velocity factor with both sigmas asks for v.velocity = "),
        ("position box ±", 2.0, "factor on P₀(ξ) with the boxes asks for p0.xi = "),
        ("factor on P₀(ξ)", -math.inf, "log10 of factor on P₀(ξ) must be a number"),
        ("slowest time T", -6.0, "slowest time T asks for k1 = "),
        ("gravity weight", 6.0, "which must lie between"),
        ("shown", "in Latin", "shown must be one of"),
        ("k1 halfway at s", 0.7, ""),
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
    assert any(sentence in text for text in page.refusals()), page.refusals()
    assert len(page.refusals()) == 2  # below the control, and in the verdict
    assert page.settings == before
    page.set(label, good)
    page.wait_until_accepted()
    assert page.settings == before


def test_a_schedule_is_switched_on_edited_and_off_and_undo_goes_back_through_it(page: Editing):
    page.set("k1 falls as the directions agree", True)
    assert page.settings.preset.gains.attitude.schedule == Schedule()
    page.tab.wait_for(lambda: page.tab.text().count("at k1 = ") == 2, "both ends")
    page.set("final k1 (1/s)", -1.0)
    assert page.settings.preset.gains.attitude.schedule == Schedule(steady=0.1)
    page.set("k1 falls as the directions agree", False)
    assert page.settings.preset.gains.attitude.schedule is None
    page.set("k1 falls as the directions agree", True)
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
    page.tab.wait_for_text("raise the slowest time T or lower the gravity weight, or sample faster")
    page.set("trust in gravity", 0.0)
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
