"""The command line as a person and a script meet it: keys, exit codes, one line of complaint, and never a traceback."""

import json
import math
import subprocess
import sys

import msgspec
import numpy as np
import pytest

import rangenav
from rangenav import analysis, preset, range_fit, record, report
from rangenav.commands import overview
from rangenav.observability import excitation
from rangenav.signals import Multisine
from tests.support.null_reasons import nulls_without_reason

pytestmark = pytest.mark.slow


SHORT = msgspec.structs.replace(preset.load("paper"), duration=8.0)
"""The paper's path, long enough to settle on and short enough to run often."""


@pytest.fixture
def short(tmp_path):
    """A file with a short preset."""
    preset.save(SHORT, tmp_path / "short.toml")
    return tmp_path / "short.toml"


def shape(value):
    """Keys of nested objects, lengths of lists: what a contract fixes."""
    if isinstance(value, dict):
        return {key: shape(entry) for key, entry in value.items()}
    return len(value) if isinstance(value, list) else None


BLOCKS = dict.fromkeys(("position", "velocity", "gravity"))
ANALYZE = {
    "preset": None,
    "duration": None,
    "limits": dict.fromkeys(
        ("speed", "acceleration", "thrust_to_weight", "body_rate", "jerk", "snap", "anchor_distance_min")
    ),
    "excitation": {
        "window": None,
        "mu": None,
        "at": None,
        "eigenvalues": 3,
        **dict.fromkeys(("floor", "required", "requirement")),
        "bound_for_all_t": None,
        "printed": {"mu": None, "at": None, "eigenvalues": 3},
        "proven": None,
        "starts": None,
        "lower": None,
    },
    "gramian": {
        **dict.fromkeys(("window", "at", "rank", "tolerance", "floor", "proven", "starts", "rank_bound")),
        "eigenvalues": 13,
    },
    "nonlinear": {"window": None, "at": None, "eigenvalues": 9, "rank": None, "floor": None},
    "blind_directions": 0,
    "accuracy": {
        "window": None,
        "at": None,
        "range_sigma": None,
        "range_rate": None,
        "lifted": {"start": BLOCKS, "end": BLOCKS},
        "nonlinear": {"start": BLOCKS, "end": BLOCKS},
        **dict.fromkeys(("ranges", "sphere", "proven", "starts", "bound", "reason")),
    },
    "caveats": 1,
    **dict.fromkeys(("verdict", "verdict_words", "verdict_sign")),
}
SIMULATE = {
    "preset": None,
    "seed": None,
    "model": None,
    "steps": None,
    "microseconds_per_step": None,
    "peak": {"position": None},
    "settle": {"position_s": None, "attitude_s": None},
    "steady": dict.fromkeys(("position_rmse", "velocity_rmse", "gravity_rmse", "attitude_rmse_deg")),
    "final": dict.fromkeys(("position", "velocity", "gravity", "attitude_deg")),
    "fit": dict.fromkeys(("word", "words", "mode", "given_up", "gains")),
    "predicted": {"position": None},
    "own": {"position": None},
    "range_residual": None,
    "diverged": None,
    **dict.fromkeys(("verdict", "verdict_words", "verdict_sign")),
}


def test_presets_lists_every_shipped_preset_with_title_and_expectation(answer):
    listed = answer("presets")["presets"]
    shipped = preset.shipped()
    assert list(listed) == list(shipped)
    for name, row in listed.items():
        assert row == {"title": shipped[name].title, "story": shipped[name].story, "expect": shipped[name].expect}


def test_analyze_answers_with_exactly_the_contracts_keys(answer):
    assert shape(answer("analyze", "paper-slow")) == ANALYZE


def test_simulate_answers_with_exactly_the_contracts_keys(answer, short):
    assert shape(answer("simulate", short)) == SIMULATE


@pytest.mark.parametrize("name", sorted(preset.shipped()))
def test_every_shipped_preset_is_analysed_with_finite_numbers_or_a_null_with_its_reason(answer, name):
    output = answer("analyze", name)
    assert nulls_without_reason(output) == []
    assert (output["gramian"]["rank"] == 13) == (preset.load(name).expect != "unobservable")
    assert (output["verdict"] == "blind") == bool(output["blind_directions"])
    for direction in output["blind_directions"]:
        assert math.hypot(*direction["vector"]) == pytest.approx(1)
        assert direction["words"]


