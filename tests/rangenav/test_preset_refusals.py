"""What is no preset is refused in one sentence that names the file, the rule and the field."""

import re
from pathlib import Path

import msgspec
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rangenav import preset
from tests.support.toml_fragments import TOML_FRAGMENTS

pytestmark = pytest.mark.slow


SHIPPED = preset.shipped()
NAMES = sorted(SHIPPED)
ROOT = Path(preset.__file__).parent.parent
PAPER_TEXT = (ROOT / "presets" / "paper.toml").read_text(encoding="utf-8")


def refusal(text, source="eight.toml"):
    """What is said about a text that is no preset; None if it is one."""
    try:
        preset.loads(text, source=source)
    except ValueError as error:
        return str(error)
    return None


def edited(old, new):
    """The paper's preset with one piece of text replaced."""
    assert old in PAPER_TEXT
    return PAPER_TEXT.replace(old, new, 1)


NO_PLACE = ""
REFUSALS = [
    pytest.param(edited("seed = 1", "colour = 2"), "unknown field `colour`", NO_PLACE, id="unknown key"),
    pytest.param(edited("mag = 0.1", "mog = 0.1"), "unknown field `mog`", "$.sensors.noise", id="unknown nested key"),
    pytest.param(edited("[gains]", "[gians]"), "unknown field `gians`", NO_PLACE, id="unknown table"),
    pytest.param(
        edited("frequency = 8.0", 'frequency = "fast"'),
        "Expected `float`, got `str`",
        "$.path.tones[0].frequency",
        id="text",
    ),
    pytest.param(
        edited("duration = 20.0", "duration = true"), "Expected `float`, got `bool`", "$.duration", id="truth"
    ),
    pytest.param(
        edited("duration = 20.0", "duration = 1979-05-27"), "Expected `float`, got `date`", "$.duration", id="date"
    ),
    pytest.param(edited("seed = 1", "seed = 1.5"), "Expected `int`, got `float`", "$.seed", id="broken seed"),
    pytest.param(
        edited("drift = [0.0, 0.0, 0.0]", "drift = [0.0]"), "length 3, got 1", "$.path.drift", id="short vector"
    ),
    pytest.param(re.sub("title = .*", "", PAPER_TEXT), "missing required field `title`", NO_PLACE, id="missing key"),
    pytest.param(edited("version = 1", "version = 2"), "Invalid enum value 2", "$.version", id="later version"),
    pytest.param(
        edited('axis = "x"', 'axis = "w"'), "Invalid enum value 'w'", "$.path.tones[0].axis", id="no such axis"
    ),
    pytest.param(edited('"multisine"', '"spline"'), "Invalid value 'spline'", "$.path.kind", id="no such kind"),
    pytest.param(
        edited("frequency = 8.0", "frequency = nan"), "frequency must be a finite", "$.path.tones[0]", id="nan"
    ),
    pytest.param(
        edited("amplitude = 0.3", "amplitude = -inf"), "amplitude must be a finite", "$.path.tones[1]", id="inf"
    ),
    pytest.param(edited("offset = [0.0", "offset = [nan"), "offset must be a finite", "$.path", id="nan in a vector"),
    pytest.param(
        edited("mu = 10000000.0", "mu = inf"), "mu must be a finite", "$.requirement", id="infinite requirement"
    ),
    pytest.param(
        re.sub(r"magnetic = .*", "magnetic = [0.0, 0.0, -1.0]", PAPER_TEXT),
        "must not be collinear",
        "$.world",
        id="collinear",
    ),
    pytest.param(
        re.sub(r"magnetic = .*", "magnetic = [1, 1, 0]", PAPER_TEXT), "a unit vector", "$.world", id="not unit"
    ),
    pytest.param(edited("gyro = 0.01", "gyro = -0.01"), "noise gyro must be 0", "$.sensors.noise", id="negative noise"),
    pytest.param(
        edited("duration = 20.0", "duration = 1e6"), "duration must lie between 0.5 and 3600 s", NO_PLACE, id="long"
    ),
    pytest.param(
        edited("duration = 20.0", "duration = -1"), "duration must lie between", NO_PLACE, id="negative duration"
    ),
    pytest.param(
        edited("imu_rate = 200.0", "imu_rate = 1e9"), "imu_rate must lie between", "$.sensors", id="absurd rate"
    ),
    pytest.param(
        edited("range_rate = 200.0", "range_rate = 0"), "range_rate must lie between", "$.sensors", id="no rate"
    ),
    pytest.param(
        edited("imu_rate = 200.0", "imu_rate = 20"), "mag_rate must lie between", "$.sensors", id="mag over imu"
    ),
    pytest.param(
        edited("range = 0.1", 'range = 0.1\nimu_unit = "root"'),
        "Invalid enum value",
        "$.sensors.noise.imu_unit",
        id="unit",
    ),
    pytest.param(
        edited("accel = 0.1", "accel = 100").replace("range = 0.1", 'range = 0.1\nimu_unit = "density"'),
        "noise accel must be 0, or lie between 1e-09 and 1000, got 1414.21 per sample at 200 Hz",
        "$.sensors",
        id="density at this rate",
    ),
    pytest.param(
        edited("[gains]", "[sensors.unmodelled]\nlever_arm = [0.0, 0.0, 1e4]\n[gains]"),
        "lever_arm must not be longer than 100 m, got 10000",
        "$.sensors.unmodelled",
        id="antenna in the next town",
    ),
    pytest.param(
        edited("[gains]", "[sensors.unmodelled]\ndropout_probability = 1.0\n[gains]"),
        "dropout_probability must lie between 0 and 1, 1 excluded, got 1",
        "$.sensors.unmodelled",
        id="no range ever",
    ),
    pytest.param(
        edited("[gains]", "[sensors.unmodelled]\nhum = 1.0\n[gains]"),
        "unknown field `hum`",
        "$.sensors.unmodelled",
        id="unknown effect",
    ),
    pytest.param(
        edited("duration = 20.0", "duration = 600").replace("imu_rate = 200.0", "imu_rate = 1e4"),
        "duration × rate must not exceed 2000000 samples, got 6000000",
        NO_PLACE,
        id="too many samples",
    ),
    pytest.param(
        edited("window = 6.0", "window = 20"),
        "window must be shorter than the duration, got 20 s",
        NO_PLACE,
        id="window",
    ),
    pytest.param(
        edited("window = 6.0", "window = 0.01"), "window must lie between 0.05", "$.requirement", id="no window"
    ),
    pytest.param(
        edited("window = 6.0", "window = 0.05").replace("_rate = 200.0", "_rate = 50.0").replace("= 16.0", "= 9.0"),
        "requirement.window must be at least 4 IMU samples long, got 2.5",
        NO_PLACE,
        id="window between two samples",
    ),
    pytest.param(
        edited("frequency = 8.0", "frequency = 629"),
        "path: 629 rad/s is faster than the IMU can sample",
        NO_PLACE,
        id="aliased",
    ),
    pytest.param(
        edited("frequency = 0.1", "frequency = 700"),
        "angular_velocity: 700 rad/s is faster",
        NO_PLACE,
        id="aliased turning",
    ),
    pytest.param(
        edited("frequency = 8.0", "frequency = 0"), "frequency must lie between", "$.path.tones[0]", id="no tone"
    ),
    pytest.param(edited("q = 5000.0", "q = 0.0"), "q must lie between 0.001 and 100000", "$.gains.riccati", id="q = 0"),
    pytest.param(
        edited("xi = 0.001", "xi = 0.0"), "v.xi must lie between 1e-06 and 100", "$.gains.riccati", id="v = 0"
    ),
    pytest.param(edited("k1 = 4.0", "k1 = -4.0"), "k1 must lie between", "$.gains.attitude", id="negative k1"),
    pytest.param(
        edited("[guess]", "[gains.attitude.schedule]\nsteady = 5.0\n[guess]"),
        "schedule.steady must not exceed k1 (4), got 5",
        "$.gains.attitude",
        id="schedule upside down",
    ),
    pytest.param(edited("_axis = [0.0", "_axis = [1e200"), "must be shorter than 1e9", "$.guess", id="axis too long"),
    pytest.param(edited("_angle = 1.57", "_angle = 15.7"), "attitude_angle must lie in", "$.guess", id="angle over π"),
    pytest.param(
        edited("seed = 1", "seed = -1"), "seed must lie between 0 and 2^53, got -1", NO_PLACE, id="negative seed"
    ),
    pytest.param(
        edited("seed = 1", "seed = " + "9" * 5000),
        "more than 100 characters in the value",
        NO_PLACE,
        id="integer of 5000 digits",
    ),
    pytest.param(
        edited("duration = 20.0", "duration = 1e400"), "must be a finite number, got inf", NO_PLACE, id="beyond floats"
    ),
    pytest.param(edited("title = ", 'title = ""\nstory = '), "", NO_PLACE, id="key twice"),
    pytest.param(re.sub("title = .*", 'title = ""', PAPER_TEXT), "title must have 1 to 80", NO_PLACE, id="empty title"),
    pytest.param(
        edited("initial_rotation = [0.0", "initial_rotation = [7.0"), "at most 2π rad", NO_PLACE, id="turned twice"
    ),
    pytest.param(edited("[path]", "[path"), "at line 9, column 6", NO_PLACE, id="broken TOML"),
    pytest.param("title = ", "Invalid value", NO_PLACE, id="cut off"),
    pytest.param("", "missing required field `title`", NO_PLACE, id="empty"),
    pytest.param("a = " + "[" * 50_000, "more than 16 brackets", NO_PLACE, id="deep arrays"),
    pytest.param("a = " + "{b = " * 50_000, "more than 16 brackets", NO_PLACE, id="deep tables"),
    pytest.param('"a\\nb" = 1', "unknown field `a b`", NO_PLACE, id="line end in a key"),
]


