"""A link asks before it replaces unsaved work, is answered once, and whatever else it holds gets a sentence."""

import dataclasses
from collections.abc import Iterator

import msgspec
import pytest
import viser

from explorer.model import share
from explorer.model.learning import Learning
from explorer.model.settings import Settings
from explorer.panels.address import Address
from explorer.panels.dock import Dock
from explorer.storage.catalog import Catalog
from explorer.storage.certifier import Certifier
from explorer.storage.library import Library
from explorer.web.door import Window
from tests.support.page_settings import SHIPPED

SHARED = Settings(origin="soft", preset=SHIPPED["soft"], time_scale=1.5)
LINK = Window(link=share.link_text(SHARED), arrival=1)
SAVED = Settings(origin="paper-slow", preset=SHIPPED["paper-slow"])
WORK = msgspec.structs.replace(SAVED, time_scale=2.0)


@pytest.fixture
def said() -> list[str]:
    """What the page has notified."""
    return []


@pytest.fixture
def recorded() -> list[Settings]:
    """The steps for undo that a link has made besides its own."""
    return []


@pytest.fixture
def address(dock: Dock, client: viser.ClientHandle, said: list[str], recorded: list[Settings]) -> Iterator[Address]:
    """The address of a page that shows a preset as it is saved."""
    dock.write(SAVED)
    catalog = Catalog(SHIPPED, Library(), Certifier())
    yield Address(
        client, dock, catalog, lambda title, text: said.append(f"{title}: {text}"), lesson="", record=recorded.append
    )
    dock.learn.restore(Learning())


def test_without_work_of_ones_own_a_link_opens_at_once(address: Address, dock: Dock):
    address.follow(LINK)
    assert address.question == ""
    assert dock.read() == SHARED


def test_work_that_is_not_saved_is_replaced_only_after_a_question(address: Address, dock: Dock):
    dock.write(WORK)
    address.follow(LINK)
    assert f"Open the shared state of “{SHARED.preset.title}”?" in address.question
    assert dock.read() == WORK
    address.actions["link-open"]()
    assert address.question == ""
    assert dock.read() == SHARED


def test_who_stays_keeps_the_work_and_the_same_link_asks_again_only_if_it_is_opened_again(address: Address, dock: Dock):
    dock.write(WORK)
    address.follow(LINK)
    address.actions["link-stay"]()
    address.follow(LINK)  # the browser reports the same once more, because its window has changed
    assert (address.question, dock.read()) == ("", WORK)
    address.actions["link-open"]()  # a browser may send what its page does not offer
    assert dock.read() == WORK
    address.follow(dataclasses.replace(LINK, arrival=2))
    assert address.question != ""


@pytest.mark.parametrize("query", ["preset=circle", "lesson=4", "preset=circle&lesson=4"])
def test_a_link_with_a_preset_or_a_lesson_asks_too_and_a_reload_does_not_ask_again(
    address: Address, dock: Dock, query: str
):
    dock.write(WORK)
    address.follow(Window(query=query, answered=True))
    assert (address.question, dock.read()) == ("", WORK)


@pytest.mark.parametrize(
    ("query", "asks", "origin"),
    [
        ("preset=soft", "Open the preset “soft”?", "soft"),
        ("lesson=2", "Open lesson 2, Planar is not enough?", "circle"),
        ("preset=soft&lesson=2", "Open the preset “soft” and lesson 2, Planar is not enough?", "circle"),
    ],
)
def test_what_an_address_names_is_asked_for_by_its_name(
    address: Address, dock: Dock, query: str, asks: str, origin: str
):
    dock.write(WORK)
    address.follow(Window(query=query))
    assert asks in address.question
    address.actions["link-open"]()
    assert dock.origin == origin
    assert (dock.learn.lesson is not None) == ("lesson" in query)


def test_a_link_that_comes_in_a_lesson_leaves_it_and_the_work_before_it_is_a_step_for_undo(
    address: Address, dock: Dock, recorded: list[Settings]
):
    dock.write(WORK)
    dock.learn.open_number(1)
    address.follow(LINK)
    assert address.question != ""
    address.actions["link-open"]()
    assert (dock.learn.lesson, dock.read(), recorded) == (None, SHARED, [WORK])


@pytest.mark.parametrize(
    ("window", "says"),
    [
        (Window(link="abc"), "The link was not opened: The link is damaged"),
        (Window(query="preset=../../etc"), "No such preset: There is no preset “../../etc”"),
        (Window(query="lesson=99"), "No such lesson: There is no lesson “99”"),
        (Window(query="lesson=²"), "No such lesson: There is no lesson “²”"),
    ],
)
def test_a_hostile_or_broken_link_gets_a_sentence_and_changes_nothing(
    address: Address, dock: Dock, said: list[str], window: Window, says: str
):
    dock.write(WORK)
    address.follow(window)
    assert [one[: len(says)] for one in said] == [says]
    assert (address.question, dock.read()) == ("", WORK)


def test_a_title_in_a_link_is_text_in_the_question(address: Address, dock: Dock):
    titled = msgspec.structs.replace(SHARED.preset, title="<img src=x onerror=alert(1)>")
    dock.write(WORK)
    address.follow(Window(link=share.link_text(msgspec.structs.replace(SHARED, preset=titled))))
    assert "<img" not in address.question
