"""A recorded flight: whether it was informative, and the errors of the observers on it."""

import html
import math
from functools import partial
from typing import Literal

from explorer.model import palette
from explorer.model.glossary import VERDICT
from explorer.model.jobs import Jobs
from explorer.storage.flight_report import ORIGIN, FlightOptions, FlightReport, WorldSource, judge, world_evidence
from explorer.widgets.controls import Choice, Number, Switch
from explorer.widgets.form import Form
from explorer.widgets.html import NOTE, bullets, table
from explorer.widgets.progress import ProgressPanel
from explorer.widgets.section import Section
from explorer.widgets.vector import Vector
from rangenav.flight_summary import ObserverSummary, more_ranges
from rangenav.formats import Flight, ImportResult
from rangenav.formats.import_result import gravity
from rangenav.inputs import require
from rangenav.logs import WholeRecord
from rangenav.number_format import NOT_DETERMINED, quantity, significant, vector

COLORS = {"observable": palette.GOOD, "weak": palette.WARNING, "blind": palette.ERROR}
SIGNS = {"observable": "●", "weak": "▲", "too few ranges": "◆", "blind": "✕", "not judged": "?"}
WORLD_SOURCES: dict[WorldSource, str] = {
    "": "as the file says",
    "still": "as its still start says",
    "given": "as given below",
}
AnchorSource = Literal["", "file", "given"]
ANCHOR_SOURCES: dict[AnchorSource, str] = {"file": "as the file says", "given": "as given below"}
ASKED_ANCHOR: dict[AnchorSource, str] = {"": "choose", "given": "as given below"}
"""Where the file does not say where the anchor of its ranges stands."""
WHERE = "where does the anchor stand? the file does not say: choose “as given below” and give its position"
BLIND_FROM = "blind where they begin at "
"""Before the times at which the blind windows of a record begin."""
HEAD = '<div style="color:{};font-weight:700;font-size:1.15em">{}</div>'
ANCHOR_HINT = "Where the anchor of the ranges stands: no log can tell, unless its file says so."
PLACE_HINT = "Where the anchor stands, in the inertial frame of the record."
WORLD_HINT = "At rest the accelerometer reads gravity and the magnetometer the field; that has to be confirmed."
SYNTHETIC_HINT = (
    "For a record with a true position and no ranges: makes some, with the noise below. The result names them."
)
SIGMA_HINT = "The standard deviation of each range of the flight."
WINDOW_HINT = "Each window of this length is judged by itself."
PART_HINT = (
    "The part of the record that is judged, by its own stamps: at rest, before and after a flight, nothing is excited, "
    "and an observer that has nothing to go by drifts away. Gravity, field and noise are taken from the whole."
)
WEAK_HINT = "Predicted position error (m) above which a window of full rank counts as weak."
JUDGE_HINT = (
    "The whole record, then sliding windows: rank and predicted error; then the observers, if there are ranges."
)


