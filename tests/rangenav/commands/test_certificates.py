"""certify, verify and repair on the command line: what is written, exit codes, and sentences on stderr."""

import json
import shutil
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from rangenav import __main__ as cli
from rangenav import certificate, preset

pytestmark = pytest.mark.slow


Call = Callable[..., tuple[int, str, str]]


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Call:
    """run(arguments) -> (exit code, stdout, stderr), in this process."""

    def call(*arguments: object) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["rangenav", *map(str, arguments)])
        code = 0
        try:
            cli.main()
        except SystemExit as stop:
            code = int(stop.code or 0)
        captured = capsys.readouterr()
        return code, captured.out, captured.err

    return call


@pytest.fixture
def soft(tmp_path: Path) -> Path:
    return Path(shutil.copy(preset.find("soft"), tmp_path / "soft.toml"))


def test_certify_writes_what_verify_accepts(run: Call, soft: Path):
    code, out, err = run("certify", soft, "-o", certificate.path_for(soft))
    assert (code, err) == (0, "")
    assert out.startswith("soft.toml   ✓ certified: observable\n")
    said = " ".join(out.split())
    assert "no window of 12 s of this 20 s flight has a larger σ (proven)" in said
    assert "0.5 m required; predicted from ranges alone, at 50 Hz with 0.1 m noise, and a perfect IMU" in said
    assert certificate.path_for(soft).read_bytes() == certificate.dumps(certificate.certify_file(soft))
    code, out, err = run("verify", soft)
    assert (code, err) == (0, "")
    assert out.startswith("soft.toml   ✓ holds: ")


def test_certify_shows_a_report_or_prints_one_object(run: Call):
    code, out, err = run("certify", "circle")
    assert (code, err) == (0, "")
    assert out.startswith("circle   ✓ certified: blind, as intended\n")
    assert "✗ the excitation along z" in out
    code, out, err = run("certify", "circle", "--json")
    assert (code, err, out.count("\n")) == (0, "", 1)
    assert json.loads(out, parse_constant=pytest.fail) == certificate.to_builtins(certificate.certify_file("circle"))


def test_what_does_not_deliver_what_it_promises_is_said_on_stderr_with_exit_1(run: Call, soft: Path):
    soft.write_text(soft.read_text().replace("mu = 50.0", "mu = 500.0"))
    code, out, err = run("certify", soft, "-o", certificate.path_for(soft))
    said = "soft.toml   ✗ NOT certified: observable, but the excitation required is not met\n"
    assert (code, out.startswith(said)) == (1, True)
    assert err == f"{soft}: not certified; not met: excitation\n"
    assert "✗ the excitation along " in out
    code, _, err = run("certify", soft, "--json")
    assert (code, err.startswith(f"{soft}: the excitation along "), err.endswith("500 m²/s⁷ required\n")) == (
        1,
        True,
        True,
    )
    code, out, err = run("verify", soft)  # the certificate says so as well, and that is no reason to accept it
    assert (code, out.splitlines()[0]) == (1, "soft.toml   ✗ the file is unchanged, but a requirement is not met")
    assert f"rangenav repair {soft}" in " ".join(out.replace("\\", "").split())
    assert err.startswith("soft.toml: the excitation along ")


def test_verify_says_one_sentence_for_each_failure_and_goes_on(run: Call, soft: Path, tmp_path: Path):
    run("certify", soft, "-o", certificate.path_for(soft))
    soft.write_bytes(soft.read_bytes() + b" ")
    missing = tmp_path / "missing.toml"
    code, out, err = run("verify", soft, missing, "circle")
    assert code == 1
    assert out.splitlines()[0] == "3 files   ✗ 2 of them do not hold"
    assert [line.strip().removeprefix("files").strip() for line in out.splitlines()[2:5]] == [
        "✗ soft.toml     the file has changed since it was certified",
        "✗ missing.toml  cannot be verified",
        "✓ circle        certified: blind, as intended",
    ]
    first, second = err.splitlines()
    assert first.startswith("soft.toml: its bytes are not those that were certified")
    assert second == f"{missing}: no such file"
    code, out, _ = run("verify", soft, "circle", "--json")
    report = json.loads(out)["files"]
    assert (code, report["circle"]) == (
        1,
        {
            "holds": True,
            "failures": [],
            "outcome": "holds",
            "path": str(preset.find("circle")),
            "verdict": "blind",
            "expect": "unobservable",
            "verdict_words": "blind",
        },
    )
    assert (report[str(soft)]["holds"], report[str(soft)]["outcome"]) == (False, "changed")


