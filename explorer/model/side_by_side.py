"""The pinned run A and the run B on the page in numbers: a row for each figure, a column for each run.

    printed condition    min over the windows of λ₁ ∫ φφᵀ ≥ μ, with the paper's printed φ or axes
    derived condition    min over the windows of λ₁ ∫ p⁗p⁗ᵀ ≥ μ

A run with a switch “as printed” is judged by the printed condition in its row of the excitation. All other figures are
derived in both runs.
"""

from typing import NamedTuple

from explorer.model.compute import Picture
from explorer.model.differences import FIGURES, Figure, notable
from rangenav.number_format import quantity, significant

ROWS = 5
"""At most so many rows: they are read from the back of a room."""
EXCITATION, ALWAYS, LAST = "excitation μ", "quantities determined", "steady position error"
VERDICT = "verdict (as derived)"
ROUNDING = 1e-13
"""Share of the greatest eigenvalue below which the least one is rounding."""


class Row(NamedTuple):
    """One figure of both runs."""

    name: str
    a: str
    b: str


def title(run: Picture, other: Picture) -> str:
    """The name of a run's preset; and of its formulas, if the runs differ in the switches “as printed”."""
    name = run.preset.title or run.settings.origin
    if run.settings.printed == other.settings.printed:
        return name
    return f"{name}, {'as printed' if any(_switches(run)) else 'as derived'}"


def rows(a: Picture, b: Picture) -> tuple[Row, ...]:
    """The condition of excitation, the verdict and the determined quantities; then the figures that differ."""
    others = [figure for figure in FIGURES if figure.name not in (ALWAYS, EXCITATION)]
    differing = [figure for figure in others if notable(figure.of(a), figure.of(b))]
    last = [figure for figure in others if figure.name == LAST and figure not in differing]
    figures = [*(figure for figure in FIGURES if figure.name == ALWAYS), *differing, *last]
    return (
        Row("excitation condition", _condition(a), _condition(b)),
        Row(VERDICT, a.analysis.verdict.word, b.analysis.verdict.word),
        *(Row(figure.name, _text(figure, a), _text(figure, b)) for figure in figures[: ROWS - 2]),
    )


def _condition(run: Picture) -> str:
    printed = run.settings.printed.excitation or run.settings.printed.body_axes
    if printed:
        least, greatest = float(run.printed_excitation.min()), float(run.printed_excitation.max())
        mu = least if least > ROUNDING * greatest else 0.0
    else:
        mu = run.analysis.resolved_mu
    needed = run.preset.requirement.mu
    form, holds = "printed" if printed else "derived", mu >= needed
    wrong = ", so it calls this motion observable" if printed and holds and run.analysis.blind else ""
    reached = quantity(mu, "m²/s⁷")
    return f"{'✓ holds' if holds else '✕ fails'}: {form} μ {reached} (required: {significant(needed)}){wrong}"


def _text(figure: Figure, run: Picture) -> str:
    if figure.steady and run.summary.diverged:
        return f"not steady: {quantity(figure.of(run), figure.unit)} over the last quarter"
    return quantity(figure.of(run), figure.unit)


def _switches(run: Picture) -> tuple[bool, ...]:
    printed = run.settings.printed
    return tuple(getattr(printed, name) for name in printed.__struct_fields__)
