"""Every label of the page has a hint, and neither shows a key of a preset's file."""

import re

from tests.support.waiting_visitor import Editing

KEY = re.compile(r"\b[a-z]+_[a-z]+\b|\b[a-z]{2,}\.[a-z_]{2,}\b")
PROJECTS = "uav_trajectories"
"""Names of other projects, which are written as they write them."""
LONGEST = 260
"""Characters of a hint: a longer one covers the controls above it."""


BESIDE_SLIDER = ": number"
"""The box beside a slider, which has the hint."""
HIDDEN = {"pointer", "range-values", "page"}
"""Boxes that no visitor sees: scripts of the page write into them."""


def test_every_control_of_the_page_has_a_hint_and_no_label_or_hint_shows_a_key(editing: Editing):
    wrong = []
    for props in editing.tab.elements.values():
        named = props.get("label") or " ".join(props.get("options") or ())
        if "hint" in props and named and named not in HIDDEN and not named.endswith(BESIDE_SLIDER):
            hint = props["hint"] or ""
            shows_key = KEY.search(f"{named} {hint}".replace(PROJECTS, ""))
            if not hint or shows_key or len(hint) > LONGEST:
                wrong.append((named, hint, len(hint)))
    assert wrong == []
