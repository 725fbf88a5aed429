"""Which plots are drawn: those in sight, with the newest picture, and the others as soon as they come into sight."""

import numpy as np
import pytest

from explorer.charts import Charts, plot_list
from explorer.charts.chart import Chart
from explorer.charts.plot_size import PlotSize
from explorer.charts.plot_tabs import OUTDATED
from explorer.model.compute import Picture
from tests.support.pictures import picture
from tests.support.sent_messages import Page

pytestmark = pytest.mark.slow

ERRORS, OBSERVABILITY, DEPTH = (
    frozenset(plot.name for plot in group.plots)
    for group in (plot_list.ERRORS, plot_list.OBSERVABILITY, plot_list.DEPTH)
)


def drawn(charts: Charts) -> set[str]:
    """The names of the plots that have been drawn at least once."""
    return {chart.base.name for chart in charts.charts if chart.drawing is not None}


def chart(charts: Charts, name: str) -> Chart:
    return next(chart for chart in charts.charts if chart.base.name == name)


def shows(charts: Charts, name: str, shown: Picture) -> bool:
    """Whether a plot shows the numbers of a picture."""
    one = chart(charts, name)
    assert one.drawing is not None
    return np.array_equal(one.drawing.values, one.base.draw(shown).values, equal_nan=True)


def test_only_plots_in_sight_are_drawn_and_the_others_when_they_come_into_sight(page: Page) -> None:
    charts, first, second = Charts(page.client, PlotSize()), picture("paper-slow"), picture("circle")
    charts.see(ERRORS)
    charts.draw(first)
    assert drawn(charts) == ERRORS
    charts.draw(second)
    page.messages.clear()
    charts.see(OBSERVABILITY)
    assert drawn(charts) == ERRORS | OBSERVABILITY
    assert shows(charts, "gramian", second)
    assert len(page.updates("data")) >= len(OBSERVABILITY)
    page.messages.clear()
    charts.see(OBSERVABILITY)
    charts.see(ERRORS)  # they show this picture already
    assert page.updates("data") == []


def test_a_plot_that_was_out_of_sight_for_a_while_shows_the_newest_picture(page: Page) -> None:
    charts = Charts(page.client, PlotSize())
    charts.draw(picture("paper-slow"))
    charts.see(OBSERVABILITY)
    charts.draw(picture("circle"))
    charts.draw(picture("hover"))
    assert shows(charts, "position", picture("paper-slow"))
    charts.see(ERRORS)
    assert shows(charts, "position", picture("hover"))


def test_slow_plots_that_come_into_sight_are_drawn_once_nothing_moves(page: Page) -> None:
    charts, example = Charts(page.client, PlotSize()), picture("circle")
    charts.see(ERRORS)
    charts.draw(example)
    charts.draw_details(example)
    assert drawn(charts) == ERRORS
    charts.see(DEPTH)
    assert drawn(charts) == ERRORS | DEPTH
    charts.draw(picture("paper-slow"))
    assert any(OUTDATED in content for content in page.updates("content"))
    assert shows(charts, "scaled", example)
    charts.draw_details(picture("paper-slow"))
    assert shows(charts, "scaled", picture("paper-slow"))


def test_the_cursor_gives_values_of_plots_in_sight_alone(page: Page) -> None:
    charts, example = Charts(page.client, PlotSize()), picture("paper-slow")
    charts.draw(example)
    charts.see(ERRORS)
    page.messages.clear()
    charts.cursor(example, 3.0)
    assert '--position-0:"' in page.live_style()
    assert "--gramian-0" not in page.live_style()
    charts.see(OBSERVABILITY)
    assert '--gramian-0:"' in page.live_style()


def test_the_file_of_a_plot_out_of_sight_is_that_of_the_newest_picture(page: Page) -> None:
    charts, newest = Charts(page.client, PlotSize()), picture("circle")
    charts.draw(picture("paper-slow"))
    charts.see(frozenset())
    charts.draw(newest)
    written = charts.file_writer("position", "csv")().decode().splitlines()
    assert float(written[-1].split(",")[0]) == pytest.approx(newest.preset.duration, abs=0.01)
    charts.draw_details(newest)
    assert charts.file_writer("scaled", "csv")()
