"""Every request of a visitor, before anything else answers it: in, out, or at the door.

GET /enter                                   200 the page at the door: type a code, or follow a link with a secret
GET /enter  Rangenav-Enter: code ABC-DEF     200 and a cookie; 403 wrong; 429 too many attempts; 503 full
GET /metrics                                 200 for the teacher's cookie or token, else 401
GET /…      Cookie: …                        what the page answers; without a valid cookie 401, a reader sees the door
"""

import math
import secrets
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from http.cookies import CookieError, SimpleCookie
from pathlib import Path

from websockets.http11 import Request

from explorer.model.listeners import Listener, Listeners
from explorer.web.access.attempts import Attempts, Connects
from explorer.web.access.codes import Codes
from explorer.web.access.visitors import LIFETIME, Role, Visitor, Visitors

DOOR_PATH, DOOR_COOKIE, HEADER, MAX_SECRET = "/enter", "rangenav-door", "Rangenav-Enter", 200
HTML = "text/html; charset=utf-8"
METRICS_PATH = "/metrics"
MAX_TABS = 6
"""Tabs of one visitor at the same time."""
DOOR = Path(__file__).with_name("door.html")
DOOR_POLICY = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; connect-src 'self'; "
    "frame-ancestors 'none'; base-uri 'none'; form-action 'none'"
)
WRONG = "This code is not right, or it has been replaced: look again, or ask your teacher."
WRONG_LINK = "This link is not right, or it has been replaced: ask for a new one."
FULL = "The class is full: all {places} places are taken. Try again when somebody has left."
FOR_TEACHER = "This is for the teacher, or for a program with the teacher's token: Authorization: Bearer …"
SENT_OUT = "Your teacher has sent you out. To come back, ask for the code."
OVER = "The class is over. Your next class has another code."
NOT_IN = "Come in with your code or your link first."


class NoRoomError(Exception):
    """A visitor who was let in a moment ago finds no place: many have come in the same moment."""


@dataclass(frozen=True)
class Answer:
    """What a request gets in place of the page."""

    status: int
    text: str
    headers: tuple[tuple[str, str], ...] = ()
    content_type: str = "text/plain; charset=utf-8"

    @property
    def is_page(self) -> bool:
        """Whether the text is HTML."""
        return self.content_type == HTML


