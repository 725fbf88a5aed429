"""What the mouse does on the plots, told to the session: its place on the time axis, brushes, and clicks on legends.

viser reports none of it, and its plots say 1e-6 as 0. So a small script on the page writes both into a text box that
nobody sees, as if it were typed there:

    0.3712 1712345678901:position-1        place on the time axis (0 … 1), if any, and the clicks of the last second
    0.5000 1712345678902:0.2000-0.5000     and a brush: pressed at one place of the time axis, let go at another

While it lasts a brush is drawn by the script alone, in CSS variables that a band over every plot takes its place from.
The newest text counts, each click and brush once by its number; so nothing is lost where viser drops all but the last
input of 50 ms. The script knows of the page only that uPlot calls its drawing area `u-over`, and that viser puts the
controls of a tab beside each other. Where either should change, the legends go on telling the values at the playhead.
"""

import re
import threading
from collections import deque
from collections.abc import Callable

import viser

from explorer.charts.plots import Plot

LABEL = "pointer"
LONGEST = 500
"""Characters; an honest text has fewer than a hundred."""
NUMBER = r"0(?:\.\d{1,6})?|1(?:\.0{1,6})?"
PLACE, CLICK = re.compile(NUMBER), re.compile(r"(\d{1,16}):([a-z-]{1,40}-\d{1,3})")
BRUSH = re.compile(rf"(\d{{1,16}}):({NUMBER})-({NUMBER})")
MAX_CLICKS = 64
"""Remembered while the session is busy; of more, the oldest are dropped."""
MARK_ORDER, BOX_ORDER = -3.0, -2.0
"""viser's order of things in a tab: before all others, the box right behind its mark."""
SCRIPT = """if (!window.rnPointer) {
  window.rnPointer = true;
  const put = Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, 'value').set;
  let place = '', clicks = [], pressed = null;
  const show = (from, span) => {
    document.documentElement.style.setProperty('--rn-brush-from', from);
    document.documentElement.style.setProperty('--rn-brush-span', span);
  };
  const tell = () => {
    const mark = document.querySelector('.rn-pointer');
    const box = mark &amp;&amp; mark.parentElement.nextElementSibling.querySelector('input');
    if (!box) return;
    clicks = clicks.filter(click => Date.now() - parseInt(click) &lt; 1000);
    put.call(box, [place, ...clicks].join(' '));
    box.dispatchEvent(new Event('input', {bubbles: true}));
  };
  const along = (area, event) => {
    const box = area.getBoundingClientRect();
    return Math.min(Math.max((event.clientX - box.left) / box.width, 0), 1).toFixed(4);
  };
  const move = plot => event => {
    const area = plot(event), share = area ? along(area, event) : '';
    if (pressed &amp;&amp; area) show(Math.min(pressed.at, share), Math.abs(pressed.at - share));
    if (share !== place) { place = share; tell(); }
  };
  const over = event => event.target.closest &amp;&amp; event.target.closest('.u-over');
  window.addEventListener('pointermove', move(event => pressed ? pressed.area : over(event)));
  window.addEventListener('pointerdown', event => {
    const area = event.button === 0 &amp;&amp; over(event);
    if (area) pressed = {area, at: along(area, event)};
  });
  window.addEventListener('pointerup', event => {
    if (!pressed) return;
    clicks.push(Date.now() + ':' + [pressed.at, along(pressed.area, event)].sort().join('-'));
    pressed = null; show(0, 0); tell();
  });
  window.addEventListener('pointercancel', () => { pressed = null; show(0, 0); });
  document.documentElement.addEventListener('pointerleave', move(() => null));
  window.addEventListener('click', event => {
    const entry = event.target.closest('[data-curve]');
    if (entry) { clicks.push(Date.now() + ':' + entry.dataset.curve); tell(); }
  });
}"""
MARK = (
    "<style>div:has(> .rn-pointer) + div { display: none }</style>"
    f'<img class="rn-pointer" alt="" src="data:," style="display:none" onerror="{SCRIPT}">'
)


def curve_id(plot: Plot, column: int) -> str:
    """The name of a curve, for CSS, the legend and the script."""
    return f"{plot.name}-{column}"


class Pointer:
    """Where the mouse is on a time axis, and the legend entries clicked since last asked."""

    def __init__(self, wake: Callable[[], None]) -> None:
        """`note` is called from viser's threads when there is news."""
        self._wake, self._lock = wake, threading.Lock()
        self._place: float | None = None
        self._clicks: deque[str] = deque(maxlen=MAX_CLICKS)
        self._brush: tuple[float, float] | None = None
        self._last = 0

    @property
    def place(self) -> float | None:
        """From 0 to 1 along the time axis; None while the mouse is on no plot."""
        return self._place

    def add_to(self, gui: viser.GuiApi) -> None:
        """Put the box and the script into the tab that is being filled."""
        gui.add_html(MARK, order=MARK_ORDER)
        box = gui.add_text(LABEL, "", order=BOX_ORDER)
        box.on_update(lambda _: self.hear(box.value))  # the newest text, whichever thread of viser's comes first

    def clicked(self) -> list[str]:
        """The curves whose entries were clicked since the last call, oldest first."""
        with self._lock:
            found = list(self._clicks)
            self._clicks.clear()
        return found

    def brushed(self) -> tuple[float, float] | None:
        """Where the time axis was brushed last since the last call, from 0 to 1: start and end, equal for a click."""
        with self._lock:
            found, self._brush = self._brush, None
        return found

    def hear(self, text: str) -> None:
        """Take in what the script has written. Anything else is no place and no click."""
        words = text[:LONGEST].split(" ")
        with self._lock:
            self._place = float(words[0]) if PLACE.fullmatch(words[0]) else None
            for word in words[1:]:
                click, brush = CLICK.fullmatch(word), BRUSH.fullmatch(word)
                found = click or brush
                if found is None or int(found[1]) <= self._last:
                    continue
                self._last = int(found[1])
                if brush is not None:
                    self._brush = (min(float(brush[2]), float(brush[3])), max(float(brush[2]), float(brush[3])))
                else:
                    self._clicks.append(found[2])
        self._wake()
