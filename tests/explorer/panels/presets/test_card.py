"""The summary of a preset: its badge by shape and text, its drawing, and no text of the preset as HTML."""

import threading
from xml.etree import ElementTree

import msgspec
import pytest

from explorer.model import palette
from explorer.panels.presets.card import card, card_of_changed, drawings
from explorer.storage.certifier import Certifier
from explorer.storage.import_file import ImportFile, guess
from explorer.widgets.html import upper_first
from rangenav import certificate, preset

pytestmark = pytest.mark.slow


SHIPPED = preset.shipped()


def _certificate(name: str) -> certificate.Certificate:
    return certificate.certify(preset.dumps(SHIPPED[name]).encode(), source=name)


@pytest.mark.parametrize(
    ("name", "badge"),
    [
        ("paper-slow", "● CERTIFIED OBSERVABLE"),
        ("wiggle", "▲ CERTIFIED WEAK"),
        ("circle", "✕ CERTIFIED UNOBSERVABLE"),
    ],
)
def test_a_badge_is_a_shape_and_text_and_says_what_is_certified(name: str, badge: str):
    assert badge in card(SHIPPED[name], _certificate(name))


def test_what_is_not_certified_says_why_and_what_is_being_certified_says_so():
    boasting = msgspec.structs.replace(SHIPPED["circle"], expect="observable")
    uncertified = certificate.certify(preset.dumps(boasting).encode(), source="x")
    shown = card(boasting, uncertified)
    assert "◌ UNCERTIFIED" in shown
    assert "rank" in shown
    assert "BEING CERTIFIED" in card(boasting, None)
    assert "◌ UNCERTIFIED" in card(boasting, "because <b>")
    assert "Because &lt;b&gt;." in card(boasting, "because <b>")


def test_the_card_of_a_changed_preset_shows_the_motion_on_the_page_and_no_reason_of_the_file():
    opened, shown = SHIPPED["circle"], SHIPPED["helix"]
    reason = "the rank is 11 of 13"
    content = card_of_changed(shown, opened, reason)
    assert "changed, not saved" in content
    assert "As opened: ◌ uncertified" in content
    assert reason not in content
    assert palette.ERROR not in content
    assert drawings(shown) in content
    assert drawings(opened) not in content
    assert "changed, not saved" not in card(opened, None)


def test_reasons_are_sentences_with_readable_numbers_of_which_the_first_is_in_sight():
    boasting = msgspec.structs.replace(SHIPPED["circle"], expect="observable", duration=14.56637)
    uncertified = certificate.certify(preset.dumps(boasting).encode(), source="x")
    assert len(uncertified.failures) > 1
    shown = card(boasting, uncertified)
    assert "14.566" not in shown
    first, folded = shown.split("<details>")
    assert upper_first(uncertified.failures[0][:20]) in first
    assert upper_first(uncertified.failures[1][:20]) in folded


def test_nothing_of_a_presets_own_text_is_markup():
    hostile = "<img src=x onerror=alert(1)>"
    shown = card(msgspec.structs.replace(SHIPPED["hover"], title=hostile, story=hostile), None)
    assert "<img" not in shown
    assert shown.count("&lt;img") == 2


@pytest.mark.parametrize("name", SHIPPED)
def test_a_drawing_is_well_formed_stays_in_its_box_and_is_there_for_every_preset(name: str):
    pictures = ElementTree.fromstring(f"<div>{drawings(SHIPPED[name])}</div>")
    lines = [line.attrib["points"] for line in pictures.iter("polyline")]
    assert len(lines) == 2
    for line in lines:
        places = [tuple(map(float, spot.split(","))) for spot in line.split()]
        assert all(0 <= x <= 92 and 0 <= y <= 92 for x, y in places)


def test_a_circle_is_drawn_round_and_seen_from_the_side_flat():
    above, side = (
        [tuple(map(float, spot.split(","))) for spot in line.attrib["points"].split()]
        for line in ElementTree.fromstring(f"<div>{drawings(SHIPPED['circle'])}</div>").iter("polyline")
    )
    radii = {round(((x - 46) ** 2 + (y - 46) ** 2) ** 0.5) for x, y in above}
    assert radii == {39}
    assert {y for _, y in side} == {46.0}


def test_certificates_come_one_after_the_other_and_are_remembered():
    certifier, came = Certifier(), threading.Semaphore(0)
    contents = [preset.dumps(SHIPPED[name]).encode() for name in ("paper-slow", "soft")] + [b"not a preset"]
    for content in contents:
        assert certifier.certificate(content, lambda: came.release()) is None
    for _ in contents:
        assert came.acquire(timeout=60)
    first, second, third = (certifier.certificate(content, lambda: None) for content in contents)
    assert isinstance(first, certificate.Certificate)
    assert first.certified
    assert isinstance(second, certificate.Certificate)
    assert isinstance(third, str)


@pytest.mark.parametrize(
    ("name", "content", "form"),
    [
        ("a.mat", b"", "mat"),
        ("A.TXT", b"", "tum"),
        ("a.csv", b"duration,x^0,x^1", "polynomial"),
        ("a.csv", b"t,p_x,p_y,p_z,q_w", "reference"),
        ("a.csv", b"#timestamp, p_RS_R_x [m]", "euroc"),
        ("a.csv", b"t [s],gyro_x [rad/s],p_x [m]", "log"),
        ("a", b"\xff\xfe\x00", "log"),
    ],
)
def test_a_format_is_guessed_from_name_and_first_line(name: str, content: bytes, form: str):
    assert guess(ImportFile(name, content)) == form
