"""The gains on the page in two units: switching changes no bit, and a moved physical value only its own gains."""

import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import settings as tried
from msgspec.structs import replace

from explorer.model import gain_units
from explorer.model.compute import compute
from explorer.model.gain_units import context_of, in_physical_units
from explorer.model.glossary import PHYSICAL_GAINS
from explorer.model.settings import GainUnits, Settings
from explorer.panels.dock import Dock
from explorer.panels.gains import summary
from explorer.widgets.complaint import InvalidInputError
from rangenav.attitude import AttitudeGains, Schedule
from rangenav.gains import Gains
from rangenav.number_format import UNBROKEN
from tests.support.page_settings import SHIPPED, SLOW_DRAWS, page_settings
from tests.support.refreshed import refreshed

pytestmark = [pytest.mark.slow, pytest.mark.filterwarnings("ignore:Do not use the `random` module")]
"""The threads of the websocket use `random` while hypothesis draws."""
FEW = tried(max_examples=12, deadline=None, suppress_health_check=SLOW_DRAWS)
SLOW = Settings(origin="paper-slow", preset=SHIPPED["paper-slow"])
TOUCHED = {
    "range_sigma": {"q"},
    "accel_sigma": {"v.xi", "v.velocity"},
    "gyro_sigma": {"v.position", "v.velocity", "v.gravity"},
    "position_factor": {"v.position"},
    "velocity_factor": {"v.velocity"},
    "position_box": {"p0.position", "p0.xi"},
    "velocity_box": {"p0.velocity", "p0.xi"},
    "gravity_box": {"p0.gravity", "p0.xi"},
    "xi_factor": {"p0.xi"},
    "attitude_time": {"k1"},
    "gravity_weight": {"k1", "rho2"},
}
"""The gains that each physical value decides, from the formulas at the top of rangenav.physical_gains."""


def _choose_units(dock: Dock, units: GainUnits) -> None:
    """Choose units in the menu, as a visitor does."""
    dock.gains.units_choice.show(units)


def _dial(dock: Dock, name: str) -> Any:
    return dock.gains.physical_dials.dials[name]


def _numbers(gains: Gains) -> dict[str, float]:
    """Every gain by its name."""
    r, a = gains.riccati, gains.attitude
    blocks = {f"{n}.{b}": getattr(getattr(r, n), b) for n in ("v", "p0") for b in r.v.__struct_fields__}
    return {"q": r.q, **blocks, "k1": a.k1, "rho1": a.rho1, "rho2": a.rho2}


@pytest.fixture(autouse=True)
def _start_in_paper_units(dock: Dock) -> None:
    """Each test begins with the paper's letters and a shipped preset."""
    dock.gains.use_units("paper")
    dock.write(SLOW)


@FEW
@given(page_settings(), page_settings())
def test_switching_there_and_back_any_number_of_times_changes_no_bit(dock: Dock, before: Settings, settings: Settings):
    dock.gains.use_units("paper")
    dock.write(before)
    for written in (settings, before):
        dock.write(written)
        for units in ("physical", "paper", "physical", "physical"):
            _choose_units(dock, units)
            assert refreshed(dock) == written
            assert refreshed(dock) == written
            assert dock.gains.units == units


def test_gains_with_a_schedule_and_far_outside_the_sliders_survive_the_other_units(dock: Dock):
    gains = Gains(mode="noise-matched", attitude=AttitudeGains(k1=999.0, rho1=1e-6, rho2=1 / 3, schedule=Schedule()))
    settings = replace(SLOW, preset=replace(SLOW.preset, gains=gains))
    dock.write(settings)
    _choose_units(dock, "physical")
    assert refreshed(dock) == settings
    _choose_units(dock, "paper")
    assert refreshed(dock) == settings


