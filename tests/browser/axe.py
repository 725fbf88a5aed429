"""axe-core in the page, and what a mouse can press and Tab does not reach."""

from pathlib import Path
from typing import Any

import axe_playwright_python
from playwright.sync_api import Page

AXE = Path(axe_playwright_python.__file__).parent / "axe.min.js"
RUN = "([where, options]) => axe.run(document.querySelector(where), options)"
NAMED, LATER = 250, 500
"""ms after a change in which the page names its controls (accessibility.js), and on a busy machine."""
UNREACHED = """() => [...document.querySelectorAll('body *')].filter(element => {
    if (getComputedStyle(element).cursor !== 'pointer') return false;
    if (!element.checkVisibility({visibilityProperty: true}) || !element.getBoundingClientRect().width) return false;
    const own = 'button, a, input, textarea, select, summary, label, [role=slider], [role=option], canvas, .u-over';
    return !element.closest(`${own}, [tabindex="0"], .mantine-Slider-root`);
}).map(element => element.outerHTML.slice(0, 120))"""
"""What a press of the mouse does something to, and neither Tab nor an arrow key reaches."""


def broken(page: Page, where: str = "html", *, only: tuple[str, ...] = (), but: tuple[str, ...] = ()) -> set[str]:
    """The rules of axe that a part of the page breaks, each with the first element that breaks it: all rules, or `only`
    some, `but` for some."""
    if not page.evaluate("typeof axe === 'object'"):
        page.evaluate(f"{AXE.read_text(encoding='utf-8')}; 0")
    options: dict[str, Any] = {"resultTypes": ["violations"], "rules": {rule: {"enabled": False} for rule in but}}
    if only:
        options["runOnly"] = {"type": "rule", "values": list(only)}
    page.wait_for_timeout(NAMED)  # a run of axe takes longer
    found = page.evaluate(RUN, [where, options])
    if found["violations"]:  # controls that have just come get their names a moment later
        page.wait_for_timeout(LATER)
        found = page.evaluate(RUN, [where, options])
    return {f"{rule['id']}: {rule['nodes'][0]['html'][:150]}" for rule in found["violations"]}
