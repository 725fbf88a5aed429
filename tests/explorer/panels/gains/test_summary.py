"""The schedule of k1 on its dials, the summary of the attitude filter's gains, and starts at undesired equilibria."""

import math
from typing import Any

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as tried
from hypothesis import strategies as st
from msgspec.structs import replace

from explorer.model.compute import compute
from explorer.model.settings import Drafts, Settings
from explorer.panels.dock import Dock
from explorer.panels.gains import equilibria, summary
from explorer.widgets.complaint import InvalidInputError
from rangenav import attitude, so3
from rangenav.attitude import SCHEDULED, AttitudeGains, Schedule
from rangenav.gains import Gains
from rangenav.motion import World
from rangenav.number_format import UNBROKEN
from tests.support.page_settings import SHIPPED, SLOW_DRAWS
from tests.support.refreshed import refreshed

pytestmark = [pytest.mark.slow, pytest.mark.filterwarnings("ignore:Do not use the `random` module")]
"""The threads of the websocket use `random` while hypothesis draws."""
FEW = tried(max_examples=40, deadline=None, suppress_health_check=SLOW_DRAWS)
SLOW = Settings(origin="paper-slow", preset=SHIPPED["paper-slow"])


@pytest.fixture(autouse=True)
def _shipped(dock: Dock) -> None:
    """Each test begins with the paper's letters and a shipped preset."""
    dock.gains.use_units("paper")
    dock.write(SLOW)


def _scheduled(plan: Schedule | None, **changes: Any) -> Settings:
    filtered = AttitudeGains(k1=8.0, schedule=plan)
    return replace(SLOW, preset=replace(SLOW.preset, gains=replace(SLOW.preset.gains, attitude=filtered)), **changes)


def test_a_presets_schedule_is_shown_edited_and_kept_while_it_is_off(dock: Dock):
    plan = Schedule(steady=1 / 3, halfway=0.07, memory=math.pi)
    dock.write(_scheduled(plan))
    dials = dock.gains.schedule_dials
    assert dials.dials_section.visible
    assert dials.steady.read() == 1 / 3
    dials.halfway.show(0.1)
    assert refreshed(dock) == _scheduled(replace(plan, halfway=0.1))
    dials.enabled.show(False)
    off = refreshed(dock)
    assert off.preset.gains.attitude.schedule is None
    assert off.drafts.schedule == replace(plan, halfway=0.1)
    assert not dials.dials_section.visible
    dock.write(SLOW)
    dock.write(off)  # as after a reload
    dials.enabled.show(True)
    assert refreshed(dock) == _scheduled(replace(plan, halfway=0.1))


def test_a_schedule_is_off_by_default_and_tells_what_the_theorem_says(dock: Dock):
    dials = dock.gains.schedule_dials
    assert not dials.enabled.read()
    dials.enabled.show(True)
    assert refreshed(dock).preset.gains.attitude.schedule == Schedule()
    dials.steady.show(5.0)
    with pytest.raises(InvalidInputError) as refusal:
        refreshed(dock)
    assert str(refusal.value.__cause__) == "schedule.steady must not exceed k1 (4), got 5"
    assert dials.dials_section.complaint.content


@FEW
@given(
    st.builds(Schedule, steady=st.floats(1e-3, 4.0), halfway=st.floats(1e-4, 1), memory=st.floats(1e-3, 100)),
    st.booleans(),
)
def test_schedules_and_their_drafts_are_read_back_as_they_were_written(dock: Dock, plan: Schedule, on: bool):
    settings = _scheduled(plan) if on else _scheduled(None, drafts=Drafts(schedule=plan))
    dock.write(settings)
    assert refreshed(dock) == settings
    assert msgspec.json.decode(msgspec.json.encode(settings), type=Settings) == settings
    dock.relabel_axes()
    dock.relabel_axes()
    assert refreshed(dock) == settings


def test_the_time_constants_are_shown_and_for_a_schedule_at_both_ends():
    picture = compute(replace(SLOW, preset=replace(SLOW.preset, gains=Gains(attitude=SCHEDULED))))
    text = summary.rates(picture).replace(UNBROKEN, " ")
    for k1 in (SCHEDULED.k1, 0.5):
        expected = attitude.time_constants(AttitudeGains(k1=k1), picture.preset.world)
        assert f"at k1 = {k1:g}" in text
        assert ", ".join(f"{one:.3g}" for one in expected) + " s" in text
    assert text.count("at k1") == 2
    assert summary.rates(compute(SLOW)).count("at k1") == 1


def test_stiff_gains_are_warned_of_with_text_and_a_mark_and_others_are_not():
    stiff = replace(SLOW.preset, gains=Gains(attitude=AttitudeGains(k1=40.0, rho2=0.1)))
    text = summary.rates(compute(replace(SLOW, preset=stiff)))
    assert "▲ The attitude filter is stiff: 425/s times the IMU&#x27;s 5 ms is 2.1, above 1" in text
    assert "▲" not in summary.rates(compute(SLOW))


worlds = st.floats(0.02, math.pi - 0.02).map(lambda a: World(magnetic=(math.sin(a), 0.0, math.cos(a))))
filters = st.builds(AttitudeGains, rho1=st.floats(0.1, 10), rho2=st.floats(1e-3, 1))


@given(filters, worlds)
def test_each_button_starts_where_the_filter_stands_still(gains: AttitudeGains, world: World):
    """σ vanishes there for any attitude: R̂ᵀm and R̂ᵀg turned by R̃ cancel in their weighted sum."""
    truth = so3.exp(np.array([0.3, -0.2, 0.9]))
    m, g = np.array(world.magnetic), np.array(world.gravity)
    for equilibrium in equilibria.undesired_equilibria(gains, world):
        error = so3.exp(math.pi * np.array(equilibrium.axis))
        estimate = error.T @ truth
        sigma = attitude.innovation(estimate, truth.T @ m, truth.T @ g, gains=gains, world=world)
        assert np.linalg.norm(sigma) < 1e-11 * (gains.rho1 + gains.rho2 * g @ g)
        away = min(equilibria.distances(error, equilibria.undesired_equilibria(gains, world)))
        assert away < 1e-7  # a trace of rounding, seen through an arc cosine
        near = so3.exp((math.pi - 0.1) * np.array(equilibrium.axis))
        assert min(equilibria.distances(near, equilibria.undesired_equilibria(gains, world))) <= 0.1 + 1e-9


def test_the_undesired_equilibria_are_described_with_numbers():
    first, second, third = equilibria.undesired_equilibria(AttitudeGains(), World())
    assert first.label == "180° · (0.39, 0, 0.92) · between m and g"
    assert second.label == "180° · (0.92, 0, -0.39) · in their plane, across it"
    assert third.label == "180° · (0, 1, 0) · across both m and g"
