"""What lets people in, to be shown: links, the code, and the students' link as a QR code."""

import io
import os
from pathlib import Path

import segno

from explorer.model import palette
from explorer.web.access.codes import Codes, checked_token
from explorer.web.access.entrance import Entrance
from explorer.web.access.visitors import Role

TOKEN_VARIABLE = "RANGENAV_TOKEN"


def codes_with(token_file: Path | None) -> Codes:
    """Codes with the teacher's token of a file, or of the environment, or a new one: the command line would show it to
    every user of this machine. Raises ValueError with one sentence."""
    if token_file is not None:
        try:
            token = token_file.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            reason = error.strerror if isinstance(error, OSError) else "it is no text"
            raise ValueError(f"--token-file {token_file}: cannot be read: {reason}") from None
        return Codes(token=checked_token(token, f"--token-file {token_file}"))
    if TOKEN_VARIABLE in os.environ:
        return Codes(token=checked_token(os.environ[TOKEN_VARIABLE], TOKEN_VARIABLE))
    return Codes()


def invitation(entrance: Entrance, page: str) -> str:
    """The lines that the teacher reads in the terminal. page: the page's address, with a slash at its end."""
    students = entrance.link(Role.STUDENT, page)
    drawn = io.StringIO()
    segno.make(students, micro=False).terminal(drawn, compact=True)
    return (
        f"For you alone: {entrance.link(Role.TEACHER, page)}\n"
        f"For students:  {students}\n"
        f"or {page} and the code {entrance.code}\n\n"
        f"{drawn.getvalue()}\n"
        "Ctrl+C ends the class. The tab Class shows a new code and link, once they were replaced there."
    )


def qr_svg(text: str, scale: float | None = 4.0) -> str:
    """A text as a QR code: an SVG picture, dark on white in either theme. scale: px of a dot; None for a picture that
    takes any size."""
    return segno.make(text, micro=False).svg_inline(
        scale=scale or 1, omitsize=scale is None, dark=palette.CODE_INK, light=palette.CODE_GROUND, border=4
    )
