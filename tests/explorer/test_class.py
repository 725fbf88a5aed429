"""A class of a teacher and a student, through viser's messages: the student's page follows, leaves, and comes back."""

import contextlib
import http.client
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace

import pytest

from explorer.model.classroom import RETURN
from explorer.server import SessionServer
from explorer.session import Session
from explorer.shared import Compilation
from explorer.web.access.codes import Codes
from explorer.web.access.entrance import Entrance
from explorer.web.access.visitors import Role, Visitor
from explorer.web.security import open_server
from rangenav import preset
from tests.support.shared_server import shared
from tests.support.waiting_visitor import newest
from tests.support.wire import Wire

pytestmark = pytest.mark.slow

WEIGHT = "range weight q (1/(m⁴ s))"


@dataclass(frozen=True)
class Class:
    """A teacher's page, a student's, and what they share."""

    teacher: Wire
    teachers: Session
    student: Wire
    students: Session
    sessions: SessionServer
    port: int
    codes: Codes


def _cookie(port: int, secret: str) -> str:
    with contextlib.closing(http.client.HTTPConnection("127.0.0.1", port, timeout=10)) as connection:
        connection.request("GET", "/enter", headers={"Rangenav-Enter": secret})
        answer = connection.getresponse()
        assert answer.status == 200
        return str(answer.getheader("Set-Cookie")).partition(";")[0]


@pytest.fixture(scope="module")
def one_class(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Class]:
    codes = Codes()
    entrance = Entrance(codes=codes, places=5)
    server, compilation = open_server("0.0.0.0", 0, entrance=entrance), Compilation()
    port, folder = server.get_port(), tmp_path_factory.mktemp("class")
    joint = replace(shared(server, compilation), entrance=entrance, address="http://class/", class_folder=folder)
    sessions = SessionServer(server, joint)
    compilation.start()
    teacher = Wire(port, cookie=_cookie(port, f"token {codes.token}"))
    teachers = newest(sessions, teacher)
    student = Wire(port, cookie=_cookie(port, f"code {codes.code}"))
    students = newest(sessions, student)
    for tab in (teacher, student):
        tab.wait_for_text("13 of 13")
    yield Class(teacher, teachers, student, students, sessions, port, codes)
    teacher.close()
    student.close()
    server.stop()


@pytest.fixture
def presented(one_class: Class) -> Iterator[Class]:
    """The class while the teacher presents."""
    one_class.teacher.press("Present my page")
    one_class.student.wait_for_text("You follow the teacher")
    yield one_class
    one_class.teacher.press("End the presentation")
    one_class.student.wait_for(lambda: "rn-class" not in one_class.student.text(), "the end of the presentation")


def _same(one: Class) -> bool:
    """Whether both pages show the same settings."""
    return (
        one.students.picture is not None
        and one.teachers.picture is not None
        and one.students.picture.settings == one.teachers.picture.settings
    )


def _weight(session: Session) -> float:
    assert session.picture is not None
    return session.picture.settings.preset.gains.riccati.q


def test_only_the_teacher_has_the_invitation_and_sees_who_is_there(one_class: Class) -> None:
    one_class.teacher.wait_for(lambda: "<svg" in one_class.teacher.text(), "the QR code")
    name = one_class.student.value("your name")
    one_class.teacher.wait_for_text(name)
    one_class.student.set("your name", "<b>Ada</b>")
    one_class.teacher.wait_for_text("&lt;b&gt;Ada&lt;/b&gt;")
    for label in ("Present my page", "New code and link", "Results as CSV"):
        one_class.teacher.find(label)
        with pytest.raises(LookupError):
            one_class.student.find(label)