@pytest.mark.parametrize(("text", "rule", "place"), REFUSALS)
def test_a_bad_preset_is_refused_in_one_sentence_that_names_file_rule_and_field(text, rule, place):
    sentence = refusal(text)
    assert sentence is not None
    assert sentence.startswith("eight.toml: ")
    assert rule in sentence
    assert sentence.endswith(f" - at `{place}`") if place else " - at " not in sentence
    assert "\n" not in sentence
    assert len(sentence) < 250


@settings(max_examples=200)
@given(st.text())
def test_no_text_whatever_raises_anything_but_a_sentence(text):
    sentence = refusal(text)
    assert sentence is None or (sentence.startswith("eight.toml: ") and "\n" not in sentence)


@settings(max_examples=200)
@pytest.mark.filterwarnings("ignore::rangenav.motion.DirectionWarning")  # a field damaged by less than 1e-3
@given(
    st.sampled_from(NAMES),
    st.lists(
        st.tuples(
            st.floats(0, 1),
            st.integers(0, 25),
            st.sampled_from([*TOML_FRAGMENTS, "[[path.tones]]"]) | st.text(max_size=3),
        ),
        min_size=1,
        max_size=3,
    ),
)
def test_a_shipped_file_damaged_anywhere_is_read_or_refused_in_one_sentence(name, damages):
    text = preset.dumps(SHIPPED[name])
    for where, length, replacement in damages:
        start = int(where * len(text))
        text = text[:start] + replacement + text[start + length :]
    sentence = refusal(text)
    assert sentence is None or (sentence.startswith("eight.toml: ") and "\n" not in sentence)


