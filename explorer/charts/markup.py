"""The HTML around a plot: title, legend with live values, foldable equation, and the time cursor that lies over it.

A plot cannot move a line cheaply. The cursor is therefore a strip of HTML at
    left = f width,   f = time / duration,
over the drawing area of the plot.
The share f and every value in the legends are CSS variables, so that one small <style> moves all cursors at once, and
another one writes all values. While
the mouse is on a plot, the legends give the values there, and every plot shows that time. Entries of a legend are
buttons whose clicks pointer.py collects. No text of a visitor enters this HTML.
"""

from collections.abc import Iterable
from html import escape

from explorer.charts.plots import Curve, Plot
from explorer.charts.pointer import curve_id
from explorer.model import palette

AXIS_SIZES, BIG_AXIS_SIZES = (50, 24), (78, 34)
"""px: width of the vertical and height of the horizontal axis of a plot; and with big type. They are fixed, so that the
ends of the time axis are known to the cursor."""
PADDING, BIG_PADDING = (8, 24, 0, 0), (13, 38, 0, 0)
"""px inside a plot: top, right, bottom, left; and with big type, whose highest label is half of its height higher."""
MARGIN = 10
"""px that viser leaves around a plot (its spacing "xs"); its border is 1 px wide."""
BORDER, BIG_FACTOR = 1, 1.5
"""px; and the factor of viser's spacing with big type (page.css)."""
FRACTION = "--tcur"
HOVERED, HOVERED_TIME = "--rn-at", "--rn-at-time"
"""The mouse's share of the time axis and the time there; unset while the mouse is on no plot."""
WINDOW_FROM, WINDOW_SPAN = "--wfrom", "--wspan"
"""Start and length of the window at the cursor, as shares of the duration: a band over every plot."""
BRUSH_FROM, BRUSH_SPAN = "--rn-brush-from", "--rn-brush-span"
"""The same for a new window while it is drawn with the mouse (set by pointer.py)."""
STYLE = f"""
.rn-plot {{ position: relative; margin: 6px 0 -7px 0; font-size: calc(12px * var(--rn-scale, 1));
  line-height: 1.35; }}
.rn-plot details {{ padding: 0 {MARGIN}px; }}
.rn-plot summary {{ cursor: pointer; list-style: none; }}
.rn-plot summary::-webkit-details-marker {{ display: none; }}
.rn-title {{ display: flex; align-items: baseline; gap: 6px; white-space: nowrap; }}
.rn-title b {{ font-weight: 600; }} .rn-unit {{ opacity: .65; }}
.rn-fold {{ margin: 0 24px 0 auto; opacity: .75; }} details[open] .rn-fold {{ transform: rotate(90deg); }}
.rn-legend {{ display: flex; flex-wrap: wrap; column-gap: 6px; font-variant-numeric: tabular-nums;
  font-size: calc(12px * var(--rn-scale, 1)); }}
.rn-legend {{ margin: 0 {MARGIN}px; }} .rn-legend svg {{ vertical-align: middle; margin-right: 3px; }}
.rn-legend button {{ all: unset; white-space: nowrap; cursor: pointer; }}
.rn-legend button:hover {{ text-decoration: underline; }}
.rn-legend button:focus-visible {{ outline: 2px solid {palette.FOCUS}; }}
.rn-legend button[aria-pressed=false] {{ opacity: .75; text-decoration: line-through; }}
.rn-v {{ display: inline-block; min-width: calc(43px * var(--rn-scale, 1)); font-weight: 500; }}
.rn-v::after {{ content: var(--rn-value, '–'); }}
.rn-note {{ margin: 0 {MARGIN}px; font-size: calc(12px * var(--rn-scale, 1)); line-height: 1.25; opacity: .75; }}
.rn-expand {{ all: unset; cursor: pointer; position: absolute; right: {MARGIN}px; top: -3px; padding: 0 4px;
  font-size: calc(16px * var(--rn-scale, 1)); }}
.rn-expand:hover {{ background: {palette.DEFINITION_FILL}; }}
.rn-expand:focus-visible {{ outline: 2px solid {palette.FOCUS}; }}
.rn-empty {{ position: absolute; inset: 0; display: flex; align-items: center; justify-content: center;
  text-align: center; padding: 0 10px; font-size: calc(12px * var(--rn-scale, 1)); }}
.rn-empty span {{ background: var(--mantine-color-body); padding: 0 .4em; border-radius: 3px; }}
.rn-other {{ color: {palette.PRINTED_FORMULA}; opacity: 1; }}
.rn-definition {{ margin: 4px 0; padding: 5px 8px; border-left: 3px solid {palette.DEFINITION_EDGE};
  background: {palette.DEFINITION_FILL}; }}
.rn-equation {{ font-family: "STIX Two Math", "Cambria Math", serif; line-height: 1.6;
  font-size: calc(15px * var(--rn-scale, 1)); }}
.rn-over {{ position: absolute; pointer-events: none; z-index: 2; }}
.rn-cursor {{ position: absolute; top: 0; bottom: 0; width: 1.5px;
  margin-left: -.75px; background: currentColor; opacity: .55; }}
.rn-at {{ position: absolute; transform: translateX(-50%); padding: 0 4px;
  border-radius: 3px; background: {palette.TOOLTIP}; color: {palette.TOOLTIP_TEXT};
  font-size: calc(12px * var(--rn-scale, 1)); font-variant-numeric: tabular-nums; }}
.rn-at::after {{ content: var({HOVERED_TIME}); }}
.rn-window {{ position: absolute; top: 0; bottom: 0; background: {palette.WINDOW}; opacity: .13; }}
.rn-brush {{ position: absolute; top: 0; bottom: 0; background: {palette.BRUSH}; opacity: .25; }}
.rn-seconds {{ position: absolute; font-size: calc(12px * var(--rn-scale, 1)); opacity: .65; }}
"""
"""The rules of all plots, for the style sheet of the page: in each plot they would be stored and sent again."""


