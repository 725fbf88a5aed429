"""The Auto-tune section through viser's messages: started, stopped, picked from, used, undone; and bad input."""

import functools
import itertools
import math
import re
import threading
import time
from collections.abc import Iterator

import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace

from explorer.model.settings import Settings
from explorer.panels.gains import tradeoff_plot, tuning_text
from explorer.panels.gains.tradeoff_plot import ATTITUDE, POSITION, MarkedPoints
from explorer.panels.gains.tuning import TuningPanel
from explorer.server import SessionServer
from rangenav import preset, tradeoff, tune
from rangenav.attitude import AttitudeGains
from rangenav.gains import Gains
from rangenav.preset import Preset
from rangenav.progress import Cancelled, Progress
from rangenav.tradeoff import Point
from rangenav.tune import Tuned
from tests.support.waiting_visitor import Editing, arrived, save_as

pytestmark = pytest.mark.slow


PRESS = 0.05
"""s: presses of buttons go through a pool of threads, and may be overtaken."""
SEEDS, TRIED = 2, 20


_tuned = functools.cache(tune.tune)


def tune_once(preset: Preset, *, progress: Progress, cancelled: Cancelled, **options: float) -> Tuned:
    """The search for gains, which has the same result for every visitor who asks the same."""
    progress(1.0)
    return _tuned(preset, **options)


@pytest.fixture
def tuned(editing: Editing, monkeypatch: pytest.MonkeyPatch) -> Editing:
    """A visitor who has tuned the gains; the result is that of the first one's search."""
    with monkeypatch.context() as patch:
        patch.setattr("rangenav.tune.tune", tune_once)
        tune_gains(editing)
        editing.tab.wait_for_text("Picked (found)")
    editing.settle()
    return editing


@pytest.fixture(scope="module")
def searched(sessions: tuple[int, SessionServer]) -> Iterator[Editing]:
    """A visitor whose own search for gains has ended, for tests that use none of them."""
    visitor = arrived(sessions)
    tune_gains(visitor)
    visitor.tab.wait_for_text("Picked (found)")
    visitor.settle()
    yield visitor
    visitor.tab.close()


def tune_gains(editing: Editing, seeds: float = SEEDS, tried: float = TRIED) -> None:
    """Set the boxes and start."""
    editing.set("runs per try", seeds)
    editing.set("sets of gains to try", tried)
    editing.press("Tune the gains")


def panel(editing: Editing) -> TuningPanel:
    return editing.session.dock.tuning


def panel_pinned(editing: Editing) -> Settings | None:
    return editing.session.dock.compare.pinned_settings


def gains(editing: Editing) -> Gains:
    return editing.settings.preset.gains


def page_text(editing: Editing) -> str:
    return re.sub(r"<[^>]+>", "", editing.tab.text())


def pick(editing: Editing, place: float) -> None:
    """Move the slider along the curve, and wait until the session has applied it."""
    editing.run(lambda: editing.tab.set("place on the curve", place))


def test_a_result_is_shown_and_changes_nothing_until_it_is_used_and_undone(tuned: Editing):
    before = gains(tuned)
    result = panel(tuned).result
    assert result is not None
    assert before == result[1].before.gains
    tuned.press("Use these gains")
    assert gains(tuned) == result[1].after.gains != before
    tuned.tab.wait_for_text("On the page now.")
    tuned.command("Undo")
    assert gains(tuned) == before
    tuned.tab.wait_for(lambda: "On the page now." not in tuned.tab.text(), "the mark to go")
    tuned.command("Redo")
    assert gains(tuned) == result[1].after.gains


def test_used_gains_say_what_they_do_on_the_runs_searched_and_on_the_run_in_view(tuned: Editing):
    before, result = tuned.session.picture, panel(tuned).result
    assert before is not None
    assert result is not None
    tuned.press("Use these gains")
    tuned.tab.wait_for_text("In use.")
    after = tuned.session.picture
    assert after is not None
    shown_text = page_text(tuned)
    shown_text = shown_text[shown_text.index("In use.") :]
    row = shown_text[shown_text.index("steady position error (m)") :].removeprefix("steady position error (m)")
    figures = (result[1].before.steady_position, result[1].after.steady_position)
    runs = (before.summary.steady_position, after.summary.steady_position)
    assert row.startswith("".join(f"{figure:.3g}" for figure in (*figures, *runs)))
    assert "may become worse" in shown_text
    assert panel_pinned(tuned) == before.settings  # A is the run before
    tuned.command("Undo")
    tuned.tab.wait_for(lambda: "In use." not in visible_text(tuned), "the sentence to go")


