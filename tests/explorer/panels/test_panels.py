"""The panels: values that are shown are read back exactly, and texts state what the numbers mean."""

import dataclasses
import html
import math
import threading
import time
from queue import Queue
from typing import Any
from unittest.mock import MagicMock

import msgspec
import pytest
import viser

from explorer.model import compute
from explorer.model.jobs import Jobs
from explorer.model.settings import Printed, Settings, effective
from explorer.panels import figures, verdict
from explorer.panels.dock import Dock
from explorer.panels.presets.printed import MISPRINTS
from explorer.panels.presets.repair import RepairPanel
from explorer.panels.sensors import CUSTOM, SensorChoice, SensorsPanel
from explorer.storage import preset_file
from explorer.widgets.complaint import Complaint, InvalidInputError
from explorer.widgets.dials import Dial, LogDial
from explorer.widgets.form import Form
from explorer.widgets.section import Section
from rangenav import analysis, certificate, preset, range_fit, sensors
from rangenav.attitude import Schedule
from rangenav.certificate.figures import Figures
from rangenav.progress import CancelledError
from rangenav.range_fit import RangeFit
from rangenav.repair import Repair
from rangenav.sensors import Noise, Sensors
from rangenav.sensors.sensor_sets import CATALOGUE, SensorSet
from rangenav.signals import Formula, Multisine, Tone
from rangenav.vehicle import FREE
from tests.support.page_settings import EVERYTHING, SHIPPED
from tests.support.refreshed import refreshed
from tests.support.wire import Wire

pytestmark = pytest.mark.slow


def _nothing() -> None:
    """For a form whose controls nobody moves."""


def _computed(name: str, **printed: bool) -> compute.Picture:
    return compute.compute(Settings(preset=SHIPPED[name], printed=Printed(**printed)))


@pytest.mark.parametrize("name", SHIPPED)
def test_every_shipped_preset_is_read_back_as_it_was_written(dock: Dock, name: str):
    """The page rounds the numbers that it shows, and computes with the exact ones, as the command line does."""
    settings = Settings(origin=name, preset=SHIPPED[name])
    dock.write(settings)
    assert refreshed(dock) == settings


def test_settings_far_outside_the_sliders_are_read_back_as_they_were_written(dock: Dock):
    p = SHIPPED["lissajous"]
    assert isinstance(p.path, Multisine)
    tones = tuple(
        msgspec.structs.replace(t, amplitude=-1234.5678, frequency=77.123456, phase=40.0) for t in p.path.tones
    )
    noise = msgspec.structs.replace(p.sensors.noise, gyro=0.0, accel=1e-9, range=900.0)
    sensing = msgspec.structs.replace(p.sensors, imu_rate=3333.0, range_rate=1234.5, noise=noise)
    attitude = msgspec.structs.replace(p.gains.attitude, k1=999.0, rho1=1e-6, schedule=Schedule(steady=0.123))
    changed = msgspec.structs.replace(
        p,
        path=msgspec.structs.replace(p.path, tones=tones, offset=(1e-7, -3e4, 0.1)),
        sensors=sensing,
        gains=msgspec.structs.replace(p.gains, mode="noise-matched", attitude=attitude),
        guess=msgspec.structs.replace(
            p.guess, state="offset", attitude_angle=-math.pi, gravity_offset=(0.0, 1 / 3, 0.0)
        ),
        seed=2**52 + 1,
    )
    settings = Settings(
        origin="lissajous", preset=changed, time_scale=1 / 3, printed=Printed(model=True, body_axes=True)
    )
    dock.write(settings)
    assert refreshed(dock) == settings


def _with_sensors(name: str, **changes: Any) -> Settings:
    p = SHIPPED[name]
    return Settings(
        origin=name, preset=msgspec.structs.replace(p, sensors=msgspec.structs.replace(p.sensors, **changes))
    )


def test_densities_and_what_the_paper_does_not_model_are_read_back_as_they_were_written(dock: Dock):
    noise = Noise(gyro=0.005 / 57.3, accel=1 / 300, mag=0.02, range=0.0, imu_unit="density")
    settings = _with_sensors("paper", noise=noise, unmodelled=EVERYTHING)
    dock.write(settings)
    assert refreshed(dock) == settings
    dock.write(Settings(origin="paper", preset=SHIPPED["paper"]))
    assert refreshed(dock) == Settings(origin="paper", preset=SHIPPED["paper"])


