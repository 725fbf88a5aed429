"""All plots of the page, in the groups that become tabs.

To add a plot: its numbers in `plots` or `details`, its equation and meaning in `definitions`, and a row here. Its name
must be unique, and no two of its curves may share dash and width.
"""

from collections.abc import Callable
from typing import NamedTuple

from viser import Icon, IconName

from explorer.charts import convergence, definitions, details, plots, styles
from explorer.charts.plots import DASH_DOT, DASHED, DOTTED, LONG, LONG_DOT, SOLID, SPARSE, Curve, Plot
from explorer.model import palette
from explorer.model.compute import Picture

PRINTED = (LONG, LONG_DOT, SPARSE, LONG)
"""The dashes of curves that follow the paper's misprints."""


class Group(NamedTuple):
    """Plots that share a tab."""

    title: str
    icon: IconName
    plots: tuple[Plot, ...]
    describe: Callable[[Picture], tuple[str, ...]] | None = None
    """The sentences above the plots."""
    compare: Callable[[Picture, Picture], tuple[str, ...]] | None = None
    """Further sentences: on the pinned run A, and on how the run B on the page differs."""
    slow: bool = False
    """Drawn only when nothing changes: the slow groups take as long to compute as all others together."""


ERRORS = Group(
    "Errors",
    Icon.CHART_LINE,
    (
        styles.error_plot("position", "Position error", "m", plots.position_error, definitions.POSITION_ERROR),
        styles.error_plot("velocity", "Velocity error", "m/s", plots.velocity_error, definitions.VELOCITY_ERROR),
        styles.error_plot("gravity", "Gravity error", "m/s²", plots.gravity_error, definitions.GRAVITY_ERROR),
        Plot(
            name="attitude",
            title="Attitude error",
            unit="°",
            curves=(Curve(label="error", color=palette.ESTIMATE),),
            draw=plots.attitude_error,
            inputs=("errors",),
            definition=definitions.ATTITUDE_ERROR,
        ),
    ),
)
OBSERVABILITY = Group(
    "Observability",
    Icon.EYE,
    (
        Plot(
            name="snap",
            title="Excitation signal φ",
            unit="m/s⁴, body axes",
            curves=styles.components("", (SOLID, DASHED, DOTTED, SOLID)) + styles.components("printed ", PRINTED),
            draw=plots.snap,
            inputs=("settings.printed",),
            empty="The excitation is zero along every axis: the path has no snap.",
            deciding=(0, 1, 2, 4, 5, 6),
            definition=definitions.SNAP,
            log=False,
            pinned_curves=(3, 7),
        ),
        Plot(
            name="excitation",
            title="PE eigenvalues",
            unit="m²/s⁷, by window start",
            x_name="window start",
            curves=(
                *styles.eigenvalues("", (SOLID, DASHED, DOTTED)),
                Curve(label="μ wanted", color=palette.REQUIRED, dash=DASH_DOT, width=2.0),
                *styles.eigenvalues("printed ", PRINTED[:3], palette.PRINTED_EIGENVALUES),
            ),
            draw=plots.excitation,
            inputs=("analysis", "preset.requirement", "settings.printed"),
            empty="The excitation is zero along every axis.",
            deciding=(0, 1, 2, 4, 5, 6),
            definition=definitions.EXCITATION,
            pinned_curves=(0, 4),
        ),
        Plot(
            name="gramian",
            title="Gramian spectrum",
            unit="SI, by window start",
            x_name="window start",
            curves=styles.spectrum("λ₁", "λ₁₃", "floor"),
            draw=plots.gramian,
            inputs=("analysis",),
            definition=definitions.GRAMIAN,
        ),
        Plot(
            name="predicted",
            title="Predicted σ",
            unit="m, by window start",
            x_name="window start",
            curves=(
                Curve(label="lifted", color=palette.BLUE, dash=DASHED, width=2.0),
                Curve(label="nonlinear", color=palette.GREEN, dash=DOTTED, width=2.0),
                Curve(label="actual", color=palette.ESTIMATE),
                Curve(label="wanted", color=palette.REQUIRED, dash=DASH_DOT),
            ),
            draw=plots.predicted,
            inputs=("analysis", "errors", "preset.requirement"),
            empty="No window determines the position.",
            deciding=(0, 1),
            definition=definitions.PREDICTED,
            pinned_curves=(0, 1),
        ),
    ),
)
SIGNALS = Group(
    "Signals",
    Icon.WAVE_SINE,
    (
        Plot(
            name="innovation",
            title="Innovation",
            unit="in its own σ",
            curves=(Curve(label="(y − ŷ)/σ", color=palette.ESTIMATE, unit=""),),
            draw=plots.innovation,
            inputs=("estimate", "measurements"),
            empty="No range was used by the observer.",
            definition=definitions.INNOVATION,
            log=False,
        ),
        Plot(
            name="distance",
            title="Range",
            unit="m",
            curves=(
                Curve(label="measured", color=palette.MEASURED, width=1.0),
                Curve(label="true", color=palette.TRUTH, dash=DASHED),
            ),
            draw=plots.distance,
            inputs=("measurements", "preset.path", "preset.world", "preset.sensors"),
            definition=definitions.DISTANCE,
            log=False,
            pinned_curves=(1,),
        ),
        Plot(
            name="speed",
            title="Speed",
            unit="m/s",
            curves=(Curve(label="true", color=palette.TRUTH), styles.limit("limit", palette.TRUTH, DASHED)),
            draw=plots.speed,
            inputs=("preset.vehicle",),
            definition=definitions.SPEED,
            log=False,
        ),
        Plot(
            name="effort",
            title="Thrust/weight and body rate",
            unit="1, rad/s",
            curves=(
                Curve(label="thrust/weight", color=palette.TRUTH, unit=""),
                Curve(label="|ω|", color=palette.TURN_RATE, dash=DASHED, unit="rad/s"),
                styles.limit("thrust limit", palette.TRUTH, DASH_DOT, ""),
                styles.limit("|ω| limit", palette.TURN_RATE, DOTTED, "rad/s"),
            ),
            draw=plots.effort,
            inputs=("preset.world", "preset.vehicle"),
            definition=definitions.EFFORT,
            log=False,
            pinned_curves=(0, 1),
        ),
    ),
)
DEPTH = Group(
    "In depth",
    Icon.MICROSCOPE,
    (
        Plot(
            name="rank-by-length",
            title="Rank by window length",
            unit="of 13",
            x_name="window length",
            curves=styles.by_length("all"),
            draw=details.rank_by_length,
            definition=definitions.RANK_BY_LENGTH,
            log=False,
        ),
        Plot(
            name="sigma-by-length",
            title="Predicted σ by window length",
            unit="m",
            x_name="window length",
            curves=styles.by_length("wanted"),
            draw=details.sigma_by_length,
            empty="No window of any length determines the position.",
            deciding=(0, 1),
            definition=definitions.SIGMA_BY_LENGTH,
        ),
        Plot(
            name="scaled",
            title="Scaled spectrum",
            unit="by window start",
            x_name="window start",
            curves=styles.spectrum("s₁₃", "s₁", "tolerance", unit=""),
            draw=details.scaled,
            definition=definitions.SCALED,
        ),
        Plot(
            name="functions",
            title="The 13 functions",
            unit="over their peaks, by τ",
            x_name="τ",
            curves=styles.functions(),
            draw=details.functions,
            definition=definitions.FUNCTIONS,
            log=False,
            pinned_curves=(),
        ),
    ),
    details.describe_depth,
    slow=True,
)
TWIN = Group(
    "Twin",
    Icon.GHOST,
    (
        Plot(
            name="twin-range",
            title="Range of the evil twin",
            unit="m",
            curves=(
                Curve(label="true", color=palette.TRUTH, width=2.5),
                Curve(label="twin", color=palette.TWIN, dash=DASHED),
            ),
            draw=details.ranges,
            empty="There is no twin: the sentence above says why.",
            deciding=(1,),
            definition=definitions.TWIN_RANGE,
            log=False,
        ),
        Plot(
            name="twin-apart",
            title="How far off, and unseen",
            unit="m",
            curves=(
                Curve(label="apart", color=palette.TWIN, dash=DASHED, width=2.0),
                Curve(label="range differs", color=palette.VERMILLION),
                Curve(label="tolerance", color=palette.REQUIRED, dash=DASH_DOT),
            ),
            draw=details.apart,
            empty="There is no twin: the sentence above says why.",
            definition=definitions.TWIN_APART,
        ),
        Plot(
            name="phi-both",
            title="|φ| derived and printed",
            unit="m/s⁴",
            curves=(
                Curve(label="derived", color=palette.DERIVED, width=2.0),
                Curve(label="printed", color=palette.PRINTED, dash=LONG),
            ),
            draw=details.phi,
            empty="Both are zero: the path has no snap.",
            deciding=(0, 1),
            definition=definitions.PHI_BOTH,
            log=False,
        ),
        Plot(
            name="pe-both",
            title="PE as printed",
            unit="m²/s⁷, by window start",
            x_name="window start",
            curves=(
                Curve(label="derived", color=palette.DERIVED, width=2.0),
                Curve(label="φ printed", color=palette.PRINTED, dash=DASHED),
                Curve(label="body axes", color=palette.GREEN, dash=DOTTED),
                Curve(label="both", color=palette.VERMILLION, dash=LONG, width=2.0),
                Curve(label="μ wanted", color=palette.REQUIRED, dash=DASH_DOT, width=2.0),
            ),
            draw=details.certificates,
            definition=definitions.CERTIFICATES,
        ),
    ),
    details.describe_twin,
    slow=True,
)
CONVERGENCE = Group(
    "Convergence",
    Icon.TRENDING_DOWN,
    (
        Plot(
            name="noiseless",
            title="Position error without noise",
            unit="m",
            curves=(
                Curve(label="without noise", color=palette.BLUE, dash=DASHED, width=2.0),
                Curve(label="this run", color=palette.ESTIMATE),
                Curve(label="settled", color=palette.REQUIRED, dash=DASH_DOT),
            ),
            draw=convergence.noiseless,
            definition=definitions.NOISELESS,
        ),
        Plot(
            name="contraction",
            title="Contraction",
            unit="by window start",
            x_name="window start",
            curves=(
                Curve(label="slowest", color=palette.VERMILLION, width=2.0),
                Curve(label="fastest", color=palette.BLUE, dash=DASHED),
                Curve(label="no fading", color=palette.REQUIRED, dash=DASH_DOT),
            ),
            draw=convergence.contraction,
            definition=definitions.CONTRACTION,
        ),
        Plot(
            name="closed-loop",
            title="Eigenvalues of 𝒜 − K𝒞",
            unit="1/s, real parts",
            curves=(
                Curve(label="largest", color=palette.VERMILLION, width=2.0),
                Curve(label="smallest", color=palette.BLUE, dash=DASHED),
            ),
            draw=convergence.closed_loop,
            definition=definitions.CLOSED_LOOP,
            log=False,
        ),
    ),
    convergence.describe,
    convergence.compare,
    slow=True,
)
GROUPS = (ERRORS, OBSERVABILITY, DEPTH, CONVERGENCE, TWIN, SIGNALS)
