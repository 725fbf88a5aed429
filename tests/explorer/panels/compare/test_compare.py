"""The Compare tab through viser's messages: pin, seeds with progress and cancel, estimators, and bad input."""

import math
import re
import time
from collections.abc import Iterator

import pytest

from explorer.charts import Charts
from explorer.panels.compare import ComparePanel
from explorer.server import SessionServer
from explorer.session import Session
from tests.support.wire import Wire

pytestmark = pytest.mark.slow


BAND = "of these settings"
PRESS = 0.05
"""s: presses of buttons go through a pool of threads, and may be overtaken."""


@pytest.fixture
def comparing(sessions: tuple[int, SessionServer]) -> Iterator[tuple[Wire, Session]]:
    port, server = sessions
    tab = Wire(port)
    tab.wait_for_text("13 of 13")
    yield tab, server.sessions[-1]
    tab.close()


def labels(session: Session) -> list[set[str]]:
    """The labels of the curves of every plot."""
    charts: Charts = session.charts
    shown = [chart for chart in charts.charts if chart.base.pinned_curves]
    return [{curve.label for curve in chart.plot.curves} for chart in shown]


def panel(session: Session) -> ComparePanel:
    return session.dock.compare


def page_text(tab: Wire) -> str:
    return re.sub(r"<[^>]+>", "", tab.text())


def test_a_pinned_run_is_in_every_plot_until_it_is_unpinned(comparing: tuple[Wire, Session]):
    tab, session = comparing
    assert not any("A" in shown for shown in labels(session))
    most = len(labels(session)) - 1  # the motion has no twin, so one plot of the twin has no curve
    tab.press("Pin this run as A")
    tab.wait_for(lambda: sum(any(name.startswith("A") for name in shown) for shown in labels(session)) >= most, "A")
    tab.wait_for_text("A and B have the same settings so far.")
    pinned = panel(session).pinned
    tab.set("range weight q (1/(m⁴ s))", 0.0)
    tab.wait_for(lambda: "Range weight q: 5000 → 1" in page_text(tab), "what was chosen otherwise")
    assert "steady position" in page_text(tab)
    assert panel(session).pinned is pinned
    tab.press("Unpin")
    tab.wait_for(lambda: not any("A" in shown for shown in labels(session)), "no A")


def test_pinning_is_no_step_of_the_history(comparing: tuple[Wire, Session]):
    tab, session = comparing
    depth = session.history.depth
    tab.press("Pin this run as A")
    tab.wait_for_text("A and B have the same settings so far.")
    assert session.history.depth == depth


def test_seeds_give_a_band_which_never_outlives_the_settings(comparing: tuple[Wire, Session]):
    tab, session = comparing
    tab.set("runs", 5)
    time.sleep(PRESS)
    tab.press("Run the noise seeds")
    tab.wait_for_text(f"5 seeds {BAND}")
    tab.wait_for(lambda: sum("5 seeds" in shown for shown in labels(session)) == 4, "four bands")
    tab.set("attitude gain k1 (1/s)", 0.3)
    tab.wait_for_text("the band belonged to others and is gone")
    assert not any("5 seeds" in shown for shown in labels(session))
    assert panel(session).seeds.band is None


def test_moving_the_window_or_the_vehicle_keeps_the_band_for_the_runs_are_the_same(comparing: tuple[Wire, Session]):
    tab, session = comparing
    tab.set("runs", 3)
    time.sleep(PRESS)
    tab.press("Run the noise seeds")
    tab.wait_for_text(f"3 seeds {BAND}")
    tab.set("time window judged δ (s)", 5.0)
    tab.wait_for_text("over δ = 5 s")
    assert sum("3 seeds" in shown for shown in labels(session)) == 4


def test_seeds_can_be_stopped_and_are_stopped_when_the_settings_change(
    comparing: tuple[Wire, Session], monkeypatch: pytest.MonkeyPatch
):
    tab, session = comparing
    stops: list[bool] = []

    def endless(*_: object, progress, cancelled, **__: object):
        while not cancelled():
            progress(0.25)
            time.sleep(0.01)
        stops.append(True)

    monkeypatch.setattr("rangenav.ensemble.seeds", endless)
    tab.press("Run the noise seeds")
    tab.wait_for_text("20 seeds, 25 %")
    tab.press("Stop")
    tab.wait_for(lambda: len(stops) == 1 and session.jobs.running is None, "the job to end")
    tab.wait_for(lambda: "20 seeds, 25 %" not in tab.text(), "its progress to be gone")
    tab.press("Run the noise seeds")
    tab.wait_for_text("20 seeds, 25 %")
    tab.set("range weight q (1/(m⁴ s))", 1.0)
    tab.wait_for(lambda: len(stops) == 2, "the job to end")
    tab.wait_for_text("The settings changed while the seeds ran")
    assert panel(session).seeds.band is None


@pytest.mark.parametrize("value", [0, 101, 2.5, math.nan, math.inf, -1e300])
def test_a_nonsense_number_of_seeds_gets_a_sentence(comparing: tuple[Wire, Session], value: float):
    tab, session = comparing
    tab.set("runs", value)
    time.sleep(PRESS)
    tab.press("Run the noise seeds")
    rule = "must be a whole number between 1 and 100" if math.isfinite(value) else "is not a number"
    tab.wait_for_text(rule)
    assert session.jobs.running is None


def test_estimators_are_drawn_tabulated_and_follow_the_settings(comparing: tuple[Wire, Session]):
    tab, session = comparing
    tab.set("extended Kalman filter (EKF)", True)
    time.sleep(PRESS)
    tab.set("refinement afterwards", True)
    tab.wait_for(lambda: "refined: converged after" in page_text(tab), "the refinement's words")
    assert sum({"EKF", "refined"} <= shown for shown in labels(session)) == 4
    before = page_text(tab)
    run = panel(session).estimators.known.results["refined"][0]
    tab.set("noise seed", 3.0)
    tab.wait_for(lambda: panel(session).estimators.known.results["refined"][0] != run, "another refinement")
    tab.wait_for(lambda: page_text(tab) != before and "at work" not in page_text(tab), "its words")
    tab.set("extended Kalman filter (EKF)", False)
    time.sleep(PRESS)
    tab.set("refinement afterwards", False)
    tab.wait_for_text("Switch one on")
    assert not any({"EKF", "refined"} & shown for shown in labels(session))


def test_a_record_without_ranges_is_refused_by_the_refinement_alone(comparing: tuple[Wire, Session]):
    tab, session = comparing
    tab.set("silent from (s)", 0.0)
    time.sleep(PRESS)
    tab.set("silent for (s)", 100.0)
    time.sleep(PRESS)
    tab.set("refinement afterwards", True)
    tab.wait_for_text("a refinement needs ranges")
    assert "Not shown" not in page_text(tab)
    assert panel(session).estimators.enabled == {"refined"}
