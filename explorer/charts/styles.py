"""Styles of curves that belong together: a colour for each component, a dash for each kind.

No two curves of a plot share dash and width, so that every curve is recognised without its colour.
"""

from explorer.charts import definitions, plots
from explorer.charts.plots import DASH_DOT, DASHED, DOTTED, LONG, LONG_DOT, SOLID, SPARSE, Curve, Plot
from explorer.model import palette
from rangenav.number_format import subscript
from rangenav.observability.functions import NAMES

NO_ESTIMATE = "The estimate is not a number."


def error_plot(name: str, title: str, unit: str, draw: plots.Callable, text: definitions.Definition) -> Plot:
    """An error, and the σ that the observer's P claims for it."""
    actual = Curve(label="error", color=palette.ESTIMATE)
    claimed = Curve(label="σ by P", color=palette.CLAIMED_SIGMA, dash=DASHED)
    return Plot(
        name=name,
        title=title,
        unit=unit,
        curves=(actual, claimed),
        draw=draw,
        inputs=("errors", "estimate"),
        definition=text,
        empty=NO_ESTIMATE,
    )


def components(prefix: str, dashes: tuple[plots.Dash, ...]) -> tuple[Curve, ...]:
    """Three components, and their norm as a thicker curve."""
    colors = (palette.X_AXIS, palette.Y_AXIS, palette.Z_AXIS, palette.NORM)
    labels = tuple(prefix + name for name in ("x", "y", "z", "norm"))
    styled = zip(labels, colors, dashes, (1.25, 1.25, 1.25, 2.25), strict=True)
    return tuple(Curve(label=label, color=color, dash=dash, width=width) for label, color, dash, width in styled)


def eigenvalues(
    prefix: str, dashes: tuple[plots.Dash, ...], colors: tuple[palette.Color, ...] = palette.EXCITATION_EIGENVALUES
) -> tuple[Curve, ...]:
    """The three eigenvalues of an excitation, least first."""
    styled = zip((f"{prefix}λ₁", f"{prefix}λ₂", f"{prefix}λ₃"), colors, dashes, strict=True)
    return tuple(Curve(label=label, color=color, dash=dash) for label, color, dash in styled)


def limit(label: str, color: str, dash: plots.Dash, unit: str | None = None) -> Curve:
    """The vehicle's limit on a quantity, in the colour of the quantity."""
    return Curve(label=label, color=color, dash=dash, width=2.0, unit=unit)


def spectrum(least: str, greatest: str, floor: str, unit: str | None = None) -> tuple[Curve, ...]:
    """The least and the greatest with labels, the eleven between them thin with one label, the floor filled."""
    numbers = range(2, plots.STATES) if least.endswith("₁") else range(plots.STATES - 1, 1, -1)
    names = [f"{least[0]}{subscript(k)}" for k in numbers]
    labels = [f"{names[0]} …", *("" for _ in names[1:])]
    between = zip(labels, names, strict=True)
    return (
        Curve(label=least, color=palette.LEAST, width=2.0, unit=unit),
        *(Curve(label=label, name=name, color=palette.MIDDLE, width=1.0, unit=unit) for label, name in between),
        Curve(label=greatest, color=palette.GREATEST, width=2.0, dash=DASHED, unit=unit),
        Curve(label=floor, color=palette.NOISE_FLOOR, width=2.0, filled=True, unit=unit),
    )


def functions() -> tuple[Curve, ...]:
    """Powers of τ in grey; of D, colour and width give the axis and the dash gives the power of τ."""
    powers = zip(NAMES[:4], (SPARSE, LONG_DOT, DASH_DOT, LONG), strict=True)
    axes = ((palette.X_AXIS, 1.25), (palette.Y_AXIS, 1.75), (palette.Z_AXIS, 2.5))
    styled = zip(NAMES[4:], [(dash, *axis) for dash in (SOLID, DASHED, DOTTED) for axis in axes], strict=True)
    return (
        *(Curve(label=name, color=palette.GREY, dash=dash, width=1.0, unit="") for name, dash in powers),
        *(Curve(label=name, color=color, dash=dash, width=width, unit="") for name, (dash, color, width) in styled),
    )


def by_length(goal: str) -> tuple[Curve, ...]:
    """A quantity by window length: of the first window, of the worst window, and the required value."""
    first = Curve(label="from 0 s", color=palette.BLUE, dash=DASHED)
    worst = Curve(label="worst", color=palette.VERMILLION, width=2.0)
    return (first, worst, Curve(label=goal, color=palette.REQUIRED, dash=DASH_DOT))
