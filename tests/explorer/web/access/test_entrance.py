"""Who comes in: the right secrets, from a browser that did not try too often, as long as there is a place."""

import contextlib
import math
import re
from collections.abc import Callable
from dataclasses import dataclass

import pytest
from hypothesis import given
from hypothesis import strategies as st
from websockets.datastructures import Headers
from websockets.http11 import Request

from explorer.web.access import visitors
from explorer.web.access.attempts import CONNECTS, PER_BROWSER, TOGETHER, Attempts
from explorer.web.access.codes import ALPHABET, MAX_WRONG, Codes, checked_token
from explorer.web.access.entrance import MAX_TABS, Answer, Entrance, NoRoomError
from explorer.web.access.invitation import codes_with, invitation, qr_svg
from explorer.web.access.visitors import LIFETIME, Role

PORT = 8080


@dataclass
class Clock:
    now: float = 1000.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def codes() -> Codes:
    return Codes()


@pytest.fixture
def entrance(codes: Codes, clock: Clock) -> Entrance:
    return Entrance(codes=codes, places=2, clock=clock)


def _request(path: str = "/", *, enter: str = "", cookie: str = "", upgrade: bool = False) -> Request:
    said = {"Rangenav-Enter": enter, "Cookie": cookie, "Upgrade": "websocket" if upgrade else ""}
    return Request(path, Headers({name: text for name, text in said.items() if text}))


def _cookie(answer: Answer | None) -> str:
    """The cookie that an answer gives, as a browser sends it back."""
    assert answer is not None
    return dict(answer.headers)["Set-Cookie"].partition(";")[0]


def _come_in(entrance: Entrance, secret: str) -> str:
    answer = entrance.answer(_request("/enter", enter=secret), PORT)
    assert answer is not None
    assert answer.status == 200, answer.text
    return _cookie(answer)


def _status(entrance: Entrance, **said: str | bool) -> int | None:
    answer = entrance.answer(_request(**said), PORT)  # type: ignore[arg-type]
    return None if answer is None else answer.status


@contextlib.contextmanager
def _tab(entrance: Entrance, cookie: str, close: Callable[[], None] = lambda: None):
    visitor = entrance.visitor(_request(cookie=cookie), PORT)
    assert visitor is not None
    with entrance.stay(visitor, close):
        yield visitor


@pytest.mark.parametrize(
    "path", ["/", "/?lesson=4", "/assets/index.js", "/../../etc/passwd", "/hdri/x.hdr", "//", "/enter/"]
)
def test_nothing_is_served_to_somebody_who_is_not_in(entrance: Entrance, path: str) -> None:
    assert _status(entrance, path=path) == 401
    assert _status(entrance, path=path, upgrade=True) == 401


@pytest.mark.parametrize(("kind", "role"), [("token", Role.TEACHER), ("key", Role.STUDENT), ("code", Role.STUDENT)])
def test_each_secret_lets_in_as_what_it_is_for_and_the_cookie_is_out_of_reach_of_scripts_and_other_sites(
    entrance: Entrance, codes: Codes, kind: str, role: Role
) -> None:
    answer = entrance.answer(_request("/enter", enter=f"{kind} {getattr(codes, kind)}"), PORT)
    assert answer is not None
    assert {"HttpOnly", "SameSite=Strict", "Path=/"} <= set(dict(answer.headers)["Set-Cookie"].split("; "))
    cookie = _cookie(answer)
    assert _status(entrance, cookie=cookie) is None
    assert _status(entrance, cookie=cookie, upgrade=True) is None
    visitor = entrance.visitor(_request(cookie=cookie), PORT)
    assert visitor is not None
    assert visitor.role is role


def test_a_secret_lets_in_only_as_the_kind_that_it_is(entrance: Entrance, codes: Codes) -> None:
    for kind, secret in [("token", codes.key), ("token", codes.code), ("key", codes.code), ("key", codes.token)]:
        assert _status(entrance, path="/enter", enter=f"{kind} {secret}") == 403


def test_behind_https_the_cookie_is_sent_by_https_alone_and_only_to_this_name(codes: Codes, clock: Clock) -> None:
    entrance = Entrance(codes=codes, places=2, secure=True, clock=clock)
    answer = entrance.answer(_request("/enter", enter=f"key {codes.key}"), PORT)
    assert answer is not None
    line = dict(answer.headers)["Set-Cookie"]
    assert line.startswith("__Host-")
    assert line.endswith("; Secure")


@pytest.mark.parametrize("typed", ["{code}", "{low}", "{spaced}", " {code} "])
def test_a_code_is_understood_as_people_type_it(entrance: Entrance, codes: Codes, typed: str) -> None:
    text = typed.format(code=entrance.code, low=codes.code.lower(), spaced=" ".join(codes.code))
    _come_in(entrance, f"code {text}")