def test_the_density_switch_turns_the_numbers_and_not_the_noise_and_back_to_the_last_bit(dock: Dock):
    settings = _with_sensors("paper", noise=Noise(gyro=1 / 3, accel=1 / 7))
    dock.write(settings)
    folder = dock.sensors.noise
    folder.as_density.show(True)
    turned = refreshed(dock).preset.sensors
    assert turned.noise == sensors.in_unit(Noise(gyro=1 / 3, accel=1 / 7), "density", rate=200.0)
    assert folder.groups["density"].visible
    assert not folder.groups["sample"].visible
    assert "at 200 Hz: 0.3333 rad/s per sample" in folder.other_unit_line.content
    assert refreshed(dock).preset.sensors == turned  # and stays so
    folder.as_density.show(False)
    assert refreshed(dock) == settings


def test_as_a_density_the_noise_is_kept_when_the_rate_changes_and_then_turned_back_at_the_new_rate(dock: Dock):
    noise = Noise(gyro=1e-3, accel=1e-2, imu_unit="density")
    dock.write(_with_sensors("paper", noise=noise))
    dock.sensors.imu_rate.show(800.0)
    assert refreshed(dock).preset.sensors.noise == noise
    dock.sensors.noise.as_density.show(False)
    assert refreshed(dock).preset.sensors.noise == sensors.in_unit(noise, "sample", rate=800.0)


def _pick(panel: SensorsPanel, name: str) -> None:
    """As a visitor would, who moves the menu and nothing else."""
    panel.sensor_set.show(name)


@pytest.mark.parametrize("entry", CATALOGUE, ids=lambda entry: entry.name)
def test_a_picked_sensor_set_replaces_everything_but_the_seed_and_is_described(dock: Dock, entry: SensorSet):
    dock.write(_with_sensors("soft", unmodelled=EVERYTHING))
    panel = dock.sensors
    assert panel.sensor_set.read() == CUSTOM
    _pick(panel, entry.name)
    assert refreshed(panel) == SensorChoice(entry.sensors, SHIPPED["soft"].seed)
    assert panel.sensor_set.read() == entry.name
    assert html.escape(entry.summary) in panel.set_text.content
    assert panel.effects.description.visible == bool(sensors.effect_sentences(entry.sensors))
    panel.range_rate.show(17.0)
    assert refreshed(panel).sensors == msgspec.structs.replace(entry.sensors, range_rate=17.0)
    assert panel.sensor_set.read() == CUSTOM
    _pick(panel, entry.name)  # and it may be picked again
    assert refreshed(panel).sensors == entry.sensors


def test_every_effect_that_is_on_is_described_outside_its_closed_folder(dock: Dock):
    dock.write(_with_sensors("soft", unmodelled=EVERYTHING))
    refreshed(dock)
    description = dock.sensors.effects.description
    assert description.visible
    for sentence in sensors.effect_sentences(Sensors(unmodelled=EVERYTHING)):
        assert html.escape(sentence) in description.content
    dock.write(Settings(origin="soft", preset=SHIPPED["soft"]))
    assert not description.visible


def test_a_slider_is_widened_for_what_it_must_show(section: Section):
    dial = Dial(section, "w", (0.0, 1.0), step=0.01, hint="")
    dial.show(math.pi)
    assert dial.read() == math.pi
    assert dial.handle.max > math.pi
    dial.show(-2.0)
    assert dial.handle.min < -2.0


def test_a_dial_may_show_another_unit_and_still_hold_the_value_exactly(section: Section):
    dial = Dial(section, "°", (-180.0, 180.0), step=0.1, hint="", scale=math.degrees(1))
    dial.show(math.pi / 2)
    assert dial.handle.value == 90.0
    assert dial.read() == math.pi / 2
    dial.handle.value = 45.0
    assert dial.read() == pytest.approx(math.pi / 4, rel=1e-15)


def test_a_control_has_been_moved_by_its_visitor_and_not_by_the_page(client: viser.ClientHandle, visitor: Wire):
    woken = threading.Event()
    form = Form(client.gui, woken.set)
    first, second = (LogDial(Section(form), label, (1e-3, 10.0), hint="") for label in ("first moved", "second moved"))
    form.refresh()
    first.handle.value = 0.5
    second.show(3.0)
    form.refresh()
    assert form.last_moved == ""
    visitor.wait_for(lambda: any(p.get("label") == second.name for p in list(visitor.elements.values())), "the sliders")
    for dial in (first, second):
        woken.clear()
        visitor.set(dial.name, -1.0)
        assert woken.wait(10.0)
        form.refresh()
        assert dial.read() == pytest.approx(0.1, rel=1e-15)
        assert form.last_moved == dial.name
    first.handle.value = 0.5
    form.refresh()
    assert form.last_moved == second.name


def test_a_log_dial_holds_zero_at_its_left_end(section: Section):
    dial = LogDial(section, "σ", (1e-3, 10.0), hint="", zero_at_left=True)
    assert dial.read() == 0.0
    dial.handle.value = -1.0
    assert dial.read() == pytest.approx(0.1, rel=1e-15)
    dial.mark()
    assert dial.text == "0.1"
    dial.handle.value = dial.handle.min
    assert dial.read() == 0.0
    for value in (1e-3, 1e-7):
        dial.show(value)
        assert dial.read() == value
        dial.handle.value = dial.handle.min
        assert dial.read() == 0.0


