"""The checker of shapes and types that conftest wraps around every function: numbers of numpy count as Python's.

A check costs more than most of the functions do, so a sample of the calls is checked: the first ones in every test
file, after them those whose number is twice that of the last, and one more in some of the later tests. Counting costs
more than many functions do, too, so a function of a module has its own code again when its last call was counted.
"""

import dataclasses
import functools
import inspect
import random
from collections.abc import Callable
from types import CodeType, FunctionType
from typing import Any

import numpy as np
from beartype import BeartypeConf, FrozenDict, beartype
from hypothesis import currently_in_test_context
from jaxtyping import TypeCheckError, config, jaxtyped

FIRST = 8
"""So many calls of a function are all checked, in each test file."""
LAST = 64
"""The last call that is counted. After it the next call is checked in each test whose number is a power of two."""

checked = beartype(
    conf=BeartypeConf(
        violation_type=TypeCheckError,
        hint_overrides=FrozenDict(
            {bool: bool | np.bool_, int: int | np.integer, float: float | int | np.floating | np.integer}
        ),
    )
)
"""Arrays are checked by jaxtyping's shapes. A scalar of numpy is accepted in place of one of Python."""


class _Calls:
    """The calls of one function in this test file; an inner function keeps its count when it is defined again."""

    __slots__ = ("codes", "left", "next")

    def __init__(self, codes: "_Codes | None" = None) -> None:
        self.codes = codes
        self.begin()

    def begin(self) -> None:
        """The first call is checked."""
        self.next, self.left = 1, 1
        if self.codes:
            self.codes.count()

    def once_more(self) -> None:
        """The next call is checked, of a function whose calls are not counted any more."""
        if self.codes and self.next > LAST:
            self.left = 1
            self.codes.count()

    def plan(self) -> None:
        """The call that was to be checked next has come: plan another one, to which `left` counts down."""
        this = self.next
        self.next = this + 1 if this < FIRST else 2 * this
        self.left = self.next - this
        if self.codes and self.next > LAST:
            self.codes.rest()


class _Codes:
    """The two codes of a function: its own, and one that calls another function, which counts and checks."""

    __slots__ = ("counting", "function", "own")

    def __init__(self, function: FunctionType) -> None:
        self.function = function
        self.own = self.counting = function.__code__

    def count_by(self, counting: Callable) -> None:
        """The other function, which stands as a constant in the code that calls it."""
        call = _call_with(self.own.co_freevars)
        constants = tuple(counting if one == PLACE else one for one in call.co_consts)
        self.counting = call.replace(co_consts=constants, co_name=self.own.co_name)

    def count(self) -> None:
        self.function.__code__ = self.counting

    def rest(self) -> None:
        self.function.__code__ = self.own


NOTE = "within the scope of a `jaxtyping.jaxtyped` function"
"""What jaxtyping notes with every error that leaves a function whose shapes it checks."""
PLACE = "the place of the function that counts"
CALL = """
def outer({names}):
    def call(*args, **kwargs):
        counting = {place!r}
        return counting(*args, **kwargs)
        {names}
    return call
"""


@functools.cache
def _call_with(names: tuple[str, ...]) -> CodeType:
    """The code of a call of a constant that has these free variables, as the code has in whose place it stands.

    Without them a traceback could not be shown: Python looks for them in each frame, and ends where there are none."""
    made: dict[str, Any] = {}
    exec(CALL.format(names=", ".join(names), place=PLACE), made)
    code = made["outer"](*names).__code__
    assert code.co_freevars == names
    return code


_calls: list[_Calls] = []
_inner: dict[CodeType, _Calls] = {}
_checked: set[CodeType] = set()


def sampled(*, typechecker: Callable) -> Callable:
    """What stands for `jaxtyping.jaxtyped`, whose own work for each call costs as much as the check itself."""

    def decorate(item):
        if not inspect.isclass(item):
            return _sampled_function(item, typechecker)
        if dataclasses.is_dataclass(item) and "__init__" in vars(item):
            item.__init__ = _sampled_function(item.__init__, typechecker)
        return item

    return decorate


def _sampled_function(function: Any, typechecker: Callable) -> Callable:
    """The function with its checks: itself, with two codes, or for an inner function or a generator another one."""
    code = function.__code__
    _checked.add(code)
    if "<locals>" in function.__qualname__ or inspect.isgeneratorfunction(function):
        if code not in _inner:
            _inner[code] = _Calls()
            _calls.append(_inner[code])
        return _counted(function, typechecker, _inner[code])
    bare = FunctionType(code, function.__globals__, function.__name__, function.__defaults__, function.__closure__)
    bare.__kwdefaults__ = function.__kwdefaults__
    functools.update_wrapper(bare, function)
    vars(bare).pop("__wrapped__")
    function.__wrapped__ = bare  # whose signature is read
    codes = _Codes(function)
    calls = _Calls(codes)
    codes.count_by(_counted(bare, typechecker, calls))
    calls.begin()
    _calls.append(calls)
    return function


def _counted(bare: Callable, typechecker: Callable, calls: _Calls) -> Callable:
    """The function with its checks, which are made when they are first needed."""
    checking = None

    @functools.wraps(bare)
    def sample(*args, **kwargs):
        nonlocal checking
        calls.left -= 1
        if calls.left > 0 or config.jaxtyping_disable:
            return bare(*args, **kwargs)
        calls.plan()
        if checking is None:
            checking = _checking(bare, typechecker)
        if not currently_in_test_context():
            return checking(*args, **kwargs)
        state = random.getstate()
        try:
            return checking(*args, **kwargs)
        finally:  # beartype draws the item of a list that it checks, and hypothesis wants no draws but its own
            random.setstate(state)

    return sample


def _checking(bare: Callable, typechecker: Callable) -> Callable:
    """The function with checks of its parameters and then of its result: `jaxtyped` alone checks the parameters twice.

    What a generator yields, and names that are known to a type checker only, it alone leaves unchecked.
    """
    named = any(isinstance(hint, str) for hint in inspect.get_annotations(bare).values())
    if named or inspect.isgeneratorfunction(bare):
        return jaxtyped(bare, typechecker=typechecker)
    return _without_note(jaxtyped(typechecker(bare), typechecker=None))


def _without_note(checking: Callable) -> Callable:
    """The function with checks, whose own errors get no note of the shapes: a test compares an error with its notes."""

    def call(*args, **kwargs):
        try:
            return checking(*args, **kwargs)
        except TypeCheckError:
            raise
        except Exception as error:
            if hasattr(error, "__notes__"):
                error.__notes__ = [note for note in error.__notes__ if NOTE not in note]
            raise

    return call


def is_checked(function: Callable) -> bool:
    """Whether calls of this function are counted and checked."""
    return inspect.unwrap(function).__code__ in _checked


def begin_file() -> None:
    """Every count starts again at zero."""
    for calls in _calls:
        calls.begin()


def begin_test(number: int) -> None:
    """The test of this number in its file begins; those of a power of two check one more call of each function."""
    if number & (number - 1) == 0:
        for calls in _calls:
            calls.once_more()
