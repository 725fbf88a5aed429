"""`rangenav presets` for a person."""

from collections.abc import Mapping
from itertools import chain

from rangenav.commands.text import layout
from rangenav.commands.text.layout import Report, group
from rangenav.preset import Preset

EXPECTED = {"observable": "✓", "weak": "!", "unobservable": "✗"}


def report(shipped: Mapping[str, Preset]) -> Report:
    """The shipped presets by what is expected of them."""
    counts = {expect: sum(p.expect == expect for p in shipped.values()) for expect in EXPECTED}
    expected = ", ".join(f"{count} {expect}" for expect, count in counts.items() if count)
    longest = max(map(len, shipped), default=0)
    lists = (
        group(f"{sign} {one}", (f"{name:<{longest}}  {p.title}" for name, p in shipped.items() if p.expect == one))
        for one, sign in EXPECTED.items()
    )
    return Report(
        subject="presets",
        sign="✓",
        answer=f"{len(shipped)} are shipped: {expected}",
        groups=(*chain.from_iterable(lists), *layout.next_commands("analyze paper-slow", "explain circle")),
    )