@given(text=st.text(st.characters(min_codepoint=32, max_codepoint=126) | st.just("\t"), max_size=300))
def test_whatever_is_sent_gets_an_answer_and_lets_nobody_in(text: str) -> None:
    entrance = Entrance(codes=Codes(), places=2, clock=Clock())
    for kind in ("", "code ", "key ", "token "):
        answer = entrance.answer(_request("/enter", enter=kind + text), PORT)
        assert answer is not None
        assert answer.is_page or answer.status in (403, 429)
    assert _status(entrance, cookie=text) == 401
    assert _status(entrance, cookie=f"rangenav-{PORT}={text}") == 401


def test_a_cookie_expires_with_the_day_and_one_that_was_changed_is_worth_nothing(
    entrance: Entrance, codes: Codes, clock: Clock
) -> None:
    cookie = _come_in(entrance, f"key {codes.key}")
    assert _status(entrance, cookie=cookie[:-1] + ("A" if cookie[-1] != "A" else "B")) == 401
    assert _status(entrance, cookie=cookie.replace(f"-{PORT}", "-9999")) == 401
    clock.now += LIFETIME - 1
    assert _status(entrance, cookie=cookie) is None
    clock.now += 1
    assert _status(entrance, cookie=cookie) == 401


def test_ten_thousand_attempts_at_a_code_let_nobody_in_and_leave_the_links_open(
    entrance: Entrance, codes: Codes, clock: Clock
) -> None:
    first, checked = codes.code, 0
    for i in range(10_000):
        clock.now += 0.01
        status = _status(entrance, path="/enter", enter=f"code {i:06d}", cookie=f"rangenav-door-{PORT}=browser{i}")
        assert status in (403, 429)
        checked += status == 403
    assert checked <= TOGETHER[0] + TOGETHER[1] * 100 + 1
    assert codes.code != first or checked < MAX_WRONG
    _come_in(entrance, f"key {codes.key}")
    _come_in(entrance, f"token {codes.token}")


def test_one_browser_that_guesses_does_not_keep_another_waiting(entrance: Entrance, codes: Codes, clock: Clock) -> None:
    guesser, other = (f"rangenav-door-{PORT}={name}" for name in ("guesser", "other"))
    statuses = [_status(entrance, path="/enter", enter="code AAAAAA", cookie=guesser) for _ in range(30)]
    assert statuses.count(403) == PER_BROWSER[0]
    waiting = entrance.answer(_request("/enter", enter="code AAAAAA", cookie=guesser), PORT)
    assert waiting is not None
    assert float(dict(waiting.headers)["Retry-After"]) == math.ceil(1 / PER_BROWSER[1])
    assert _status(entrance, path="/enter", enter=f"code {codes.code}", cookie=other) == 200


def test_a_class_of_forty_may_type_at_the_same_moment() -> None:
    attempts = Attempts(0.0)
    assert [attempts.wait(f"student {i}", 0.0) for i in range(40)] == [0.0] * 40


def test_a_code_that_is_guessed_at_too_often_is_replaced_and_the_teacher_can_see_it(
    entrance: Entrance, codes: Codes
) -> None:
    first = codes.code
    for _ in range(MAX_WRONG):
        assert not codes.is_code("AAAAAA" if first != "AAAAAA" else "BBBBBB")
    assert codes.code != first
    assert entrance.code_was_guessed_at == 1
    assert not codes.is_code(first)


def test_new_codes_leave_everybody_in_and_the_old_ones_let_nobody_in(entrance: Entrance, codes: Codes) -> None:
    old_key, old_code, cookie = codes.key, codes.code, _come_in(entrance, f"key {codes.key}")
    entrance.renew()
    assert _status(entrance, cookie=cookie) is None
    assert _status(entrance, path="/enter", enter=f"key {old_key}") == 403
    assert _status(entrance, path="/enter", enter=f"code {old_code}") == 403


def test_the_class_is_full_when_its_places_are_taken_and_never_for_the_teacher(
    entrance: Entrance, codes: Codes
) -> None:
    first, second, third = (_come_in(entrance, f"key {codes.key}") for _ in range(3))
    with _tab(entrance, first), _tab(entrance, first):
        assert _status(entrance, cookie=third) is None
        with _tab(entrance, second):
            door = entrance.answer(_request(cookie=third), PORT)
            assert door is not None
            assert (door.status, door.is_page) == (503, True)
            assert "all 2 places are taken" in door.text
            assert _status(entrance, cookie=third, upgrade=True) == 503
            assert _status(entrance, path="/enter", enter=f"code {codes.code}") == 503
            assert _status(entrance, cookie=first) is None, "who has a place may reload"
            _come_in(entrance, f"token {codes.token}")
        assert _status(entrance, cookie=third) is None


def test_a_visitor_has_a_few_tabs_and_no_more(entrance: Entrance, codes: Codes) -> None:
    cookie = _come_in(entrance, f"key {codes.key}")
    with contextlib.ExitStack() as tabs:
        for _ in range(MAX_TABS):
            assert _status(entrance, cookie=cookie, upgrade=True) is None
            tabs.enter_context(_tab(entrance, cookie))
        assert _status(entrance, cookie=cookie, upgrade=True) == 503
    assert entrance.inside == {}


