"""The Studies tab through viser's messages: maps that start, fill, stop, are read, taken, undone and saved."""

import csv
import dataclasses
import html
import io
import json
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from msgspec.structs import replace

from explorer.model.settings import effective
from explorer.model.study_map import MATCHED, READY, Ready
from explorer.panels.studies import FOLLOWS, OTHER_CHOICE, OTHER_DESIGN, StudiesPanel, showing
from explorer.panels.studies.choice import COMPUTE
from explorer.panels.studies.files import COMMAND, STUDY_FILE, STUDY_PRESET
from explorer.panels.studies.map_file import caption
from explorer.server import SessionServer
from explorer.web.elements import element_id
from explorer.widgets.html import escaped, upper_first
from rangenav import preset
from rangenav.studies import study
from rangenav.studies.maps import StudyMap
from tests.support.waiting_visitor import Editing, arrived
from tests.support.wire import Storage

pytestmark = pytest.mark.slow
ANCHOR, SIZE, GAINS = READY
WINDOW = "width=1366&height=768&tabs="
"""What a browser reports, up to the names of its open tabs."""
CONTENT = re.compile(r'data-rn-cells="([^"]*)"')


@pytest.fixture(scope="module")
def visitor(sessions: tuple[int, SessionServer]) -> Iterator[Editing]:
    """One visitor for all tests."""
    visitor = arrived(sessions)
    yield visitor
    visitor.tab.close()


@pytest.fixture
def page(visitor: Editing) -> Editing:
    """The visitor's page with the preset as it is shipped, and no map."""
    visitor.run(lambda: visitor.tab.press_own("again"))
    panel(visitor).forget_preset()
    panel(visitor).follows = lambda: False
    return visitor


def panel(page: Editing) -> StudiesPanel:
    return page.session.dock.studies


def do(page: Editing, action) -> None:
    """Run an action in the session's loop."""
    page.run(lambda: page.session.form.do(action, step=False))


def computed(page: Editing, ready: Ready, count: int = 2) -> StudyMap:
    """A ready map with a few points, once it is complete."""
    do(page, lambda: panel(page).start_ready(dataclasses.replace(ready, count=count, runs=1)))
    page.tab.wait_for(lambda: panel(page).progress.running is None, "the map")
    page.settle()
    filling = panel(page).filling
    assert filling is not None
    assert filling.map is not None
    return filling.map


def shown(page: Editing) -> str:
    """The block of the map."""
    return panel(page).block.content


@pytest.mark.parametrize("ready", READY, ids=lambda ready: ready.name)
def test_every_ready_map_is_offered_and_starts(page: Editing, ready: Ready):
    page.tab.find(ready.question)
    of = computed(page, ready)
    assert of.share == 1
    assert ready.metric in of.values
    cells = json.loads(html.unescape(CONTENT.findall(shown(page))[0]))
    assert len(cells["texts"]) == 4
    assert "not computed yet" not in cells["texts"]
    assert "present design" in shown(page)


def test_a_taken_cell_is_one_step_with_exactly_its_values_and_undo_takes_it_back(page: Editing):
    of = computed(page, SIZE)
    before = page.settings
    page.run(lambda: page.tab.press_own("map-take-1-0"))
    after, filling = page.settings, panel(page).filling
    assert filling is not None
    assert after.time_scale == of.second[0]
    assert effective(after) == filling.study.preset_at(2)
    assert OTHER_DESIGN not in shown(page)
    page.command("Undo")
    assert page.settings == before


def test_another_metric_of_the_same_kind_needs_no_new_run_and_one_of_another_kind_does(page: Editing):
    of = computed(page, SIZE)
    page.set("metric", "excitation μ (m²/s⁷)")
    filling = panel(page).filling
    assert filling is not None
    assert filling.map is of
    page.tab.wait_for(lambda: "<b>excitation μ (m²/s⁷)</b>" in shown(page), "the other metric")
    page.set("metric", "settling time, position (s)")
    page.tab.wait_for(lambda: upper_first(OTHER_CHOICE) in shown(page), "the notice")


def test_a_changed_design_stops_and_marks_the_map_and_its_cells_are_refused(page: Editing):
    page.press(SIZE.question)
    page.tab.wait_for(lambda: panel(page).progress.running is not None, "the job")
    page.set("range noise σ (m)", 0.31)
    page.tab.wait_for(lambda: panel(page).progress.running is None, "the job to end")
    computed(page, ANCHOR)
    page.set("range noise σ (m)", 0.32)
    page.tab.wait_for(lambda: upper_first(OTHER_DESIGN) in shown(page), "the notice")
    before = page.settings
    page.run(lambda: page.tab.press_own("map-take-1-0"))
    assert page.settings == before
    assert any(OTHER_DESIGN in refusal for refusal in page.refusals())