def test_a_complaint_is_text_and_a_sign_and_never_html(client: viser.ClientHandle):
    complaint = Complaint(client.gui)
    complaint.say("<script>alert(1)</script>")
    assert "⚠ &lt;script&gt;" in complaint.content


def _row(picture: compute.Picture, name: str) -> str:
    return dict(figures.rows(picture))[name]


def test_the_verdict_names_what_is_blind_and_why():
    picture = _computed("hover")
    assert "5 of 13" in _row(picture, "rank")
    assert "nothing excites" in _row(picture, "blind")


def test_a_diverged_observer_is_reported_instead_of_errors():
    picture = _computed("hover")
    reason = {"diverged": True, "divergence": "its own 1-σ is 300 m"}
    diverged = dataclasses.replace(picture, summary=dataclasses.replace(picture.summary, **reason))
    assert _row(diverged, "observer") == "✕ diverged: its own 1-σ is 300 m"
    assert "steady error" not in dict(figures.rows(diverged))
    assert "⚠ diverged" in figures.chips(diverged)


def test_the_verdict_has_the_fit_of_the_ranges_whether_or_not_the_errors_mean_something():
    """Settled, not settled, blind, diverged, lost."""
    blind, seen = _computed("hover"), _computed("paper-slow").at_rest
    diverged = dataclasses.replace(blind, summary=dataclasses.replace(blind.summary, diverged=True))
    lost = RangeFit(word="lost", factor=None)
    said = f"{blind.summary.fit.summary(blind=True)} (constant gains)"
    assert _row(blind, "ranges") == _row(diverged, "ranges") == said
    assert ", and the ranges do not determine the position" in said
    assert _row(seen, "ranges") == f"{range_fit.WHITE} (constant gains); predicted position ±1.81 m"
    lost_run = dataclasses.replace(seen, summary=dataclasses.replace(seen.summary, fit=lost))
    assert _row(lost_run, "ranges").startswith("lost (")


def test_an_eigenvalue_below_the_noise_floor_is_not_given_as_a_number():
    assert "below the noise floor" in _row(_computed("circle"), "least λ(W)")
    assert "noise floor" in _row(_computed("paper-slow"), "least λ(W)")


def test_what_is_not_determined_says_so():
    assert figures.number(math.nan, "m") == "not determined"
    assert figures.number(math.inf) == "not determined"
    assert figures.number(0.12345, "m") == "0.123 m"
    assert figures.number(1.02e-15, "m") == "0 m"
    assert figures.number(1.02e-15) == "1.02e-15"
    assert figures.number(1251.0, "m²/s⁷") == "1251 m²/s⁷"
    assert figures.number(5.62e6) == "5.62e6"


def test_the_papers_thrust_is_shown():
    assert "14.9 times the weight" in _row(_computed("paper"), "vehicle")


def test_printed_switches_that_are_on_are_labelled():
    assert figures.chips(_computed("paper-slow")) == ""
    assert "PRINTED: model, body axes" in figures.chips(_computed("paper-slow", model=True, body_axes=True))


@pytest.mark.parametrize(
    ("switch", "off", "on"),
    [
        ("model", "Off: the mean position error", "never converges"),
        ("excitation", "Off: μ = ", "On: μ reads"),
        (
            "reduced_row",
            "Off: the least eigenvalue of the reduced pair",
            "On: the least eigenvalue of the reduced pair",
        ),
        ("body_axes", "Off: μ = ", "On: μ reads"),
        ("initial_values", "follow from the formula", "drifts away"),
        ("attitude_rate", "Off: the slowest time constant", "On: the slowest time constant"),
    ],
)
def test_each_printed_switch_tells_what_it_does(switch: str, off: str, on: str):
    assert off in MISPRINTS[switch].consequence(_computed("paper-slow"))
    assert on in MISPRINTS[switch].consequence(_computed("paper-slow", **{switch: True}))


def _verdict_shown(picture: compute.Picture) -> str:
    gui = MagicMock()
    verdict.VerdictPanel(gui, {}).draw(picture)
    return gui.add_html.return_value.content


def test_the_verdict_of_sampled_windows_is_marked_until_all_windows_are_judged():
    moving = _computed("paper-slow")
    assert moving.analysis.proof is None
    sampled, proven = _verdict_shown(moving), _verdict_shown(moving.proven())
    assert "● ≈ observable" in sampled
    assert "≈" not in proven
    assert "● observable" in proven
    assert "1.81 m" in proven


