"""`rangenav export`, `import` and `log` as people and scripts meet them: files, questions, exit codes, one sentence."""

import io
import json
import re
import zipfile

import msgspec
import numpy as np
import pytest

from explorer.storage.bundle import pack
from rangenav import formats, preset
from rangenav.certificate import exports
from tests.support.present import present
from tests.support.real_files import shared

pytestmark = pytest.mark.slow


EVERYTHING = tuple(row.name for row in formats.writable() if row.name != "preset")


@pytest.mark.parametrize("format", [row.name for row in formats.writable()])
def test_every_format_is_exported_and_what_was_written_is_said(answer, tmp_path, format):
    if format in ("bag", "mcap"):
        pytest.importorskip("rosbags", reason="rosbags is not installed (the extra ros has it)")
    path = tmp_path / f"x{formats.row(format).suffix}"
    said = answer("export", "soft", "--to", format, "-o", path)
    assert (said["preset"], said["format"], said["uncertified"]) == ("soft", format, False)
    assert path.exists()
    assert all(tmp_path in one.parents for one in map(type(tmp_path), said["files"]))
    if format in ("reference", "polynomial"):
        length = said["steady"]["to"] - said["steady"]["from"]
        if format == "polynomial":  # one loop, which windows of 12 s reach over
            assert length == pytest.approx(preset.load("soft").path.period)
            assert (said["loop"]["from"], said["loop"]["first_piece"]) == (2.0, 5)
        else:
            assert length >= 12.0
        assert said["notes"][0].startswith("any certificate covers 2 s to ")


def test_a_report_for_people_says_the_same(run, tmp_path):
    code, out, err = run("export", "soft", "--to", "tum", "-o", tmp_path / "x.tum")
    assert (code, err) == (0, "")
    assert out.startswith("soft   ✓ written as tum\n")
    assert "x.tum.certificate.json" in out


def test_a_preset_that_misses_its_requirement_is_exported_only_marked(answer, complaint, tmp_path):
    soft = preset.load("soft")
    greedy = msgspec.structs.replace(soft, requirement=msgspec.structs.replace(soft.requirement, mu=1e4))
    preset.save(greedy, tmp_path / "greedy.toml")
    asked = ("export", tmp_path / "greedy.toml", "--to", "reference", "-o", tmp_path / "x.csv")
    said = complaint(*asked)
    assert "m²/s⁷ required" in said
    assert "nothing was written (--uncertified writes it all the same, marked)" in said
    assert not (tmp_path / "x.csv").exists()
    said = answer(*asked, "--uncertified")
    assert said["uncertified"]
    assert any(
        note.startswith("UNCERTIFIED: this motion is too gentle: the excitation along ") for note in said["notes"]
    )
    assert sorted(one.name for one in tmp_path.iterdir()) == ["greedy.toml", "x.uncertified.csv"]


def test_the_command_that_a_refusal_names_exports(answer, complaint, tmp_path):
    said = complaint("export", "hand-held", "--to", "polynomial", "-o", tmp_path / "x.csv")
    command = present(re.search(r"slow down 1\.1×: rangenav (export .*)\n", said))[1]
    assert answer(*command.split())["uncertified"] is False
    assert (tmp_path / "x.csv.certificate.json").is_file()
    said = complaint("export", "soft", "--to", "polynomial", "--loop", "-o", tmp_path / "y.csv")
    assert said.startswith("soft: its path is not made of pieces that end where they begin")


def test_the_page_and_the_command_line_pass_one_gate(complaint, tmp_path):
    """What the command refuses, the page's zip refuses or leaves out, in the same words: direction, window, by how
    much, and what would help."""
    circle, words = preset.load("circle"), present(exports.gate(preset.load("circle"), "reference"))
    for said in (
        "along z over the 10 s from t = 0 s is nothing, 1 m²/s⁷ required",
        "it would do to add for example a tone",
    ):
        assert said in words
    assert words in complaint("export", "circle", "--to", "reference", "-o", tmp_path / "x.csv")
    told = {"uncertified": False, "progress": lambda _: None, "cancelled": lambda: False}
    alone = pack(circle, "circle", ["reference"], **told)
    assert alone.content == b""
    assert words in alone.refused[0].reason
    assert [cure.text for cure in alone.refused[0].cures] == [
        "add for example a tone of 0.064 m at 4 rad/s along z with phase 0"
    ]
    with pytest.raises(ValueError, match="no format is chosen"):
        pack(circle, "circle", [], **told)
    both = pack(circle, "circle", ["reference", "csv"], **told)
    assert any(note.startswith("reference: left out:") and words in note for note in both.notes)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["torus", "circle"])