def visible_text(editing: Editing) -> str:
    """What stands in the blocks that are shown."""
    shown = (p for p in editing.tab.elements.values() if p.get("visible", True))
    return " ".join(str(p.get("content", "")) for p in shown)


def test_the_figures_on_the_page_are_those_that_scoring_the_gains_again_gives(searched: Editing):
    p, result = searched.settings.preset, panel(searched).result
    assert result is not None
    training = tradeoff.runs(p, p.seed + tune.TRAINING_OFFSET, SEEDS)
    held_out = tradeoff.runs(p, p.seed, SEEDS)
    shown_text = page_text(searched)
    for chosen, runs in itertools.product((result[1].before.gains, result[1].after.gains), (training, held_out)):
        again = tradeoff.score(chosen, runs, preset=p, cancelled=lambda: False)
        for figure in (again.settle_position, again.settle_attitude, again.steady_position):
            assert f"{figure:.3g}" in shown_text


def test_every_place_on_the_curve_can_be_picked_and_used(tuned: Editing):
    walk = panel(tuned).choices
    assert len(walk) > 2
    for place in (1, len(walk)):
        pick(tuned, place)
        tuned.tab.wait_for_text(f"position {tradeoff_plot.point_text(POSITION, walk[place - 1])}")
        tuned.press("Use these gains")
        assert gains(tuned) == walk[place - 1].gains
    tuned.command("Undo")
    assert gains(tuned) == walk[0].gains  # each use is a step of its own


def test_what_is_used_right_after_picking_is_what_was_picked(tuned: Editing):
    """The button comes with the pick, while all threads are busy in which viser calls plain functions."""
    walk, tab, form = panel(tuned).choices, tuned.tab, tuned.session.form
    ranked = sorted(range(len(walk)), key=lambda k: walk[k].gains == gains(tuned))  # one that is not in use
    place, go_on, used = ranked[0] + 1, threading.Event(), form.actions_run
    for _ in range(64):
        form.gui._thread_executor.submit(go_on.wait)
    tab.set("place on the curve: number", str(place))
    tab.press("Use these gains")
    tab.wait_for(lambda: form.actions_run > used, "the button")
    go_on.set()
    tuned.settle()
    assert gains(tuned) == walk[place - 1].gains


def test_picking_is_no_step_of_the_history_and_leaves_the_settings(searched: Editing):
    depth, before = searched.session.history.depth, searched.settings
    pick(searched, 1)
    searched.run(lambda: searched.tab.set("curve to pick from", "attitude"))
    assert searched.session.history.depth == depth
    assert searched.settings == before


@pytest.mark.parametrize(
    ("curve", "settle", "steady"), [(c, *m) for c, m in [("position", POSITION[1:3]), ("attitude", ATTITUDE[1:3])]]
)
def test_along_a_curve_what_settles_later_is_more_exact(searched: Editing, curve: str, settle: str, steady: str):
    searched.run(lambda: searched.tab.set("curve to pick from", curve))
    walk, result = panel(searched).choices, panel(searched).result
    assert result is not None
    times, errors = ([getattr(point, name) for point in walk] for name in (settle, steady))
    assert times == sorted(times)
    assert errors == sorted(errors, reverse=True)
    for point in walk:  # nothing tried beats it in both, by the definition and not by the function
        assert not any(
            getattr(other, settle) < getattr(point, settle) and getattr(other, steady) < getattr(point, steady)
            for other in result[1].points
        )
    for point in walk:  # and of those with the same figures it is the best by J
        same = [
            o
            for o in result[1].points
            if (getattr(o, settle), getattr(o, steady)) == (getattr(point, settle), getattr(point, steady))
        ]
        assert point.objective(0.5) == min(other.objective(0.5) for other in same)


def test_discarding_takes_the_result_off_and_leaves_the_gains(tuned: Editing):
    before = tuned.settings
    tuned.press("Discard the search")
    tuned.tab.wait_for(lambda: "Picked" not in tuned.tab.text(), "the result to go")
    tuned.press("Use these gains")  # what no honest page could send
    assert tuned.settings == before


def test_another_path_or_sensor_is_named_with_the_result_and_another_gain_is_not(tuned: Editing):
    tuned.set("attitude gain k1 (1/s)", 0.3)
    assert "The page shows" not in tuned.tab.text()
    tuned.set("speed (slower ⟷ faster)", 0.3)
    tuned.tab.wait_for_text("The page shows another path by now")
    tuned.set("ranges per second (Hz)", 20.0)
    tuned.tab.wait_for_text("The page shows another path and other sensors by now")
    tuned.command("Undo")
    tuned.command("Undo")
    tuned.tab.wait_for(lambda: "The page shows" not in tuned.tab.text(), "the warning to go")


