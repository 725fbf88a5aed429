"""The file: one HTML document with its library, its numbers, its script and its style in it.

Nothing is fetched when it is opened. What is downloaded from it, the preset and its certificate, is part of it.
"""

import base64
import html
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from explorer.handout import contents
from explorer.handout.sliders import Baked, slider
from explorer.lessons import text
from explorer.lessons.lesson import SECTIONS, Lesson
from explorer.model.compute import Picture, compute
from explorer.model.settings import Settings
from explorer.storage import preset_file
from rangenav import certificate
from rangenav.inputs import require
from rangenav.number_format import significant
from rangenav.progress import Cancelled, CancelledError, Progress, never, unheard

MAX_BYTES = 6_000_000
MAX_SLIDERS = 2
FOLDER = Path(__file__).parent
BUTTON = '<button type="button" class="choice">{}</button>'
HIDDEN_UNTIL_PREDICTED = ("What you see", "Insight")


def handout(
    settings: Settings,
    sliders: Sequence[str] = (),
    *,
    lesson: Lesson | None = None,
    name: str = "motion",
    progress: Progress = unheard,
    cancelled: Cancelled = never,
) -> bytes:
    """The file of some settings, or of a lesson that begins with them.

    sliders: at most two numbers that can be moved in the file, as `handout.slider` takes them. name: of the preset's
    file in it. Raises ValueError with one sentence, and CancelledError.
    """
    require(len(sliders) <= MAX_SLIDERS, f"a handout has at most {MAX_SLIDERS} sliders, got {len(sliders)}")
    baked = [slider(settings, one) for one in sliders]
    base = compute(settings)
    shown = contents.plots(lesson.header.plots if lesson is not None else ())
    total, done = 1 + sum(len(one.settings) for one in baked), 1
    tables = []
    for one in baked:
        variants = []
        for state in one.settings:
            if cancelled():
                raise CancelledError
            variants.append(contents.variant(compute(state), shown, base))
            done += 1
            progress(done / total)
        tables.append(_slider(one, variants))
    data = {"plots": [contents.style(plot) for plot in shown], "base": contents.variant(base, shown), "sliders": tables}
    document = _document(base, data, lesson, name)
    require(
        len(document) <= MAX_BYTES,
        f"the handout would have {len(document)} bytes, and may have {MAX_BYTES}: take one slider less",
    )
    return document


def _slider(baked: Baked, variants: list[dict[str, Any]]) -> dict[str, Any]:
    values = [significant(value) for value in baked.values]
    return {"label": baked.label, "values": values, "at": baked.at, "variants": variants}


def _document(base: Picture, data: dict[str, Any], lesson: Lesson | None, name: str) -> bytes:
    import plotly.offline  # here: it takes a second, and the page begins without it

    preset_bytes = preset_file.document(base.settings)
    certified = certificate.dumps(certificate.certify(preset_bytes, source=f"{name}.toml"))
    title = lesson.header.title if lesson is not None else base.preset.title or name
    parts = {
        "TITLE": html.escape(title),
        "STORY": html.escape(base.preset.story) if lesson is None else "",  # it may answer the lesson's question
        "LESSON": _lesson(lesson) if lesson is not None else "",
        "PRESET_NAME": html.escape(f"{name}.toml", quote=True),
        "PRESET": _data_url(preset_bytes, "application/toml"),
        "CERTIFICATE_NAME": html.escape(f"{name}.certificate.json", quote=True),
        "CERTIFICATE": _data_url(certified, "application/json"),
        "STYLE": (FOLDER / "handout.css").read_text(encoding="utf-8"),
        "LIBRARY": plotly.offline.get_plotlyjs(),
        "DATA": json.dumps(data, separators=(",", ":"), ensure_ascii=False).replace("</", "<\\/"),
        "SCRIPT": (FOLDER / "handout.js").read_text(encoding="utf-8"),
    }
    head, *pieces = (FOLDER / "handout.html").read_text(encoding="utf-8").split("{{")
    filled = [parts[key] + rest for key, _, rest in (piece.partition("}}") for piece in pieces)]
    return "".join([head, *filled]).encode()


def _lesson(lesson: Lesson) -> str:
    """The text of a lesson; what answers its prediction stays folded until the prediction is made."""
    states = lesson.states(lesson.start)
    blocks = []
    for section in SECTIONS:
        screens = "".join(text.to_html(screen, states) for screen in lesson.sections[section])
        hidden = section in HIDDEN_UNTIL_PREDICTED
        blocks.append(_section(section, screens, hidden=hidden))
        if section == "Question":
            blocks.append(_prediction(lesson, states))
        if section == "Task":
            blocks.append(_outcome(lesson, states))
    return "".join(blocks)


def _section(heading: str, body: str, *, hidden: bool = False) -> str:
    title = f"<h2>{heading}</h2>" if heading else ""
    return f'<section class="{"after" if hidden else ""}">{title}{body}</section>'


def _prediction(lesson: Lesson, states: text.States) -> str:
    asked = lesson.header.prediction
    answers = [BUTTON.format(html.escape(choice)) for choice in asked.choices]
    if not answers:
        answers = ['<input id="number" inputmode="decimal" aria-label="your prediction">', html.escape(asked.unit)]
        answers.append(BUTTON.format("commit"))
    question = html.escape(text.filled(asked.question, states))
    return _section("Your prediction", f'<p>{question}</p><p class="choices">{" ".join(answers)}</p>')


def _outcome(lesson: Lesson, states: text.States) -> str:
    """The outcome, next to what was predicted."""
    asked = lesson.header.prediction
    came, because = (html.escape(part) for part in (text.came(asked, states), text.filled(asked.because, states)))
    sentence = f'You predicted: <b id="predicted"></b>. It came: <b>{came}</b>. {because}'
    return _section("", f"<p>{sentence}</p>", hidden=True)


def _data_url(content: bytes, kind: str) -> str:
    return f"data:{kind};base64,{base64.b64encode(content).decode()}"
