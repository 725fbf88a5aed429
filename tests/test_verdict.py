"""There is one verdict: the page, the command line, the certificate and the library give the same one."""

import math
from pathlib import Path
from unittest.mock import MagicMock

import msgspec
import pytest

from explorer.model.compute import compute
from explorer.model.settings import Settings
from explorer.panels.verdict import VerdictPanel
from explorer.storage import flight_report
from explorer.storage.flight_report import FlightOptions
from rangenav import analysis, certificate, formats, logs, preset, verdict
from rangenav.formats.path_preset import as_preset
from rangenav.preset import Preset

pytestmark = pytest.mark.slow


SHIPPED = sorted(preset.shipped())
SOFT = preset.load("soft")


def of_page(p: Preset) -> str:
    """The word at the head of the page's verdict block."""
    gui = MagicMock()
    VerdictPanel(gui, {}).draw(compute(Settings(origin="", preset=p)).proven())
    html = gui.add_html.return_value.content
    (word,) = (word for word in ("observable", "weak", "blind", "not judged") if f" {word}</b>" in html)
    return word


@pytest.fixture(scope="module")
def imported(tmp_path_factory: pytest.TempPathFactory) -> Preset:
    """A path whose snap comes from a fit to sampled positions."""
    file = tmp_path_factory.mktemp("import") / "flight.tum"
    formats.export(SOFT, "tum", file)
    return as_preset(formats.read(file, "tum", confirm={"frame": "z-up"}))


@pytest.mark.parametrize("name", SHIPPED)
def test_page_command_line_certificate_and_library_agree_on_every_preset(name: str, answer):
    p = preset.load(name)
    stored = certificate.loads(certificate.path_for(preset.find(name)).read_bytes(), source=name)
    library = analysis.analyse(p).verdict
    assert library.judged
    assert [answer("analyze", name)["verdict"], stored.verdict, of_page(p)] == 3 * [library.word]


def test_all_four_refuse_to_judge_a_fitted_path_and_give_the_same_reason(answer, tmp_path: Path, imported: Preset):
    preset.save(imported, tmp_path / "x.toml")
    library = analysis.analyse(imported).verdict
    assert library.word == "not judged"
    assert library.reason.startswith("the path's snap was not in flight.tum but comes from fitting: ")
    assert str(library) == f"not judged: {library.reason}"
    said = answer("analyze", tmp_path / "x.toml")
    assert (said["verdict"], said["verdict_reason"]) == (None, f"null: {library}")
    certified = certificate.certify_file(tmp_path / "x.toml")
    assert (certified.verdict, certified.failures) == ("not judged", (library.reason,))
    assert of_page(imported) == "not judged"


def test_a_fit_and_the_same_path_as_a_design_differ_in_the_verdict_alone(imported: Preset):
    design = msgspec.structs.replace(imported, source=None)
    fit, judged = analysis.analyse(imported), analysis.analyse(design)
    assert (fit.verdict.judged, judged.verdict.judged) == (False, True)
    assert (fit.mu, fit.rank, fit.lifted_end) == (judged.mu, judged.rank, judged.lifted_end)


def test_page_command_line_and_library_agree_on_a_recorded_flight(answer, tmp_path: Path):
    formats.export(preset.load("paper-slow"), "log", tmp_path / "demo.csv")
    flight = formats.settled(formats.read(tmp_path / "demo.csv", "log")).flight
    assert flight is not None
    for window in (1.0, 6.0):
        library = logs.informative(flight, window=window, range_sigma=0.1, requirement=0.5, noise=None)
        said = answer("log", tmp_path / "demo.csv", "--window", window)
        page = flight_report.judge(flight, FlightOptions(anchor=(0.0, 0.0, 0.0), window=window))
        assert library.verdict == said["informative"]["verdict"]
        whole = logs.whole(flight, range_sigma=0.1, requirement=0.5, noise=None)
        assert whole.verdict == said["verdict"] == page.whole.verdict
        assert whole.summary == said["whole"]["words"] == page.whole.summary
        assert said["informative"]["words"] == page.summary == library.summary


MISSED = msgspec.structs.replace(
    SOFT, requirement=msgspec.structs.replace(SOFT.requirement, mu=500.0, position_sigma=1.0)
)
"""The same motion with a required μ that it does not reach."""


@pytest.mark.parametrize("name", ["analyze", "explain", "certify"])
def test_no_report_has_a_tick_on_its_first_line_where_a_requirement_is_not_met(name: str, run, tmp_path: Path):
    preset.save(MISSED, tmp_path / "missed.toml")
    assert analysis.analyse(MISSED).verdict.word == "observable"
    _, out, _ = run(name, tmp_path / "missed.toml")
    first = " ".join(out.split("\n\n")[0].split())
    assert "✓" not in first
    assert "observable" in first
    assert "not met" in first


def test_page_certificate_and_json_say_the_same_of_an_excitation_that_is_not_met(answer, tmp_path: Path):
    preset.save(MISSED, tmp_path / "missed.toml")
    library = analysis.analyse(MISSED).verdict
    assert library.summary == "observable, but the excitation required is not met"
    assert certificate.verdict_of(certificate.certify_file(tmp_path / "missed.toml")) == library
    said = answer("analyze", tmp_path / "missed.toml")
    assert (said["verdict"], said["verdict_words"], said["verdict_sign"]) == ("observable", library.summary, "!")
    gui = MagicMock()
    VerdictPanel(gui, {}).draw(compute(Settings(origin="", preset=MISSED)).proven())
    shown = gui.add_html.return_value.content
    assert "but the excitation μ is " in shown
    assert "● observable" not in shown


@pytest.mark.parametrize("excitation", ["met", "not met", "not proven"])
@pytest.mark.parametrize(("rank", "sigma"), [(12, 0.1), (13, 0.1), (13, 0.9), (13, None)])
def test_only_an_observable_motion_whose_excitation_is_reached_has_a_tick(rank, sigma, excitation):
    judged = verdict.judge(rank, sigma, 0.5, excitation=excitation)
    assert (judged.sign == "✓") == ((judged.word, excitation) == ("observable", "met"))
    assert (judged.sign == "✗") == (judged.word == "blind")
    assert (f"required is {excitation}" in str(judged)) == (judged.sign == "!" and excitation != "met")


def test_an_excitation_between_its_bound_and_the_least_sample_is_not_proven_and_without_a_bound_samples_decide():
    assert verdict.excitation_reached(3.0, 2.0, 2.5) == "not proven"
    assert verdict.excitation_reached(3.0, 2.5, 2.5) == "met"
    assert verdict.excitation_reached(3.0, None, 2.5) == "met"
    assert verdict.excitation_reached(2.4, None, 2.5) == "not met"


@pytest.mark.parametrize(
    ("rank", "sigma", "word"),
    [
        (12, 0.1, "blind"),
        (13, 0.5, "observable"),
        (13, 0.51, "weak"),
        (13, None, "blind"),
        (13, math.nan, "blind"),
        (13, math.inf, "blind"),
    ],
)
def test_the_verdict_follows_rank_and_predicted_error(rank: int, sigma: float | None, word: verdict.Word):
    assert verdict.judge(rank, sigma, 0.5).word == word
    assert not verdict.judge(rank, sigma, 0.5, restriction="it jumps").judged