def test_a_path_without_a_common_period_says_why_there_is_no_bound_for_all_t(answer, tmp_path):
    assert isinstance(SHORT.path, Multisine)
    tones = tuple(
        msgspec.structs.replace(tone, frequency=w)
        for tone, w in zip(SHORT.path.tones, (2.0, 3.1415926, 2.7182818), strict=True)
    )
    preset.save(msgspec.structs.replace(SHORT, path=Multisine(tones=tones)), tmp_path / "free.toml")
    output = answer("analyze", tmp_path / "free.toml")
    assert output["excitation"]["bound_for_all_t"] is None
    assert "does not repeat" in output["excitation"]["bound_reason"]
    assert nulls_without_reason(output) == []


def test_a_run_that_never_settles_says_so_beside_the_null(answer):
    output = answer("simulate", "hover")
    assert output["settle"]["position_s"] is None
    assert nulls_without_reason(output) == []


def test_the_numbers_are_those_of_the_library(answer):
    p = preset.load("lissajous")
    library = analysis.analyse(p)
    output = answer("analyze", "lissajous")
    assert output == json.loads(json.dumps(report.analysis_report(p, library, name="lissajous")))
    assert output["gramian"]["eigenvalues"] == sorted(output["gramian"]["eigenvalues"])
    assert output["excitation"]["mu"] == pytest.approx(library.mu)
    assert output["verdict"] == library.verdict.word == "observable"


def test_the_printed_excitation_is_reported_at_its_own_worst_window(answer):
    p = preset.load("hover")
    truth = record.run(p).truth.motion
    signal = excitation.chosen_signal(truth, printed_formula=True, body_axes=True)
    printed = answer("analyze", "hover")["excitation"]["printed"]
    there = excitation.sampled_eigenvalues(signal, truth.time, np.array([printed["at"]]), 6.0)[0]
    np.testing.assert_allclose(printed["eigenvalues"], there, rtol=1e-9)
    assert printed["mu"] == printed["eigenvalues"][0]
    everywhere = excitation.sampled_eigenvalues(signal, truth.time, np.linspace(0, 14, 57), 6.0)
    # between 101 starts the curve may dip a little lower than on them
    assert printed["mu"] <= 1.01 * everywhere[:, 0].min()


def test_window_overrides_the_presets_own(answer):
    own, longer = answer("analyze", "soft"), answer("analyze", "soft", "--window", "15")
    for part in ("excitation", "gramian", "nonlinear", "accuracy"):
        assert (own[part]["window"], longer[part]["window"]) == (12.0, 15.0)
    # a longer window contains a shorter one: the integral can only grow
    assert longer["excitation"]["mu"] > own["excitation"]["mu"]
    assert longer["excitation"]["mu"] == pytest.approx(
        analysis.analyse(preset.with_window(preset.load("soft"), 15.0, source="soft")).mu
    )


def test_a_seed_gives_the_same_run_again_and_another_seed_another(answer, short):
    first, again, other = (answer("simulate", short, "--seed", seed) for seed in (3, 3, 4))
    for one in (first, again, other):
        assert one.pop("microseconds_per_step") > 0  # a clock's reading, the only thing that may differ
    assert first == again
    assert (first["seed"], other["seed"]) == (3, 4)
    assert first["steady"] != other["steady"]


def test_without_a_seed_the_presets_own_is_used(answer, short):
    own, given = answer("simulate", short), answer("simulate", short, "--seed", SHORT.seed)
    assert own["steady"] == given["steady"]
    assert own["steps"] == 8.0 * 200.0


