"""What the mouse does on the plots: the legends tell the values where it is, and their entries switch curves."""

import dataclasses
import re
import time

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from explorer.charts import Charts, curves, markup, plot_list, plots, pointer
from explorer.charts.pointer import Pointer
from explorer.interaction import BRUSH_STEP, drawn_window
from rangenav import preset
from tests.support.pictures import picture
from tests.support.sent_messages import Page

POSITION = plot_list.ERRORS.plots[0]
GRAMIAN = next(plot for plot in plot_list.OBSERVABILITY.plots if plot.name == "gramian")


class Told:
    """Plots whose box is written as the page's script would."""

    def __init__(self, page: Page, name: str) -> None:
        self.page, self.seen, self.notes = page, picture(name), 0
        self.charts = Charts(page.client, narrow=False, wake=self._wake)
        self.charts.draw(self.seen)
        self._boxes = [m.uuid for m in page.messages if type(m).__name__ == "GuiTextMessage"]

    def _wake(self) -> None:
        self.notes += 1

    def write(self, text: str) -> None:
        """Into the box of the first column, and let the plots take it in."""
        self.page.messages.clear()
        before = self.notes
        self.page.gui._gui_input_handle_from_uuid[self._boxes[0]].value = text
        deadline = time.monotonic() + 5
        while self.notes == before and time.monotonic() < deadline:
            time.sleep(0.005)
        self.charts.cursor(self.seen, 1.0)

    def sent(self, prop: str) -> list:
        """New values of a property since the text was written."""
        updates = [vars(m)["updates"] for m in self.page.messages if type(m).__name__ == "GuiUpdateMessage"]
        return [update[prop] for update in updates if prop in update]

    def live(self) -> str:
        """What changes as time moves."""
        return "".join(text for text in self.sent("content") if markup.FRACTION + ":" in text)


@given(st.text())
def test_no_text_is_an_error_and_only_places_on_the_axis_are_places(text: str):
    heard = Pointer(lambda: None)
    heard.hear(text)
    assert heard.place is None or 0 <= heard.place <= 1
    assert all(re.fullmatch(r"[a-z-]+-\d+", name) for name in heard.clicked())


def test_each_click_counts_once_however_often_and_late_it_is_told():
    heard = Pointer(lambda: None)
    for text in (
        "0.5 10:position-1",
        "0.5 10:position-1 12:gramian-0",
        " 12:gramian-0 13:position-1",
        " 13:position-1",
    ):
        heard.hear(text)
    assert heard.clicked() == ["position-1", "gramian-0", "position-1"]
    assert heard.clicked() == []
    assert heard.place is None


def test_the_newest_brush_counts_once_whichever_way_it_was_drawn():
    heard = Pointer(lambda: None)
    assert heard.brushed() is None
    heard.hear("0.5 20:0.2000-0.5000 21:position-1")
    heard.hear("0.6 20:0.2000-0.5000 21:position-1 25:0.9000-0.6000")
    assert heard.brushed() == (0.6, 0.9)
    assert heard.brushed() is None
    heard.hear("0.6 25:0.9000-0.6000 26:0.3000-0.3000")
    assert heard.brushed() == (0.3, 0.3)
    assert heard.clicked() == ["position-1"]
    for nonsense in ("27:1.2-0.5", "28:0.5", "29:-0.5-0.7", "30:0.1-0.2-0.3", "31:nan-0.2"):
        heard.hear(f" {nonsense}")
        assert heard.brushed() is None


def test_a_flood_of_clicks_is_not_kept():
    heard = Pointer(lambda: None)
    for k in range(1000):
        heard.hear(f" {k + 1}:position-1")
    assert len(heard.clicked()) <= pointer.MAX_CLICKS


def test_the_legends_tell_the_time_under_the_mouse_and_the_values_there(page: Page):
    told = Told(page, "paper-slow")
    duration = float(told.seen.motion.time[-1])
    told.write("0.4000")
    k = int(np.argmin(np.abs(told.seen.motion.time - 0.4 * duration)))
    text = told.live()
    assert f'--position-0:"{curves.number(told.seen.errors.position[k])}"' in text
    assert f'{markup.HOVERED_TIME}:"{0.4 * duration:.2f} s"' in text
    assert f"{markup.HOVERED}:0.4000" in text
    assert "<b>1.00 s</b>" in text  # the scene, and the line that tells of it, stay at the playhead
    told.write("")
    text = told.live()
    k = int(np.argmin(np.abs(told.seen.motion.time - 1.0)))
    assert f'--position-0:"{curves.number(told.seen.errors.position[k])}"' in text
    assert markup.HOVERED not in text


