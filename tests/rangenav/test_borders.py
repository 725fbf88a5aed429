"""What a caller gives to an observer or to a question about a path is checked before it is used: nothing ends the
interpreter, every refusal is one sentence, and whatever holds the right numbers gives what arrays of float64 give."""

# pyright: reportArgumentType=false, reportCallIssue=false
# Arguments of the wrong type are what this file is about.

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import jaxtyping
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from rangenav import baselines, cascade, errors, reference, refine, strapdown
from rangenav.cascade import Sample
from rangenav.observability import accuracy, ambiguity, blindness, excitation, frozen, functions, reduced, rows
from rangenav.observability import spectrum as spectra
from tests.support import records
from tests.support.refusals import exactly

pytestmark = pytest.mark.slow


SCENE = records.scene("paper-slow", duration=0.5, imu_rate=40.0, range_rate=20.0)
Z, START, CONFIG = SCENE.measurements, SCENE.start, SCENE.setting()
PATH = SCENE.preset.path
FIELDS = ("time", "gyro", "accel", "mag", "range_time", "range")
OBSERVERS = [cascade.observe, reference.observe, baselines.ekf]
ODD = [
    None,
    "text",
    ["1", "2", "3"],
    3.0,
    [],
    [[]],
    [1, None, 3],
    np.zeros((3, 3, 3)),
    np.zeros(3, dtype=complex),
    np.array([object()] * 3),
    np.full((21, 3), np.inf),
    np.full((21, 3), np.nan),
    np.full(21, -np.inf),
    {"x": 1.0},
]


@pytest.fixture(autouse=True, scope="module")
def _no_checker_of_the_tests() -> Iterator[None]:
    """Without the checker of shapes that conftest puts around the library: here the library's own checks answer."""
    jaxtyping.config.update("jaxtyping_disable", True)
    yield
    jaxtyping.config.update("jaxtyping_disable", False)


def observed(observe: Callable[..., Any], **fields: Any) -> Any:
    return observe(replace(Z, **fields), START, CONFIG)


