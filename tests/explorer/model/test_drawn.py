"""What is drawn again: it is decided by the identity of arrays and by the contents of values."""

import numpy as np

from explorer.model.drawn import Drawn
from rangenav.motion import World


def test_the_first_inputs_are_a_change_and_the_same_ones_are_none() -> None:
    drawn, array = Drawn(), np.zeros(3)
    assert drawn.changed(array, World(), 1.0)
    assert not drawn.changed(array, World(), 1.0)  # another World with the same contents


def test_another_array_another_value_and_another_number_of_inputs_are_changes() -> None:
    drawn, array = Drawn(), np.zeros(3)
    for inputs in ((array, 1.0), (np.zeros(3), 1.0), (np.zeros(3), 2.0), (array,), (array, World())):
        assert drawn.changed(*inputs)


def test_what_was_forgotten_is_drawn_again() -> None:
    drawn = Drawn()
    drawn.changed(1.0)
    drawn.forget()
    assert drawn.changed(1.0)
