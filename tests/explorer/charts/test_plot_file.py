"""Files of plots and lines of Python: they hold what the page shows, to the last digit where they are numbers."""

import csv
import io
import json
import math
import re
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
import viser

from explorer.charts import Charts, plot_file, plot_list
from explorer.charts.plot_size import PlotSize
from explorer.charts.plots import Drawing, Plot
from explorer.model.compute import Picture, compute
from explorer.model.settings import Printed, Settings
from explorer.panels.export import python_lines
from explorer.server import SessionServer
from explorer.shared import Compilation
from explorer.storage import preset_file
from explorer.web.security import open_server
from rangenav import preset
from tests.support.pictures import picture
from tests.support.sent_messages import Page
from tests.support.shared_server import shared
from tests.support.wire import Wire

pytestmark = pytest.mark.slow


ALL = {plot.name: plot for group in plot_list.GROUPS for plot in group.plots}
SVG = "{http://www.w3.org/2000/svg}"
ROOT = Path(__file__).parents[3]


def _columns(plot: Plot, drawing: Drawing) -> tuple[int, ...]:
    return tuple(i for i in range(len(plot.curves)) if i not in drawing.hidden)


def _duration(example: Picture) -> float:
    return float(example.motion.time[-1])


def _table(example: Picture, name: str) -> tuple[list[str], np.ndarray]:
    """Names and numbers of a plot's CSV, an empty cell as NaN."""
    plot = ALL[name]
    drawing = plot.draw(example)
    content = plot_file.table(plot, drawing, _columns(plot, drawing), _duration(example)).decode()
    names, *rows = csv.reader(io.StringIO(content))
    return names, np.array([[float(cell) if cell else math.nan for cell in row] for row in rows])


@pytest.mark.parametrize("name", list(ALL))
@pytest.mark.parametrize("of", ["paper-slow", "circle"])
def test_a_table_holds_every_sample_of_every_curve_to_the_last_digit(name: str, of: str):
    example = picture(of)
    drawing = ALL[name].draw(example)
    names, numbers = _table(example, name)
    shown = drawing.values[:, _columns(ALL[name], drawing)]
    np.testing.assert_array_equal(numbers[:, 0], drawing.time)
    np.testing.assert_array_equal(numbers[:, 1:], np.where(np.isneginf(shown), np.nan, shown))
    assert len(set(names)) == len(names) == numbers.shape[1]


def test_the_first_line_names_every_curve_with_its_unit():
    example = picture("paper-slow")
    assert _table(example, "position")[0] == ["t (s)", "error (m; log axis)", "σ by P (m; log axis)"]
    assert _table(example, "effort")[0] == ["t (s)", "thrust/weight", "|ω| (rad/s)"]
    gramian = _table(example, "gramian")[0]
    assert gramian[:3] == ["window start (s)", "λ₁ (SI; log axis)", "λ₂ (SI; log axis)"]
    assert gramian[-3:] == ["λ₁₂ (SI; log axis)", "λ₁₃ (SI; log axis)", "floor (SI; log axis)"]
    assert _table(example, "snap")[0][1] == "x (m/s⁴)"


def test_a_table_is_not_the_decimated_curve():
    example = picture("paper-slow")
    assert len(_table(example, "position")[1]) == len(example.motion.time) > 1000


def test_a_blind_window_is_inf_and_below_the_floor_there_is_nothing():
    example = picture("circle")
    assert (_table(example, "predicted")[1][:, 1] == math.inf).all()
    assert np.isnan(_table(example, "gramian")[1][:, 1]).all()


def _patches(root: ElementTree.Element, colour: str) -> list[np.ndarray]:
    """The points (px) of all open lines of a colour."""
    points = []
    for path in root.iter(f"{SVG}path"):
        if f"stroke: {colour}" in path.get("style", "") and "clip-path" in path.attrib:
            numbers = re.findall(r"-?\d+(?:\.\d+)?", path.get("d", ""))
            points.append(np.array(numbers, dtype=float).reshape(-1, 2))
    return points


def test_the_svg_draws_the_curve_on_a_logarithmic_axis():
    example, plot = picture("paper-slow"), ALL["attitude"]
    drawing = plot.draw(example)
    root = ElementTree.fromstring(plot_file.svg(plot, drawing, (0,), _duration(example)))
    (curve,) = _patches(root, plot.curves[0].color.lower())
    corners = next(group for group in root.iter(f"{SVG}g") if group.get("id") == "patch_2")[0].get("d", "")
    frame = np.array(re.findall(r"-?\d+(?:\.\d+)?", corners), dtype=float).reshape(-1, 2)
    left, right, top, bottom = *(f(frame[:, 0]) for f in (min, max)), *(f(frame[:, 1]) for f in (min, max))
    share = (bottom - curve[:, 1]) / (bottom - top)
    low, high = np.log10(drawing.axis)
    read_off = 10 ** (low + share * (high - low))
    when = (curve[:, 0] - left) / (right - left) * _duration(example)
    inside = (read_off > drawing.axis[0]) & (read_off < drawing.axis[1])
    assert inside.sum() > 100
    # Lines are simplified to a ninth of a pixel, which is less than a hundredth of the axis' height per vertex.
    near = [np.abs(np.log10(drawing.values[np.abs(example.motion.time - t) < 0.05, 0]) - np.log10(v)).min()
            for t, v in zip(when[inside], read_off[inside], strict=True)]  # fmt: skip
    assert max(near) < 0.01 * (high - low)


