"""The text of a plot names its axes and, for each curve, where it lies and where it ends."""

import numpy as np
import pytest

from explorer.charts import Charts, plot_text
from explorer.charts.plot_list import GROUPS
from explorer.charts.plot_size import PlotSize
from rangenav.number_format import significant
from tests.support.pictures import picture
from tests.support.sent_messages import Page

pytestmark = pytest.mark.slow

PLOTS = [plot for group in GROUPS if not group.slow for plot in group.plots]


def test_every_curve_has_its_range_and_its_last_value() -> None:
    shown = picture("paper-slow")
    for plot in PLOTS:
        drawing = plot.draw(shown)
        text = plot_text.text(plot, drawing, 20.0, drawing.hidden)
        assert text.startswith(f"{plot.title} ({plot.unit}) over {plot.x_name} from 0 to 20 s")
        for column in [k for k in plot.in_legend if k not in drawing.hidden][: plot_text.MOST_CURVES]:
            curve, values = plot.curves[column], drawing.values[:, column]
            (said,) = (part for part in text.split(". ") if part.startswith(f"{curve.label}: "))
            if np.isfinite(values).all() and np.ptp(values) > 0:
                for number in (values.min(), values.max(), values[-1]):
                    assert significant(float(number)) in said, (plot.name, said)


def test_an_empty_plot_says_why_and_a_blind_window_that_it_is_blind() -> None:
    shown = picture("circle")
    predicted = next(plot for plot in PLOTS if plot.name == "predicted")
    assert "lifted: blind throughout" in plot_text.text(predicted, predicted.draw(shown), 20.0)
    hover = picture("hover")
    snap = next(plot for plot in PLOTS if plot.name == "snap")
    assert snap.empty in plot_text.text(snap, snap.draw(hover), 20.0)


def test_a_plot_refers_to_its_text_which_follows_at_rest_and_not_before(page: Page) -> None:
    charts, shown = Charts(page.client, PlotSize()), picture("paper-slow")
    charts.draw(shown)
    assert not any("Position error (m) over t" in str(vars(message)) for message in page.messages)
    position = charts.charts[0]
    assert 'aria-describedby="rn-text-position"' in position.header.content
    page.messages.clear()
    charts.draw_details(shown)
    assert any("Position error (m) over t" in str(vars(message)) for message in page.messages)