def test_a_page_follows_changes_and_time_and_takes_no_input_itself(presented: Class) -> None:
    presented.teacher.set(WEIGHT, 2.0)  # the slider's position: q = 100
    presented.student.wait_for(lambda: _same(presented) and _weight(presented.students) == 100.0, "the same gain")
    presented.student.set(WEIGHT, 0.0)
    presented.student.wait_for(
        lambda: presented.student.value(f"{WEIGHT}: number") == "100", "the teacher's gain again"
    )
    assert _weight(presented.students) == 100.0
    presented.teacher.command("One step on in time")
    presented.student.wait_for(lambda: presented.student.value("t (s)") == presented.teacher.value("t (s)") > 0, "t")


def test_a_copy_is_a_step_of_the_own_work_and_following_again_leaves_it_untouched(one_class: Class) -> None:
    student = one_class.student
    student.set(WEIGHT, 1.0)
    student.wait_for(lambda: _weight(one_class.students) == 10.0, "the own gain")
    one_class.teacher.press("Present my page")
    student.wait_for(lambda: _same(one_class), "what the teacher shows")
    student.press_own("class-copy")
    student.wait_for_text("You work on a copy")
    assert _same(one_class)
    student.command("Undo")
    student.wait_for(lambda: _weight(one_class.students) == 10.0, "the own work one step before the copy")
    student.press_own("class-follow")
    student.wait_for(lambda: _same(one_class), "what the teacher shows again")
    student.press_own("class-copy")
    student.wait_for_text("You work on a copy")
    student.set(WEIGHT, 0.0)
    student.wait_for(lambda: _weight(one_class.students) == 1.0, "a change of the copy")
    student.press_own("class-follow")
    student.wait_for(lambda: _same(one_class), "what the teacher shows once more")
    student.press_own("class-back")
    student.wait_for(lambda: _weight(one_class.students) == 10.0, "the own work, and not the copy")
    one_class.teacher.press("End the presentation")
    student.wait_for(lambda: "rn-class" not in student.text(), "the end of the presentation")
    assert _weight(one_class.students) == 10.0


def test_frozen_pages_cannot_leave_and_get_their_work_back(one_class: Class) -> None:
    student, own = one_class.student, _weight(one_class.students)
    one_class.teacher.press("Eyes on me")
    student.wait_for_text("Eyes on the teacher")
    form = one_class.students.form
    for name in ("class-back", "class-copy"):
        before = form.actions_run
        student.press_own(name)
        student.wait_for(lambda before=before: form.actions_run > before, name)
    one_class.teacher.press("Release all")
    student.wait_for_text("You follow the teacher")
    student.press_own("class-back")
    student.wait_for_text("The teacher presents")
    one_class.teacher.press("End the presentation")
    student.wait_for(lambda: "rn-class" not in student.text(), "the end of the presentation")
    student.wait_for(lambda: _weight(one_class.students) == own, "the own work")


def test_a_page_whose_boxes_hold_nonsense_follows_too_and_gets_its_last_valid_work_back(one_class: Class) -> None:
    student, own = one_class.student, _weight(one_class.students)
    student.set("noise seed", "many")
    student.wait_for_text("“many” is not a number")
    one_class.teacher.press("Present my page")
    student.wait_for_text("You follow the teacher")
    student.wait_for(lambda: _same(one_class) and "“many”" not in student.text(), "what the teacher shows")
    one_class.teacher.press("End the presentation")
    student.wait_for(lambda: "rn-class" not in student.text(), "the end of the presentation")
    student.wait_for(lambda: _weight(one_class.students) == own, "the own work")


def test_a_preset_of_the_teachers_own_is_offered_once_while_a_control_is_moved(presented: Class) -> None:
    teacher, student, catalog = presented.teacher, presented.student, presented.students.catalog
    teacher.set("title", "Mine alone")
    teacher.press("keep", "save as")
    teacher.wait_for_text("saved as")
    before = set(catalog.presets)
    for position, weight in ((1.0, 10.0), (2.0, 100.0), (1.5, 31.62)):
        teacher.set(WEIGHT, position)
        student.wait_for(lambda weight=weight: abs(_weight(presented.students) - weight) < 0.01, "the gain")
    assert len(set(catalog.presets) - before) <= 1
    assert len([name for name, one in catalog.presets.items() if one.title == "Mine alone"]) == 1
    teacher.set("preset", f"{preset.load('paper-slow').title} (paper-slow)")
    student.wait_for(lambda: _same(presented), "a preset that both have")


