"""The report for a person: 80 columns, the answer first, a few groups, numbers with units, nothing of the JSON."""

import io
import json
import math
import re
import shlex
import sys
import time
from pathlib import Path

import pytest
from msgspec.structs import replace

from rangenav import analysis, formats, preset, record
from rangenav.commands import progress
from rangenav.commands.text import layout
from rangenav.commands.text.layout import Group, Report
from rangenav.commands.text.spectrum_bar import spectrum_bar
from rangenav.number_format import vector
from rangenav.signals import Multisine, Tone
from rangenav.vehicle import FREE

pytestmark = pytest.mark.slow


FIRST = {
    "paper-slow": "✓ observable in every window of 6 s of this 20 s flight (weakest from 0.8",
    "circle": "✗ blind: rank 11 of 13 in the window of 10 s",
    "wiggle": "! weak: rank 13 in every window of 6 s of this 20 s flight, but",
}
JSON_PATH = re.compile(r"\b[a-z]{2,}_[a-z_]+\b|\b[a-z]{4,}\.(?!toml|csv|json)[a-z]+\b")
ANSI = "\x1b["
FILE = f"{5 * '/folder'}/flight.csv"


@pytest.fixture(scope="module")
def flight(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A recorded flight with ranges and a truth."""
    file = tmp_path_factory.mktemp("flight") / "flight.csv"
    formats.export(preset.load("soft"), "log", file)
    return file


def names(out: str) -> list[str]:
    """The names of a report's groups."""
    return [line[: layout.NAMES].strip() for line in out.split("\n\n", 1)[1].splitlines() if line[:1].strip()]


def check(out: str, most_groups: int) -> None:
    """What holds for every report."""
    lines = out.splitlines()
    assert max(map(len, lines)) <= 80
    assert not any(line.endswith(" ") for line in lines)
    assert ANSI not in out
    assert not re.search(r"\bnan\b|\bNone\b|\binf\b|null", out)
    assert not JSON_PATH.search(out), JSON_PATH.search(out)
    said = [line.strip() for line in lines if line.strip()]
    assert len(said) == len(set(said))
    assert 1 <= len(names(out)) <= most_groups
    assert len(names(out)) == len(set(names(out)))


@pytest.mark.parametrize("name", FIRST)
def test_analyze_answers_first_and_then_in_groups(run, name: str):
    code, out, err = run("analyze", name)
    assert (code, err) == (0, "")
    check(out, 7)
    assert " ".join(out.split("\n\n")[0].split()).startswith(f"{name} {FIRST[name]}")
    assert names(out)[0] == "what can be seen"
    assert ("why not" in names(out)) == (name == "circle")
    p, analysed = preset.load(name), analysis.analyse(preset.load(name))
    assert f"rank {analysed.rank} of 13" in out
    assert (
        f"required of the predicted error ±{p.requirement.position_sigma:g} m: "
        f"{'✓ met' if name == 'paper-slow' else '✗ not met'}" in out
    )
    assert re.search(r"\d m/s, [\d.]+ × weight in thrust, [\d.]+ rad/s", out)
    assert "(floor " in out


@pytest.mark.parametrize("name", FIRST)
def test_explain_gives_the_same_answer_and_the_reasons(run, name: str):
    code, out, err = run("explain", name)
    assert (code, err) == (0, "")
    check(out, 7)
    assert out.split("\n\n")[0] == run("analyze", name)[1].split("\n\n")[0]
    assert names(out)[:2] == ["how long to fly", "what coincides"]


@pytest.mark.parametrize("name", FIRST)
def test_simulate_and_verify_answer_first(run, name: str):
    code, out, err = run("simulate", name)
    assert (code, err) == (0, "")
    check(out, 7)
    assert out.splitlines()[0].split()[1] == {"paper-slow": "✓", "circle": "✗", "wiggle": "!"}[name]
    code, out, err = run("verify", name)
    assert (code, err) == (0, "")
    check(out, 3)
    assert out.startswith(f"{name}   ✓ holds: ")


def test_a_run_names_what_does_not_settle_and_not_what_does(run):
    code, out, _ = run("simulate", "wiggle")
    assert (code, out.splitlines()[0]) == (0, "wiggle   ! position does not settle below 0.3 m")


def test_several_runs_are_counted_and_a_run_names_its_gains_and_the_predicted_error(run):
    code, out, _ = run("simulate", "soft", "--runs", 3)
    said = " ".join(out.split())
    assert code == 0
    settled = int(re.findall(r"position settles below 0.3 m in (\d) of 3 runs", said)[0])
    seeds = range(preset.load("soft").seed, preset.load("soft").seed + 3)
    assert settled == sum(
        record.run_seed(preset.load("soft"), seed).summary.settle_position_s is not None for seed in seeds
    )
    assert "3 consistent" in said
    assert "constant gains" in said
    assert "predicted, after the worst window: position ±0.323 m" in said


def test_a_diverged_run_has_a_cross_and_says_by_which_figure(run, tmp_path: Path):
    """An eight of minutes, which constant gains do not hold."""
    tones = (
        Tone(axis="x", amplitude=30.0, frequency=0.04),
        Tone(axis="y", amplitude=15.0, frequency=0.08),
        Tone(axis="z", amplitude=8.0, frequency=0.05),
    )
    soft = preset.load("soft")
    requirement = replace(soft.requirement, window=150.0)
    preset.save(
        replace(soft, path=Multisine(tones=tones), duration=200.0, requirement=requirement), tmp_path / "slow.toml"
    )
    out = run("simulate", tmp_path / "slow.toml")[1]
    first = " ".join(out.split("\n\n")[0].split())
    assert re.match(r"slow\.toml ✗ diverged: its distance from the anchor is wrong by \d+ m", first)
    answer = json.loads(run("simulate", tmp_path / "slow.toml", "--json")[1])
    assert answer["diverged"]
    assert answer["diverged_reason"] in first
    assert 'mode = "noise-matched" under [gains]' in " ".join(out.split())


def test_a_run_that_settles_on_a_weak_motion_has_no_tick_and_every_run_names_the_verdict(run, tmp_path: Path):
    paper = replace(preset.load("paper"), duration=8.0)
    strict = replace(paper, requirement=replace(paper.requirement, position_sigma=0.01))
    for name, chosen in (("paper", paper), ("strict", strict)):
        preset.save(chosen, tmp_path / f"{name}.toml")
    settled, weak = (" ".join(run("simulate", tmp_path / f"{name}.toml")[1].split()) for name in ("paper", "strict"))
    assert settled.startswith("paper.toml ✓ settles, and is then off by ")
    assert "the motion: ✓ observable" in settled
    assert "the observer's own 1-σ at the end: position ±" in settled
    assert re.match(r"strict\.toml ! settles, .*°, but the motion is weak: the predicted error 0\.0\d+ m exceeds", weak)
    assert "the motion: ! weak: the predicted error " in weak


def test_runs_that_diverge_on_a_blind_motion_are_counted_in_the_first_line(run):
    out = run("simulate", "turning-hover", "--runs", 2)[1]
    first, said = " ".join(out.split("\n\n")[0].split()), " ".join(out.split())
    count = json.loads(run("simulate", "turning-hover", "--runs", 2, "--json")[1])["runs_diverged"]
    assert ("have diverged" in first) == (count > 0)
    assert count == 0 or f"why {count} of 2 runs have diverged, the first: " in said
    alone = run("simulate", "turning-hover")[1]
    assert ("the run has diverged" in " ".join(alone.split("\n\n")[0].split())) == (count > 0)
    assert count > 0


def test_ranges_that_fall_on_one_place_make_a_run_and_a_certificate_say_so(run, tmp_path: Path):
    """All three tones repeat each second, and so do the ranges. Slower flight does not help, and is not advised."""
    turn = 2 * math.pi
    tones = (
        Tone(axis="x", amplitude=1.0, frequency=turn),
        Tone(axis="y", amplitude=1.0, frequency=2 * turn),
        Tone(axis="z", amplitude=1.0, frequency=3 * turn),
    )
    soft = preset.load("soft")
    sensors = replace(soft.sensors, range_rate=1.0)
    loop = replace(soft, path=Multisine(tones=tones), sensors=sensors, vehicle=FREE)
    file = tmp_path / "loop.toml"
    file.write_text(preset.dumps(loop))
    code, out, _ = run("simulate", file)
    assert code == 0
    assert "✗ blind: the position cannot be told" in " ".join(out.split())
    assert "rangenav tune" not in out
    assert "consistent" not in out
    assert "; blind motion" in " ".join(out.split())
    code, out, _ = run("certify", file)
    assert code == 1
    assert "slower" not in out


def test_log_answers_first_and_says_how_far_off_the_observers_were(run, flight: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(flight.parent)
    code, out, err = run("log", flight.name, "--window", 8)
    assert (code, err) == (0, "")
    check(out, 7)
    assert re.match(r"flight\.csv   [✓!✗] ", out)
    assert names(out)[:4] == ["the file", "what can be seen", "how well", "the observer"]
    assert re.search(r"position error [\d., ]+ m$", out, re.MULTILINE)
    assert "ranges of the file to an anchor at (0, 0, 1.5) m, as the file says" in " ".join(out.split())


def test_an_observer_that_ends_far_off_takes_the_tick_from_the_first_line(run, tmp_path: Path):
    """Two seconds determine the position, and are too short for an observer that starts from zero."""
    formats.export(preset.load("paper"), "log", tmp_path / "paper.csv")
    part = ("log", tmp_path / "paper.csv", "--end", 2, "--window", 1.5, "--position-sigma", 0.2)
    code, out, err = run(*part)
    assert (code, err) == (0, "")
    first = " ".join(out.split("\n\n")[0].split())
    assert re.search(r"paper\.csv ! observable: .*; but the observer is 0\.\d+ m off in the last quarter", first)
    report = json.loads(run(*part, "--json")[1])
    assert report["verdict"] == "observable"
    assert report["observer"]["failure"] in first


def test_synthetic_ranges_are_named_with_their_noise_and_their_anchor_in_the_first_lines(
    run, flight: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.chdir(flight.parent)
    code, out, err = run("log", flight.name, "--synthetic-ranges", 0.05, "--anchor", 0, 0, 1)
    assert (code, err) == (0, "")
    first = " ".join(out.split("\n\n")[0].split())
    assert first.endswith("with synthetic ranges of σ 0.05 m to an anchor at (0, 0, 1) m, as given")


def test_several_questions_end_with_the_command_that_answers_them(run, flight: Path, tmp_path: Path):
    """The command is typed as it stands, and asks nothing more; its first argument has a blank."""
    file, text = tmp_path / "my flight.csv", flight.read_text()
    stated = [line for line in text.splitlines() if not line.startswith("# frame")]
    file.write_text("\n".join(stated).replace("gyro_x [rad/s],gyro_y [rad/s],gyro_z [rad/s]", "gyro_x,gyro_y,gyro_z"))
    code, out, err = run("log", file, "--window", 8)
    assert (code, out, err.count("\n")) == (2, "", 1)
    _, command = err.split("in one command, with the suggested answers: ")
    program, *arguments = shlex.split(command)
    assert (program, arguments[:2]) == ("rangenav", ["log", str(file)])
    assert arguments[-4:] == ["--gyro-unit", "rad/s", "--frame", "z-down"]
    code, out, err = run(*arguments)
    assert (code, err) == (0, "")
    assert "as confirmed: the gyro rad/s" in out


def test_a_flag_that_was_no_answer_stands_once_in_the_command_that_answers_the_questions(
    run, flight: Path, tmp_path: Path
):
    """The record starts in motion, so its start does not tell gravity, and is not offered again."""
    stated = [line for line in flight.read_text().splitlines() if not re.match("# (frame|gravity|magnetic)", line)]
    (tmp_path / "moving.csv").write_text("\n".join(stated))
    code, out, err = run("log", tmp_path / "moving.csv", "--world", "still", "--window", 8, "--frame", "z-down")
    assert (code, out) == (2, "")
    assert "--world still" not in err.partition("rangenav log")[0]
    (tmp_path / "moving.csv").write_text("\n".join(line for line in stated if "anchor" not in line))
    _, _, err = run("log", tmp_path / "moving.csv", "--world", "still", "--window", 8, "--frame", "z-down")
    command = err.split("suggested answers: ")[1]
    assert command.count("--world") == 1
    assert "--world given --gravity X Y Z --magnetic X Y Z" in command
    assert "--window 8" in command


def test_a_part_of_a_record_and_a_flag_against_the_file_are_said(run, flight: Path):
    x, y, z = preset.load("soft").world.anchor
    code, out, err = run("log", flight, "--begin", 2, "--end", 12, "--anchor", x + 0.02, y, z, "--window", 8)
    said = " ".join(out.split())
    assert (code, err) == (0, "")
    assert re.search(r"log, \d+ rows of the IMU at \d+ Hz, 10 s, z-\w+ \(\d+ rows in the file\)", said)
    assert f"anchor {vector((x + 0.02, y, z))} m, given instead of {vector((x, y, z))} m in the file" in said
    assert "after windows of 8 s: position ±" in said
    assert "at the end of the whole record: position ±" in said


def test_a_preset_without_a_certificate_is_not_said_to_fail(run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    preset.save(preset.load("soft"), tmp_path / "soft.toml")
    code, out, err = run("verify", "soft.toml")
    assert (code, err) == (1, "soft.toml: there is no certificate beside it (soft.certificate.json)\n")
    assert out.startswith("soft.toml   ? no certificate beside it to compare with\n")
    assert "rangenav certify soft.toml -o soft.certificate.json" in out


def test_the_other_commands_keep_the_same_manners(run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    for arguments in (
        ("presets",),
        ("certify", "soft", "-o", "c.json"),
        ("repair", "circle", "-o", "round.toml"),
        ("export", "soft", "--to", "reference", "-o", "soft.csv"),
        ("import", "soft.csv", "--from", "reference", "-o", "again.toml"),
    ):
        code, out, err = run(*arguments)
        assert (code, err) == (0, ""), arguments
        check(out, 7)
        assert re.search(r"^\S+   [✓!✗?] ", out), arguments


def test_a_long_answer_and_a_long_line_are_wrapped_and_a_long_command_stays_a_command():
    words = " ".join(["word"] * 40)
    report = Report(
        subject="x",
        sign="!",
        answer=words,
        groups=(
            Group(name="group", lines=(words,)),
            *layout.next_commands(f"log {FILE} --window 12"),
        ),
    )
    lines = layout.rendered(report)
    assert max(map(len, lines)) <= 80
    assert "\n".join(lines).count("word") == 80
    command = [line[layout.NAMES :] for line in lines[lines.index("") + 1 :] if "folder" in line or "--" in line]
    assert "".join(part.removesuffix("\\").strip() + " " for part in command).split()[-2:] == ["--window", "12"]
    assert command[0].endswith("\\")


def test_a_command_breaks_before_an_option_and_never_between_an_option_and_its_values():
    command = f"rangenav log {FILE} --anchor 1 -2 0.5 --begin SECONDS --end SECONDS"
    lines = layout.folded_command(command, 61)
    assert " ".join(line.removesuffix("\\").strip() for line in lines) == command
    assert all(line.strip().startswith("--") for line in lines[1:])
    assert max(map(len, lines)) <= 61


def test_no_color_prints_no_escape_sequence_on_a_terminal(monkeypatch: pytest.MonkeyPatch, capsys):
    report = Report(subject="x", sign="✓", answer="done", title="T", groups=layout.group("files", "✓ a"))
    monkeypatch.setattr("sys.stdout.isatty", lambda: True)
    monkeypatch.setenv("TERM", "xterm-256color")
    monkeypatch.delenv("NO_COLOR", raising=False)
    layout.show(report)
    assert ANSI in capsys.readouterr().out
    monkeypatch.setenv("NO_COLOR", "1")
    layout.show(report)
    assert ANSI not in capsys.readouterr().out


@pytest.mark.parametrize("has_truth", [True, False])
def test_log_suggests_ranges_only_where_the_file_has_positions_and_repeats_the_options_typed(
    run, flight: Path, tmp_path: Path, has_truth: bool
):
    rows = [row.split(",") for row in flight.read_text().splitlines() if not row.startswith("#")]
    names = [name.split(" ")[0] for name in rows[0]]
    kept = [k for k, name in enumerate(names) if name[0] in "tga" or (has_truth and name[:2] in ("p_", "q_"))]
    file = tmp_path / "flight.csv"
    file.write_text("\n".join(",".join(row[k] for k in kept) for row in rows))
    code, out, err = run("log", file, "--frame", "z-down", "--gyro-unit", "rad/s", "--window", 2)
    assert (code, err) == (0, "")
    last = " ".join(out.split("next  ")[1].replace("\\", "").split())
    assert ("--anchor X Y Z --synthetic-ranges 0.1" in last) == has_truth
    assert "--synthetic-ranges" not in last or "--frame z-down" in last
    assert "the gyro rad/s" in out
    assert out.count("the file") <= 2


def test_a_marked_export_gives_its_reason_once(run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    code, out, err = run("export", "circle", "--to", "reference", "-o", "x.csv", "--uncertified")
    assert (code, err) == (0, "")
    check(out, 7)
    assert " ".join(out.split()).count("the excitation along z") == 1


def test_the_spectrum_bar_has_one_sign_for_each_eigenvalue_and_states_its_floor():
    (bar,) = spectrum_bar([1e-20, 1e-3, 1.0, 9e4], 1e-12)
    low, drawn, high, *floor = bar.split()
    assert (low, high) == ("10⁻³", "10⁵")
    assert drawn == "·▁▄█"
    assert " ".join(floor) == "(floor 1e-12; 1 of 4 below it (·))"
    assert spectrum_bar([0.0, 0.0], 1e-12) == ("all 2 eigenvalues lie below the floor 1e-12",)


def test_what_may_be_typed_next_keeps_the_window_that_was_typed(run):
    for command, other in (("analyze", "explain"), ("explain", "analyze")):
        code, out, _ = run(command, "soft", "--window", "1.2")
        assert code == 0
        following = out.split("next  ")[1]
        assert f"rangenav {other} soft --window 1.2" in following
        assert "repair" not in following  # it would speak of the preset's own window


def test_a_log_gets_the_newest_text_of_a_long_task_now_and_then_and_a_short_task_writes_nothing(
    monkeypatch: pytest.MonkeyPatch,
):
    log = io.StringIO()  # no terminal
    monkeypatch.setattr(sys, "__stderr__", log)
    with progress.describing("computing x") as say:
        say(0.5, "1/2 parts")
    assert log.getvalue() == ""
    monkeypatch.setattr(progress, "LINE_EVERY", 0.01)
    with progress.describing("computing x") as say:
        say(0.5, "1/2 parts")
        while not log.getvalue():
            time.sleep(0.001)
    assert log.getvalue().splitlines()[0] == "computing x: 1/2 parts"