def test_stop_keeps_what_is_done(page: Editing):
    page.press(GAINS.question)
    page.tab.wait_for(lambda: panel(page).filling.map is not None, "the first points")  # pyright: ignore
    do(page, panel(page).progress.stop)
    page.tab.wait_for(lambda: "Stopped: " in shown(page), "the sentence")  # the points of a part may still arrive
    filling = panel(page).filling
    assert filling is not None
    assert filling.map is not None
    count = int(filling.map.computed.sum())
    assert 0 < count < filling.map.computed.size
    assert f"Stopped: {count} of 289 points are computed" in shown(page)


def test_a_closed_tab_is_not_drawn_and_catches_up_when_it_is_opened(page: Editing):
    computed(page, ANCHOR)
    page.tab.set("page", WINDOW + "motion")
    page.settle()
    before = shown(page)
    page.set("range noise σ (m)", 0.33)
    assert shown(page) == before
    page.tab.set("page", WINDOW + "studies")
    page.tab.wait_for(lambda: upper_first(OTHER_DESIGN) in shown(page), "the notice")


def test_a_bad_range_is_refused_in_one_sentence_with_the_label_of_its_box(page: Editing):
    computed(page, ANCHOR)
    page.set("highest across", "-9")
    assert any("highest across must be larger than lowest across" in refusal for refusal in page.refusals())
    page.set("highest across", "2")
    page.set("points upwards", "66")
    assert any("points upwards must be a whole number between 2 and 65" in refusal for refusal in page.refusals())
    page.set("points upwards", "3")
    page.wait_until_accepted()


def test_a_page_that_follows_a_presentation_starts_no_map_and_takes_no_cell(page: Editing):
    computed(page, ANCHOR)
    panel(page).follows = lambda: True
    before, filling = page.settings, panel(page).filling
    page.press("Compute the map")
    page.run(lambda: page.tab.press_own("map-take-0-0"))
    assert (page.settings, panel(page).filling) == (before, filling)
    assert any(FOLLOWS in refusal for refusal in page.refusals())


@pytest.mark.parametrize("changed", [False, True], ids=["as shipped", "changed"])
def test_the_saved_study_loads_with_its_preset_and_is_the_same_study(page: Editing, tmp_path: Path, changed: bool):
    if changed:
        page.set("range noise σ (m)", 0.34)
    computed(page, GAINS)
    page.tab.downloads.clear()
    page.press("save map as", "Study")
    assert offered(page, STUDY_PRESET) == changed  # a shipped one needs no file
    if changed:
        page.press(STUDY_PRESET)
    page.tab.wait_for(lambda: len(page.tab.downloads) == 1 + changed, "the files")
    for name, content in page.tab.downloads:
        (tmp_path / name).write_bytes(content)
    filling = panel(page).filling
    assert filling is not None
    loaded = study.load(tmp_path / STUDY_FILE)
    assert loaded.file == replace(filling.study.file, metrics=("steady_position", "flyable"))
    of = replace_names(dataclasses.replace(filling.study, file=loaded.file), loaded.names)
    assert loaded.bases == filling.study.bases
    assert loaded.preset_at(3) == filling.study.preset_at(3)
    assert loaded.digest == of.digest
    assert COMMAND in page.tab.text()
    assert preset.load("paper-slow") == filling.study.bases[0] or changed


def offered(page: Editing, label: str) -> bool:
    """Whether a button is on the page."""
    return any(p.get("label") == label and p.get("visible", True) for p in page.tab.elements.values())


def test_the_button_preset_saves_the_design_that_a_cell_has_made(page: Editing):
    computed(page, SIZE)
    page.run(lambda: page.tab.press_own("map-take-1-0"))
    page.tab.downloads.clear()
    page.press("save map as", "Preset")
    page.tab.wait_for(lambda: page.tab.downloads, "the file")
    ((name, content),) = page.tab.downloads
    assert name == "paper-slow-changed.toml"
    assert preset.loads(content.decode(), source=name) == effective(page.settings)


def test_a_stopped_map_goes_on_from_what_is_kept(page: Editing):
    page.press(GAINS.question)
    page.tab.wait_for(lambda: panel(page).filling.map is not None, "the first points")  # pyright: ignore
    do(page, panel(page).progress.stop)
    page.tab.wait_for(lambda: f"“{COMPUTE}” goes on from there" in shown(page), "the sentence")
    filling = panel(page).filling
    assert filling is not None
    assert filling.map is not None
    kept = filling.map.computed.copy()
    page.press(COMPUTE)
    assert panel(page).filling is filling
    assert filling.map.computed[kept].all()
    page.tab.wait_for(lambda: filling.map.computed.sum() > kept.sum(), "more points")  # pyright: ignore
    do(page, panel(page).progress.stop)
    page.set("points across", "5")
    page.tab.wait_for(lambda: f"“{COMPUTE}” goes on" not in shown(page), "the notice")  # another map begins anew