def test_everything_in_the_pages_zip_verifies_where_it_is_unpacked_and_nothing_else_does(run, tmp_path, name):
    pytest.importorskip("rosbags", reason="rosbags is not installed (the extra ros has it)")
    packed = pack(
        preset.load(name), name, EVERYTHING, uncertified=True, progress=lambda _: None, cancelled=lambda: False
    )
    zipfile.ZipFile(io.BytesIO(packed.content)).extractall(tmp_path)
    marked = [path for path in tmp_path.iterdir() if "uncertified" in path.name]
    proven = [path for path in tmp_path.iterdir() if path.name != "README.txt" and path not in marked]
    proven = [path for path in proven if not path.name.startswith("fly_")]
    artifacts = [path for path in proven if not path.name.endswith("certificate.json")]
    refused = {"circle": 2, "torus": 0}.get(name, 0)
    assert len(marked) == refused
    assert (packed.name == f"{name}.uncertified.zip") == bool(refused)
    left_out = sum(": left out: " in note for note in packed.notes)
    assert len(artifacts) + refused + left_out == 1 + len(EVERYTHING), packed.notes
    assert len(artifacts) >= 9
    code, out, err = run("verify", *proven)
    assert (code, err, out.count("✓")) == (0, "", 1 + len(proven))  # all of them, and each one
    code, out, err = run("verify", tmp_path)
    assert (code, err, out.count("✓")) == (0, "", 1 + len(artifacts))  # the folder stands for all that is certified
    if marked:
        assert run("verify", *marked)[0] == 1
    for path in artifacts:
        file = path if path.is_file() else next(one for one in path.rglob("*.*") if one.name != "certificate.json")
        content = bytearray(file.read_bytes())
        content[len(content) // 3] ^= 1
        file.write_bytes(content)
    assert run("verify", *artifacts)[1].count("✗") == 1 + len(artifacts)


@pytest.mark.parametrize("format", ["bezier", "qgc"])
def test_formats_that_lose_the_excitation_say_why_they_are_not_written(complaint, tmp_path, format):
    said = complaint("export", "soft", "--to", format, "-o", tmp_path / "x")
    assert said.startswith(f"{format}: ")
    assert "nothing about it can be certified" in said


def test_what_was_exported_is_imported_again_with_the_same_verdict(answer, tmp_path):
    for format in ("polynomial", "reference"):
        answer("export", "paper-slow", "--to", format, "-o", tmp_path / "x.csv")
        said = answer("import", tmp_path / "x.csv", "--from", format, "-o", tmp_path / "y.toml", "--duration", "11")
        assert (said["rank"], said["attitude"], said["frame"]) == (13, "as flown", "z-up")
        assert answer("analyze", tmp_path / "y.toml")["gramian"]["rank"] == 13
        assert preset.load(tmp_path / "y.toml").duration == 11.0


def test_an_import_that_leaves_something_open_asks_and_writes_nothing(answer, complaint, tmp_path):
    answer("export", "soft", "--to", "tum", "-o", tmp_path / "x.tum")
    asked = ("import", tmp_path / "x.tum", "--from", "tum", "-o", tmp_path / "y.toml")
    said = complaint(*asked)
    assert "which way does z point" in said
    assert said.endswith("--frame z-up\n")
    assert not (tmp_path / "y.toml").exists()
    report = answer(*asked, "--frame", "z-up", "--anchor", "1", "2", "3")
    assert (report["verdict"], report["verdict_words"], report["fit_error"] > 0) == (None, "not judged", True)
    assert (report["excitation"], report["rank"]) == (None, None)
    assert "cannot be judged" in report["reason"]
    assert preset.load(tmp_path / "y.toml").world.anchor == (1.0, 2.0, 3.0)
    assert answer(*asked, "--frame", "z-up", "--window", "9")["verdict"] is None
    assert preset.load(tmp_path / "y.toml").requirement.window == 9.0
    assert "--window: " in complaint(*asked, "--frame", "z-up", "--window", "999")


def test_the_stamps_and_the_gap_of_a_sampled_path_are_asked_and_answered_by_flags(answer, complaint, tmp_path):
    time = np.concatenate([np.arange(0, 3, 0.02), np.arange(4, 8, 0.02)])
    rows = [f"{1e3 * t:.0f} {np.cos(t):.6f} {np.sin(t):.6f} {np.sin(2 * t):.6f} 0 0 0 1" for t in time]
    (tmp_path / "x.tum").write_text("\n".join(rows))
    asked = ("import", tmp_path / "x.tum", "--from", "tum", "--frame", "z-up", "-o", tmp_path / "x.toml")
    said = complaint(*asked)
    assert "in which unit are the stamps?" in said
    assert ("--time-unit ms; what to do with the gap? no rows for 1.02 s between line 150 at 2.98 s and "
                         "line 151 at 4 s; longest uses the part from 4 s to 7.98 s, bridge draws the curve through, "
                         "begin and end cut anywhere: --gaps longest; in one command") in said  # fmt: skip
    typed = f"rangenav import {tmp_path / 'x.tum'} --from tum --frame z-up -o {tmp_path / 'x.toml'}"
    assert said.endswith(f" {typed} --time-unit ms --gaps longest\n")
    given = (*asked, "--time-unit", "ms")
    lengths = [
        answer(*given, *flags)["duration"]
        for flags in (("--gaps", "longest"), ("--gaps", "bridge"), ("--begin", "1", "--end", "2.98"))
    ]
    assert lengths == pytest.approx([3.98, 7.98, 1.98])


def test_a_path_is_no_flight_and_a_flight_no_path(answer, complaint, tmp_path):
    answer("export", "soft", "--to", "log", "-o", tmp_path / "x.csv")
    said = complaint("import", tmp_path / "x.csv", "--from", "log", "-o", tmp_path / "y.toml")
    assert said == "x.csv: holds a recorded flight and no path: ask `rangenav log` about it\n"
    answer("export", "soft", "--to", "euroc", "-o", tmp_path / "flight")
    truth = tmp_path / "flight" / "mav0" / "state_groundtruth_estimate0" / "data.csv"
    assert "holds a path and no recorded flight" in complaint("log", truth, "--from", "euroc")
    assert "must name a file that ends in .toml" in complaint("import", truth, "--from", "euroc", "-o", tmp_path / "y")


def test_a_log_of_our_own_is_judged_and_observed_without_a_question(answer, tmp_path):
    answer("export", "soft", "--to", "log", "-o", tmp_path / "x.csv")
    said = answer("log", tmp_path / "x.csv", "--window", "12")
    assert (said["verdict"], said["informative"]["rank"]) == ("observable", 13)
    assert len(said["informative"]["eigenvalues"]) == 13
    assert said["observer"]["position"]["quarters_rmse"][-1] < 1.0
    assert said["observer"]["attitude_deg"]["quarters_rmse"][-1] < 5.0
    assert said["observer"]["fit"]["word"] == said["observer"]["fit"]["words"] == "consistent"
    assert said["world"]["anchor"] == [0.0, 0.0, 1.5]


def test_a_euroc_folder_of_our_own_has_its_world_and_another_one_needs_a_world_and_an_anchor(
    answer, complaint, tmp_path
):
    answer("export", "soft", "--to", "euroc", "-o", tmp_path / "flight")
    assert answer("log", tmp_path / "flight", "--window", "12")["world"]["anchor"] == [0.0, 0.0, -1.5]
    ranges = tmp_path / "flight" / "mav0" / "uwb0" / "data.csv"
    rows = ranges.read_text().splitlines()
    ranges.write_text("\n".join(row for row in rows if not row.startswith("# ")))
    said = complaint("log", tmp_path / "flight")
    assert "where do gravity and the magnetic field point? the record does not start still" in said
    assert "where does the anchor stand? the file does not say: --anchor X Y Z" in said
    given = ("--world", "given", "--gravity", "0", "0", "-9.81", "--magnetic", "1", "0", "-1")
    report = answer("log", tmp_path / "flight", *given, "--anchor", "0", "0", "-1.5", "--window", "12")
    assert report["observer"]["position"]["quarters_rmse"][-1] < 1.0
    assert "--world given needs --gravity" in complaint("log", tmp_path / "flight", "--world", "given")
    assert "used with --world given" in complaint("log", tmp_path / "flight", "--gravity", "0", "0", "-9.81")


def test_blind_and_rangeless_records_say_null_with_a_reason(answer, tmp_path):
    answer("export", "hover", "--to", "log", "-o", tmp_path / "x.csv")
    report = answer("log", tmp_path / "x.csv")
    assert (report["verdict"], report["informative"]["position"]) == ("blind", None)
    assert report["observer"]["fit"]["words"] == "fits the ranges, position cannot be told"
    assert report["informative"]["reason"].startswith("null:")
    rows = (tmp_path / "x.csv").read_text().splitlines()
    k = next(j for j, row in enumerate(rows) if not row.startswith("#"))
    columns = [row.split(",")[:10] for row in rows[k:]]
    (tmp_path / "bare.csv").write_text("\n".join([*rows[:k], *map(",".join, columns)]))
    plain_name = answer("log", tmp_path / "bare.csv")
    assert plain_name["observer"] is None
    assert "--synthetic-ranges" in plain_name["observer_reason"]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--synthetic-ranges", "-1", "--anchor", "0", "0", "0"), "must lie between 0.001 and 100 m, got -1"),
        (("--range-sigma", "0"), "--range-sigma must lie between 0.001 and 100 m, got 0"),
        (("--window", "99"), "the window must be shorter than the record's 20 s"),
        (("--window", "nan"), "--window: must be a finite number"),
        (("--begin", "50"), "x.csv: --begin, --end: no two samples from 50 s on: the record goes from 0 s to 20 s"),
        (("--anchor", "nan", "0", "0"), "Error parsing --anchor"),
    ],
)
def test_nonsense_is_refused_in_one_sentence(complaint, tmp_path, arguments, said):
    formats.export(preset.load("soft"), "log", tmp_path / "x.csv")
    assert said in complaint("log", tmp_path / "x.csv", *arguments)