def test_several_runs_are_told_by_their_medians(answer, short):
    single = [answer("simulate", short, "--seed", seed) for seed in (5, 6, 7)]
    together = answer("simulate", short, "--seed", "5", "--runs", "3")
    assert together["runs"] == 3
    assert together["fits"] == f"3 {range_fit.WHITE}"
    assert together["runs_fit"] == {"consistent": 3, "overconfident": 0, "correlated": 0, "lost": 0, "not judged": 0}
    assert together["runs_settled"] == {
        key: sum(one["settle"][f"{key}_s"] is not None for one in single) for key in ("position", "attitude")
    }
    assert together["runs_diverged"] == 0
    for part in ("peak", "steady", "final", "settle"):
        for key, value in together[part].items():
            assert value == pytest.approx(sorted(one[part][key] for one in single)[1])
    assert together["range_residual"] == pytest.approx(sorted(one["range_residual"] for one in single)[1])
    assert together["own"]["position"] == pytest.approx(sorted(one["own"]["position"] for one in single)[1])


def test_the_printed_model_is_metres_off_where_the_derived_one_is_centimetres(answer, short):
    derived, printed = (answer("simulate", short, "--model", form)["steady"] for form in ("derived", "printed"))
    assert derived["position_rmse"] < 0.2
    assert printed["position_rmse"] > 1.0


def test_save_writes_every_array_of_the_run(answer, short, tmp_path):
    output = answer("simulate", short, "--save", tmp_path / "run.npz")
    n, m = 1601, 1601  # 8 s at 200 Hz, and a range with every sample
    expected = {
        "time": (n,),
        **dict.fromkeys(("position", "velocity", "acceleration", "jerk", "snap", "angular_velocity"), (n, 3)),
        "rotation": (n, 3, 3),
        **dict.fromkeys(("gyro", "accel", "mag"), (n, 3)),
        "range": (m,),
        "range_time": (m,),
        "state": (n, 13),
        "std": (n, 13),
        "rotation_estimate": (n, 3, 3),
        "phi": (n, 3),
        "phi_printed": (n, 3),
        "model": (),
    }
    with np.load(tmp_path / "run.npz", allow_pickle=False) as saved:
        assert {name: saved[name].shape for name in saved.files} == expected
        assert saved["model"] == output["model"] == "derived"
        run = record.run(SHORT)
        np.testing.assert_array_equal(saved["state"], run.estimate.state)
        np.testing.assert_array_equal(saved["range"], run.measurements.range)
        np.testing.assert_array_equal(saved["snap"], run.truth.motion.snap)
        # φ = Rᵀp⁗
        np.testing.assert_allclose(np.einsum("nij,nj->ni", saved["rotation"], saved["phi"]), saved["snap"], atol=1e-9)
        body_error = saved["state"][-1, 4:7] - saved["rotation"][-1].T @ saved["position"][-1]
    assert np.linalg.norm(body_error) == pytest.approx(output["final"]["position"])


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["presets"], ["paper-slow", "✓ observable", "✗ unobservable"]),
        (["analyze", "hover"], ["hover   ✗ blind", "rank 5 of 13", "nothing excites x"]),
        (["analyze", "paper"], ["paper   ✓ observable", "excitation μ", "m²/s⁷"]),
        (["simulate", "line"], ["steady error", "position: does not stay below 0.3 m"]),
    ],
)
def test_without_json_a_report_is_printed_for_people(run, arguments, words):
    code, out, err = run(*arguments)
    assert (code, err) == (0, "")
    for word in words:
        assert word in out


def test_brackets_in_a_title_are_text_and_no_markup(run, tmp_path):
    title = "[/bold] 100% [red]eight"
    preset.save(msgspec.structs.replace(SHORT, title=title), tmp_path / "odd.toml")
    for command in ("analyze", "simulate"):
        code, out, err = run(command, tmp_path / "odd.toml")
        assert (code, err) == (0, "")
        assert title in out


