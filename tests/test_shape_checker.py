"""The suite checks shapes and types in every function of the library; of many calls of one function, a sample."""

import dataclasses
import importlib
import inspect
import pkgutil
from collections.abc import Callable

import numpy as np
import pytest
from jaxtyping import Float, TypeCheckError

import rangenav
from rangenav import record, so3
from tests.support import shape_checker

UNCHECKED = ("rangenav.kernels", "rangenav.__main__")


def checkable(module_name: str) -> list[Callable]:
    """The functions of a module, and the constructors of its dataclasses."""
    members = [
        one
        for one in vars(importlib.import_module(module_name)).values()
        if getattr(one, "__module__", "") == module_name
    ]
    records = [one.__init__ for one in members if inspect.isclass(one) and dataclasses.is_dataclass(one)]
    return [*filter(inspect.isfunction, members), *records]


def norm(*, wrong_result: bool = False) -> Callable:
    """A new function with the suite's checks."""

    @shape_checker.sampled(typechecker=shape_checker.checked)
    def checked_norm(vector: Float[np.ndarray, "3"]) -> float:
        return vector if wrong_result else np.linalg.norm(vector)  # pyright: ignore

    return checked_norm


def refused(function: Callable, argument: object, calls: int) -> int:
    """How many of so many calls are refused."""
    count = 0
    for _ in range(calls):
        try:
            function(argument)
        except TypeCheckError:
            count += 1
    return count


def test_every_function_and_every_result_of_the_library_is_checked():
    names = [module.name for module in pkgutil.walk_packages(rangenav.__path__, "rangenav.")]
    functions = [one for name in names if not name.startswith(UNCHECKED) for one in checkable(name)]
    assert len(functions) > 500
    assert [one.__qualname__ for one in functions if not shape_checker.is_checked(one)] == []


def test_a_wrong_shape_a_wrong_type_and_a_wrong_result_are_refused():
    with pytest.raises(TypeCheckError, match=r"rangenav\.so3\.hat"):
        so3.hat(np.zeros((4, 4)))
    with pytest.raises(TypeCheckError, match="parameter vector='abc'"):
        norm()("abc")
    with pytest.raises(TypeCheckError, match='return "array'):
        norm(wrong_result=True)(np.ones(3))


def test_the_first_calls_are_all_checked_and_after_them_the_powers_of_two():
    shape_checker.begin_file()
    of_three = norm()
    assert refused(of_three, np.ones(4), shape_checker.FIRST) == shape_checker.FIRST
    assert refused(of_three, np.ones(4), 1024 - shape_checker.FIRST) == np.log2(1024 / shape_checker.FIRST)
    assert of_three(np.array([2.0, 3.0, 6.0])) == 7.0


def test_a_function_of_a_module_runs_as_it_is_written_after_some_calls_until_a_test_checks_one_more():
    shape_checker.begin_file()
    count = shape_checker.FIRST + np.log2(shape_checker.LAST / shape_checker.FIRST)
    code = so3.hat.__code__
    assert refused(so3.hat, np.ones(3, int), 1000) == count
    assert so3.hat.__code__ is so3.hat.__wrapped__.__code__ is not code  # pyright: ignore
    for number, more in ((3, 0), (4, 1), (5, 0), (8, 1)):
        shape_checker.begin_test(number)
        assert refused(so3.hat, np.ones(3, int), 1000) == more
    assert list(inspect.signature(so3.hat).parameters) == ["w"]


def test_the_traceback_of_a_wrong_call_can_be_shown():
    """`Outcome.__init__` has free variables, as whatever dataclass makes, and so has a method that calls super()."""
    shape_checker.begin_file()
    with pytest.raises(TypeError) as refused:
        record.Outcome(1, 2, 3)  # pyright: ignore
    assert any("args" in entry.frame.f_locals for entry in refused.traceback)
    assert record.Outcome.__init__.__code__.co_freevars == record.Outcome.__init__.__wrapped__.__code__.co_freevars  # pyright: ignore


def test_each_test_file_checks_its_own_first_calls():
    of_three = norm()
    refused(of_three, np.ones(4), 1000)
    shape_checker.begin_file()
    assert refused(of_three, np.ones(4), 1) == 1


def test_a_function_inside_another_is_counted_over_all_its_definitions():
    shape_checker.begin_file()
    assert sum(refused(norm(), np.ones(4), 1) for _ in range(1024)) == shape_checker.FIRST + np.log2(
        1024 / shape_checker.FIRST
    )


def test_an_error_of_a_checked_function_is_the_error_of_the_function_alone():
    @shape_checker.sampled(typechecker=shape_checker.checked)
    def failing(vector: Float[np.ndarray, "n"]) -> None:
        raise ValueError("its own words")

    with pytest.raises(ValueError, match="own") as refusal:
        failing(np.ones(3))
    assert not getattr(refusal.value, "__notes__", [])
    with pytest.raises(TypeCheckError):
        failing("no array")  # pyright: ignore
