"""A preset's card: its path as a small drawing, its badge, its story, what was found about it; all text escaped."""

import html
from functools import lru_cache

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from explorer.certifying import Found
from rangenav.preset import Preset

SIDE, MARGIN, POINTS = 92, 7, 240
"""px of one drawing and of the space around its path; points along it."""
DRAWN = 64
"""Drawings remembered."""
BADGES = {
    "observable": ("●", "#00785a", "CERTIFIED OBSERVABLE"),
    "weak": ("▲", "#9a5b00", "CERTIFIED WEAK"),
    "unobservable": ("✕", "#7a3e00", "CERTIFIED UNOBSERVABLE"),
}
"""Shape, colour and words of what a certificate confirms, by what the preset expects."""
UNCERTIFIED = ("◌", "#b3261e", "UNCERTIFIED")
EXPECTED = {
    "observable": "● expected observable",
    "weak": "▲ expected weak",
    "unobservable": "✕ expected unobservable",
}
LINE = '<polyline points="{}" fill="none" stroke="#0072b2" stroke-width="1.5" stroke-linejoin="round"/>'
ANCHOR = '<path d="M{x:.1f} {y:.1f}m0-4l4 7h-8z" fill="#d55e00"/>'
STYLE = "font-size:0.85em;line-height:1.45;padding:0 0.9em 0.6em;overflow-wrap:anywhere"
CAPTION = '<figcaption style="color:#666;font-size:0.8em">{}</figcaption>'
FIGURE = f'<figure style="margin:0;text-align:center">{{}}{CAPTION}</figure>'
BOX = (
    f'<svg width="{SIDE}" height="{SIDE}" style="border:1px solid #ccc;border-radius:4px" role="img" aria-label="{{}}">'
)


def card(shown: Preset, found: Found | None, *, changed: bool) -> str:
    """The card as HTML; `found` None means that the certificate is being computed."""
    title = html.escape(shown.title) + (" • changed, not saved" if changed else "")
    said = [f'<div style="font-weight:600">{title}</div>']
    said += [_badge(shown, found), f"<div>{html.escape(shown.story)}</div>" if shown.story else ""]
    said.append(f'<div style="color:#555"><b>{EXPECTED[shown.expect]}</b>{_figures(shown, found)}</div>')
    pictures = f'<div style="display:flex;gap:0.8em;padding:0.3em 0">{drawings(shown)}</div>'
    return f'<div style="{STYLE}">{pictures}{"".join(said)}</div>'


@lru_cache(maxsize=DRAWN)
def drawings(shown: Preset) -> str:
    """The path over its period or the flight, from above and from the side where it is longer, as inline SVG."""
    signal, up = shown.path, -1.0 if shown.world.gravity[2] > 0 else 1.0
    length = min(shown.duration, signal.period or shown.duration)
    places = signal(np.linspace(0.0, length, POINTS)) * (1.0, 1.0, up)
    anchor = np.asarray(shown.world.anchor) * (1.0, 1.0, up)
    wide = int(np.ptp(places[:, 1]) > np.ptp(places[:, 0]))
    extent = " × ".join(f"{size:.2g}" for size in np.ptp(places, axis=0))
    return "".join(
        FIGURE.format(_svg(places[:, axes], anchor[list(axes)], words), caption)
        for axes, words, caption in (
            ([0, 1], "the path from above", "from above"),
            ([wide, 2], "the path from the side", f"from the side; {extent} m"),
        )
    )


def _svg(places: Float[Array, "n 2"], anchor: Float[Array, "2"], words: str) -> str:
    low, high = places.min(axis=0), places.max(axis=0)
    size = max(float((high - low).max()), 1e-6)
    scale, middle = (SIDE - 2 * MARGIN) / size, (low + high) / 2

    def spot(place: Float[Array, "... 2"]) -> Float[Array, "... 2"]:
        return SIDE / 2 + (place - middle) * (scale, -scale)

    line = LINE.format(" ".join(f"{x:.1f},{y:.1f}" for x, y in spot(places)))
    x, y = spot(anchor)
    stands = ANCHOR.format(x=x, y=y) if 0 <= x <= SIDE and 0 <= y <= SIDE else ""
    x, y = spot(places[0])
    start = f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2.5" fill="#0072b2"/>'
    return f"{BOX.format(words)}{stands}{line}{start}</svg>"


def _badge(shown: Preset, found: Found | None) -> str:
    shape, colour, words = UNCERTIFIED
    why = ""
    if found is None:
        words, colour = "BEING CERTIFIED …", "#555555"
    elif isinstance(found, str):
        why = found
    elif found.certified:
        shape, colour, words = BADGES[shown.expect]
    else:
        why = "; ".join(found.failures)
    chip = f'<span style="color:{colour};border:1px solid;border-radius:3px;padding:0 0.4em;font-weight:600">'
    said = f"<div>{html.escape(why)}</div>" if why else ""
    return f'<div style="padding:0.15em 0 0.3em">{chip}{shape} {words}</span></div>{said}'


def _figures(shown: Preset, found: Found | None) -> str:
    """μ and σ as the certificate has them."""
    if found is None or isinstance(found, str):
        return ""
    excited, sigma = found.excitation, found.accuracy.lifted.end.position
    needed = shown.requirement
    if excited.lower is not None:
        mu = f"μ ≥ {excited.lower:.3g}"
    else:
        mu = "μ below rounding" if excited.found is None else f"μ = {excited.found:.3g} on sampled windows"
    told = "not determined" if sigma is None else f"{sigma:.3g} m"
    return (
        f"<br>{mu} m²/s⁷ over {needed.window:g} s (required {needed.mu:.3g})"
        f"<br>predicted σ {told} (required {needed.position_sigma:.3g} m)"
    )