@pytest.mark.parametrize("name", PHYSICAL_GAINS)
def test_a_physical_value_that_is_moved_changes_its_gains_and_no_bit_of_the_others(dock: Dock, name: str):
    _choose_units(dock, "physical")
    before = refreshed(dock).preset.gains
    _dial(dock, name).show(0.6 * _dial(dock, name).read())
    after = refreshed(dock)
    changed = {n for n, value in _numbers(after.preset.gains).items() if value != _numbers(before)[n]}
    assert changed == TOUCHED[name]
    # and what is now stored says what was asked, to rounding
    assert getattr(in_physical_units(after.preset.gains, context_of(after)), name) == pytest.approx(
        _dial(dock, name).read(), rel=1e-12
    )


@pytest.mark.parametrize("name", PHYSICAL_GAINS)
def test_a_physical_value_moved_away_and_back_or_reset_leaves_the_presets_own_gains(dock: Dock, name: str):
    _choose_units(dock, "physical")
    refreshed(dock)
    dial = _dial(dock, name)
    good = dial.read()
    dial.show(good / 2)
    assert refreshed(dock) != SLOW
    dial.show(good)
    assert refreshed(dock) == SLOW
    for other in PHYSICAL_GAINS:
        _dial(dock, other).show(0.9 * _dial(dock, other).read())
        refreshed(dock)
    for other in PHYSICAL_GAINS:
        assert _dial(dock, other).mark()
        _dial(dock, other).reset()
        refreshed(dock)
    assert refreshed(dock) == SLOW


def test_another_motion_anchor_or_rate_gives_the_same_gains_other_physical_values(dock: Dock):
    _choose_units(dock, "physical")
    _dial(dock, "range_sigma").show(0.3)
    gains = refreshed(dock).preset.gains
    for change in (
        lambda: dock.motion.timing.time_scale.show(3.0),
        lambda: dock.world.move_anchor((4.0, 5.0, 6.0)),
        lambda: dock.sensors.range_rate.show(20.0),
        lambda: dock.sensors.imu_rate.show(700.0),
    ):
        shown = (
            _dial(dock, "range_sigma").read(),
            _dial(dock, "position_factor").read(),
            _dial(dock, "gyro_sigma").read(),
        )
        change()
        settings = refreshed(dock)
        assert settings.preset.gains == gains
        physical = in_physical_units(gains, context_of(settings))
        assert all(_dial(dock, name).read() == getattr(physical, name) for name in PHYSICAL_GAINS)
        assert shown != (physical.range_sigma, physical.position_factor, physical.gyro_sigma)
    _choose_units(dock, "paper")
    assert refreshed(dock).preset.gains == gains


def test_a_physical_value_moved_together_with_the_path_means_what_it_says_on_the_new_path(dock: Dock):
    _choose_units(dock, "physical")
    before = refreshed(dock)
    dock.world.move_anchor((4.0, 5.0, 6.0))
    _dial(dock, "range_sigma").show(0.5)
    after = refreshed(dock)
    at = context_of(after).at
    variance = at.distance**2 * 0.5**2 + 0.5**4 / 2
    assert after.preset.gains.riccati.q == pytest.approx(after.preset.sensors.range_rate / variance, rel=1e-12)
    assert replace(after.preset.gains.riccati, q=1.0) == replace(before.preset.gains.riccati, q=1.0)
    assert refreshed(dock) == after


def test_everything_reset_at_once_is_the_preset_to_the_last_bit(dock: Dock):
    _choose_units(dock, "physical")
    refreshed(dock)
    for name in PHYSICAL_GAINS:
        _dial(dock, name).show(0.8 * _dial(dock, name).read())
        refreshed(dock)
    dock.motion.timing.time_scale.show(3.0)
    refreshed(dock)
    dock.form.reset_all()
    assert refreshed(dock) == SLOW


