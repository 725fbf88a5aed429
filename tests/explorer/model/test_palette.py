"""The page has one palette: no other module spells a colour, and every text colour can be read."""

import io
import itertools
import re
import tokenize
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import explorer
from explorer.model import palette

ROOT = Path(explorer.__file__).parent
SPELLED = re.compile(r"#(?:[0-9a-f]{8}|[0-9a-f]{6}|[0-9a-f]{3,4})\b|\brgba?\s*\(\s*\d|\bhsla?\s*\(\s*\d", re.IGNORECASE)
NAMED = re.compile(r"color:\s*[a-z]+\b(?<!currentColor)(?<!light)|\bcolor=\"[a-z]+\"")
PAIR = re.compile(r"light-dark\((#[0-9A-F]{6}), (#[0-9A-F]{6})\)")
WHITE, DARK = "#FFFFFF", "#1F1F1F"
"""viser's own backgrounds."""


def strings(source: str) -> Iterator[str]:
    """The string literals of a module."""
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type in (tokenize.STRING, getattr(tokenize, "FSTRING_MIDDLE", tokenize.STRING)):
            yield token.string


@pytest.mark.parametrize("path", sorted(ROOT.rglob("*.py")), ids=lambda path: str(path.relative_to(ROOT)))
def test_no_module_but_the_palette_spells_a_colour(path: Path) -> None:
    if path == ROOT / "model" / "palette.py":
        return
    spelled = [text for text in strings(path.read_text()) if SPELLED.search(text) or NAMED.search(text)]
    assert spelled == []
    triples = re.findall(r"\(\s*(?:\d{2,3},\s*){2}\d{2,3}\s*\)", path.read_text())
    assert triples == []


def luminance(color: str) -> float:
    """WCAG 2: relative luminance."""
    shares = [channel / 255 for channel in palette.rgb(color)]
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in shares]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one: str, other: str) -> float:
    light, dark = sorted((luminance(one), luminance(other)), reverse=True)
    return (light + 0.05) / (dark + 0.05)


def test_every_text_colour_has_the_contrast_that_wcag_asks_of_text_in_both_themes() -> None:
    pairs = {name: PAIR.fullmatch(value) for name, value in vars(palette).items() if isinstance(value, str)}
    checked = {name: pair for name, pair in pairs.items() if pair is not None and not name.startswith("THUMBNAIL")}
    assert len(checked) >= 8
    for name, pair in checked.items():
        assert contrast(pair[1], WHITE) >= 4.5, name
        assert contrast(pair[2], DARK) >= 4.5, name


def test_the_runs_that_share_a_plot_have_colours_of_their_own() -> None:
    runs = (palette.TRUTH, palette.ESTIMATE, palette.PINNED, palette.TWIN, *palette.ESTIMATORS.values())
    assert len(set(runs)) == len(runs)


@pytest.mark.parametrize(("color", "three"), [("#000000", (0, 0, 0)), ("#FFFFFF", (255, 255, 255))])
def test_black_and_white_are_the_same_in_linear_light(color: str, three: palette.Rgb) -> None:
    assert palette.rgb(color) == palette.linear(color) == three


def test_linear_light_is_the_srgb_curve_within_three_percent() -> None:
    """The browser applies about the inverse: what is sent as linear light comes back as the colour that was meant."""
    for color in palette.SETTLING_SCALE:
        for meant, sent in zip(palette.rgb(color), palette.linear(color), strict=True):
            exact = meant / 255 / 12.92 if meant <= 10 else ((meant / 255 + 0.055) / 1.055) ** 2.4
            assert sent / 255 == pytest.approx(exact, abs=0.03)


MACHADO = {
    "usual vision": np.eye(3),
    "protanopia": np.array(
        [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]]
    ),
    "deuteranopia": np.array(
        [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]]
    ),
}
"""What a reader sees of linear red, green and blue: Machado, Oliveira and Fernandes, A physiologically-based model for
simulation of color vision deficiency (2009), severity 1."""
TO_XYZ = np.array(
    [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]]
)
"""Of linear sRGB (IEC 61966-2-1)."""
WHITE_POINT = np.array([0.95047, 1.0, 1.08883])
APART = 17.0
"""ΔE*ab (CIE 1976) between two runs. 2.3 can just be told apart side by side; orange and vermillion have 18."""


def lab(color: str, vision: np.ndarray) -> np.ndarray:
    """CIELAB of a colour as a reader sees it."""
    shares = np.array(palette.rgb(color)) / 255
    linear = np.where(shares <= 0.04045, shares / 12.92, ((shares + 0.055) / 1.055) ** 2.4)
    x, y, z = np.cbrt(TO_XYZ @ np.clip(vision @ linear, 0.0, 1.0) / WHITE_POINT)
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


@pytest.mark.parametrize("vision", MACHADO)
def test_the_runs_stay_apart_for_every_reader(vision: str) -> None:
    runs = [palette.TRUTH, palette.ESTIMATE, palette.PINNED, palette.TWIN, *palette.ESTIMATORS.values()]
    gaps = [
        float(np.linalg.norm(lab(one, MACHADO[vision]) - lab(other, MACHADO[vision])))
        for one, other in itertools.combinations(runs, 2)
    ]
    assert min(gaps) >= APART


def test_the_simulation_confuses_the_red_and_the_green_that_deuteranopes_confuse() -> None:
    red, green = "#B3261E", "#6B6B00"
    usual, deutan = (
        np.linalg.norm(lab(red, MACHADO[vision]) - lab(green, MACHADO[vision]))
        for vision in ("usual vision", "deuteranopia")
    )
    assert deutan < 0.4 * usual