def test_a_magnetic_direction_in_five_digits_is_used_and_said(run, tmp_path):
    text = preset.dumps(preset.load("barrel")).replace("0.7071067811865476", "0.70711")
    assert "0.70711" in text
    (tmp_path / "mine.toml").write_text(text)
    code, out, err = run("analyze", tmp_path / "mine.toml", "--json")
    assert (code, err) == (0, "magnetic has the length 1.000005: it is used as a unit vector\n")
    assert out.startswith("{")


def test_units_that_the_file_states_and_the_data_confirm_are_taken_and_named(complaint, answer):
    path = shared("imu/fusion_sensor_data.csv")
    assert "--frame z-up" in complaint("log", path)
    report = answer("log", path, "--frame", "z-up")
    for taken in ("the gyro: deg/s", "the accelerometer: g", "the magnetometer: uT"):
        assert any(finding.startswith(f"{taken}, as the file states;") for finding in report["findings"])
    assert report["observer"] is None
    assert report["informative"]["windows"]["blind"] > 40  # it mostly lies on a table


def test_broad_on_the_command_line_is_the_library(answer):
    path = shared("imu/broad_21_undisturbed_fast_combined.mat")
    asked = ("--mag-unit", "uT", "--world", "still", "--anchor", "1.5", "1.2", "0.2", "--synthetic-ranges", "0.05")
    report = answer("log", path, *asked, "--begin", "36.3", "--end", "154.2")
    assert report["observer"]["position"]["median"] < 0.8
    assert report["observer"]["attitude_deg"]["median"] < 5
    assert report["informative"]["windows"]["blind"] == 0  # in the last one it mostly stands still: weak, 45 m
    assert np.linalg.norm(report["world"]["gravity"]) == pytest.approx(9.82, abs=0.01)


def test_columns_may_be_chosen_with_one_option_or_with_one_each(run, tmp_path):
    """Each choice counts: no later one takes the place of an earlier one."""
    rows = [f"{k / 50},0,0,{k % 2},0,0,9.81,{2 + k / 100},{5 + k / 100}" for k in range(60)]
    header = (
        "t [s],roll [rad/s],pitch [rad/s],yaw [rad/s],accel_x [m/s2],accel_y [m/s2],accel_z [m/s2],near [m],far [m]"
    )
    (tmp_path / "x.csv").write_text("\n".join([header, *rows]))
    once = ("--columns", "gyro=roll,pitch,yaw", "range=far")
    each = ("--columns", "gyro=roll,pitch,yaw", "--columns=range=far")
    for chosen in (once, each):
        code, out, _ = run("log", tmp_path / "x.csv", *chosen, "--list-columns", "--json")
        uses = json.loads(out)["columns"]
        assert (code, uses["yaw [rad/s]"], uses["far [m]"], uses["near [m]"]) == (0, "gyro", "range", "")
