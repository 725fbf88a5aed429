"""A lesson's Markdown -> HTML: equations become MathML, figures become numbers, and nothing else is let through.

HTML within the Markdown is shown as the characters that were typed: a lesson brings text, not scripts.
"""

import html
import re
from collections.abc import Callable, Collection
from functools import cache

import latex2mathml.converter
from markdown_it import MarkdownIt
from markdown_it.token import Token
from mdit_py_plugins.dollarmath import dollarmath_plugin

from explorer.lessons import figures
from explorer.lessons.lesson import FIGURE, Prediction
from explorer.lessons.state import State
from rangenav.inputs import require, shortened

States = dict[str, State | None]
"""The states by the word before the dot; "" is what is shown. None where there is none, as without a pinned run."""
Reader = Callable[[str, State], str]
"""The text of a figure by its name and state: `figures.text`, which computes it, or one that has it computed later."""
MISSING = "…"
UNKNOWN = re.compile(r"\\[A-Za-z]+")
"""A command that the converter has left as it is."""
DOTS = re.compile(r"<mo>(&#x000A8;|&#x002D9;)</mo></mover>")
"""One dot or two above a letter. At the size that a browser gives them, two look like one."""


def to_html(markdown: str, states: States, read: Reader = figures.text) -> str:
    """One screen as HTML; `read` gives its figures. Raises ValueError for a figure that does not exist, or a wrong
    equation."""
    tokens = _parser().parse(markdown)
    for token in tokens:
        for child in token.children or ():
            if child.type == "text":
                child.content = filled(child.content, states, read)
    return _parser().renderer.render(tokens, _parser().options, {})


def filled(text: str, states: States, read: Reader = figures.text) -> str:
    """A plain text with its figures, which `read` gives. Raises ValueError for a figure that does not exist."""
    pieces, end = [], 0
    for match in FIGURE.finditer(text):
        pieces += [text[end : match.start()], _figure(match[1] or "", match[2], states, read)]
        end = match.end()
    return "".join([*pieces, text[end:]])


def came(prediction: Prediction, states: States, read: Reader = figures.text) -> str:
    """The outcome, in the words of the prediction: the right choice, or the number."""
    if prediction.choices:
        return prediction.choices[prediction.right - 1]
    return filled(f"{{{prediction.figure}}}", states, read)


def refuse(markdown: str, states: Collection[str]) -> None:
    """Raise ValueError for a figure that does not exist, a state that is none of `states`, or a wrong equation."""
    to_html(markdown, dict.fromkeys(states))
    for token in _parser().parse(markdown):
        for child in token.children or ():
            for match in FIGURE.finditer(child.content if child.type == "text" else ""):
                require((match[1] or "") in states, f"{match[0]}: the lesson has no state {match[1]}")


def _figure(whose: str, name: str, states: States, read: Reader) -> str:
    require(name in figures.FIGURES, f"{{{name}}}: no such figure; there are {', '.join(figures.FIGURES)}")
    state = states.get(whose)
    return MISSING if state is None else read(name, state)


@cache
def _parser() -> MarkdownIt:
    parser = MarkdownIt("commonmark", {"html": False}).enable("table").use(dollarmath_plugin, double_inline=True)
    parser.add_render_rule("math_inline", _inline)
    parser.add_render_rule("math_inline_double", _block)
    parser.add_render_rule("math_block", _block)
    return parser


def _inline(_renderer: object, tokens: list[Token], k: int, *_: object) -> str:
    return _mathml(tokens[k].content, "inline")


def _block(_renderer: object, tokens: list[Token], k: int, *_: object) -> str:
    return f"<p>{_mathml(tokens[k].content, 'block')}</p>"


def _mathml(latex: str, display: str) -> str:
    """An equation; its source in words of LaTeX is kept as the text that a screen reader and a copy get."""
    try:
        made = latex2mathml.converter.convert(latex.strip(), display=display)
    except Exception as error:  # the converter raises an exception of its own for every kind of mistake
        raise ValueError(f"the equation {shortened(latex.strip())}: {type(error).__name__}") from None
    unknown = UNKNOWN.search(made)
    require(unknown is None, f"the equation {shortened(latex.strip())}: {unknown and unknown[0]} is not known")
    made = DOTS.sub(r'<mo mathsize="150%">\1</mo></mover>', made)
    return made.replace("<math ", f'<math alttext="{html.escape(latex.strip(), quote=True)}" ', 1)