def test_the_choice_of_a_map_outlives_a_reload_and_the_page_says_what_is_lost(sessions: tuple[int, SessionServer]):
    storage = Storage()
    before = arrived(sessions, storage)
    for label, value in (("points across", "4"), ("points upwards", "3"), ("highest across", "1.5")):
        before.set(label, value)
    before.set("metric", "excitation μ (m²/s⁷)")
    before.press(COMPUTE)
    before.tab.wait_for(lambda: panel(before).progress.running is None and panel(before).filling, "the map")
    before.settle()
    chosen = panel(before).chosen
    before.tab.close()
    after = arrived(sessions, storage)
    after.tab.wait_for_text("its values are not kept")
    assert panel(after).chosen == chosen
    assert chosen is not None
    assert (chosen.across.count, chosen.across.high, chosen.upwards.count) == (4, 1.5, 3)
    assert (chosen.metric, chosen.drawn) == ("mu", True)
    after.press(COMPUTE)
    after.tab.wait_for(lambda: "present design" in shown(after), "the map")
    after.tab.close()


def test_a_ready_map_whose_parameter_does_nothing_says_what_to_do_instead(page: Editing):
    page.set("kind of gains", "noise-matched (outside it)")
    before = panel(page).filling
    page.press(GAINS.question)
    assert any(escaped(MATCHED) in refusal for refusal in page.refusals())
    assert panel(page).filling is before
    assert panel(page).progress.running is None


def test_every_wrong_box_is_named_and_marked_and_the_reason_is_said_once(page: Editing):
    wrong = {"points across": "-3", "highest across": "abc", "seeds per point": "1000000", "lowest upwards": "99"}
    before = {label: panel(page).choice.section for label in wrong}
    for label, text in wrong.items():
        page.set(label, text)
    page.press(COMPUTE)
    (said,) = [one for one in page.refusals() if "points across" in one]
    for label in ("points across", "highest across", "seeds per point", "highest upwards"):
        assert said.count(label) == 1
    section = before["points across"]
    boxes = {one.name: element_id(one.boxes[0]) for one in section.controls if one.boxes}
    marked = {name for name, box in boxes.items() if section.complaint.is_about(box)}
    assert marked == {*wrong, "highest upwards"}
    do(page, lambda: panel(page).choice.write_ready(ANCHOR, page.settings.preset))
    page.settle()
    page.wait_until_accepted()


def replace_names(of: study.Study, names: tuple[str, ...]) -> study.Study:
    """The same study, whose presets are called as those of a file."""
    return dataclasses.replace(of, names=names)


def test_the_table_has_a_line_for_each_point_with_every_metric(page: Editing):
    of = computed(page, ANCHOR)
    page.tab.downloads.clear()
    page.press("save map as", "CSV")
    page.tab.wait_for(lambda: page.tab.downloads, "the file")
    ((name, content),) = page.tab.downloads
    head, *lines = csv.reader(io.StringIO(content.decode()))
    assert name == "map-sigma-lifted.csv"
    assert head[:2] == ["world.anchor.x (m)", "world.anchor.y (m)"]
    assert {line[head.index("preset")] for line in lines} == {"paper-slow"}
    assert all("sampled" in line[head.index("windows")] for line in lines)
    column = head.index("sigma_lifted (m)")
    assert [float(line[column]) for line in lines] == of.values["sigma_lifted"].ravel().tolist()
    assert [float(line[0]) for line in lines] == [of.first[0], of.first[0], of.first[1], of.first[1]]


def test_a_picture_of_a_map_is_written_in_a_job(page: Editing):
    computed(page, SIZE)
    page.tab.downloads.clear()
    page.press("save map as", "SVG")
    page.tab.wait_for(lambda: page.tab.downloads, "the file")
    ((name, content),) = page.tab.downloads
    assert name == "map-sigma-lifted.svg"
    assert content.startswith(b"<?xml")
    assert content.count(b"<image") == 1  # the cells; all else is lines and letters
    filling = panel(page).filling
    assert filling is not None
    assert filling.map is not None
    of = showing.shown(filling, filling.map, page.settings, "sigma_lifted", outdated="", running=False)
    signs, rests = caption(of)
    assert "white cross: present design" in signs
    assert "hatched" not in signs  # no vehicle is chosen
    assert rests.startswith("preset paper-slow; ")
    assert "sampled" in rests


def test_the_number_that_was_moved_last_can_be_put_on_an_axis(page: Editing):
    page.set("range noise σ (m): number", 0.35)
    page.command("Put the last control on the map's axis across")
    first = panel(page).choice.axes[0].read()
    assert first.path == "sensors.noise.range"
    assert first.low < 0.35 < first.high
    assert replace(first, low=0.1).low == 0.1