@pytest.mark.parametrize("name", ["gramian", "snap", "predicted"])
def test_a_picture_has_its_size_and_the_same_plot_gives_the_same_bytes(name: str):
    example, plot = picture("circle"), ALL[name]
    drawing = plot.draw(example)
    columns, duration = _columns(plot, drawing), _duration(example)
    drawn = plot_file.png(plot, drawing, columns, duration)
    assert drawn[:8] == b"\x89PNG\r\n\x1a\n"
    assert [int.from_bytes(drawn[k : k + 4], "big") for k in (16, 20)] == [1440, 720]
    assert plot_file.svg(plot, drawing, columns, duration) == plot_file.svg(plot, drawing, columns, duration)


def test_the_floor_is_drawn_and_a_curve_that_is_not_shown_is_not():
    example, plot = picture("circle"), ALL["gramian"]
    drawing = plot.draw(example)
    grey, blue = plot.curves[-1].color.lower(), plot.curves[-2].color.lower()
    every = ElementTree.fromstring(plot_file.svg(plot, drawing, _columns(plot, drawing), _duration(example)))
    assert len(_patches(every, grey)) == len(_patches(every, blue)) == 1
    some = ElementTree.fromstring(plot_file.svg(plot, drawing, (0, 13), _duration(example)))
    assert (len(_patches(some, grey)), len(_patches(some, blue))) == (1, 0)


def test_two_plots_side_by_side_are_one_picture_with_the_curves_of_both():
    panels = []
    for name in ("circle", "paper-slow"):
        plot, example = ALL["position"], picture(name)
        drawing = plot.draw(example)
        panels.append(plot_file.Panel(plot, drawing, _columns(plot, drawing), _duration(example)))
    rows = [("verdict", "blind", "observable"), ("excitation condition", "fails", "holds")]
    summary = plot_file.Summary(("A · one", "B · other"), rows, "A sentence that is long. " * 12)
    content = plot_file.picture(panels, "svg", summary)
    root = ElementTree.fromstring(content)
    assert len(_patches(root, ALL["position"].curves[0].color.lower())) == 2
    words = _words(content)
    assert {"A · one", "B · other", "excitation condition", "holds", "observable"} <= set(words)
    assert " ".join(words).count("A sentence that is long.") == 12


def test_curves_of_which_nothing_can_be_seen_share_an_entry_of_the_legend_that_says_why():
    example, plot = picture("hover"), ALL["excitation"]
    words = _words(plot_file.svg(plot, plot.draw(example), (0, 1, 2, 3), 20.0))
    assert "λ₁, λ₂, λ₃: zero" in words
    assert plot.empty in words
    assert len({curve.color for curve in plot.curves[:3]} | {curve.color for curve in plot.curves[4:]}) == 6


def _words(svg: bytes) -> list[str]:
    """The texts of a picture, which matplotlib writes as comments before their outlines."""
    return re.findall("<!-- (.*?) -->", svg.decode())


def test_a_plot_that_follows_later_is_no_file_of_what_is_chosen_now():
    server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    charts, example, other = (
        Charts(Page(server).client, PlotSize(two_panels=True)),
        picture("paper-slow"),
        picture("circle"),
    )
    charts.draw(example)
    with pytest.raises(ValueError, match="no plot 'scaled' yet"):
        charts.file_writer("scaled", "csv")
    charts.draw_details(example)
    assert charts.file_writer("scaled", "csv")().startswith("window start (s),s₁₃ (log axis),s₁₂ (log axis)".encode())
    charts.draw(other)
    assert charts.file_writer("position", "csv")()
    with pytest.raises(ValueError, match="Scaled spectrum: still shows an earlier state"):
        charts.file_writer("scaled", "csv")
    turned = Settings(preset=other.preset, twin_turn=(0.0, 0.0, 0.5))
    charts.draw_details(compute(turned))  # as when only the twin was turned
    assert charts.file_writer("scaled", "csv")()
    assert charts.file_writer("position", "csv")()
    server.stop()


def test_nothing_to_write_and_too_much_are_refused():
    plot = ALL["position"]
    drawing = plot.draw(picture("paper-slow"))
    with pytest.raises(ValueError, match="Position error: no curve of it is shown"):
        plot_file.require_writable(plot, drawing, ())
    count = plot_file.MAX_CELLS // 3
    plot_file.require_writable(plot, replace(drawing, time=np.zeros(count)), (0, 1))
    with pytest.raises(ValueError, match=f"would hold {3 * count + 3} numbers"):
        plot_file.require_writable(plot, replace(drawing, time=np.zeros(count + 1)), (0, 1))


