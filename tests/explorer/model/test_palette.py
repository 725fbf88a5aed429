"""The page has one palette: no other module spells a colour, and every text colour can be read."""

import io
import re
import tokenize
from collections.abc import Iterator
from pathlib import Path

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