BAD = [
    ([], "see rangenav --help"),
    (["fly"], "rangenav fly: no such command; there are presets, analyze"),
    (["studdy", "run"], "rangenav studdy: no such command; did you mean study? There are presets"),
    (["study", "rn", "h.toml"], "rangenav study rn: no such command; did you mean run? There are plan, run, show"),
    (["study", "run"], "Missing from rangenav study run: STUDY (a shipped study's name or a path to a TOML file) (see"),
    (["study", "preset", "h.zarr"], "that export writes), -o FILE.toml, --output FILE.toml (the preset's file) (see"),
    (["analyze"], "Missing from rangenav analyze: PRESET ("),
    (["analyze", "paper", "twice"], "not understood: twice (see rangenav analyze --help)"),
    (["analyze", "paper", "twice"], "twice"),
    (["analyze", "papper"], "papper: no such preset; did you mean paper? Shipped are barrel"),
    (["analyze", "none.toml"], "none.toml: no such file"),
    (["analyze", "."], "no such preset"),
    (["analyze", "broken.toml"], "broken.toml: Expected `float`, got `str` - at `$.duration`"),
    (["simulate", "binary.toml"], "binary.toml: not UTF-8 text"),
    (["analyze", "paper", "--window"], "--window"),
    (["analyze", "paper", "--window", "wide"], "--window"),
    (["analyze", "paper", "--window", "nan"], "--window: must be a finite number, got 'nan'"),
    (["analyze", "paper", "--window", "0"], "window must lie between 0.05 and 3600 s, got 0"),
    (["analyze", "paper", "--window", "20"], "window must be shorter than the duration, got 20 s"),
    (["analyze", "paper", "--widow", "3"], "--widow"),
    (["simulate", "paper", "--seed", "-1"], "seed must lie between 0 and 2^53, got -1"),
    (["simulate", "paper", "--seed", "x"], "--seed"),
    (["simulate", "paper", "--runs", "0"], "--runs must lie between 1 and 10000, got 0"),
    (["simulate", "paper", "--model", "both"], "both"),
    (["simulate", "paper", "--save", "run.txt"], "--save must name a file that ends in .npz, got run.txt"),
    (["simulate", "paper", "--save", "nowhere/run.npz"], "--save nowhere/run.npz: no such folder"),
]


@pytest.mark.parametrize("json_flag", [[], ["--json"]], ids=["table", "json"])
@pytest.mark.parametrize(("arguments", "words"), BAD, ids=[" ".join(arguments) or "nothing" for arguments, _ in BAD])
def test_bad_input_is_answered_by_one_line_on_stderr_and_exit_2(
    run, tmp_path, monkeypatch, arguments, words, json_flag
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "broken.toml").write_text(preset.dumps(SHORT).replace("duration = 8.0", 'duration = "long"'))
    (tmp_path / "binary.toml").write_bytes(b"\xff\xfe")
    code, out, err = run(*arguments, *json_flag)
    assert (code, out) == (2, "")
    assert words in err
    assert err.count("\n") == 1
    assert err.endswith("\n")
    assert "Traceback" not in err
    assert not set("│╭╮╰╯─") & set(err)
    assert "---" not in err  # no frame, in either drawing


def test_help_says_what_there_is(run):
    code, out, _ = run("--help")
    assert code == 0
    for command in overview.NAMES:
        assert f"\n  {command:<10}" in out
        assert f"$ rangenav {command}" in out
    assert max(map(len, out.splitlines())) <= 80


def test_the_version_is_the_packages_own(run):
    assert run("--version") == (0, f"rangenav {rangenav.__version__}\n", "")


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_a_completion_script_names_every_command(run, shell):
    code, out, err = run("--tyro-print-completion", shell)
    assert (code or 0, err) == (0, "")
    assert all(command in out for command in overview.NAMES)


def subprocess_run(*arguments, cwd):
    command = [sys.executable, "-W", "error", "-m", "rangenav", *map(str, arguments)]
    return subprocess.run(command, cwd=cwd, capture_output=True, text=True, timeout=120, check=False)


def test_as_a_process_it_prints_one_object_and_nothing_else(tmp_path):
    done = subprocess_run("analyze", "lissajous", "--json", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert json.loads(done.stdout)["gramian"]["rank"] == 13


def test_as_a_process_it_refuses_a_bad_file_in_one_line(tmp_path):
    (tmp_path / "bad.toml").write_text(preset.dumps(SHORT).replace("k1 = 4.0", "k1 = inf"))
    done = subprocess_run("simulate", "bad.toml", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "bad.toml: k1 must be a finite number, got inf - at `$.gains.attitude`\n"


def test_a_reader_that_leaves_early_is_no_error(tmp_path):
    command = f"{sys.executable} -m rangenav presets --json | true"
    done = subprocess.run(
        ["bash", "-o", "pipefail", "-c", command], cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")
