"""One term of the page: its name, its unit, its meaning in one sentence, its equation, and its place in the paper."""

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Term:
    """A label of the page, or a word of its texts, with its definition."""

    label: str
    """A noun, with its symbol where it has one."""
    unit: str = ""
    meaning: str
    """One sentence."""
    formula: str = ""
    """The symbol in an equation."""
    place: str = ""
    """Where in the paper it stands; empty if it is not in the paper."""
    advice: str = ""
    """When to change it."""
    fields: tuple[str, ...] = ()
    """The keys of a preset whose values the term names, with dots."""

    @property
    def caption(self) -> str:
        """The label with its unit, as beside a control."""
        return f"{self.label} ({self.unit})" if self.unit else self.label

    @property
    def hint(self) -> str:
        """Meaning, equation with its place, and advice: the text that appears over a control or a row."""
        place = f" ({self.place})" if self.place else ""
        equation = f"{self.formula}{place}." if self.formula else ""
        meaning = f"{self.meaning[:-1]}{place}." if place and not self.formula else self.meaning
        return " ".join(part for part in (meaning, equation, self.advice) if part)