EXPAND = (
    '<button type="button" class="rn-expand" data-rn-event="expand-{}" title="Large view, with export" '
    'aria-label="Large view: {}">⤢</button>'
)


def variable(plot: Plot, column: int) -> str:
    """The CSS variable that carries the value of a curve at the cursor."""
    return f"--{curve_id(plot, column)}"


def text_id(name: str) -> str:
    """The id of the element with the text of a plot, for readers of the screen."""
    return f"rn-text-{name}"


def axis_sizes(big: bool) -> tuple[int, int]:
    """px: width of the vertical and height of the horizontal axis."""
    return BIG_AXIS_SIZES if big else AXIS_SIZES


def padding(big: bool) -> tuple[int, int, int, int]:
    """px inside a plot: top, right, bottom, left."""
    return BIG_PADDING if big else PADDING


def header(
    plot: Plot,
    *,
    height: int,
    big: bool = False,
    large: bool = False,
    empty: str = "",
    hidden: tuple[int, ...],
    switched_off: frozenset[int] = frozenset(),
) -> str:
    """Title, legend, equation and cursor of a plot that is `height` px high.

    A hidden curve has no legend entry. A curve that the visitor has switched off keeps its entry, to switch it on."""
    legend = "".join(_entry(plot, i, on=i not in switched_off) for i in plot.in_legend if i not in hidden)
    margin = MARGIN * (BIG_FACTOR if big else 1.0)
    inset, right, _, _ = padding(big)
    top = margin - 7 + BORDER + inset
    axis_width, axis_height = axis_sizes(big)
    inside = height - inset - axis_height
    ends = f"left:{margin + BORDER + axis_width:g}px;right:{margin + BORDER + right:g}px"
    span = f"width:calc(var({WINDOW_SPAN}, 0) * 100%)"
    brush = f"left:{_left(BRUSH_FROM, '0')};width:calc(var({BRUSH_SPAN}, 0) * 100%)"
    fold = '<span class="rn-fold" title="Equation and meaning">▸ ƒ</span>'
    expand = "" if large else EXPAND.format(plot.name, plot.title)
    beneath = f"bottom:-{axis_height - 4}px"
    at_end = f"{beneath};right:-{right}px"
    other = f'<span class="rn-seconds rn-other" style="{at_end}">{plot.x_name} (s)</span>'
    title = f'<b>{plot.title}</b><span class="rn-unit">{plot.unit}</span>{fold}'
    note = f'<div class="rn-note">{plot.definition.note}</div>' if plot.definition.note else ""
    equation = f'<div class="rn-equation">{plot.definition.equation}</div>'
    moving = (
        f'<div class="rn-window" style="left:{_left(WINDOW_FROM, "0")};{span}"></div>'
        f'<div class="rn-cursor" style="left:{_left(FRACTION, "0")}"></div>'
        f'<span class="rn-seconds" style="{at_end}">s</span>'
    )
    reason = f'<div class="rn-empty"><span>{escape(empty)}</span></div>' if empty else ""
    return (
        f'<div class="rn-plot" data-plot="{plot.name}">{expand}<details>'
        f'<summary><div class="rn-title">{title}</div></summary>'
        f'<div class="rn-definition">{equation}{plot.definition.meaning}</div></details>'
        f'<div class="rn-legend">{legend}</div>{note}'
        f'<div class="rn-over" role="img" aria-label="Plot: {plot.title}" aria-describedby="{text_id(plot.name)}" '
        f'style="top:calc(100% + {top:g}px);height:{inside}px;{ends}">{reason}'
        f'{moving if plot.along_flight else other}<div class="rn-brush" style="{brush}"></div>'
        f'<span class="rn-at" style="left:{_left(HOVERED, "-99")};{beneath}"></span></div></div>'
    )