@pytest.mark.parametrize("far", [1e280, 1e-280, math.nextafter(0, 1), 1e40])
def test_a_physical_value_of_any_size_is_a_sentence_and_never_an_overflow(dock: Dock, far: float):
    _choose_units(dock, "physical")
    good = refreshed(dock).preset.gains
    for name in PHYSICAL_GAINS:
        shown = _dial(dock, name).read()
        _dial(dock, name).show(far)
        with pytest.raises(InvalidInputError) as refusal:
            refreshed(dock)
        assert PHYSICAL_GAINS[name].label in str(refusal.value.__cause__)
        assert dock.gains.physical_dials.sections[name].complaint.content
        _dial(dock, name).show(shown)
        assert refreshed(dock).preset.gains == good


def test_a_path_without_a_typical_state_changes_no_gain_and_says_so(dock: Dock, monkeypatch: pytest.MonkeyPatch):
    _choose_units(dock, "physical")
    good = refreshed(dock)

    def nowhere(settings: Settings) -> gain_units.GainContext:
        raise ValueError("distance must lie between 0.001 and 100000 m, got 3e+07")

    monkeypatch.setattr("explorer.panels.gains.context_of", nowhere)
    dock.motion.timing.time_scale.show(2.0)
    assert refreshed(dock).preset.gains == good.preset.gains
    assert "the path&#x27;s typical distance must lie" in dock.gains.physical_dials.noise.complaint.content
    _dial(dock, "range_sigma").show(0.5)
    with pytest.raises(InvalidInputError):
        refreshed(dock)
    _choose_units(dock, "paper")
    monkeypatch.undo()
    dock.motion.timing.time_scale.show(1.0)
    assert refreshed(dock).preset.gains != good.preset.gains


def test_only_the_units_in_use_are_on_the_page_and_only_what_the_mode_uses(dock: Dock):
    def shown() -> tuple[bool, ...]:
        panels = (dock.gains.paper_dials, dock.gains.physical_dials)
        return tuple(s.visible for p in panels for s in (p.noise, p.attitude))

    refreshed(dock)
    assert shown() == (True, True, False, False)
    dock.gains.mode.show("noise-matched")
    refreshed(dock)
    assert shown() == (False, True, False, False)
    assert "own dials are not shown" in dock.gains.mode_line.content
    _choose_units(dock, "physical")
    refreshed(dock)
    assert shown() == (False, False, False, True)
    dock.gains.mode.show("constant")
    refreshed(dock)
    assert shown() == (False, False, True, True)
    assert "as the theorem assumes" in dock.gains.mode_line.content


def test_the_other_units_are_in_a_table(dock: Dock):
    picture = compute(SLOW)
    dock.gains.draw(picture)
    physical = in_physical_units(SLOW.preset.gains, context_of(SLOW))
    assert f"{physical.range_sigma:.4g}{UNBROKEN}m" in dock.gains.other_units_table.content
    assert dock.gains.other_units_section.label == "The same as physical quantities"
    _choose_units(dock, "physical")
    refreshed(dock)
    dock.gains.draw(picture)
    assert "5000" in dock.gains.other_units_table.content
    assert all(
        dock.gains.other_units_table.content.count(f">{letter}<") == 1
        for letter in ("initial variance P₀(ξ)", "process noise V(g)", "attitude gain k1")
    )
    assert dock.gains.other_units_section.label == "The same in the paper's letters"


@pytest.mark.parametrize("size", [1e-14, 1e-100, 1e-161])
def test_a_world_in_which_gains_have_no_physical_values_says_so_and_changes_none(dock: Dock, size: float):
    world = replace(SLOW.preset.world, gravity=(0.0, 0.0, size))
    weightless = replace(SLOW, preset=replace(SLOW.preset, world=world))
    _choose_units(dock, "physical")
    dock.write(weightless)
    assert refreshed(dock).preset.gains == weightless.preset.gains
    assert "no physical values" in dock.gains.physical_dials.noise.complaint.content
    assert "not converted" in summary.in_other_units(compute(weightless), "paper")
    dock.write(SLOW)
    assert refreshed(dock) == SLOW
    assert not dock.gains.physical_dials.noise.complaint.content
