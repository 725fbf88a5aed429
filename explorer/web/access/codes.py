"""The secrets of a class: the teacher's token, the students' key, and the code that students type."""

import hashlib
import hmac
import re
import secrets
from dataclasses import dataclass, field

ALPHABET = "ABCDEFGHJKMNPQRSTUVWXYZ23456789"
"""What a code consists of: no I, L, O, 0 or 1, which are confused on a projector."""
CODE_LENGTH = 6
"""Letters of a code: 8.9e8 codes. With `MAX_WRONG` attempts a guess is right with a chance of 3.4e-7."""
MAX_WRONG = 300
"""Wrong attempts, by all visitors together, after which a code is replaced."""
TOKEN_BYTES, KEY_BYTES = 32, 16
TOKEN = re.compile(r"[A-Za-z0-9_-]{16,180}")
"""The form of a token that somebody has chosen."""


def new_code() -> str:
    """A code of random letters."""
    return "".join(secrets.choice(ALPHABET) for _ in range(CODE_LENGTH))


def new_token() -> str:
    """A token of 256 random bits."""
    return secrets.token_urlsafe(TOKEN_BYTES)


def digest(secret: str) -> bytes:
    """What is kept of a secret: nobody who reads the memory of a table of digests can come in with it."""
    return hashlib.sha256(secret.encode()).digest()


def typed(text: str) -> str:
    """A code as it was meant: capital letters, without the spaces and dashes that people put in."""
    return "".join(character for character in text.upper() if character.isalnum())


def checked_token(token: str, source: str) -> str:
    """A token that somebody has chosen. Raises ValueError naming its source if it is too short, or no part of a
    link."""
    token = token.strip()
    if TOKEN.fullmatch(token) is None:
        raise ValueError(
            f"{source}: a token consists of 16 to 180 letters, digits, - and _; leave it away, and one is made"
        )
    return token


@dataclass
class Codes:
    """The secrets that are valid now."""

    token: str = field(default_factory=new_token)
    key: str = field(default_factory=lambda: secrets.token_urlsafe(KEY_BYTES))
    code: str = field(default_factory=new_code)
    wrong: int = 0
    """Wrong attempts at this code."""
    replaced: int = 0
    """How often a code was replaced because of wrong attempts."""

    def is_token(self, text: str) -> bool:
        """Whether a text is the teacher's token; the time that this takes tells nothing about it."""
        return hmac.compare_digest(digest(text), digest(self.token))

    def is_key(self, text: str) -> bool:
        """Whether a text is the students' key."""
        return hmac.compare_digest(digest(text), digest(self.key))

    def is_code(self, text: str) -> bool:
        """Whether a typed text is the students' code. A code that was guessed at too often is replaced."""
        if hmac.compare_digest(digest(typed(text)), digest(self.code)):
            return True
        self.wrong += 1
        if self.wrong >= MAX_WRONG:
            self.code, self.wrong, self.replaced = new_code(), 0, self.replaced + 1
        return False

    def renew(self) -> None:
        """Replace what students come in with. Who is in stays in."""
        self.key, self.code, self.wrong = secrets.token_urlsafe(KEY_BYTES), new_code(), 0
