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
