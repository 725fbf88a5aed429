"""Editing in a real Chromium: dragging, typing, undoing, and finding the work again."""

import math

import numpy as np

from tests.browser.page import BLUR, Server, Visitor, until, until_still

TABLE = "points, a line t x y z each"


def test_a_waypoint_dragged_with_the_mouse_moves_the_path_and_undo_brings_it_back(wide: Visitor):
    wide.choose("path made of", "waypoints")
    until(lambda: "/handles/waypoint3" in wide.node_names(), "handles")
    until_still(wide.camera_position)
    table, place = wide.typed(TABLE), wide.node_position("/handles/waypoint3")
    verdict = wide.chart_data("μ wanted")
    wide.drag_node("/handles/waypoint3", (60, -40))
    until(lambda: wide.typed(TABLE) != table, "the point in the table")
    until(lambda: math.dist(wide.node_position("/handles/waypoint3"), place) > 0.05, "the handle elsewhere")
    until(lambda: wide.chart_data("μ wanted") != verdict, "another excitation")
    until_still(lambda: wide.typed(TABLE))  # the drag has ended for the session, too
    wide.page.evaluate(BLUR)  # out of any box, whose own undo would come first
    wide.page.keyboard.press("Control+z")
    until(lambda: wide.typed(TABLE) == table, "the table as it was")
    until(lambda: math.dist(wide.node_position("/handles/waypoint3"), place) < 1e-6, "the handle where it was")


def test_a_formula_is_typed_a_mistake_is_pointed_at_and_the_rest_goes_on(wide: Visitor):
    wide.choose("path made of", "formulas")
    wide.type_text("x(t) =", "cos(2*t")
    wide.wait_for_text("a ) is missing at the end (column 8)")
    wide.type_text("x(t) =", "cos(2*t)")
    wide.wait_for_no_text("is missing at the end")
    before = wide.chart_data("norm")
    wide.type_text("z(t) =", "0.2*sin(3*t)")
    until(lambda: wide.chart_data("norm") != before, "another φ")
    assert wide.typed("x(t) =") == "cos(2*t)"


def test_undo_and_redo_by_buttons_and_keys(wide: Visitor):
    wide.nudge("amplitude x (m)")
    until(lambda: "amplitude x (m) •" in wide.text(), "the mark")
    moved = wide.number("amplitude x (m)")
    wide.press("Undo")
    until(lambda: wide.number("amplitude x (m)") == "1", "the value before")
    wide.page.keyboard.press("Control+Shift+z")
    until(lambda: wide.number("amplitude x (m)") == moved, "the value again")
    wide.press("amplitude x (m)")
    until(lambda: wide.number("amplitude x (m)") == "1", "the value of the preset")
    wide.wait_for_no_text("amplitude x (m) •")


def test_the_work_is_there_after_a_reload(wide: Visitor):
    wide.choose("path made of", "formulas")
    wide.type_text("y(t) =", "0.4*cos(3*t)")
    wide.wait_until_saved("0.4*cos(3*t)")
    wide.reload()
    until(lambda: wide.typed("y(t) =") == "0.4*cos(3*t)", "the formula")


def test_the_work_is_there_after_the_server_was_restarted(server: Server, wide: Visitor):
    wide.choose("path made of", "waypoints")
    until(lambda: "/handles/waypoint3" in wide.node_names(), "handles")
    wide.type_number("flight duration (s)", "17")
    wide.wait_for_text("duration (s) •")
    wide.wait_until_saved('"duration":17')
    with wide.reconnecting():
        server.restart()
    until(lambda: wide.number("flight duration (s)") == "17", "the duration")
    assert len(wide.typed(TABLE).split("\n")) == 12
    wide.complaints.clear()  # of the connection that was lost


def test_dragging_the_anchor_changes_the_predicted_accuracy_and_not_the_gramian(wide: Visitor):
    until_still(wide.camera_position)
    gramian, predicted = wide.chart_data("λ₁₃"), wide.chart_data("lifted")
    wide.drag_node("/handles/anchor", (50, 30))
    until(lambda: wide.chart_data("lifted") != predicted, "another accuracy")
    until(lambda: wide.chart_data("λ₁₃") == gramian, "all windows as they were: a hand that moves has a third of them")
    wide.tab("World")
    wide.wait_for_text("anchor position (m) •")


def test_two_hundred_kilobytes_in_a_formula_are_refused_and_nothing_is_lost(wide: Visitor):
    wide.choose("path made of", "formulas")
    before = wide.chart_data("norm")
    wide.type_text("x(t) =", "7" * 200_000)
    wide.wait_for_text("at most 20000 characters, got 200000")
    after = wide.chart_data("norm")  # the last picture may be the formulas' own, which differs in the last digits
    assert np.allclose(np.array(after, dtype=float), np.array(before, dtype=float), rtol=1e-9, equal_nan=True)
    wide.type_text("x(t) =", "cos(3*t)")
    wide.wait_for_no_text("at most 20000 characters")
    until(lambda: wide.chart_data("norm") != before, "another φ")