def test_another_tab_of_the_teachers_takes_a_presentation_over_only_when_its_page_was_closed(presented: Class) -> None:
    classroom = presented.sessions.shared.classroom
    shown, began = classroom.state.shown, time.monotonic()
    second = Wire(presented.port, cookie=_cookie(presented.port, f"token {presented.codes.token}"))
    session = newest(presented.sessions, second)
    second.wait_for_text("13 of 13")
    assert classroom.state.shown is shown
    classroom.leave(began + RETURN)  # as though the first tab had been open for long
    second.wait_for(lambda: classroom.state.left is None, "the presentation that goes on")
    times: list[float | None] = []
    end = classroom.listen(lambda: times.append(classroom.state.left))
    second.close()
    session.thread.join()
    end()
    assert any(times)  # the page may come back: the first tab, which is not open for long, goes on
    assert classroom.state.shown is not None
    assert "You follow the teacher" in presented.student.text()


def test_a_visitor_who_comes_with_ever_new_browsers_pushes_nobodys_work_out(one_class: Class) -> None:
    joint, visitor = one_class.sessions.shared, Visitor(number=99, role=Role.STUDENT, until=1e9)
    kept = [joint.keeps_work_of(visitor, f"browser {k}") for k in (0, 0, 1, 2, 3, 4, 1)]
    assert kept == [True, True, True, True, False, False, True]
    assert joint.keeps_work_of(Visitor(number=98, role=Role.STUDENT, until=1e9), "browser 3")


def test_what_is_sent_to_all_is_one_step_and_a_lesson_is_opened_for_all(one_class: Class) -> None:
    student, own = one_class.student, _weight(one_class.students)
    one_class.teacher.press("Send what I see to all")
    student.wait_for(lambda: _same(one_class), "what was sent")
    student.command("Undo")
    student.wait_for(lambda: _weight(one_class.students) == own, "the own work again")
    one_class.teacher.set("lesson", "2 · Planar is not enough")
    one_class.teacher.press("Open it for all")
    student.wait_for_text("Planar is not enough")
    one_class.teacher.wait_for_text("<td")
    one_class.teacher.wait_for(lambda: "Planar is not enough, 1 / " in one_class.teacher.text(), "where the student is")
    one_class.teacher.press("Keep the answers back")
    one_class.teacher.wait_for(lambda: one_class.sessions.shared.classroom.state.answers_wait, "the answers to wait")
    student.press_own("lesson-next")
    student.wait_for_text("Your prediction")
    student.set("your prediction", "13")
    student.press("Commit")
    student.wait_for_text("when your teacher shows the answer")
    one_class.teacher.wait_for_text("1 of 1 have predicted")
    one_class.teacher.press("Show the answers to all")
    student.wait_for_text("What came is shown after the task")


def test_who_is_sent_out_has_left_and_the_end_of_the_class_forgets_all(one_class: Class) -> None:
    classroom = one_class.sessions.shared.classroom
    guest = Wire(one_class.port, cookie=_cookie(one_class.port, f"key {one_class.codes.key}"))
    one_class.teacher.wait_for(lambda: len(classroom.members) == 2, "two students")
    one_class.teacher.press("End the class")
    one_class.teacher.press("Go on with the class")
    one_class.teacher.press("End the class")
    one_class.teacher.wait_for_text("Names, predictions and the presets")
    assert guest.closed_with is None
    one_class.teacher.press("End it now")
    for tab in (guest, one_class.student):
        tab.wait_for(lambda tab=tab: tab.closed_with == 4001, "the end of the connection")
    one_class.teacher.wait_for_text("No student is on the page yet")
    assert classroom.members == {}