class FlightPanel:
    """Hidden until a flight has been read."""

    def __init__(self, form: Form, jobs: Jobs) -> None:
        self._flight, self._source = None, ""
        self._judged: FlightOptions | None = None
        """The options of the report that is shown."""
        self._section = section = Section(form, "Recorded flight")
        with section:
            self._evidence = form.gui.add_html("")
            self._anchor_source = Choice(section, "anchor from", ANCHOR_SOURCES, hint=ANCHOR_HINT)
            self._anchor = Vector(section, "flight's anchor (m)", hint=PLACE_HINT)
            self._world = Choice(section, "gravity and field from", WORLD_SOURCES, hint=WORLD_HINT)
            self._gravity = Vector(
                section, "flight's gravity (m/s²)", hint="Gravity in the inertial frame of the record."
            )
            self._magnetic = Vector(
                section,
                "flight's magnetic direction",
                hint="The direction of the magnetic field there, in the inertial frame of the record.",
            )
            self._synthetic = Switch(section, "synthetic ranges", hint=SYNTHETIC_HINT)
            self._sigma = Number(section, "flight's range noise σ (m)", hint=SIGMA_HINT)
            self._begin = Number(section, "begin at (s)", hint=PART_HINT)
            self._end = Number(section, "end at (s)", hint=PART_HINT)
            self._window = Number(section, "flight's window δ (s)", hint=WINDOW_HINT)
            self._weak = Number(section, VERDICT["wanted error"].caption, hint=WEAK_HINT)
            form.button("Was it informative?", self._judge, hint=JUDGE_HINT)
            self._progress = ProgressPanel(form, jobs)
            self._report_block = form.gui.add_html("", visible=False)
        section.check(self._follow)
        for choice in (self._anchor_source, self._world):
            form.when_moved(choice.handle, self._show_boxes)
        section.show(False)

    def close(self) -> None:
        """Hide the flight and its result, because another file is being read."""
        self._flight, self._report_block.visible = None, False
        self._section.show(False)

    def offer(self, import_result: ImportResult) -> None:
        """Offer a flight that was read."""
        flight = self._flight = import_result.flight
        if flight is None:
            return
        source, evidence = world_evidence(flight)
        self._source = import_result.source
        asked = flight.anchor is None and len(flight.range) > 0
        sentences = (f"{import_result.source}: {_contents(flight)}", evidence, *((WHERE,) if asked else ()))
        self._evidence.content = NOTE.format(bullets(sentences))
        defaults = FlightOptions()
        self._anchor_source.offer(ASKED_ANCHOR if asked else ANCHOR_SOURCES)
        self._anchor_source.show("" if asked else "file")
        self._anchor.show(flight.anchor or ORIGIN)
        self._world.show(source)
        self._gravity.show(flight.gravity or gravity(flight.frame))
        self._magnetic.show(flight.magnetic or defaults.magnetic)
        self._synthetic.show(False)
        self._sigma.show(defaults.range_sigma)
        self._begin.show(float(flight.time[0]))
        self._end.show(math.ceil(1e3 * flight.time[-1]) / 1e3)
        self._window.show(min(defaults.window, import_result.duration / 2))
        self._weak.show(defaults.position_sigma)
        self._report_block.visible = False
        self._section.complaint.clear()
        self._show_boxes()
        self._section.show(True)

    def _show_boxes(self) -> None:
        """Show the boxes of what is given by hand, and hide those whose values are not used."""
        with self._section.catching():
            given = self._world.read() == "given"
            self._anchor.reveal(visible=self._anchor_source.read() == "given")
        self._gravity.reveal(visible=given)
        self._magnetic.reveal(visible=given)

    def _judge(self) -> None:
        flight = self._flight
        if flight is None:
            return
        with self._section.catching():
            require(self._anchor_source.read() != "" or self._synthetic.read(), WHERE)
            options = self._judged = self._options()
        self._report_block.visible = False
        show, complain = partial(self._show, self._source), self._section.complaint.say
        self._progress.start(f"judging {self._source}", lambda *_: judge(flight, options), show, complain)

    def _options(self) -> FlightOptions:
        """What is chosen. Raises ValueError with the reason."""
        return FlightOptions(
            anchor=self._anchor.read() if self._anchor_source.read() == "given" else None,
            source=self._world.read(),
            gravity=self._gravity.read(),
            magnetic=self._magnetic.read(),
            ranges="synthetic" if self._synthetic.read() else "measured",
            range_sigma=self._sigma.read(),
            begin=self._begin.read(),
            end=self._end.read(),
            window=self._window.read(),
            position_sigma=self._weak.read(),
        )

    def _follow(self) -> None:
        """Remove a report on other options from the page. Raises ValueError with what is wrong about those chosen."""
        if self._flight is not None and self._options() != self._judged:
            self._report_block.visible = False

    def _show(self, source: str, flight_report: FlightReport) -> None:
        self._report_block.content = NOTE.format(report(source, flight_report))
        self._report_block.visible = True


