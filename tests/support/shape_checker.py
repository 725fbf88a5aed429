"""The checker of shapes and types that conftest wraps around every function: numbers of numpy count as Python's.

A check costs more than most of the functions do, so a sample of the calls is checked: the first ones in every test
file, and after them those whose number is twice that of the last.
"""

import dataclasses
import functools
import inspect
import random
from collections.abc import Callable
from types import CodeType

import numpy as np
from beartype import BeartypeConf, FrozenDict, beartype
from hypothesis import currently_in_test_context
from jaxtyping import jaxtyped

FIRST = 8
"""So many calls of a function are all checked, in each test file."""

checked = beartype(
    conf=BeartypeConf(
        hint_overrides=FrozenDict(
            {bool: bool | np.bool_, int: int | np.integer, float: float | int | np.floating | np.integer}
        )
    )
)
"""Arrays are checked by jaxtyping's shapes. A scalar of numpy is accepted in place of one of Python."""


class _Calls:
    """The calls of one function in this test file; an inner function keeps its count when it is defined again."""

    __slots__ = ("left", "next")

    def __init__(self) -> None:
        self.begin()

    def begin(self) -> None:
        """The first call is checked."""
        self.next, self.left = 1, 1

    def plan(self) -> None:
        """The call that was to be checked next has come: plan another one, to which `left` counts down."""
        this = self.next
        self.next = this + 1 if this < FIRST else 2 * this
        self.left = self.next - this


_calls: dict[CodeType, _Calls] = {}


def sampled(*, typechecker: Callable) -> Callable:
    """What stands for `jaxtyping.jaxtyped`, whose own work for each call costs as much as the check itself."""

    def decorate(item):
        if not inspect.isclass(item):
            return _sampled_function(item, typechecker)
        if dataclasses.is_dataclass(item) and "__init__" in vars(item):
            item.__init__ = _sampled_function(item.__init__, typechecker)
        return item

    return decorate


def _sampled_function(bare: Callable, typechecker: Callable) -> Callable:
    """The function with its checks, which are made when they are first needed."""
    calls, checking = _calls.setdefault(bare.__code__, _Calls()), None

    @functools.wraps(bare)
    def sample(*args, **kwargs):
        nonlocal checking
        calls.left -= 1
        if calls.left > 0:
            return bare(*args, **kwargs)
        calls.plan()
        if checking is None:
            checking = jaxtyped(bare, typechecker=typechecker)
        if not currently_in_test_context():
            return checking(*args, **kwargs)
        state = random.getstate()
        try:
            return checking(*args, **kwargs)
        finally:  # beartype draws the item of a list that it checks, and hypothesis wants no draws but its own
            random.setstate(state)

    return sample


def is_checked(function: Callable) -> bool:
    """Whether calls of this function are counted and checked."""
    return inspect.unwrap(function).__code__ in _calls


def begin_file() -> None:
    """Every count starts again at zero."""
    for calls in _calls.values():
        calls.begin()
