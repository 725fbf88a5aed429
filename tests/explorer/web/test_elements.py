"""Controls of a kind have ids by which one rule of the style sheet reaches them all."""

from pathlib import Path
from typing import get_args

import pytest

from explorer import web
from explorer.web.elements import Kind, element_id, of_kind
from tests.support.sent_messages import Page

STYLE = (Path(web.__path__[0]) / "page.css").read_text(encoding="utf-8")


@pytest.mark.parametrize("kind", [kind for kind in get_args(Kind) if kind])
def test_what_is_added_as_a_kind_is_reached_by_the_style_sheet_and_what_comes_later_is_not(page: Page, kind: Kind):
    with of_kind(kind):
        one, other = page.gui.add_text("x", ""), page.gui.add_slider("y", 0.0, 1.0, 0.1, 0.0)
    later = page.gui.add_text("z", "")
    assert element_id(one).startswith(kind)
    assert element_id(other).startswith(kind)
    assert element_id(one) != element_id(other)
    assert not element_id(later).startswith("rn-")
    assert f'="{kind}"' in STYLE