def test_a_changed_file_has_its_own_headline_and_its_own_way_out(run: Call, soft: Path):
    run("certify", soft, "-o", certificate.path_for(soft))
    soft.write_bytes(soft.read_bytes() + b" ")
    code, out, _ = run("verify", soft)
    assert (code, out.splitlines()[0]) == (1, "soft.toml   ✗ the file has changed since it was certified")
    said = " ".join(out.replace("\\", "").split())
    command = said.partition("rangenav ")[2].split()
    assert run(*command)[0] == 0
    assert run("verify", soft)[0] == 0


@pytest.mark.parametrize("place", ["{}.certificate.json", "kept.json"])
def test_a_certificate_is_verified_where_it_was_written_by_the_command_that_certify_ends_with(
    run: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, place: str
):
    """Of a shipped preset, whose own certificate lies elsewhere; and by the certificate's name alone."""
    monkeypatch.chdir(tmp_path)
    written = Path(place.format("soft"))
    _, out, _ = run("certify", "soft", "-o", written)
    *_, command = out.strip().rpartition("rangenav ")
    assert command == f"verify soft --certificate {written}"
    assert run(*command.split())[0] == run("verify", written)[0] == 0
    written.write_text(written.read_text().replace('"rank": 13', '"rank": 12'))
    for arguments in (command.split(), ("verify", written)):
        code, out, _ = run(*arguments)
        assert (code, "✗ the certificate states what the file does not give" in out) == (1, True)


@pytest.mark.parametrize("name", ["soft.toml", "kept.toml", "flight.toml"])
def test_a_changed_file_beside_a_certificate_is_never_replaced_by_a_shipped_preset(run: Call, soft: Path, name: str):
    """Found by the shipped preset's name, by the certificate's name, or by its title alone."""
    flown = soft.rename(soft.with_name(name))
    written = flown.with_name("kept.json")
    run("certify", flown, "-o", written)
    code, out, _ = run("verify", written, "--json")
    assert (code, json.loads(out)["files"][str(written)]["path"]) == (0, str(flown))
    flown.write_text(flown.read_text().replace("seed = 1", "seed = 4"))
    code, out, err = run("verify", written)
    assert (code, out.splitlines()[0]) == (1, "kept.json   ✗ the file has changed since it was certified")
    assert err.startswith(f"{name}: its bytes are not those that were certified")
    assert f"rangenav certify {flown} -o {written}" in " ".join(out.replace("\\", "").split())
    flown.unlink()
    code, out, _ = run("verify", written, "--json")
    assert (code, json.loads(out)["files"][str(written)]["path"]) == (0, str(preset.find("soft")))


def test_a_certificate_of_a_file_that_is_nowhere_says_how_to_name_it(run: Call, tmp_path: Path, soft: Path):
    (tmp_path / "elsewhere").mkdir()
    soft.write_text(soft.read_text().replace("seed = 1", "seed = 4"))
    written = tmp_path / "elsewhere" / "kept.json"
    run("certify", soft, "-o", written)
    code, _, err = run("verify", written)
    assert (code, err.count("\n")) == (1, 1)
    assert "rangenav verify FILE --certificate kept.json" in err
    assert run("verify", soft, "--certificate", written)[0] == 0


def test_repair_writes_a_preset_that_certifies(run: Call, tmp_path: Path):
    file = tmp_path / "round.toml"
    code, out, err = run("repair", "circle", "-o", file, "--json")
    assert (code, err) == (0, "")
    report = json.loads(out, parse_constant=pytest.fail)
    assert report["words"] in preset.load(file).story.lower()
    assert report["after"]["rank"] == 13
    assert run("certify", file, "-o", certificate.path_for(file))[0] == 0
    code, out, _ = run("repair", file)
    assert code == 0
    assert "✓ nothing needs repair: every requirement is met" in out
    assert "motions tried" not in out
    assert "rangenav repair" not in out.split("next", 1)[1]


def test_a_repair_that_cannot_be_made_is_a_sentence_and_exit_1(run: Call, tmp_path: Path):
    code, out, err = run("repair", "circle", "--by", "timescale", "-o", tmp_path / "no.toml")
    assert (code, out) == (1, "")
    assert err.startswith("circle: timescale: the path has no snap along z")
    assert not (tmp_path / "no.toml").exists()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["certify", "papper"], "papper: no such preset; did you mean paper? Shipped are"),
        (["certify"], "Missing"),
        (["certify", "circle", "-o", "nowhere/c.json"], "-o nowhere/c.json: no such folder"),
        (["verify"], "no file was named"),
        (["repair", "circle", "--by", "magic"], "magic"),
        (["repair", "circle", "-o", "new.json"], "--output must name a file that ends in .toml"),
    ],
)
def test_bad_input_is_one_line_on_stderr_and_exit_2(run: Call, arguments: list[str], said: str):
    code, out, err = run(*arguments)
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert said in err