@pytest.mark.parametrize(
    ("name", "content", "sentence"),
    [
        ("binary.toml", b'title = "\xff\xfe"', "binary.toml: not UTF-8 text (byte 9)"),
        ("huge.toml", b"#" * 1_000_001, "huge.toml: larger than 1000000 bytes, which no preset is"),
        ("broken.toml", b"title", "broken.toml: "),
    ],
)
def test_a_file_that_is_no_preset_is_refused_by_its_name(tmp_path, name, content, sentence):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(ValueError, match="^" + re.escape(sentence)):
        preset.load(tmp_path / name)


def test_what_is_no_file_is_refused_by_its_name(tmp_path):
    (tmp_path / "folder.toml").mkdir()
    long = "a" * 5000 + ".toml"
    for path, rule in [
        ("none.toml", "no such file"),
        ("folder.toml", "not a file"),
        ("", "not a file"),
        (long, "too long"),
    ]:
        with pytest.raises(ValueError, match=rule) as refused:
            preset.load(tmp_path / path)
        assert str(refused.value).startswith(str(tmp_path / path))


def test_a_file_one_may_not_read_is_refused_by_its_name(tmp_path, monkeypatch):
    def forbidden(path, mode):
        raise PermissionError(13, "Permission denied", str(path))

    (tmp_path / "secret.toml").touch()
    monkeypatch.setattr(Path, "open", forbidden)  # root, who runs most gates, may read everything
    with pytest.raises(ValueError, match=r"secret.toml: cannot be read: Permission denied"):
        preset.load(tmp_path / "secret.toml")


@pytest.mark.parametrize(
    ("name", "meant"), [("papper", "paper"), ("", ""), ("PAPER", ""), ("paper\x00", "paper"), ("circle ", "circle")]
)
def test_an_unknown_name_is_answered_with_the_nearest_and_all_shipped_ones(name, meant):
    before = f"did you mean {meant}? Shipped" if meant else "shipped"
    sentence = f"{name}: no such preset; {before} are barrel, circle, eight-repaired, "
    with pytest.raises(ValueError, match="^" + re.escape(sentence)):
        preset.load(name)


@pytest.mark.parametrize(
    ("title", "match"),
    [
        ("", "title must have 1 to 80 printable characters, got none"),
        ("   ", "title must have 1 to 80 printable characters, got blanks only"),
        ("x" * 81, "title must have 1 to 80 printable characters, got 81"),
        ("a\x00b", r"mark of writing direction: got U\+0000 at character 2"),
        ("two\nlines", r"line end.*: got U\+000A at character 4"),
        ("\u202edesrever", r"mark of writing direction: got U\+202E at character 1"),
        ("two\u2028lines", r"got U\+2028 at character 4"),
    ],
)
def test_a_title_that_cannot_be_shown_as_it_is_is_refused_from_a_file_in_the_words_of_the_pages_box(title, match):
    from explorer.storage.catalog import checked_title

    text = preset.dumps(preset.load("soft"))
    damaged = msgspec.toml.encode(msgspec.toml.decode(text) | {"title": title}).decode()
    with pytest.raises(ValueError, match=match) as from_file:
        preset.loads(damaged, source="x.toml")
    with pytest.raises(ValueError, match=match) as from_box:
        checked_title(title)
    if title.strip():
        assert str(from_file.value).startswith(f"x.toml: {from_box.value}")


def test_a_title_may_have_any_script_and_any_blank():
    for title in ("Süd « Tour » 1", "北 — 南", "é̂ ∫p⁗"):
        shown = msgspec.structs.replace(preset.load("soft"), title=title)
        assert preset.loads(preset.dumps(shown), source="x.toml") == shown
