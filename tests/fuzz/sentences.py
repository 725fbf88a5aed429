"""What is refused is refused in one line that begins with the name of what was read."""

COLUMNS_NAMED = 2000
"""Characters of a refusal that lists the columns of the file."""


def check(said: str, start: str, *, longest: int = 400) -> None:
    """Raise AssertionError unless a refusal is one line of a readable length that begins as it should."""
    assert said.startswith(start), said
    assert "\n" not in said, said
    assert len(said) < longest, said