@pytest.mark.parametrize("observe", OBSERVERS)
@pytest.mark.parametrize(
    ("fields", "sentence"),
    [
        ({"gyro": Z.gyro.T}, "gyro must have shape (21, 3), got (3, 21)"),
        ({"mag": Z.mag[:10]}, "mag must have shape (21, 3), got (10, 3)"),
        ({"accel": Z.accel[:, 0]}, "accel must have shape (21, 3), got (21,)"),
        ({"time": Z.time[:, None]}, "time must have shape (n,), got (21, 1)"),
        ({"range_time": Z.range_time[:4]}, "range must have shape (4,), got (11,)"),
        ({"range": None}, "range must hold numbers, got None"),
        (
            {"mag": None},
            "mag must hold numbers, got None: where the magnetometer gave no sample, write NaN in all three columns",
        ),
        ({"time": Z.time[::-1]}, "time must increase: broken at sample 1"),
        ({"range_time": Z.range_time[::-1]}, "range_time must increase: broken at sample 1"),
        ({"gyro": np.where(np.arange(21)[:, None] == 4, np.inf, Z.gyro)}, "gyro must be finite: broken at sample 4"),
        ({"accel": Z.accel.astype(object)}, "accel must hold numbers, got objects of type float"),
        ({"accel": Z.accel.astype(str)}, "accel must hold numbers, got text"),
    ],
)
def test_a_record_is_refused_by_argument_shape_wanted_and_shape_given(observe, fields, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        observed(observe, **fields)


@pytest.mark.parametrize("observe", OBSERVERS)
@pytest.mark.parametrize(
    ("start", "sentence"),
    [
        ({"state": np.zeros(9)}, "start.state must have shape (13,), got (9,)"),
        ({"rotation": np.eye(4)}, "start.rotation must have shape (3, 3), got (4, 4)"),
        ({"state": np.full(13, np.nan)}, "start.state must be finite, got nan at [0]"),
    ],
)
def test_a_start_is_refused_in_the_same_way(observe, start, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        observe(Z, replace(START, **start), CONFIG)


@pytest.mark.parametrize("observe", OBSERVERS)
@pytest.mark.parametrize("as_given", [np.ndarray.tolist, np.asfortranarray, lambda a: a.astype(">f8")])
def test_lists_and_other_dtypes_give_what_arrays_give(observe, as_given):
    fields = {name: as_given(getattr(Z, name)) for name in FIELDS}
    start = replace(START, state=as_given(START.state), rotation=as_given(START.rotation))
    converted, plain = observe(replace(Z, **fields), start, CONFIG), observe(Z, START, CONFIG)
    np.testing.assert_array_equal(converted.rotation, plain.rotation)
    np.testing.assert_array_equal(converted.covariance, plain.covariance)


def test_whole_numbers_are_numbers():
    rounded = np.rint(Z.accel)
    whole, plain = observed(cascade.observe, accel=rounded.astype(int)), observed(cascade.observe, accel=rounded)
    np.testing.assert_array_equal(whole.state, plain.state)


def sample(**fields: Any) -> Sample:
    first = Sample(float(Z.time[1]), Z.gyro[1], Z.accel[1], Z.mag[1], Z.time[1:2], Z.range[:1])
    return first._replace(**fields)


def begun() -> cascade.State:
    return cascade.begin(Sample(0.0, Z.gyro[0], Z.accel[0], Z.mag[0], [], []), START, CONFIG)


def test_a_sample_of_lists_is_a_sample():
    lists = sample(**{name: np.asarray(getattr(sample(), name)).tolist() for name in FIELDS})
    np.testing.assert_array_equal(cascade.step(begun(), lists).state, cascade.step(begun(), sample()).state)


@pytest.mark.parametrize(
    ("fields", "sentence"),
    [
        ({"gyro": np.zeros((3, 1))}, "gyro must have shape (3,), got (3, 1)"),
        ({"accel": [0, 0]}, "accel must have shape (3,), got (2,)"),
        ({"range": [1.0, 2.0]}, "range must have shape (1,), got (2,)"),
        ({"range_time": 0.02}, "range_time must have shape (r,), got ()"),
        ({"time": "now"}, "time must be a number, got 'now'"),
        ({"time": np.inf}, "time must be a finite number, got inf"),
        ({"time": 0.0}, "time must increase: 0 after 0"),
        ({"gyro": [0, np.nan, 0]}, "gyro, accel and range must be finite, at time 0.025"),
        ({"mag": [0, np.inf, 0]}, "mag must be finite, or NaN where there is none, at time 0.025"),
        (
            {"range_time": [0.3]},
            "range_time must increase and lie after the last sample and not after this one, at time 0.025",
        ),
        (
            {"mag": None},
            "mag must hold numbers, got None: where the magnetometer gave no sample, write NaN in all three columns",
        ),
    ],
)
def test_a_sample_is_refused_in_one_sentence_and_the_state_stays(fields, sentence):
    state = begun()
    with pytest.raises(ValueError, match=exactly(sentence)):
        cascade.step(state, sample(**fields))
    np.testing.assert_array_equal(cascade.step(state, sample()).state, cascade.step(begun(), sample()).state)


@pytest.mark.parametrize("name", FIELDS)
@pytest.mark.parametrize("value", [None, "text", ["1", "2", "3"], [1, None, 3], np.zeros((3, 3, 3)), [np.inf] * 3, {}])
def test_the_first_sample_is_checked_too(name, value):
    first = Sample(0.0, Z.gyro[0], Z.accel[0], Z.mag[0], [], [])._replace(**{name: value})
    with pytest.raises(ValueError, match=rf"\A{name} "):
        cascade.begin(first, START, CONFIG)


def test_things_in_each_others_place_are_named():
    with pytest.raises(ValueError, match=exactly("state must be a cascade.State, got Start")):
        cascade.step(START, sample())
    with pytest.raises(ValueError, match=exactly("sample must be a cascade.Sample, got tuple")):
        cascade.step(begun(), tuple(sample()))
    with pytest.raises(ValueError, match=exactly("measurements must be a sensors.Measurements, got Start")):
        cascade.observe(START, Z, CONFIG)
    with pytest.raises(ValueError, match=exactly("setting.form must be derived or printed, got 'drawn'")):
        cascade.observe(Z, START, replace(CONFIG, form="drawn"))


def views(array: np.ndarray) -> list[np.ndarray]:
    return [array, array.T, array[1:], array[::-1]]


anything = st.one_of(
    st.sampled_from(ODD),
    st.sampled_from(
        [array for name in FIELDS for array in (getattr(Z, name), getattr(Z, name).T, getattr(Z, name)[1:])]
    ),
    hnp.arrays(
        dtype=st.sampled_from([np.float64, np.float32, np.int64, np.uint8, np.bool_, np.complex128]),
        shape=hnp.array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=22),
    ),
)


def answer_or_sentence(call: Callable[[], Any]) -> Any:
    """The result, or the one line of the ValueError; any other exception is a failure."""
    try:
        return call()
    except ValueError as error:
        text = str(error)
        return text if len(text.splitlines()) == 1 else pytest.fail(text)


@given(fields=st.dictionaries(st.sampled_from(FIELDS), anything, min_size=1, max_size=3))
def test_whatever_a_record_holds_the_observers_answer_or_refuse(fields):
    """Before there were checks, most of these read past an array's end or ended the interpreter."""
    for observe in (cascade.observe, baselines.ekf):
        outcome = answer_or_sentence(lambda observe=observe: observed(observe, **fields))
        assert isinstance(outcome, str) or len(outcome.rotation) == len(outcome.time)


@given(fields=st.dictionaries(st.sampled_from(FIELDS), anything, min_size=1, max_size=3))
def test_whatever_a_sample_holds_a_step_answers_or_refuses(fields):
    outcome = answer_or_sentence(lambda: cascade.step(begun(), sample(**fields)))
    assert isinstance(outcome, str) or outcome.state.shape == (13,)


def track() -> strapdown.Track:
    return baselines.ekf(Z, START, CONFIG)


def settling(**changed):
    inputs = cascade.attitude_inputs(
        Z, cascade.observe(Z, START, CONFIG), CONFIG, truth=np.tile(np.eye(3), (len(Z.time), 1, 1))
    )
    given = {"rotations": np.eye(3)[None], "chosen": np.ones(len(Z.time), dtype=bool), "limit": 1.0}
    return cascade.attitude_settling(inputs, **{**given, **changed})


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (
            lambda: refine.smooth(Z, replace(track(), position=track().position.T), CONFIG),
            "position must have shape (21, 3), got (3, 21)",
        ),
        (
            lambda: refine.smooth(Z, replace(track(), time=Z.time[:5]), CONFIG),
            "the trajectory must have one row for each of the 21 IMU samples, got 5",
        ),
        (
            lambda: refine.refine(replace(Z, gyro=Z.gyro[:4]), cascade.observe(Z, START, CONFIG), CONFIG),
            "gyro must have shape (21, 3), got (4, 3)",
        ),
        (
            lambda: baselines.filtered(Z, (np.zeros(3), np.zeros(3), np.eye(3)), np.eye(6), CONFIG),
            "covariance must have shape (9, 9), got (6, 6)",
        ),
        (
            lambda: baselines.filtered(Z, (np.zeros(2), np.zeros(3), np.eye(3)), np.eye(9), CONFIG),
            "start position must have shape (3,), got (2,)",
        ),
        (
            lambda: cascade.attitudes(Z, START, CONFIG, rotations=np.eye(3)),
            "rotations must have shape (j, 3, 3), got (3, 3)",
        ),
        (
            lambda: settling(chosen=np.arange(3)),
            "chosen must hold a truth value for each of the 21 samples, got an array of shape (3,)",
        ),
        (lambda: settling(limit=3.2), "limit must lie between 0 and 3.14159 rad, got 3.2"),
        (lambda: settling(limit="5"), "limit must be a number, got '5'"),
        (
            lambda: errors.norms(np.zeros((4, 13)), np.zeros((3, 13))),
            "truth must have shape (4, 13), got (3, 13)",
        ),
        (
            lambda: errors.angles(np.zeros((2, 4, 3, 3)), np.zeros((3, 3, 3))),
            "rotation must have shape (4, 3, 3), got (3, 3, 3)",
        ),
    ],
)
def test_the_other_estimators_and_their_errors_are_guarded_too(call, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        call()


NO_SIGNAL = "path must be a signal (rangenav.signals), got an array of shape (5, 3)"
QUESTIONS = {
    "spectrum": lambda path, start, window: spectra.window_spectra(path, (0.0, 0.0, 9.81), start, window),
    "nonlinear": lambda path, start, window: spectra.nonlinear_spectra(path, (0.0, 0.0, 0.0), start, window),
    "sampled": lambda path, start, window: spectra.sampled_spectra(path, (0.0, 0.0, 9.81), start, window, rate=50.0),
    "excitation": excitation.eigenvalues,
    "worst": excitation.worst,
    "sample": rows.sample,
}


@pytest.mark.parametrize("name", QUESTIONS)
@pytest.mark.parametrize(
    ("path", "start", "window", "sentence"),
    [
        (np.zeros((5, 3)), np.zeros(1), 1.0, NO_SIGNAL),
        (PATH, np.zeros((2, 2)), 1.0, "start must have shape (w,), got (2, 2)"),
        (PATH, 0.0, 1.0, "start must have shape (w,), got ()"),
        (PATH, np.zeros(0), 1.0, "start must hold the start of at least one window, got none"),
        (PATH, [np.inf], 1.0, "start must be finite, got inf at [0]"),
        (PATH, [0.0], 0.0, "window must be longer than 0 s, got 0 s"),
        (PATH, [0.0], np.nan, "window must be a finite number, got nan"),
        (PATH, [0.0], "6", "window must be a number, got '6'"),
    ],
)
def test_questions_about_windows_refuse_in_one_sentence(name, path, start, window, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        QUESTIONS[name](path, start, window)


def test_starts_may_be_a_list_of_whole_numbers():
    np.testing.assert_array_equal(
        excitation.eigenvalues(PATH, [0, 1], 2), excitation.eigenvalues(PATH, np.array([0.0, 1.0]), 2.0)
    )


ONE_WINDOW = {
    "directions": excitation.directions,
    "reduced": lambda path, start, window: reduced.least_eigenvalue(path, (0.0, 0.0, 9.81), start, window),
    "functions": lambda path, start, window: functions.functions(path, (0.0, 0.0, 9.81), start, window),
    "ranged": lambda path, start, window: accuracy.ranged(path, start, window, 50.0),
}


@pytest.mark.parametrize("name", ONE_WINDOW)
def test_questions_about_one_window_take_one_start(name):
    with pytest.raises(ValueError, match=exactly(NO_SIGNAL)):
        ONE_WINDOW[name](np.zeros((5, 3)), 0.0, 1.0)
    with pytest.raises(ValueError, match=exactly("start must be a number, got an array of shape (2,)")):
        ONE_WINDOW[name](PATH, np.zeros(2), 1.0)
    with pytest.raises(ValueError, match=exactly("window must be longer than 0 s, got -1 s")):
        ONE_WINDOW[name](PATH, 0.0, -1.0)


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: frozen.rank(np.zeros(4), np.zeros(3)), "gyro must have shape (3,), got (4,)"),
        (
            lambda: ambiguity.sensitivity(np.zeros((4, 3)), np.arange(5.0), 5.0),
            "position must have shape (5, 3), got (4, 3)",
        ),
        (
            lambda: ambiguity.search(np.zeros((5, 3)), np.zeros((5, 2)), np.arange(5.0), 5.0, apart=1.0),
            "acceleration must have shape (5, 3), got (5, 2)",
        ),
        (
            lambda: excitation.sampled_eigenvalues(np.zeros((5, 3)), np.arange(5.0)[::-1], np.zeros(1), 1.0),
            "time must increase: broken at [1], 3 after 4",
        ),
        (
            lambda: excitation.sampled_eigenvalues(np.zeros((5, 3)), np.arange(5.0), np.array([7.0]), 1.0),
            "windows must start within the samples, 0 to 4 s, and be longer than 0 s",
        ),
        (
            lambda: blindness.directions(np.zeros((9, 1)), np.zeros(3), np.eye(3)),
            "null_basis must have shape (13, k), got (9, 1)",
        ),
        (
            lambda: rows.lifted(PATH, (0.0, 0.0, 9.81), [0.0, 1.0], np.zeros((3, 4))),
            "tau must have one row, or one for each of the 2 windows, got 3",
        ),
    ],
)
def test_questions_that_take_samples_refuse_in_one_sentence(call, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        call()
