"""A preset's card: its path as a small drawing, its badge, its story, what was found about it; all text escaped."""

import html
from functools import lru_cache

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from explorer.model import palette
from explorer.storage.certifier import CertificateOrReason
from rangenav.preset import Preset

SIDE, MARGIN, POINTS = 92, 7, 240
"""px of one drawing and of the space around its path; points along it."""
DRAWN = 64
"""Drawings remembered."""
BADGES = {
    "observable": ("●", palette.GOOD, "CERTIFIED OBSERVABLE"),
    "weak": ("▲", palette.WARNING, "CERTIFIED WEAK"),
    "unobservable": ("✕", palette.UNOBSERVABLE, "CERTIFIED UNOBSERVABLE"),
}
"""Shape, colour (on white, on black) and words of what a certificate confirms, by what the preset expects."""
UNCERTIFIED = ("◌", palette.ERROR, "UNCERTIFIED")
BEING_CERTIFIED = ("◌", palette.NEUTRAL, "BEING CERTIFIED …")
EXPECTED = {
    "observable": "● expected observable",
    "weak": "▲ expected weak",
    "unobservable": "✕ expected unobservable",
}
DIMMED = f"color:{palette.CAPTION_TEXT}"
LINE = f'<polyline points="{{}}" fill="none" stroke="{palette.THUMBNAIL_LINE}" stroke-width="1.5"'
LINE += ' stroke-linejoin="round"/>'
START = f'<circle cx="{{:.1f}}" cy="{{:.1f}}" r="2.5" fill="{palette.THUMBNAIL_LINE}"/>'
ANCHOR = f'<path d="M{{x:.1f}} {{y:.1f}}m0-4l4 7h-8z" fill="{palette.THUMBNAIL_ANCHOR}"/>'
STYLE = "font-size:0.85em;line-height:1.45;padding:0 0.9em 0.6em;overflow-wrap:anywhere"
CAPTION = f'<figcaption style="{DIMMED};font-size:0.8em">{{}}</figcaption>'
FIGURE = f'<figure style="margin:0;text-align:center">{{}}{CAPTION}</figure>'
FRAME = f"border:1px solid {palette.THUMBNAIL_FRAME};border-radius:4px"
BOX = f'<svg width="{{0}}" height="{{0}}" style="{FRAME}" role="img" aria-label="{{1}}">'
UPRIGHT = np.eye(3)


def card(shown: Preset, found: CertificateOrReason | None, *, changed: bool) -> str:
    """The card as HTML; `found` None means that the certificate is being computed."""
    title = html.escape(shown.title) + (" • changed, not saved" if changed else "")
    said = [f'<div style="font-weight:600">{title}</div>']
    said += [_badge(shown, found), f"<div>{html.escape(shown.story)}</div>" if shown.story else ""]
    said.append(f'<div style="{DIMMED}"><b>{EXPECTED[shown.expect]}</b>{_figures(shown, found)}</div>')
    pictures = f'<div style="display:flex;gap:0.8em;padding:0.3em 0">{drawings(shown)}</div>'
    return f'<div style="{STYLE}">{pictures}{"".join(said)}</div>'


def badge(shown: Preset, found: CertificateOrReason | None) -> tuple[str, str, str]:
    """Shape, colour and words of what is known about a preset."""
    if found is None:
        return BEING_CERTIFIED
    return BADGES[shown.expect] if not isinstance(found, str) and found.certified else UNCERTIFIED


@lru_cache(maxsize=DRAWN)
def drawings(shown: Preset) -> str:
    """The path over its period or the flight, from above and from the side where it is longer, as inline SVG."""
    places = _places(shown, POINTS)
    wide = int(np.ptp(places[:, 1]) > np.ptp(places[:, 0]))
    extent = " × ".join(f"{size:.2g}" for size in np.ptp(places, axis=0))
    return "".join(
        FIGURE.format(picture(shown, UPRIGHT[:, axes], SIDE, POINTS, words), caption)
        for axes, words, caption in (
            ([0, 1], "the path from above", "from above"),
            ([wide, 2], "the path from the side", f"from the side; {extent} m"),
        )
    )


def picture(shown: Preset, view: Float[Array, "3 2"], side: int, points: int, words: str) -> str:
    """The path and the anchor from one side (the columns of `view` point right and up), as inline SVG."""
    places, anchor = _places(shown, points) @ view, np.asarray(shown.world.anchor) * (1.0, 1.0, _up(shown)) @ view
    low, high = places.min(axis=0), places.max(axis=0)
    size = max(float((high - low).max()), 1e-6)
    scale, middle = (side - 2 * MARGIN) / size, (low + high) / 2

    def spot(place: Float[Array, "... 2"]) -> Float[Array, "... 2"]:
        return side / 2 + (place - middle) * (scale, -scale)

    line = LINE.format(" ".join(f"{x:.1f},{y:.1f}" for x, y in spot(places)))
    x, y = spot(anchor)
    stands = ANCHOR.format(x=x, y=y) if 0 <= x <= side and 0 <= y <= side else ""
    x, y = spot(places[0])
    return f"{BOX.format(side, words)}{stands}{line}{START.format(x, y)}</svg>"


def _places(shown: Preset, points: int) -> Float[Array, "n 3"]:
    """Where the path goes, z up."""
    length = min(shown.duration, shown.path.period or shown.duration)
    return shown.path(np.linspace(0.0, length, points)) * (1.0, 1.0, _up(shown))


def _up(shown: Preset) -> float:
    return -1.0 if shown.world.gravity[2] > 0 else 1.0


def _badge(shown: Preset, found: CertificateOrReason | None) -> str:
    shape, colour, words = badge(shown, found)
    why = ""
    if isinstance(found, str):
        why = found
    elif found is not None and not found.certified:
        why = "; ".join(found.failures)
    chip = f'<span style="color:{colour};border:1px solid;border-radius:3px;padding:0 0.4em;font-weight:600">'
    said = f"<div>{html.escape(why)}</div>" if why else ""
    return f'<div style="padding:0.15em 0 0.3em">{chip}{shape} {words}</span></div>{said}'


def _figures(shown: Preset, found: CertificateOrReason | None) -> str:
    """μ and σ as the certificate has them."""
    if found is None or isinstance(found, str):
        return ""
    excited, sigma = found.excitation, found.accuracy.lifted.end.position
    needed = shown.requirement
    unit = f"m²/s⁷ over {needed.window:g} s (required {needed.mu:.3g})"
    if excited.found is None:
        mu = f"μ = 0 {unit}: nothing above rounding"
    elif excited.lower is not None:
        mu = f"μ ≥ {excited.lower:.3g} {unit}"
    else:
        mu = f"μ = {excited.found:.3g} {unit}, on sampled windows"
    told = "not determined" if sigma is None else f"{sigma:.3g} m"
    return f"<br>{mu}<br>predicted σ {told} (required {needed.position_sigma:.3g} m)"
