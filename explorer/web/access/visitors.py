"""Who was let in: each browser by the digest of its cookie, until the class ends or it is removed."""

import secrets
from dataclasses import dataclass
from enum import StrEnum

from explorer.web.access.codes import digest

COOKIE_BYTES = 32
LIFETIME = 12 * 3600.0
"""s for which a cookie is valid: a day of classes."""
MAX_ADMITTED = 2000
"""Cookies that are remembered. Beyond that, students who were let in and never came are forgotten, the first of them
first; a teacher is always let in."""


class Role(StrEnum):
    """What a visitor may do."""

    TEACHER = "teacher"
    STUDENT = "student"


@dataclass(frozen=True)
class Visitor:
    """A browser that was let in."""

    number: int
    """Counts from 1 in the order of coming in; it names the visitor, and lets nobody in."""
    role: Role
    until: float
    """s, of a clock that never goes back."""


class Visitors:
    """The browsers that were let in. Not safe for threads: its owner holds a lock."""

    def __init__(self) -> None:
        self._by_digest: dict[bytes, Visitor] = {}
        self._students: set[int] = set()
        self._came: set[int] = set()
        """Who has opened a tab."""
        self._count = 0
        self._gone: dict[bytes, str] = {}
        """The reasons why visitors were sent out, by their cookies; only the last ones are kept."""

    def admit(self, role: Role, now: float) -> str | None:
        """Let a browser in. Returns the value of its cookie; None for a student if too many were let in."""
        self._forget_expired(now)
        if len(self._by_digest) >= MAX_ADMITTED and not self._forget_absent() and role is Role.STUDENT:
            return None
        secret = secrets.token_urlsafe(COOKIE_BYTES)
        self._count += 1
        if role is Role.STUDENT:
            self._students.add(self._count)
        self._by_digest[digest(secret)] = Visitor(self._count, role, now + LIFETIME)
        return secret

    def has_come(self, number: int) -> None:
        """A visitor has opened a tab."""
        self._came.add(number)

    def of(self, secret: str, now: float) -> Visitor | None:
        """Who has this cookie; None for a cookie that is forged, expired, or was taken back."""
        visitor = self._by_digest.get(digest(secret))
        return visitor if visitor is not None and now < visitor.until else None

    def has(self, number: int) -> bool:
        """Whether a visitor was let in and not sent out."""
        return any(visitor.number == number for visitor in self._by_digest.values())

    def is_student(self, number: int) -> bool:
        """Whether a visitor who was let in is a student, also after the cookie was taken back."""
        return number in self._students

    def farewell(self, secret: str) -> str:
        """Why the visitor with this cookie was sent out; empty for anybody else."""
        return self._gone.get(digest(secret), "")

    def remove(self, number: int, why: str) -> None:
        """Take back the cookie of one visitor."""
        self._take_back([key for key, one in self._by_digest.items() if one.number == number], why)

    def remove_students(self, why: str) -> None:
        """Take back the cookies of all students: the class is over."""
        self._take_back([key for key, one in self._by_digest.items() if one.role is Role.STUDENT], why)

    def _take_back(self, cookies: list[bytes], why: str) -> None:
        for cookie in cookies:
            del self._by_digest[cookie]
            self._gone[cookie] = why
        while len(self._gone) > MAX_ADMITTED:
            del self._gone[next(iter(self._gone))]

    def _forget_absent(self) -> bool:
        """Take back the oldest cookie of a student who never came. Returns whether there was one."""
        for key, one in self._by_digest.items():
            if one.role is Role.STUDENT and one.number not in self._came:
                del self._by_digest[key]
                return True
        return False

    def _forget_expired(self, now: float) -> None:
        self._by_digest = {key: one for key, one in self._by_digest.items() if now < one.until}
