"""Formulas as drawings (SVG) in the page itself: it needs no script, no network and no mathematical font to be read."""

from functools import cache
from html import escape

import ziamath
from docutils import nodes

SIZE = 17.0
"""px of an em, as the text around."""
ziamath.config.svg2 = False  # paths in each drawing, and no symbols shared by name


@cache
def drawing(latex: str, *, inline: bool) -> str:
    """The formula as an <svg> element in the colour of the text, with its source for those who cannot see it."""
    made = ziamath.Latex(latex, size=SIZE, color="currentColor", inline=inline)
    style = f"vertical-align: {made.getyofst() - 1:.2f}px" if inline else ""
    return made.svg().replace("<svg ", f'<svg role="img" aria-label="{escape(latex)}" style="{style}" ', 1)


def inline(translator, node: nodes.math) -> None:
    """One formula in a line of text."""
    translator.body.append(drawing(node.astext(), inline=True))
    raise nodes.SkipNode


def block(translator, node: nodes.math_block) -> None:
    """One formula on a line of its own; a wide one scrolls."""
    translator.body.append(f'<div class="formula">{drawing(node.astext(), inline=False)}</div>')
    raise nodes.SkipNode


def setup(app):
    """Make this the renderer of formulas in HTML."""
    app.add_html_math_renderer("drawn", (inline, None), (block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