class Entrance:
    """Who is in, and who may come in. Safe for threads."""

    def __init__(
        self, *, codes: Codes, places: int, secure: bool = False, clock: Callable[[], float] = time.monotonic
    ) -> None:
        """places: how many students may be in at the same time. secure: whether cookies are for https only."""
        self._lock, self._clock, self._secure = threading.RLock(), clock, secure
        self._codes, self._visitors, self._attempts = codes, Visitors(), Attempts(clock())
        self.places = places
        self._tabs: dict[int, list[Callable[[], None]]] = {}
        """What closes each open tab of a visitor, by the visitor's number."""
        self._connects = Connects()
        self._listeners = Listeners()

    @property
    def code(self) -> str:
        """The code that students type, as it is shown: ABC-DEF."""
        with self._lock:
            return f"{self._codes.code[:3]}-{self._codes.code[3:]}"

    def link(self, role: Role, page: str) -> str:
        """What lets somebody in who opens it. page: the page's address, with a slash at its end."""
        with self._lock:
            secret = f"token={self._codes.token}" if role is Role.TEACHER else f"key={self._codes.key}"
        return f"{page.rstrip('/')}{DOOR_PATH}#{secret}"

    @property
    def code_was_guessed_at(self) -> int:
        """How often the code was replaced because it was guessed at."""
        with self._lock:
            return self._codes.replaced

    @property
    def inside(self) -> dict[int, int]:
        """How many tabs each visitor has open, by number."""
        with self._lock:
            return {number: len(tabs) for number, tabs in self._tabs.items()}

    def has(self, number: int) -> bool:
        """Whether a visitor was let in and not sent out."""
        with self._lock:
            return self._visitors.has(number)

    def is_student(self, number: int) -> bool:
        """Whether a visitor who was let in is a student."""
        with self._lock:
            return self._visitors.is_student(number)

    def on_change(self, listener: Listener) -> Listener:
        """Have a listener called when somebody comes or leaves. Returns a function that ends this."""
        return self._listeners.add(listener)

    def renew(self) -> None:
        """Replace the code and the link of the students; who is in stays in."""
        with self._lock:
            self._codes.renew()

    def remove(self, number: int) -> None:
        """Send a visitor out."""
        with self._lock:
            self._visitors.remove(number, SENT_OUT)
            tabs = self._tabs.get(number, [])[:]
        for close in tabs:
            close()

    def end_class(self) -> None:
        """Send all students out, and replace their code and link."""
        with self._lock:
            self._codes.renew()
            students = [number for number in self._tabs if self._visitors.is_student(number)]
            self._visitors.remove_students(OVER)
        for number in students:
            self.remove(number)

    def visitor(self, request: Request, port: int) -> Visitor | None:
        """Who sends a request; None for somebody who is not in."""
        with self._lock:
            return self._visitors.of(_cookie(request, self._cookie_name(port)), self._clock())

    @contextmanager
    def stay(self, visitor: Visitor, close: Callable[[], None]) -> Iterator[None]:
        """Count a tab of a visitor as long as it is connected. close: what ends the connection.

        Raises NoRoomError if others were faster between the visitor's request and this moment."""
        with self._lock:
            if self._has_all_tabs(visitor) or self._is_full(visitor):
                raise NoRoomError
            self._visitors.has_come(visitor.number)
            self._tabs.setdefault(visitor.number, []).append(close)
        self._listeners.call()
        try:
            yield
        finally:
            with self._lock:
                self._tabs[visitor.number].remove(close)
                if not self._tabs[visitor.number]:
                    del self._tabs[visitor.number]
            self._listeners.call()

    def answer(self, request: Request, port: int) -> Answer | None:
        """What a request gets here; None for somebody who is in, and asks for something else than the door."""
        path = request.path.partition("?")[0]
        upgrade = bool(request.headers.get_all("Upgrade"))
        if path == DOOR_PATH and not upgrade:
            return self._at_the_door(request, port)
        with self._lock:
            visitor, reader = self.visitor(request, port), path == "/" and not upgrade
            if path == METRICS_PATH and not upgrade:
                return None if self._may_measure(request, visitor) else Answer(401, FOR_TEACHER)
            if visitor is None:
                return self._door(401, request, port) if reader else Answer(401, NOT_IN)
            if upgrade and self._has_all_tabs(visitor):
                return Answer(503, f"You have {MAX_TABS} tabs open on this page: close one.")
            if self._is_full(visitor):
                return self._door(503, request, port) if reader else Answer(503, self._full_sentence)
            return self._too_often(visitor) if upgrade else None

    def _too_often(self, visitor: Visitor) -> Answer | None:
        """The answer to a visitor who opens websockets all the time; None for anybody else, whose websocket counts."""
        wait = self._connects.wait(visitor.number, self._clock())
        if wait == 0:
            return None
        seconds = math.ceil(wait)
        sentence = f"You have loaded this page very often: it opens again in {seconds} s."
        return Answer(429, sentence, (("Retry-After", str(seconds)),))

    def _may_measure(self, request: Request, visitor: Visitor | None) -> bool:
        """The teacher, and a program that has the teacher's token."""
        kind, _, token = request.headers.get("Authorization", "").partition(" ")
        by_token = kind == "Bearer" and self._codes.is_token(token[:MAX_SECRET])
        return by_token or (visitor is not None and visitor.role is Role.TEACHER)

    def _at_the_door(self, request: Request, port: int) -> Answer:
        said = request.headers.get_all(HEADER)
        if not said:
            return self._door(200, request, port)
        kind, _, secret = said[0][:MAX_SECRET].strip().partition(" ")
        browser = _cookie(request, f"{DOOR_COOKIE}-{port}")
        with self._lock:
            now = self._clock()
            if kind == "code":
                wait = self._attempts.wait(browser, now)
                if wait > 0:
                    seconds = math.ceil(wait)
                    sentence = f"Many codes are being tried. This one is tried again in {seconds} s."
                    return Answer(429, sentence, (("Retry-After", str(seconds)),))
                return self._admit(Role.STUDENT, port) if self._codes.is_code(secret) else Answer(403, WRONG)
            if kind == "key" and self._codes.is_key(secret):
                return self._admit(Role.STUDENT, port)
            if kind == "token" and self._codes.is_token(secret):
                return self._admit(Role.TEACHER, port)
        return Answer(403, WRONG_LINK)

    def _admit(self, role: Role, port: int) -> Answer:
        if role is Role.STUDENT and self._students_inside() >= self.places:
            return Answer(503, self._full_sentence)
        secret = self._visitors.admit(role, self._clock())
        if secret is None:
            return Answer(503, "Too many people have come in today: the teacher must end the class, or start anew.")
        flags = f"Path=/; Max-Age={int(LIFETIME)}; HttpOnly; SameSite=Strict" + "; Secure" * self._secure
        return Answer(200, "Welcome.", (("Set-Cookie", f"{self._cookie_name(port)}={secret}; {flags}"),))

    def _has_all_tabs(self, visitor: Visitor) -> bool:
        return len(self._tabs.get(visitor.number, ())) >= MAX_TABS

    def _is_full(self, visitor: Visitor) -> bool:
        outside = visitor.number not in self._tabs
        return visitor.role is Role.STUDENT and outside and self._students_inside() >= self.places

    def _students_inside(self) -> int:
        return sum(self._visitors.is_student(number) for number in self._tabs)

    @property
    def _full_sentence(self) -> str:
        return FULL.format(places=self.places)

    def _door(self, status: int, request: Request, port: int) -> Answer:
        """The page at the door. It gives the browser a cookie that lets nobody in: attempts are counted by it."""
        name = f"{DOOR_COOKIE}-{port}"
        farewell = self._visitors.farewell(_cookie(request, self._cookie_name(port)))
        sentence = self._full_sentence if status == 503 else farewell
        text = DOOR.read_text(encoding="utf-8").replace("SENTENCE", sentence)
        headers = [("Content-Security-Policy", DOOR_POLICY)]
        if not _cookie(request, name):
            flags = f"Path={DOOR_PATH}; HttpOnly; SameSite=Strict" + "; Secure" * self._secure
            headers.append(("Set-Cookie", f"{name}={secrets.token_urlsafe(12)}; {flags}"))
        return Answer(status, text, tuple(headers), content_type=HTML)

    def _cookie_name(self, port: int) -> str:
        """The name tells pages on other ports of this machine apart: browsers send cookies to all ports."""
        return "__Host-rangenav" if self._secure else f"rangenav-{port}"


def _cookie(request: Request, name: str) -> str:
    """The value of a cookie; empty for a request that has none, or lines that are no cookies."""
    try:
        cookies = SimpleCookie("; ".join(request.headers.get_all("Cookie"))[:8192])
    except CookieError:
        return ""
    return cookies[name].value if name in cookies else ""
