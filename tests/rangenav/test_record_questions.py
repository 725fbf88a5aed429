"""What a file leaves open is asked at once: units, what its checks find, gravity, field and anchor."""

import numpy as np
from scipy.spatial.transform import Rotation

from rangenav import formats, record_questions
from tests.support.present import present

RATE, LENGTH = 50, 20.0
IRON = np.array([120.0, -160.0, 250.0])


def record(*, gyro_unit="rad/s", accel_unit=" [m/s2]", scale=1.0, iron=IRON, lines=()):
    """A record that rests for 2 s and then turns about changing axes, with iron on the body and ranges, as CSV."""
    t = np.arange(0, LENGTH, 1 / RATE)
    turn = np.where(t < 2, 0.0, t - 2)
    angles = np.column_stack([0.9 * np.sin(1.1 * turn), 0.8 * np.sin(1.7 * turn), 0.7 * np.sin(0.6 * turn)])
    rotation = Rotation.from_euler("xyz", angles)
    rates = (rotation[:-1].inv() * rotation[1:]).as_rotvec() * RATE
    gyro = np.vstack([rates, rates[-1:]]) * (180 / np.pi if gyro_unit == "deg/s" else 1)
    accel, mag = scale * rotation.inv().apply([0.0, 0, 9.81]), rotation.inv().apply([20.0, 0, -43]) + iron
    names = ["t [s]", *(f"gyro_{a} [{gyro_unit}]" for a in "xyz"), *(f"accel_{a}{accel_unit}" for a in "xyz")]
    names += [*(f"mag_{a} [uT]" for a in "xyz"), "range [m]"]
    rows = np.column_stack([t, gyro, accel, mag, 3 + 0.2 * np.sin(t)])
    text = [",".join(names), *(",".join(f"{value:.6g}" for value in row) for row in rows)]
    for line in lines:
        text.insert(40, line)
    return "\n".join(text).encode()


def asked(data, confirm=None):
    """The questions about a record, gravity, field and anchor included."""

    def read(answers):
        return formats.parse(data, "log", source="x.csv", confirm=answers)

    first = record_questions.read(read, confirm or {})
    of_world = record_questions.of_world(first, vectors=None, still=False)
    return {one.key: one.suggestion for one in (*first.imported.questions, *of_world)}


def test_what_follows_from_the_suggested_answers_is_asked_in_the_same_round():
    """Broken lines hide the frame, the frame hides the iron, and the iron hides where gravity and field point."""
    first = asked(record(lines=["ERR"]))
    assert list(first) == ["lines", "frame", "mag-offset", "world", "anchor"]
    assert (first["lines"], first["frame"], first["world"], first["anchor"]) == ("drop", "z-up", "still", None)
    offset = np.array(present(first["mag-offset"]).split(), dtype=float)
    np.testing.assert_allclose(offset, IRON, atol=5)
    answers = {key: value for key, value in first.items() if key in ("lines", "frame", "mag-offset")}
    assert asked(record(lines=["ERR"]), answers) == {"world": "still", "anchor": None}


def test_where_an_answer_has_no_suggestion_nothing_is_asked_that_depends_on_it():
    """Gravity of 3 is none in any unit, so that no check and no rest means anything before the unit is known."""
    data = record(accel_unit="", scale=0.3)
    assert asked(data) == {"accel": None, "frame": "z-up", "anchor": None}


def test_a_unit_that_the_file_states_and_the_data_confirm_is_taken_and_said():
    """deg/s by the turns of the field; a unit that the data contradict is asked about."""
    data = record(gyro_unit="deg/s", iron=0 * IRON)
    imported = formats.parse(data, "log", source="x.csv", confirm={"frame": "z-up"})
    assert imported.questions == ()
    (said,) = [one for one in imported.findings if one.startswith("the gyro")]
    assert said.startswith("the gyro: deg/s, as the file states; the field turns 0.017")
    wrong = formats.parse(data.replace(b"deg/s", b"rad/s"), "log", source="x.csv", confirm={"frame": "z-up"})
    assert [(one.key, one.suggestion) for one in wrong.questions] == [("gyro", "deg/s")]
