"""A link holds the settings to the last bit, and whatever else a link may hold gets one sentence."""

import base64
import zlib

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from explorer.model import share
from explorer.model.settings import Drafts, Printed, Settings
from rangenav import preset
from rangenav.signals import Waypoint, Waypoints
from tests.support.page_settings import SHIPPED


def packed(content: bytes) -> str:
    return base64.urlsafe_b64encode(zlib.compress(content)).decode()


@pytest.mark.parametrize("name", SHIPPED)
def test_settings_come_back_as_they_were(name: str):
    settings = Settings(origin=name, preset=SHIPPED[name], time_scale=1.25, printed=Printed(model=True))
    text = share.link_text(settings)
    assert share.from_link(text) == msgspec.structs.replace(settings, drafts=Drafts(), edition="")
    assert set(text) <= set("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_")
    assert len(text) < 4000


def test_what_is_too_large_for_a_link_is_refused_with_the_way_out():
    rng_like = [
        ((k * 7919) % 997 / 100.0, (k * 104729) % 991 / 100.0, (k * 1299709) % 983 / 100.0) for k in range(2000)
    ]
    points = tuple(Waypoint(time=0.5 * k, value=value) for k, value in enumerate(rng_like))
    long = msgspec.structs.replace(preset.load("hover"), path=Waypoints(points=points), duration=900.0)
    with pytest.raises(ValueError, match=r"too large for a link.*Download this preset"):
        share.link_text(Settings(origin="hover", preset=long))


@given(st.text(max_size=300) | st.binary(max_size=300).map(packed))
def test_any_other_text_is_refused_in_one_sentence(text: str):
    with pytest.raises(ValueError, match=r"\AThe link .*\.\Z"):
        share.from_link(text)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "A" * (share.MAX_LINK + 1),
        packed(b"0" * 50_000_000),
        packed(b"[" * 100_000),
        packed(b"{}"),
        share.link_text(Settings(origin="x", preset=SHIPPED["hover"]))[:-9],
        share.link_text(Settings(origin="x", preset=SHIPPED["hover"])) + "AAAA",
    ],
    ids=["empty", "long", "bomb", "nested", "no settings", "cut", "more"],
)
def test_hostile_and_broken_links_are_refused_without_work(text: str):
    with pytest.raises(ValueError, match=r"\AThe link "):
        share.from_link(text)