def test_a_folded_verdict_is_its_line_alone_until_it_is_unfolded_or_proven():
    gui, moving = MagicMock(), _computed("hover")
    panel, shown = verdict.VerdictPanel(gui, {}), gui.add_html.return_value
    panel.fold(True)
    panel.draw(moving)
    assert "≈ blind" in shown.content
    assert "all figures" not in shown.content
    panel.fold(False)
    assert "all figures" in shown.content
    panel.fold(True)
    panel.draw(moving.proven())
    assert "all figures" in shown.content


def test_the_dock_replaces_the_verdict_of_sampled_windows_as_soon_as_the_other_is_there(dock: Dock):
    shown: list[compute.Picture] = []
    dock.verdict.draw = shown.append  # pyright: ignore[reportAttributeAccessIssue]
    picture = _computed("hover")
    dock.prove(picture)
    for _ in range(200):
        dock.form.deliver()
        if shown:
            break
        time.sleep(0.05)
    assert [one.analysis.proof is not None for one in shown] == [True]
    assert shown[0].settings == picture.settings


def test_the_proof_of_an_older_picture_is_not_wanted_once_another_is_proven(dock: Dock):
    with pytest.raises(CancelledError):
        _computed("trefoil").proven(lambda: True)
    older, wanted = MagicMock(), Queue()
    older.proven = wanted.put
    dock.prove(older)
    cancelled = wanted.get(timeout=5.0)
    assert not cancelled()
    dock.prove(_computed("hover"))
    assert cancelled()


def test_the_download_is_a_preset_whose_first_lines_state_the_verdict_of_that_very_file():
    shown = effective(Settings(preset=SHIPPED["paper-slow"], time_scale=1.5))
    text = preset_file.document(Settings(preset=shown)).decode()
    assert preset.loads(text, source="download") == shown
    comments = [line for line in text.splitlines() if line.startswith("#")]
    result = analysis.analyse(shown)
    assert text.startswith(f"# verdict: {result.verdict.word}; rank {result.rank} of 13")
    assert f"mu = {result.mu:.6g}" in comments[1]
    assert "required: 500" in comments[1]


def test_a_download_says_every_window_only_of_what_is_proven():
    """Nothing bounds the snap of this formula, so its μ is that of sampled windows."""
    x, y, z = (f"sin({w}*t)*(1 - exp(-sqrt((t - 9)*(t - 9)/9 + 1e-3)**32))" for w in (2, 3, 5))
    steep = Formula(x=x, y=y, z=z)
    p = msgspec.structs.replace(SHIPPED["soft"], path=steep, angular_velocity=Multisine(), vehicle=FREE)
    sampled = preset_file.verdict_comments(p)
    assert "over sampled windows of 12 s" in sampled
    assert "every window" not in sampled
    proven = preset_file.verdict_comments(SHIPPED["soft"])
    assert "over every window of 12 s" in proven
    assert "required: 50: met" in proven


def test_nothing_of_a_presets_own_text_reaches_the_comments_of_its_download():
    hostile = msgspec.structs.replace(SHIPPED["hover"], title='" # x = 7', story='"\nseed = 7\n# x')
    text = preset_file.document(Settings(preset=hostile)).decode()
    assert preset.loads(text, source="download") == hostile


def test_a_changed_preset_is_downloaded_under_another_name():
    p: Any = SHIPPED["hover"]
    assert preset_file.file_name("hover", p, p) == "hover.toml"
    assert preset_file.file_name("hover", msgspec.structs.replace(p, seed=9), p) == "hover-changed.toml"


def test_a_change_that_does_not_fit_what_is_chosen_by_now_pins_nothing(client: viser.ClientHandle):
    before = SHIPPED["soft"]
    fast = Multisine(tones=(Tone(axis="x", amplitude=1e-3, frequency=80.0),))
    after = msgspec.structs.replace(before, path=fast)
    looked = Figures(mu=1.0, sigma=1.0, excess={})
    result = Repair(
        before=before,
        after=after,
        by="tones",
        description="",
        effort=1.0,
        evaluations=1,
        figures_before=looked,
        figures_after=looked,
        certificate=certificate.certify_file("soft"),
    )
    rates = dict.fromkeys(("imu_rate", "mag_rate", "range_rate"), 20.0)
    slow = msgspec.structs.replace(before, sensors=msgspec.structs.replace(before.sensors, **rates))
    done: list[str] = []

    class Shown:
        def read(self) -> Settings:
            return Settings(origin="soft", preset=slow)

        def write(self, settings: Settings) -> None:
            done.append("written")

    panel = RepairPanel(Form(client.gui, _nothing), Shown(), Jobs(_nothing), lambda: done.append("pinned"))
    panel.show(result)
    with pytest.raises(InvalidInputError) as refusal:
        panel.accept()
    assert "faster than the IMU can sample" in str(refusal.value.__cause__)
    assert done == []
    assert panel.accept_button.visible  # nothing is lost: it fits again at the rate it was found for
