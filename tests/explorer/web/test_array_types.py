"""viser's setters convert and compare what is assigned as they did before the types of arrays were built once."""

from typing import Any, get_type_hints

import numpy as np
import numpy.typing as npt
from viser import _assignable_props_api

from explorer.web import array_types
from tests.support.sent_messages import Page


def test_the_types_are_those_of_numpy_and_each_is_built_once() -> None:
    array_types.build_once()
    of_viser: Any = _assignable_props_api
    for scalar in (np.float16, np.float32, np.float64, np.uint8):
        built = of_viser.npt.NDArray[scalar]
        assert built == npt.NDArray[scalar]
        assert of_viser.npt.NDArray[scalar] is built


def test_arrays_are_converted_colours_become_bytes_and_equal_values_are_not_sent(page: Page) -> None:
    array_types.build_once()
    points = np.zeros((1, 2, 3))
    line: Any = page.scene.add_line_segments("/line", points, (0, 0, 0))
    plot: Any = page.gui.add_uplot((np.zeros(2), np.zeros(2)), ({"label": "t"}, {"label": "x"}))
    page.messages.clear()
    line.points = points + 1.0
    line.colors = np.full((1, 2, 3), 0.5)
    plot.data = (np.arange(2), np.arange(2))
    assert line.points.dtype == np.float32
    assert (line.points == 1.0).all()
    assert line.colors.dtype == np.uint8
    assert [array.dtype for array in plot.data] == [np.float64, np.float64]
    assert len(page.messages) == 3
    line.points = points + 1.0
    assert len(page.messages) == 3


def test_the_types_of_properties_are_those_that_are_annotated_and_each_is_built_once(page: Page) -> None:
    array_types.build_once()
    one: Any = page.gui.add_text("x", "")
    other: Any = page.gui.add_text("y", "")
    assert one._prop_hints == get_type_hints(type(one._impl.props))
    assert other._prop_hints is one._prop_hints
