"""The mouse on the plots: its position along the time axis, brushes (drags), and clicks on legend entries.

viser reports none of it, and its own legends write 1e-6 as 0. A small script on the page therefore writes the following
into a hidden text box, as if it were typed there:

    0.3712 1712345678901:position-1        share of the time axis (0 … 1), if any, and the clicks of the last second
    0.5000 1712345678902:0.2000-0.5000     and a brush: pressed at one share of the time axis, released at another

While a brush lasts, only the script draws it: it sets the CSS variables of a band over every plot. viser drops all but
the last input of 50 ms. Nothing is lost by that, for the newest text repeats the clicks and brushes of the last second,
and each one counts once by its number. The script relies on two facts of the page: uPlot calls its drawing area
`u-over`, and viser makes the controls of a container siblings. If either changes, the legends give the values at the
cursor.
"""

import re
import threading
from collections import deque
from collections.abc import Callable

import viser

from explorer.charts.plots import Plot

LABEL = "pointer"
MAX_LENGTH = 500
"""Characters; the script writes fewer than a hundred."""
NUMBER = r"0(?:\.\d{1,6})?|1(?:\.0{1,6})?"
SHARE, CLICK = re.compile(NUMBER), re.compile(r"(\d{1,16}):([a-z-]{1,40}-\d{1,3})")
BRUSH = re.compile(rf"(\d{{1,16}}):({NUMBER})-({NUMBER})")
MAX_CLICKS = 64
"""Clicks stored while the session is busy; beyond that the oldest are dropped."""
MARK_ORDER, BOX_ORDER = -3.0, -2.0
"""viser's order of controls in a container: both before all others, the box directly behind the script."""
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
    """The name of a curve for CSS, the legend and the script."""
    return f"{plot.name}-{column}"


class Pointer:
    """The position, clicks and brush of the mouse since the session last took them."""

    def __init__(self, wake: Callable[[], None]) -> None:
        """`wake` is called from viser's threads when the mouse has done something."""
        self._wake, self._lock = wake, threading.Lock()
        self._fraction: float | None = None
        self._clicks: deque[str] = deque(maxlen=MAX_CLICKS)
        self._brush: tuple[float, float] | None = None
        self._last = 0

    @property
    def fraction(self) -> float | None:
        """The mouse's share of the time axis, from 0 to 1; None while the mouse is on no plot."""
        return self._fraction

    def add_to(self, gui: viser.GuiApi) -> None:
        """Put the box and the script into the page."""
        gui.add_html(MARK, order=MARK_ORDER)
        box = gui.add_text(LABEL, "", order=BOX_ORDER)
        box.on_update(lambda _: self.receive(box.value))  # the newest text, whichever of viser's threads runs first

    def take_clicks(self) -> list[str]:
        """The curves whose legend entries were clicked since the last call, oldest first."""
        with self._lock:
            clicks = list(self._clicks)
            self._clicks.clear()
        return clicks

    def take_brush(self) -> tuple[float, float] | None:
        """The newest brush since the last call: start and end as shares of the time axis, equal for a click."""
        with self._lock:
            brush, self._brush = self._brush, None
        return brush

    def receive(self, text: str) -> None:
        """Store what the script has written; any other text is ignored."""
        share, *events = text[:MAX_LENGTH].split(" ")
        with self._lock:
            self._fraction = float(share) if SHARE.fullmatch(share) else None
            for event in events:
                click, brush = CLICK.fullmatch(event), BRUSH.fullmatch(event)
                match = click or brush
                if match is None or int(match[1]) <= self._last:
                    continue
                self._last = int(match[1])
                if brush is not None:
                    self._brush = (min(float(brush[2]), float(brush[3])), max(float(brush[2]), float(brush[3])))
                else:
                    self._clicks.append(match[2])
        self._wake()