def endless(*_: object, progress, cancelled, **__: object) -> Tuned:
    """A search that goes on until it is stopped."""
    while not cancelled():
        progress(0.5)
        time.sleep(0.01)
    HEARD.append(True)
    raise AssertionError("its result is not wanted any more")


HEARD: list[bool] = []


def test_a_search_is_stopped_and_the_page_goes_on_with_the_gains_it_had(
    editing: Editing, monkeypatch: pytest.MonkeyPatch
):
    HEARD.clear()
    before = gains(editing)
    monkeypatch.setattr("rangenav.tune.tune", endless)
    tune_gains(editing)
    editing.tab.wait_for_text(f"auto-tune, {TRIED} gains, 48 %")
    editing.set(
        "attitude gain k1 (1/s)", 0.3
    )  # the page is not held up, and the job goes on for what it was started with
    assert gains(editing) != before
    editing.tab.wait_for_text(f"auto-tune, {TRIED} gains, 48 %")
    assert HEARD == []
    editing.tab.press("Stop")
    editing.tab.wait_for(lambda: HEARD == [True] and editing.session.jobs.running is None, "the job to end")
    assert panel(editing).result is None
    assert "Picked" not in editing.tab.text()


def test_a_search_begun_by_the_palette_is_shown_and_stopped_below_the_verdict(
    editing: Editing, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr("rangenav.tune.tune", endless)
    editing.command("Auto-tune")
    editing.tab.wait_for(lambda: 'class="rn-progress"' in editing.tab.text(), "the progress below the verdict")
    editing.tab.press_own("stop")
    editing.tab.wait_for(lambda: editing.session.jobs.running is None, "the job to end")


def test_a_result_stays_when_another_search_is_stopped(tuned: Editing, monkeypatch: pytest.MonkeyPatch):
    before = panel(tuned).result
    monkeypatch.setattr("rangenav.tune.tune", endless)
    tuned.press("Tune the gains")
    tuned.tab.wait_for_text("48 %")
    tuned.tab.press("Stop")
    tuned.tab.wait_for(lambda: tuned.session.jobs.running is None, "the job to end")
    assert panel(tuned).result is before
    assert "Picked (found)" in tuned.tab.text()


@pytest.mark.parametrize(
    ("label", "value"),
    [
        ("runs per try", 0),
        ("runs per try", 33),
        ("runs per try", 2.5),
        ("runs per try", 1e6),
        ("sets of gains to try", 1e300),
    ],
)
def test_nonsense_in_a_box_gets_a_sentence(editing: Editing, label: str, value: float):
    editing.set(label, value)
    editing.press("Tune the gains")
    editing.tab.wait_for_text(f"{label} must be a whole number between 1 and")
    assert editing.session.jobs.running is None


@pytest.mark.parametrize(("value", "rule"), [(math.nan, "must be a finite number"), (-1, "must lie between 0 and 1")])
def test_a_nonsense_weight_gets_a_sentence(editing: Editing, value: float, rule: str):
    editing.set("settle soon ⟷ err less, w", value)
    editing.press("Tune the gains")
    editing.tab.wait_for_text(f"settle soon ⟷ err less, w {rule}")
    assert editing.session.jobs.running is None


@pytest.mark.parametrize(
    ("label", "value"), [("place on the curve", 0), ("place on the curve", 1e9), ("curve to pick from", "nothing")]
)
def test_a_place_that_was_not_offered_gets_a_sentence(tuned: Editing, label: str, value: object):
    before = panel(tuned).picked
    tuned.run(lambda: tuned.tab.set(label, value))
    tuned.tab.wait_for_text(f"{label} must be")
    assert panel(tuned).picked is before


def test_too_much_work_is_refused_in_a_sentence_where_it_was_asked_for(editing: Editing):
    editing.set("flight duration (s)", 600.0)
    tune_gains(editing, 32, 2000)
    editing.tab.wait_for_text("runs × duration × IMU rate must not exceed")


# Words and plots, without a page


def point(settle: float, steady: float, *, settled: float = 1.0, k1: float = 1.0) -> Point:
    return Point(
        gains=Gains(attitude=AttitudeGains(k1=k1)),
        settled=settled,
        settle_position=settle,
        settle_attitude=settle,
        steady_position=steady,
        steady_attitude=steady,
    )


def tuned_result(
    before: Point, after: Point, held_before: Point, held_after: Point, starts: tuple[float, float]
) -> Tuned:
    return Tuned(
        preset=replace(preset.load("soft"), gains=after.gains),
        steadiness=0.5,
        before=before,
        after=after,
        points=(before, after) if before is not after else (before,),
        held_out_before=held_before,
        held_out_after=held_after,
        starts_before=starts[0],
        starts_after=starts[1],
    )


def test_a_result_that_is_worse_on_held_out_seeds_says_so_and_a_better_one_does_not():
    start, better, worse = point(5, 0.2), point(3, 0.1), point(9, 0.4)
    assert "Worse on held-out seeds" in tuning_text.summary(tuned_result(start, better, start, worse, (1.0, 1.0)), 8)
    assert "⚠" not in tuning_text.summary(tuned_result(start, better, start, better, (1.0, 1.0)), 8)


def test_fewer_random_starts_that_hold_are_marked():
    start, better = point(5, 0.2), point(3, 0.1)
    summary_text = tuning_text.summary(tuned_result(start, better, start, better, (1.0, 0.98)), 8)
    assert "⚠ Of 200 other runs, which begin at random, 200 keep within 0.3 m" in summary_text
    assert "<b>196</b> with the new ones" in summary_text


def test_a_search_that_finds_nothing_better_says_so():
    start = point(5, 0.2)
    assert "None of the 0 other gains tried did better" in tuning_text.summary(
        tuned_result(start, start, start, start, (1, 1)), 8
    )


figure = st.floats(1e-6, 1e6)


@given(st.lists(st.tuples(figure, figure), min_size=1, max_size=40))
def test_every_marked_point_lies_inside_its_plot_where_the_logarithms_put_it(pairs: list[tuple[float, float]]):
    points = tuple(point(*pair) for pair in pairs)
    walk = tradeoff.front(points, "settle_position", "steady_position")
    drawn = tradeoff_plot.plot(
        POSITION, points, MarkedPoints(start=points[0], best=walk[0], picked=walk[-1], choices=walk)
    )
    spots = [(float(x), float(y)) for x, y in re.findall(r'<circle cx="([\d.]+)" cy="([\d.]+)" r="3.2"', drawn)]
    assert len(spots) == len(walk)
    for x, y in spots:
        assert tradeoff_plot.LEFT <= x <= tradeoff_plot.WIDTH - tradeoff_plot.RIGHT
        assert tradeoff_plot.TOP <= y <= tradeoff_plot.HEIGHT - tradeoff_plot.BOTTOM
    if len(walk) > 2:  # equal ratios are equally far apart; places are written with one decimal
        (a, b), (x0, _), (x1, _), (x2, _) = (walk[0], walk[-1]), spots[0], spots[1], spots[-1]
        share = math.log(walk[1].settle_position / a.settle_position) / math.log(b.settle_position / a.settle_position)
        assert x1 - x0 == pytest.approx(share * (x2 - x0), abs=0.2)


@given(figure, st.floats(1.0, 1e9))
def test_an_axis_has_three_to_seven_numbers_on_it_in_order(low: float, ratio: float):
    axis = tradeoff_plot.axis_limits((low, low * ratio))
    places = tradeoff_plot.ticks(axis)
    assert 3 <= len(places) <= 7
    assert places == sorted(set(places))
    assert axis[0] <= places[0]
    assert places[-1] <= axis[1]
    written = [f"{place:.3g}" for place in places]
    assert len(set(written)) == len(written)


def test_what_belongs_to_a_preset_goes_with_it_from_every_panel(tuned: Editing):
    dock, tab = tuned.session.dock, tuned.tab
    baseline = "Pin a run, change anything"
    tuned.press("Pin this run as A")
    tuned.press("", "Download Python")
    tab.wait_for_text("Run these lines in the folder")
    tuned.press("Make it observable")
    tab.wait_for_text(" motions tried: ")
    save_as(tuned, "Kept for a moment")
    tab.wait_for_text("Picked (found)")  # the same motion under another name: nothing goes
    assert baseline not in page_text(tuned)
    tuned.set("preset", f"{preset.load('hover').title} (hover)")
    tab.wait_for_text(baseline)
    seen = {p["content"] for p in tab.elements.values() if p.get("visible", True) and "content" in p}
    for text in ("Picked", "Run these lines in the folder", "motions tried", "saved as"):
        assert not any(text in str(content) for content in seen), text
    assert dock.compare.pinned is None
    assert dock.tuning.result is None
    assert not dock.repair.found
    panels = {name for name, panel in vars(dock).items() if hasattr(panel, "forget_preset")}
    assert panels <= {name for name, panel in vars(dock).items() if panel in dock.belonging}


def test_the_pinned_run_stays_with_another_preset_if_the_visitor_keeps_it(editing: Editing):
    editing.press("Pin this run as A")
    editing.set("keep A with another preset", True)
    editing.set("preset", f"{preset.load('hover').title} (hover)")
    editing.tab.wait_for_text("path, four times slower, noise seed")
    pinned = editing.session.dock.compare.pinned
    assert pinned is not None
    assert pinned.settings.origin == "paper-slow"