def report(source: str, flight_report: FlightReport) -> str:
    """The report on a file as HTML: its name and verdict, the ranges that were used, windows by verdict, the worst
    window, and the errors of the observers."""
    windows, whole = flight_report.windows, flight_report.whole
    summary = whole.summary.removeprefix(f"{whole.verdict}: ")
    failure = flight_report.failure if whole.verdict in ("observable", "weak") else None
    observer, word = flight_report.observer, whole.verdict
    if failure is not None:
        word = "weak" if observer is None or observer.diverged is None else "blind"
    sign, color = SIGNS[word], COLORS.get(word, palette.NEUTRAL)
    head = f"{source}: {sign} {whole.verdict}: {summary}{'' if failure is None else f'; but {failure}'}"
    worst = f"from {significant(windows.worst_start, 4)} s: rank {windows.worst_rank} of 13"
    if windows.worst_rank < windows.motion_rank:
        ranges = "1 range" if windows.worst_ranges == 1 else f"{windows.worst_ranges} ranges"
        worst += f" from {ranges}; its motion has rank {windows.motion_rank}"
    required = f"required ±{quantity(flight_report.required, 'm')}"
    parts = [] if whole.restriction is not None else flight_report.summary.split("; ")
    blind = [part.removeprefix(BLIND_FROM) for part in parts if part.startswith(BLIND_FROM)]
    rows = [
        *_whole(whole, flight_report.required, required),
        (f"windows of {significant(windows.window)} s", _counts(windows.counts)),
        *(("blind if they begin at", one) for one in blind),
        ("worst window", worst),
        ("σ there", _number(windows.worst_position, "m", "blind there, or with too few ranges")),
        ("σ, median", _number(windows.median_position, "m")),
        (f"{required} after each", _met(windows.worst_position, flight_report.required)),
    ]
    lines = (flight_report.ranges_source, flight_report.world_source, more_ranges(windows.counts))
    text = HEAD.format(color, html.escape(head)) + bullets(filter(None, lines)) + table((), rows)
    if flight_report.observer is None:
        return text + bullets(("no ranges, so the observers were not run (synthetic ones need a true position)",))
    return text + _observers(flight_report.observer, whole)


def _whole(whole: WholeRecord, needed: float, required: str) -> tuple[tuple[str, str], ...]:
    """The predicted error of the whole record against the requirement, as a row; none where it is not predicted."""
    if whole.position is None or whole.restriction is not None:
        return ()
    reached = f"±{quantity(whole.position, 'm')}, {required}: {_met(whole.position, needed)}"
    return (("σ at the end of all of it" if whole.all_of_it else "σ at the end of that part", reached),)


def _met(sigma: float | None, needed: float) -> str:
    return "✓ met" if sigma is not None and sigma <= needed else "✗ not met"


def _counts(counts: dict[str, int]) -> str:
    return ", ".join(f"{count} {name}" for name, count in counts.items() if count)


def _observers(observer: ObserverSummary, whole: WholeRecord) -> str:
    position = ", ".join(_number(value) for value in observer.final_position)
    rows: list[tuple[str, ...]] = []
    for label, errors in (("position error (m)", observer.position), ("attitude error (°)", observer.attitude)):
        if errors is not None:
            rows.append((label, *(_number(value) for value in (*errors.quarters, errors.median))))
    text = bullets((f"ends at {position} m; innovations {_number(observer.innovation_rms, 'm²')} rms",))
    text += bullets((f"on its ranges: {observer.fit.statement(blind=whole.blind, predicted=whole.position)}",))
    if observer.diverged is not None:
        text += bullets((f"✕ diverged: {observer.diverged}",))
    if not rows:
        return text + bullets(("no truth in the file to hold the estimate against",))
    return text + table(("rms by quarters", "1st", "2nd", "3rd", "4th", "median"), rows)


def _contents(flight: Flight) -> str:
    length = flight.time[-1] - flight.time[0]
    parts = [f"{len(flight.time)} samples over {significant(length, 4)} s", f"{len(flight.range)} ranges"]
    parts.append("a magnetometer" if flight.mag is not None else "no magnetometer")
    parts.append("a true position" if flight.position is not None else "no truth")
    parts.append("no anchor" if flight.anchor is None else f"an anchor at {vector(flight.anchor)} m")
    return ", ".join(parts)


def _number(value: float | None, unit: str = "", reason: str = "") -> str:
    return quantity(value, unit, otherwise=f"{NOT_DETERMINED} ({reason})" if reason else NOT_DETERMINED)
