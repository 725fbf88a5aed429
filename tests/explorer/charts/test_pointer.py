"""The mouse on the plots: the legends show the values at its position, and clicks on their entries hide curves."""

import dataclasses
import re
import time

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from explorer.charts import Charts, markup, plot_list, plots, pointer
from explorer.charts.plot_size import PlotSize
from explorer.charts.pointer import Pointer
from explorer.session.interaction import BRUSH_STEP, drawn_window
from rangenav import preset
from rangenav.number_format import significant
from tests.support.pictures import picture
from tests.support.sent_messages import Page

pytestmark = pytest.mark.slow


POSITION = plot_list.ERRORS.plots[0]
GRAMIAN = next(plot for plot in plot_list.OBSERVABILITY.plots if plot.name == "gramian")


class PlotsUnderMouse:
    """Plots whose hidden text box is written as the page's script would write it."""

    def __init__(self, page: Page, name: str, *, two_panels: bool = True) -> None:
        self.page, self.picture, self.wakes = page, picture(name), 0
        self.charts = Charts(page.client, PlotSize(two_panels=two_panels), wake=self._wake)
        self.charts.draw(self.picture)

    def _wake(self) -> None:
        self.wakes += 1

    def write(self, text: str) -> None:
        """Into the box of the first panel; then the session's loop comes round."""
        self.page.messages.clear()
        before = self.wakes
        self.page.type_text(pointer.LABEL, text)
        deadline = time.monotonic() + 5
        while self.wakes == before and time.monotonic() < deadline:
            time.sleep(0.005)
        self.charts.cursor(self.picture, 1.0)


@given(st.text())
def test_no_text_is_an_error_and_only_places_on_the_axis_are_places(text: str):
    received = Pointer(lambda: None)
    received.receive(text)
    assert received.fraction is None or 0 <= received.fraction <= 1
    assert all(re.fullmatch(r"[a-z-]+-\d+", name) for name in received.take_clicks())


def test_each_click_counts_once_however_often_and_late_it_is_repeated():
    received = Pointer(lambda: None)
    for text in (
        "0.5 10:position-1",
        "0.5 10:position-1 12:gramian-0",
        " 12:gramian-0 13:position-1",
        " 13:position-1",
    ):
        received.receive(text)
    assert received.take_clicks() == ["position-1", "gramian-0", "position-1"]
    assert received.take_clicks() == []
    assert received.fraction is None


def test_the_newest_brush_counts_once_whichever_way_it_was_drawn():
    received = Pointer(lambda: None)
    assert received.take_brush() is None
    received.receive("0.5 20:0.2000-0.5000 21:position-1")
    received.receive("0.6 20:0.2000-0.5000 21:position-1 25:0.9000-0.6000")
    assert received.take_brush() == (0.6, 0.9)
    assert received.take_brush() is None
    received.receive("0.6 25:0.9000-0.6000 26:0.3000-0.3000")
    assert received.take_brush() == (0.3, 0.3)
    assert received.take_clicks() == ["position-1"]
    for nonsense in ("27:1.2-0.5", "28:0.5", "29:-0.5-0.7", "30:0.1-0.2-0.3", "31:nan-0.2"):
        received.receive(f" {nonsense}")
        assert received.take_brush() is None


def test_a_flood_of_clicks_is_not_kept():
    received = Pointer(lambda: None)
    for k in range(1000):
        received.receive(f" {k + 1}:position-1")
    assert len(received.take_clicks()) <= pointer.MAX_CLICKS


def test_the_legends_give_the_values_under_the_mouse_and_all_plots_the_time_there(page: Page):
    mouse = PlotsUnderMouse(page, "paper-slow")
    duration = float(mouse.picture.motion.time[-1])
    mouse.write("0.4000")
    k = int(np.argmin(np.abs(mouse.picture.motion.time - 0.4 * duration)))
    text = page.live_style()
    assert f'--position-0:"{significant(mouse.picture.errors.position[k])}"' in text
    assert f'{markup.HOVERED_TIME}:"{0.4 * duration:.2f} s"' in text
    assert f"{markup.HOVERED}:0.4000" in text
    assert "<b>1.00 s</b>" in text  # the scene and the status line stay at the playhead
    mouse.write("")
    text = page.live_style()
    k = int(np.argmin(np.abs(mouse.picture.motion.time - 1.0)))
    assert f'--position-0:"{significant(mouse.picture.errors.position[k])}"' in text
    assert markup.HOVERED not in text


