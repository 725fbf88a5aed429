"""What the panels show and read: values survive being shown, and words say what the numbers mean."""

import dataclasses
import math
from collections.abc import Iterator
from typing import Any

import msgspec
import pytest
import viser

from explorer import compute
from explorer.access import open_server
from explorer.panels import presets, verdict
from explorer.panels.controls import Complaint, Dial, LogDial
from explorer.panels.dock import Dock
from explorer.panels.printed import ROWS
from explorer.settings import Printed, Settings, effective
from rangenav import analysis, preset
from rangenav.attitude import Schedule
from tests.wire import Wire

SHIPPED = preset.shipped()


def _nothing() -> None:
    """For controls that nobody moves."""


@pytest.fixture(scope="module")
def client() -> Iterator[viser.ClientHandle]:
    server = open_server("127.0.0.1", 0)
    visitor = Wire(server.get_port())
    visitor.wait_for(server.get_clients, "the connection")
    (found,) = server.get_clients().values()
    yield found
    visitor.close()
    server.stop()


@pytest.fixture(scope="module")
def dock(client: viser.ClientHandle) -> Dock:
    return Dock(client.gui, SHIPPED, "paper-slow", _nothing)


def _computed(name: str, **printed: bool) -> compute.Picture:
    return compute.compute(Settings(preset=SHIPPED[name], printed=Printed(**printed)))


@pytest.mark.parametrize("name", SHIPPED)
def test_every_shipped_preset_is_read_back_as_it_was_written(dock: Dock, name: str):
    """Shown numbers are rounded, those behind them are not: the page computes what the command line does."""
    settings = Settings(preset=SHIPPED[name])
    dock.write(name, settings)
    assert dock.read() == settings


def test_settings_far_outside_the_sliders_are_read_back_as_they_were_written(dock: Dock):
    p = SHIPPED["lissajous"]
    tones = tuple(
        msgspec.structs.replace(t, amplitude=-1234.5678, frequency=77.123456, phase=40.0) for t in p.path.tones
    )
    noise = msgspec.structs.replace(p.sensors.noise, gyro=0.0, accel=1e-9, range=900.0)
    sensors = msgspec.structs.replace(p.sensors, imu_rate=3333.0, range_rate=1234.5, noise=noise)
    attitude = msgspec.structs.replace(p.gains.attitude, k1=999.0, rho1=1e-6, schedule=Schedule(steady=0.123))
    changed = msgspec.structs.replace(
        p,
        path=msgspec.structs.replace(p.path, tones=tones, offset=(1e-7, -3e4, 0.1)),
        sensors=sensors,
        gains=msgspec.structs.replace(p.gains, mode="noise-matched", attitude=attitude),
        guess=msgspec.structs.replace(
            p.guess, state="offset", attitude_angle=-math.pi, gravity_offset=(0.0, 1 / 3, 0.0)
        ),
        seed=2**52 + 1,
    )
    settings = Settings(preset=changed, time_scale=1 / 3, printed=Printed(model=True, body_axes=True))
    dock.write("lissajous", settings)
    assert dock.read() == settings


def test_a_slider_is_widened_for_what_it_must_show(client: viser.ClientHandle):
    dial = Dial(client.gui, "w", (0.0, 1.0), step=0.01, hint="", note=_nothing)
    dial.write(math.pi)
    assert dial.read() == math.pi
    assert dial._slider.max > math.pi
    dial.write(-2.0)
    assert dial._slider.min < -2.0


def test_a_dial_may_show_another_unit_and_still_hold_the_value_exactly(client: viser.ClientHandle):
    dial = Dial(client.gui, "°", (-180.0, 180.0), step=0.1, hint="", note=_nothing, scale=math.degrees(1))
    dial.write(math.pi / 2)
    assert dial._slider.value == 90.0
    assert dial.read() == math.pi / 2
    dial._slider.value = 45.0
    assert dial.read() == pytest.approx(math.pi / 4, rel=1e-15)


