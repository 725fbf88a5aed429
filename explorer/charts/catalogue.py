"""All plots of the page, in the groups that become dock panels or tabs."""

from collections.abc import Callable
from typing import NamedTuple

from explorer.charts import depth, looks, plots, words
from explorer.charts.plots import DASH_DOT, DASHED, DOTTED, LONG, LONG_DOT, SOLID, SPARSE, Curve, Plot
from explorer.compute import Picture

PRINTED = (LONG, LONG_DOT, SPARSE, LONG)
"""The dashes of what the paper's misprints give."""


class Group(NamedTuple):
    """Plots that are shown together."""

    title: str
    plots: tuple[Plot, ...]
    say: Callable[[Picture], tuple[str, ...]] | None = None
    """Plain sentences above the plots, if there is something to say."""
    later: bool = False
    """Drawn only when nothing moves: they take as long as all others together."""


ERRORS = Group(
    "Errors",
    (
        looks.error("position", "Position error", "m", plots.position_error, words.POSITION_ERROR),
        looks.error("velocity", "Velocity error", "m/s", plots.velocity_error, words.VELOCITY_ERROR),
        looks.error("gravity", "Gravity error", "m/s²", plots.gravity_error, words.GRAVITY_ERROR),
        Plot(
            name="attitude",
            title="Attitude error",
            unit="°",
            curves=(Curve(label="error", color=plots.VERMILLION),),
            draw=plots.attitude_error,
            words=words.ATTITUDE_ERROR,
        ),
    ),
)
OBSERVABILITY = Group(
    "Observability",
    (
        Plot(
            name="snap",
            title="Excitation signal φ",
            unit="m/s⁴, body axes",
            curves=looks.components("", (SOLID, DASHED, DOTTED, SOLID)) + looks.components("printed ", PRINTED),
            draw=plots.snap,
            words=words.SNAP,
            log=False,
            again=(3,),
        ),
        Plot(
            name="excitation",
            title="PE eigenvalues",
            unit="m²/s⁷, by window start",
            across="window start",
            curves=(
                *looks.eigenvalues("", (SOLID, DASHED, DOTTED)),
                Curve(label="μ", color=plots.GREY, dash=DASH_DOT, width=2.0),
                *looks.eigenvalues("printed ", PRINTED[:3]),
            ),
            draw=plots.excitation,
            words=words.EXCITATION,
        ),
        Plot(
            name="gramian",
            title="Gramian spectrum",
            unit="SI, by window start",
            across="window start",
            curves=looks.spectrum("λ₁", "λ₁₃", "floor"),
            draw=plots.gramian,
            words=words.GRAMIAN,
        ),
        Plot(
            name="predicted",
            title="Predicted σ",
            unit="m, by window start",
            across="window start",
            curves=(
                Curve(label="lifted", color=plots.BLUE, dash=DASHED, width=2.0),
                Curve(label="nonlinear", color=plots.GREEN, dash=DOTTED, width=2.0),
                Curve(label="actual", color=plots.VERMILLION),
                Curve(label="wanted", color=plots.GREY, dash=DASH_DOT),
            ),
            draw=plots.predicted,
            words=words.PREDICTED,
            again=(0, 1),
        ),
    ),
)
SIGNALS = Group(
    "Signals",
    (
        Plot(
            name="innovation",
            title="Innovation",
            unit="in its own σ",
            curves=(Curve(label="(y − ŷ)/σ", color=plots.VERMILLION, unit=""),),
            draw=plots.innovation,
            words=words.INNOVATION,
            log=False,
        ),
        Plot(
            name="distance",
            title="Range",
            unit="m",
            curves=(
                Curve(label="measured", color=plots.SKY, width=1.0),
                Curve(label="true", color=plots.BLUE, dash=DASHED),
            ),
            draw=plots.distance,
            words=words.DISTANCE,
            log=False,
            again=(1,),
        ),
        Plot(
            name="speed",
            title="Speed",
            unit="m/s",
            curves=(Curve(label="true", color=plots.BLUE), looks.limit("limit", plots.BLUE, DASHED)),
            draw=plots.speed,
            words=words.SPEED,
            log=False,
        ),
        Plot(
            name="effort",
            title="Thrust/weight and body rate",
            unit="1, rad/s",
            curves=(
                Curve(label="thrust/weight", color=plots.BLUE, unit=""),
                Curve(label="|ω|", color=plots.ORANGE, dash=DASHED, unit="rad/s"),
                looks.limit("thrust limit", plots.BLUE, DASH_DOT, ""),
                looks.limit("|ω| limit", plots.ORANGE, DOTTED, "rad/s"),
            ),
            draw=plots.effort,
            words=words.EFFORT,
            log=False,
            again=(0, 1),
        ),
    ),
)
DEPTH = Group(
    "In depth",
    (
        Plot(
            name="rank-by-length",
            title="Rank by window length",
            unit="of 13",
            across="window length",
            curves=looks.by_length("all"),
            draw=depth.rank_by_length,
            words=words.RANK_BY_LENGTH,
            log=False,
        ),
        Plot(
            name="sigma-by-length",
            title="Predicted σ by window length",
            unit="m",
            across="window length",
            curves=looks.by_length("wanted"),
            draw=depth.sigma_by_length,
            words=words.SIGMA_BY_LENGTH,
        ),
        Plot(
            name="scaled",
            title="Scaled spectrum",
            unit="by window start",
            across="window start",
            curves=looks.spectrum("s₁₃", "s₁", "tolerance", unit=""),
            draw=depth.scaled,
            words=words.SCALED,
        ),
        Plot(
            name="functions",
            title="The 13 functions",
            unit="over their peaks, by τ",
            across="τ",
            curves=looks.functions(),
            draw=depth.functions,
            words=words.FUNCTIONS,
            log=False,
            again=(),
        ),
    ),
    depth.say_depth,
    later=True,
)
TWIN = Group(
    "Twin",
    (
        Plot(
            name="twin-range",
            title="Range of the evil twin",
            unit="m",
            curves=(
                Curve(label="true", color=plots.BLUE, width=2.5),
                Curve(label="twin", color=plots.OLIVE, dash=DASHED),
            ),
            draw=depth.ranges,
            words=words.TWIN_RANGE,
            log=False,
        ),
        Plot(
            name="twin-apart",
            title="How far off, and unseen",
            unit="m",
            curves=(
                Curve(label="apart", color=plots.OLIVE, dash=DASHED, width=2.0),
                Curve(label="range differs", color=plots.VERMILLION),
                Curve(label="tolerance", color=plots.GREY, dash=DASH_DOT),
            ),
            draw=depth.apart,
            words=words.TWIN_APART,
        ),
        Plot(
            name="phi-both",
            title="|φ| derived and printed",
            unit="m/s⁴",
            curves=(
                Curve(label="derived", color=plots.BLUE, width=2.0),
                Curve(label="printed", color=plots.ORANGE, dash=LONG),
            ),
            draw=depth.phi,
            words=words.PHI_BOTH,
            log=False,
        ),
        Plot(
            name="pe-both",
            title="PE as printed",
            unit="m²/s⁷, by window start",
            across="window start",
            curves=(
                Curve(label="derived", color=plots.BLUE, width=2.0),
                Curve(label="φ printed", color=plots.ORANGE, dash=DASHED),
                Curve(label="body axes", color=plots.GREEN, dash=DOTTED),
                Curve(label="both", color=plots.VERMILLION, dash=LONG, width=2.0),
                Curve(label="μ", color=plots.GREY, dash=DASH_DOT, width=2.0),
            ),
            draw=depth.certificates,
            words=words.CERTIFICATES,
        ),
    ),
    depth.say_twin,
    later=True,
)
GROUPS = (ERRORS, OBSERVABILITY, DEPTH, TWIN, SIGNALS)
