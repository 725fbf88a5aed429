"""A handout is one file: small enough, fetching nothing, with a preset and a certificate that verify."""

import base64
import json
import re

import msgspec
import pytest

from explorer.handout import MAX_BYTES, POSITIONS, handout, slider
from explorer.lessons import course
from explorer.model.settings import Settings
from rangenav import certificate, preset

SLOW = Settings(origin="paper-slow", preset=preset.load("paper-slow"))
HOSTILE = "</script><script>alert(1)</script>"


@pytest.fixture(scope="module")
def page() -> str:
    titled = msgspec.structs.replace(SLOW, preset=msgspec.structs.replace(SLOW.preset, title=HOSTILE))
    return handout(titled, ["gains.attitude.k1", "path.tones.3.amplitude=-0.8:0"], name="slow").decode()


def data(page: str) -> dict:
    return json.loads(page.partition('id="data">')[2].partition("</script>")[0])


def downloads(page: str) -> list[bytes]:
    return [base64.b64decode(content) for content in re.findall(r'href="data:[^;]*;base64,([^"]*)"', page)]


def test_it_is_smaller_than_six_megabytes_and_fetches_nothing(page: str):
    assert len(page.encode()) <= MAX_BYTES <= 6_000_000
    assert re.findall(r"<(?:script|link|img|iframe)[^>]*(?:src|href)=", page.partition("<script>")[0]) == []
    assert 'src="' not in page.rpartition('id="data">')[2]


def test_a_title_is_text_wherever_it_stands(page: str):
    assert HOSTILE not in page
    assert "&lt;/script&gt;" in page


def test_the_preset_in_it_is_the_one_shown_and_its_certificate_is_that_of_its_bytes(page: str):
    written, certified = downloads(page)
    assert preset.loads(written.decode(), source="it").path == SLOW.preset.path
    assert certificate.dumps(certificate.certify(written, source="slow.toml")) == certified


def test_each_position_of_a_slider_was_computed_and_a_gain_repeats_no_motion(page: str):
    gain, amplitude = data(page)["sliders"]
    assert len(gain["variants"]) == len(amplitude["variants"]) == POSITIONS
    assert all("truth" not in variant for variant in gain["variants"])
    assert all("truth" in variant for variant in amplitude["variants"])
    words = {variant["verdict"]["word"] for variant in amplitude["variants"]}
    assert words >= {"observable", "blind"}  # without its third tone the path is planar


def test_the_text_of_a_lesson_hides_what_answers_its_prediction():
    lesson = course().lessons[0]
    page = handout(lesson.start.settings, lesson=lesson).decode()
    assert lesson.header.prediction.question in page
    for section in ("What you see", "Insight"):
        assert f'<section class="after"><h2>{section}' in page


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("gains.k9", "there is no k9"),
        ("gains.attitude.k1=3:2", "first limit must be below"),
        ("gains.attitude.k1=a:b", "two numbers with a colon"),
        ("world.anchor.x", "is 0, so its limits must be given"),
        ("time_scale=20:30", "no two of its positions are valid: time_scale"),
    ],
)
def test_a_slider_that_cannot_be_baked_has_one_sentence(text: str, says: str):
    with pytest.raises(ValueError, match=says):
        slider(SLOW, text)


def test_three_sliders_are_refused():
    with pytest.raises(ValueError, match="at most 2 sliders, got 3"):
        handout(SLOW, ["gains.attitude.k1"] * 3)