def test_a_log_dial_holds_zero_at_its_left_end(client: viser.ClientHandle):
    dial = LogDial(client.gui, "σ", (1e-3, 10.0), hint="", note=_nothing, zero_at_left=True)
    assert dial.read() == 0.0
    dial._slider.value = -1.0
    assert dial.read() == pytest.approx(0.1, rel=1e-15)
    assert dial._slider.label == "σ = 0.1"
    dial._slider.value = dial._slider.min
    assert dial.read() == 0.0


def test_a_complaint_is_words_and_a_sign_and_never_html(client: viser.ClientHandle):
    complaint = Complaint(client.gui)
    complaint.say("<script>alert(1)</script>")
    assert "⚠ &lt;script&gt;" in complaint._line.content


def _row(picture: compute.Picture, name: str) -> str:
    return dict(verdict._rows(picture))[name]


def test_the_verdict_names_what_is_blind_and_why():
    picture = _computed("hover")
    assert "5 of 13" in _row(picture, "rank")
    assert "nothing excites" in _row(picture, "blind")


def test_a_diverged_covariance_is_told_instead_of_errors():
    picture = _computed("hover")
    diverged = dataclasses.replace(picture, summary=dataclasses.replace(picture.summary, diverged=True))
    assert "unobservable, covariance diverges" in _row(diverged, "observer")
    assert "steady error" not in dict(verdict._rows(diverged))
    assert "covariance diverges" in verdict._chips(diverged)


def test_an_eigenvalue_below_the_noise_floor_is_not_given_as_a_number():
    assert "below the noise floor" in _row(_computed("circle"), "least λ(W)")
    assert "noise floor" in _row(_computed("paper-slow"), "least λ(W)")


def test_what_is_not_determined_says_so():
    assert verdict.number(math.nan, "m") == "not determined"
    assert verdict.number(math.inf) == "not determined"
    assert verdict.number(0.12345, "m") == "0.123 m"


def test_the_papers_thrust_is_told():
    assert "14.9 times the weight" in _row(_computed("paper"), "vehicle")


def test_printed_switches_that_are_on_are_labelled():
    assert verdict._chips(_computed("paper-slow")) == ""
    assert "PRINTED: model, body axes" in verdict._chips(_computed("paper-slow", model=True, body_axes=True))


@pytest.mark.parametrize(
    ("switch", "off", "on"),
    [
        ("model", "Off: position error", "never converges"),
        ("excitation", "Off: μ = ", "On: μ reads"),
        ("reduced_row", "Off: the reduced pair", "On: the reduced pair"),
        ("body_axes", "Off: μ = ", "On: μ reads"),
        ("initial_values", "follow from the formula", "drifts away"),
        ("attitude_rate", "Off: the slowest is", "On: the slowest reads"),
    ],
)
def test_each_printed_switch_tells_what_it_does(switch: str, off: str, on: str):
    assert off in ROWS[switch].consequence(_computed("paper-slow"))
    assert on in ROWS[switch].consequence(_computed("paper-slow", **{switch: True}))


def test_every_departure_has_a_row():
    assert set(ROWS) == set(Printed.__struct_fields__)


def test_the_download_is_a_preset_whose_first_lines_state_the_verdict_of_that_very_file():
    shown = effective(Settings(preset=SHIPPED["paper-slow"], time_scale=1.5))
    text = presets.document(Settings(preset=shown)).decode()
    assert preset.loads(text, source="download") == shown
    comments = [line for line in text.splitlines() if line.startswith("#")]
    found = analysis.analyse(shown)
    assert text.startswith(f"# verdict: {found.verdict}; rank {found.rank} of 13")
    assert f"mu = {found.mu:.6g}" in comments[1]
    assert "required: 500" in comments[1]


def test_nothing_of_a_presets_own_text_reaches_the_comments_of_its_download():
    hostile = msgspec.structs.replace(SHIPPED["hover"], title='"\nseed = 7\n# x')
    text = presets.document(Settings(preset=hostile)).decode()
    assert preset.loads(text, source="download") == hostile


def test_a_changed_preset_is_downloaded_under_another_name():
    p: Any = SHIPPED["hover"]
    assert presets.file_name("hover", p, p) == "hover.toml"
    assert presets.file_name("hover", msgspec.structs.replace(p, seed=9), p) == "hover-changed.toml"
