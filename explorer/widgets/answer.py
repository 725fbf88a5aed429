"""A button beside a progress or an outcome that is shown over the scene: it answers what a panel has found."""

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class AnswerButton:
    """One of the page's own HTML, by the event that it sends."""

    event: str
    label: str
    hint: str
    main: bool = False
    """Whether it is the one that is usually wanted."""
