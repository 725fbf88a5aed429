"""A map of two parameters in Chromium: it fills, is read by the mouse and by the keyboard, taken, and undone."""

from tests.browser.page import Visitor

FULL = "() => { const grid = document.querySelector('[data-rn-cells]');" + (
    " return grid && !grid.dataset.rnCells.includes('not computed yet') }"
)


def test_a_map_fills_and_a_cell_is_read_taken_and_undone(visitor: Visitor):
    page = visitor.page
    visitor.tab("Studies")
    for axis in ("across", "upwards"):
        visitor.type_number(f"points {axis}", "3")
    visitor.press("Compute the map")
    page.wait_for_function(FULL)
    grid, line = page.locator("[data-rn-cells]"), page.locator(".rn-cells-read")
    visitor.wait_for_text("present design: anchor position x 0 m, anchor position y 0 m")

    box = grid.bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + 0.9 * box["width"], box["y"] + 0.9 * box["height"])
    assert line.inner_text().startswith("anchor position x 2.5 m, anchor position y -1.8 m: ")
    page.mouse.down()
    page.mouse.up()
    visitor.wait_for_text("present design: anchor position x 2.5 m, anchor position y -1.8 m")
    assert line.inner_text().startswith("anchor position x 2.5 m, anchor position y -1.8 m: ")  # still

    grid.press("ArrowUp")
    assert line.inner_text().startswith("anchor position x 2.5 m, anchor position y 0 m: ")
    grid.press("Enter")
    visitor.wait_for_text("present design: anchor position x 2.5 m, anchor position y 0 m")
    for undone in ("2.5 m, anchor position y -1.8 m", "0 m, anchor position y 0 m"):
        page.keyboard.press("Control+z")
        visitor.wait_for_text(f"present design: anchor position x {undone}")


def test_a_menu_is_searched_by_key_takes_the_only_name_left_and_says_what_it_does_not_know(visitor: Visitor):
    page = visitor.page
    visitor.tab("Studies")
    box = visitor.beside("across").locator("input:not([type=hidden])").first
    box.click()
    page.keyboard.type("zzz")
    visitor.wait_for_text("Nothing here is called “zzz”")
    assert box.input_value() == "zzz"  # the old name was selected, and is replaced
    page.keyboard.press("Control+a")
    page.keyboard.type("riccati.q")
    visitor.wait_for_no_text("Nothing here is called")
    page.keyboard.press("Enter")
    visitor.wait_for_text("Keys of a study's file: → gains.riccati.q")
    assert box.input_value() == "range weight q (1/(m⁴ s)): gains.riccati.q"


def test_the_map_comes_into_sight_when_it_is_computed_from_below(visitor: Visitor):
    page = visitor.page
    visitor.tab("Studies")
    for axis in ("across", "upwards"):
        visitor.type_number(f"points {axis}", "3")
    visitor.press("Compute the map")
    page.wait_for_function(FULL)
    page.wait_for_function(
        "() => { const box = document.querySelector('[data-rn-place]').getBoundingClientRect();"
        " const at = y => document.elementFromPoint(box.left + box.width / 2, y);"
        " return [box.top + 2, box.bottom - 2].every(y => at(y) && at(y).closest('[data-rn-place]')) }"
    )