def test_tabs_that_come_in_one_moment_get_no_more_than_their_places(entrance: Entrance, codes: Codes) -> None:
    cookie = _come_in(entrance, f"key {codes.key}")
    assert all(_status(entrance, cookie=cookie, upgrade=True) is None for _ in range(MAX_TABS + 1))
    with contextlib.ExitStack() as tabs:
        for _ in range(MAX_TABS):
            tabs.enter_context(_tab(entrance, cookie))
        with pytest.raises(NoRoomError):
            tabs.enter_context(_tab(entrance, cookie))
        assert list(entrance.inside.values()) == [MAX_TABS]


def test_who_reloads_all_the_time_waits_and_nobody_else_does(entrance: Entrance, codes: Codes, clock: Clock) -> None:
    stormy, other = (_come_in(entrance, f"key {codes.key}") for _ in range(2))
    statuses = [_status(entrance, cookie=stormy, upgrade=True) for _ in range(40)]
    assert (statuses.count(None), statuses[-1]) == (CONNECTS[0], 429)
    assert _status(entrance, cookie=other, upgrade=True) is None
    assert _status(entrance, cookie=stormy) is None, "the page itself is there to say so"
    clock.now += 1 / CONNECTS[1]
    assert _status(entrance, cookie=stormy, upgrade=True) is None


def test_who_comes_in_again_and_again_takes_nobodys_place(
    entrance: Entrance, codes: Codes, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(visitors, "MAX_ADMITTED", 20)
    teacher, student = _come_in(entrance, f"token {codes.token}"), _come_in(entrance, f"key {codes.key}")
    with _tab(entrance, student):
        pass
    first, *_ = [_come_in(entrance, f"key {codes.key}") for _ in range(30)]
    assert _status(entrance, cookie=first) == 401, "never used, and forgotten"
    assert _status(entrance, cookie=student) is None
    assert _status(entrance, cookie=teacher) is None
    _come_in(entrance, f"token {codes.token}")


def test_who_is_sent_out_is_disconnected_and_does_not_come_back_with_the_cookie(
    entrance: Entrance, codes: Codes
) -> None:
    out, stays = (_come_in(entrance, f"key {codes.key}") for _ in range(2))
    closed: list[str] = []
    with (
        _tab(entrance, out, lambda: closed.append("out")) as visitor,
        _tab(entrance, stays, lambda: closed.append("stays")),
    ):
        entrance.remove(visitor.number)
        assert closed == ["out"]
    assert _status(entrance, cookie=out) == 401
    assert _status(entrance, cookie=stays) is None


def test_when_the_class_ends_students_go_and_the_teacher_stays(entrance: Entrance, codes: Codes) -> None:
    key, student = codes.key, _come_in(entrance, f"key {codes.key}")
    teacher = _come_in(entrance, f"token {codes.token}")
    closed: list[str] = []
    with (
        _tab(entrance, student, lambda: closed.append("student")),
        _tab(entrance, teacher, lambda: closed.append("teacher")),
    ):
        entrance.end_class()
    assert closed == ["student"]
    assert _status(entrance, cookie=student) == 401
    assert _status(entrance, cookie=teacher) is None
    assert _status(entrance, path="/enter", enter=f"key {key}") == 403


def test_the_invitation_names_both_links_and_the_code_and_the_secrets_stand_after_the_number_sign(
    entrance: Entrance, codes: Codes
) -> None:
    text = invitation(entrance, "http://192.168.7.5:8080/")
    links = re.findall(r"http://\S+", text)
    assert links[:2] == [
        f"http://192.168.7.5:8080/enter#token={codes.token}", f"http://192.168.7.5:8080/enter#key={codes.key}"
    ]  # fmt: skip
    assert entrance.code in text
    assert "█" in text
    assert "<svg" in qr_svg(links[1])
    assert set(codes.code) <= set(ALPHABET)


def test_a_token_of_ones_own_comes_from_a_file_or_the_environment(tmp_path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "token"
    file.write_text("a-token-that-is-long-enough\n", encoding="utf-8")
    monkeypatch.setenv("RANGENAV_TOKEN", "another-token-long-enough")
    assert codes_with(file).token == "a-token-that-is-long-enough"
    assert codes_with(None).token == "another-token-long-enough"
    monkeypatch.delenv("RANGENAV_TOKEN")
    assert codes_with(None).token != codes_with(None).token


@pytest.mark.parametrize(
    "token", ["", "short", "with spaces in the middle", "umlaut-ü-is-no-part-of-a-link", "x" * 181]
)
def test_a_token_that_is_short_or_no_part_of_a_link_is_refused_with_its_source(token: str) -> None:
    with pytest.raises(ValueError, match=r"RANGENAV_TOKEN: a token consists of 16"):
        checked_token(token, "RANGENAV_TOKEN")


def test_a_token_file_that_cannot_be_read_is_named(tmp_path) -> None:
    with pytest.raises(ValueError, match=r"--token-file .*nothing: cannot be read: No such file"):
        codes_with(tmp_path / "nothing")