def test_a_millionth_is_told_as_a_millionth_and_a_blind_window_as_blind(page: Page):
    told = Told(page, "circle")
    told.write("0.1000")
    row = plots.gramian(told.seen).read[int(0.1 * told.seen.preset.duration / 0.14)]
    assert 0 < row[2] < 1e-2
    assert f'--gramian-1:"{"< floor" if np.isneginf(row[1]) else curves.number(row[1])}"' in told.live()
    assert '--predicted-0:"blind"' in told.live()
    small = dataclasses.replace(told.seen, errors=dataclasses.replace(told.seen.errors, position=1e-6 * np.ones(4001)))
    page.messages.clear()
    told.charts.draw(small)
    assert '--position-0:"1e-6"' in told.live()


def _shown(told: Told, plot: plots.Plot) -> list[bool]:
    """Of the last description of this plot's curves that was sent."""
    of_plot = [sent for sent in told.sent("series") if len(sent) == 1 + len(plot.curves)]
    return [bool(series["show"]) for series in of_plot[-1][1:]]


def test_a_click_on_an_entry_hides_its_curve_until_the_next_and_redraws_leave_it_hidden(page: Page):
    told = Told(page, "paper-slow")
    told.write(" 1:position-1")
    assert _shown(told, POSITION) == [True, False]
    (header,) = [text for text in told.sent("content") if "rn-plot" in text]
    assert 'data-curve="position-1" aria-pressed="false"' in header
    assert 'data-curve="position-0" aria-pressed="true"' in header
    assert '--position-1:"' not in told.live()
    page.messages.clear()
    told.charts.draw(picture("circle"))  # other axes: every plot is described anew
    first = next(sent for sent in told.sent("series"))
    assert [series["show"] for series in first[1:]] == [True, False]
    told.write(" 2:position-1")
    assert _shown(told, POSITION) == [True, True]


def test_eigenvalues_without_a_name_go_with_the_one_before_them(page: Page):
    told = Told(page, "paper-slow")
    told.write(" 1:gramian-1")
    assert _shown(told, GRAMIAN) == [True, *[False] * 11, True, True]


def test_all_curves_come_back_at_once(page: Page):
    told = Told(page, "paper-slow")
    told.write(" 1:gramian-1 2:position-0")
    page.messages.clear()
    told.charts.show_all()
    assert all(_shown(told, GRAMIAN))
    assert all(_shown(told, POSITION))


def test_what_is_switched_off_is_left_out_of_files(page: Page):
    told = Told(page, "paper-slow")
    told.write(" 1:position-1")
    assert told.charts.plan("position", "csv")().decode().splitlines()[0] == "t (s),error (m)"
    told.write(" 2:position-0")
    with pytest.raises(ValueError, match="no curve of it is shown"):
        told.charts.plan("position", "csv")


def test_clicks_on_nothing_change_nothing(page: Page):
    told = Told(page, "paper-slow")
    told.write(" 1:position-9 2:nothing-0 3:snap-4")
    assert told.sent("series") == [] or not any(len(sent) == 3 for sent in told.sent("series"))


def test_hidden_curves_stay_hidden_when_tabs_are_made_anew(page: Page):
    charts, seen = Charts(page.client, narrow=True), picture("paper-slow")
    charts.draw(seen)
    charts._pointer.hear(" 1:gramian-1")
    charts.cursor(seen, 0.0)
    page.messages.clear()
    charts.show_paper_figures()
    updates = [vars(m)["updates"] for m in page.messages if type(m).__name__ == "GuiUpdateMessage"]
    spectra = [u["series"] for u in updates if len(u.get("series", ())) == 1 + len(GRAMIAN.curves)]
    (sent,) = [series for series in spectra if series[1]["label"] == GRAMIAN.curves[0].label]
    assert [series["show"] for series in sent[1:]] == [True, *[False] * 11, True, True]


@given(st.floats(0.5, 100.0), st.floats(0.0, 1.0))
def test_every_brush_draws_a_window_that_the_flight_has(duration: float, share: float):
    """Also across the whole plot, and on a flight so short that a hundredth of it is no tenth of a second."""
    soft = preset.load("soft")
    drawn = drawn_window(share * duration, duration)
    assert drawn == pytest.approx(min(share * duration, duration - BRUSH_STEP), abs=BRUSH_STEP)
    asked = msgspec.structs.replace(soft.requirement, window=drawn)
    assert msgspec.structs.replace(soft, duration=duration, requirement=asked).requirement.window < duration