def _left(fraction: str, otherwise: str) -> str:
    """The position of a share of the time axis, for CSS; `otherwise` while the share is unset."""
    return f"calc(var({fraction}, {otherwise}) * 100%)"


def _entry(plot: Plot, column: int, *, on: bool) -> str:
    curve = plot.curves[column]
    return (
        f'<button type="button" data-curve="{curve_id(plot, column)}" aria-pressed="{str(on).lower()}" '
        f'title="Show or hide {curve.label}">{_line(curve)}{curve.label} '
        f'<b class="rn-v" style="--rn-value:var({variable(plot, column)},\'–\');font-weight:500"></b>'
        f"{curve.unit or ''}</button>"
    )


def _line(curve: Curve) -> str:
    dash = " ".join(f"{length:g}" for length in curve.dash)
    line = (
        f'<path d="M0 5h18" stroke="{curve.color}" stroke-width="{max(curve.width, 2):g}" stroke-dasharray="{dash}"/>'
    )
    return f'<svg width="18" height="10">{line}</svg>'


TEXT_STYLE = "font-size:calc(12px * var(--rn-scale, 1));line-height:1.35"


def paragraphs(lines: Iterable[str]) -> str:
    """Sentences above the plots of a tab, one below the other."""
    return "".join(f'<div style="padding:2px {MARGIN}px;{TEXT_STYLE}">{escape(line)}</div>' for line in lines)


def moving_style(fraction: float, window: tuple[float, float]) -> str:
    """What changes at every frame: the positions of cursor and window, as shares of the time axis."""
    start, span = window
    return f"<style>:root{{{FRACTION}:{fraction:.5f};{WINDOW_FROM}:{start:.5f};{WINDOW_SPAN}:{span:.5f};}}</style>"


def values_style(values: Iterable[tuple[str, str]], status: str, hovered: tuple[float, str] | None) -> str:
    """What changes as time moves, and is to be read: the values in the legends, the status line, and the mouse's share
    of the time axis with the time there."""
    assigned = "".join(f'{name}:"{text}";' for name, text in values)
    if hovered is not None:
        assigned += f'{HOVERED}:{hovered[0]:.4f};{HOVERED_TIME}:"{hovered[1]}";'
    line = f'<div class="rn-status">{status}</div>'
    return f"<style>:root{{{assigned}}}</style>{line}"
