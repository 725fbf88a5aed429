"""The page in Firefox: verdict, plots and scene are drawn, and a control changes them."""

from pathlib import Path

from tests.browser.firefox import firefox
from tests.browser.page import VERDICT, Server

NODES = "return Object.keys(page.__viserMutable.nodeRefFromName).length"
PLOTS = "return Object.keys(page.__viserTestpoints.uplots).length"
WEBGL = "return document.createElement('canvas').getContext('webgl2') !== null"
TYPE = """
    const labels = Array.from(document.querySelectorAll('label'));
    let row = labels.find(label => label.innerText.startsWith(arguments[0]));
    while (!row.querySelector('input')) row = row.parentElement;
    const box = row.querySelector('input:not([type=hidden])');
    Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, 'value').set.call(box, arguments[1]);
    box.dispatchEvent(new Event('input', {bubbles: true}));
    box.focus();
    box.blur();
"""


def test_firefox_draws_the_page_and_answers_a_control(server: Server, tmp_path: Path):
    with firefox(tmp_path) as window:
        window.open(server.url)
        window.wait_for_text(VERDICT)
        assert window.run(WEBGL) is True
        nodes, plots = window.run(NODES), window.run(PLOTS)
        assert isinstance(nodes, int)
        assert nodes > 10
        assert isinstance(plots, int)
        assert plots >= 4
        window.run("page.rnPage.act('tab', 'Motion')")
        window.wait_for_text("flight duration (s)")
        window.run(TYPE, "flight duration (s)", "2")
        window.wait_for_text("must be shorter than the duration")
        assert window.screenshot().startswith(b"\x89PNG")