def test_the_page_starts_without_matplotlib():
    code = "import sys, explorer.session; print('matplotlib' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True).stdout == "False\n"


CASES = [
    Settings(origin="paper-slow", preset=preset.load("paper-slow"), time_scale=1.5),
    Settings(origin="circle", preset=preset.load("circle"), printed=Printed(model=True, initial_values=True)),
    Settings(origin="hover", preset=preset.load("hover"), printed=Printed(excitation=True, body_axes=True)),
]


@pytest.mark.parametrize("settings", CASES, ids=[case.origin for case in CASES])
def test_the_lines_of_python_compute_what_the_page_shows(settings: Settings, tmp_path: Path):
    (tmp_path / "mine.toml").write_bytes(preset_file.document(settings))
    lines = python_lines(settings, "mine.toml")
    assert len(lines.splitlines()) <= 8
    ask = "import json\nprint(json.dumps([flight.errors.position.tolist(), result.mu, result.verdict.word"
    ask += ", printed.tolist()]))" if "printed =" in lines else "]))"
    ran = subprocess.run(
        [sys.executable, "-c", lines + ask], cwd=tmp_path, env={"PYTHONPATH": str(ROOT)}, capture_output=True, text=True
    )
    assert ran.stderr == ""
    *figures, numbers = ran.stdout.splitlines()
    position, mu, verdict, *rest = json.loads(numbers)
    assert figures[0].startswith(f"{verdict}: rank ")
    assert figures[1].startswith("position: settled after (s) ")
    example = compute(settings)
    np.testing.assert_array_equal(position, example.errors.position)
    judged = example.proven().analysis
    assert (mu, verdict) == (judged.mu, judged.verdict.word)
    if rest:
        # The same sums, but in a process where numpy may add in another order: 14 digits of the greatest.
        np.testing.assert_allclose(rest[0], example.at_rest.printed_excitation, rtol=0, atol=1e-14 * np.max(rest[0]))


def test_the_printed_switches_change_what_the_lines_compute():
    """Otherwise the test above would also pass for lines that ignore the switches."""
    plain = [compute(Settings(origin=case.origin, preset=case.preset)) for case in CASES]
    assert plain[0].analysis.mu != compute(CASES[0]).analysis.mu
    assert not np.array_equal(plain[1].errors.position, compute(CASES[1]).errors.position)
    assert not np.array_equal(plain[2].printed_excitation, compute(CASES[2]).printed_excitation)


@pytest.fixture(scope="module")
def tab() -> Iterator[Wire]:
    server, compilation = open_server("127.0.0.1", 0), Compilation()
    SessionServer(server, shared(server, compilation))
    compilation.start()
    visitor = Wire(server.get_port())
    visitor.wait_for_text("estimate’s")
    yield visitor
    visitor.close()
    server.stop()


def _download(tab: Wire, row: str, option: str) -> tuple[str, bytes]:
    before = len(tab.downloads)
    tab.press(row, option)
    tab.wait_for(lambda: len(tab.downloads) > before, f"the download of {option}")
    return tab.downloads[-1]


@pytest.mark.parametrize("kind", ["csv", "svg", "png", "pdf"])
def test_a_visitor_gets_the_file_of_the_plot_they_chose(tab: Wire, kind: plot_file.PlotFormat):
    tab.set("plot", "Attitude error")
    time.sleep(0.1)
    name, content = _download(tab, "file type", kind.upper())
    assert name == f"paper-slow-attitude.{kind}"
    plot = ALL["attitude"]
    example = picture("paper-slow")
    assert content == plot_file.WRITERS[kind](plot, plot.draw(example), (0,), _duration(example))


def test_a_visitor_sees_and_gets_the_lines_and_their_file(tab: Wire):
    name, lines = _download(tab, "", "Download Python")
    settings = Settings(origin="paper-slow", preset=preset.load("paper-slow"))
    assert (name, lines.decode()) == ("paper-slow.py", python_lines(settings, "paper-slow.toml"))
    assert "flight = record.run(p)" in tab.text()
    assert _download(tab, "", "Download preset") == ("paper-slow.toml", preset_file.document(settings))
    for q in ("700", "5000"):  # the lines go with what they compute
        tab.set("range weight q (1/(m⁴ s)): number", q)
        tab.wait_for(lambda: "flight = record.run(p)" not in tab.text(), "the lines to go")


def test_a_plot_that_is_none_is_refused_beside_the_buttons(tab: Wire):
    tab.set("plot", "../../etc/passwd")
    time.sleep(0.1)
    tab.press("file type", "CSV")
    tab.wait_for_text("there is no plot")
