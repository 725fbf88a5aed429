"""Error messages are compared word for word."""

import re


def exactly(sentence: str) -> str:
    """The pattern that this sentence matches and no other, for `pytest.raises(..., match=)`."""
    return rf"\A{re.escape(sentence)}\Z"