def test_a_millionth_is_written_as_a_millionth_and_a_blind_window_as_blind(page: Page):
    mouse = PlotsUnderMouse(page, "circle")
    mouse.write("0.1000")
    row = plots.gramian(mouse.picture).values[int(0.1 * mouse.picture.preset.duration / 0.14)]
    assert 0 < row[2] < 1e-2
    assert f'--gramian-1:"{"< floor" if np.isneginf(row[1]) else significant(row[1])}"' in page.live_style()
    assert '--predicted-0:"blind"' in page.live_style()
    errors = dataclasses.replace(mouse.picture.errors, position=1e-6 * np.ones(4001))
    small = dataclasses.replace(mouse.picture, errors=errors)
    page.messages.clear()
    mouse.charts.draw(small)
    assert '--position-0:"1e-6"' in page.live_style()


def _shown(page: Page, plot: plots.Plot) -> list[bool]:
    """Which curves of a plot are shown, by the last description of them that was sent."""
    of_plot = [sent for sent in page.updates("series") if len(sent) == 1 + len(plot.curves)]
    return [bool(series["show"]) for series in of_plot[-1][1:]]


def test_a_click_on_an_entry_hides_its_curve_until_the_next_and_redraws_leave_it_hidden(page: Page):
    mouse = PlotsUnderMouse(page, "paper-slow")
    mouse.write(" 1:position-1")
    assert _shown(page, POSITION) == [True, False]
    (header,) = [text for text in page.updates("content") if "rn-plot" in text]
    assert 'data-curve="position-1" aria-pressed="false"' in header
    assert 'data-curve="position-0" aria-pressed="true"' in header
    assert '--position-1:"' not in page.live_style()
    page.messages.clear()
    mouse.charts.draw(picture("circle"))  # other axes: every plot is described anew
    first = next(sent for sent in page.updates("series"))
    assert [series["show"] for series in first[1:]] == [True, False]
    mouse.write(" 2:position-1")
    assert _shown(page, POSITION) == [True, True]


def test_eigenvalues_without_a_label_are_switched_with_the_labelled_one_before_them(page: Page):
    mouse = PlotsUnderMouse(page, "paper-slow")
    mouse.write(" 1:gramian-1")
    assert _shown(page, GRAMIAN) == [True, *[False] * 11, True, True]


def test_all_curves_come_back_at_once(page: Page):
    mouse = PlotsUnderMouse(page, "paper-slow")
    mouse.write(" 1:gramian-1 2:position-0")
    page.messages.clear()
    mouse.charts.show_all_curves()
    assert all(_shown(page, GRAMIAN))
    assert all(_shown(page, POSITION))


def test_what_is_switched_off_is_left_out_of_files(page: Page):
    mouse = PlotsUnderMouse(page, "paper-slow")
    mouse.write(" 1:position-1")
    assert mouse.charts.file_writer("position", "csv")().decode().splitlines()[0] == "t (s),error (m; log axis)"
    mouse.write(" 2:position-0")
    with pytest.raises(ValueError, match="no curve of it is shown"):
        mouse.charts.file_writer("position", "csv")


def test_clicks_on_nothing_change_nothing(page: Page):
    mouse = PlotsUnderMouse(page, "paper-slow")
    mouse.write(" 1:position-9 2:nothing-0 3:snap-4")
    assert page.updates("series") == [] or not any(len(sent) == 3 for sent in page.updates("series"))


def test_hidden_curves_stay_hidden_when_tabs_are_made_anew(page: Page):
    mouse = PlotsUnderMouse(page, "paper-slow", two_panels=False)
    mouse.write(" 1:gramian-1")
    page.messages.clear()
    mouse.charts.show_paper_figures()
    spectra = [lines for lines in page.updates("series") if len(lines) == 1 + len(GRAMIAN.curves)]
    (sent,) = [series for series in spectra if series[1]["label"] == GRAMIAN.curves[0].label]
    assert [series["show"] for series in sent[1:]] == [True, *[False] * 11, True, True]


@given(st.floats(0.5, 100.0), st.floats(0.0, 1.0))
def test_every_brush_draws_a_window_that_the_flight_has(duration: float, share: float):
    """This includes brushes across the whole plot, and flights so short that 1 % of them is less than 0.1 s."""
    soft = preset.load("soft")
    drawn = drawn_window(share * duration, duration)
    assert drawn == pytest.approx(min(share * duration, duration - BRUSH_STEP), abs=BRUSH_STEP)
    asked = msgspec.structs.replace(soft.requirement, window=drawn)
    assert msgspec.structs.replace(soft, duration=duration, requirement=asked).requirement.window < duration
