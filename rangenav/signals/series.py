"""Truncated power series: u(t + h) = Σ u_k hᵏ, so the k-th derivative is k! u_k, by arithmetic and not by differences.

A series is a tuple of coefficients (arrays over time, or intervals over stretches of time); those left out are zero, so
a constant has one and t has two, and products of short series are cheap. A function w = f(u) with ẇ = u̇ g grows by
    k w_k = Σ_{j=1..k} j u_j g_{k−j}
one coefficient at a time, whatever g is: w itself for exp, 1 + w² for tan, a series in u for log or atan.
"""

from collections.abc import Callable, Sequence
from typing import Any, TypeAlias

import numpy as np

from rangenav.signals.intervals import ELEMENTARY, Interval
from rangenav.signals.rounded import Rounded

Series: TypeAlias = tuple[Any, ...]
"""Coefficients are floats, arrays, Intervals or Rounded, which have +, −, ×, ÷ in common and no common type."""
Function: TypeAlias = Callable[[Series, int], Series]


def constant(value: float) -> Series:
    """A number of numpy: it becomes infinite where Python's raises, and a later check reports the time."""
    return (np.float64(value),)


def variable(t: Any) -> Series:
    """t itself: t + h."""
    return (t, np.float64(1.0))


def add(a: Series, b: Series) -> Series:
    """a + b."""
    longer, shorter = (a, b) if len(a) >= len(b) else (b, a)
    return (*(x + y for x, y in zip(longer, shorter, strict=False)), *longer[len(shorter) :])


def negative(a: Series) -> Series:
    """−a."""
    return tuple(-x for x in a)


def multiply(a: Series, b: Series, order: int) -> Series:
    """a b, up to hᵒʳᵈᵉʳ."""
    count = min(order + 1, len(a) + len(b) - 1)
    return tuple(_product_term(a, b, k) for k in range(count))


def divide(a: Series, b: Series, order: int) -> Series:
    """a / b; infinite or undefined where b vanishes."""
    if len(b) == 1:
        return tuple(x / b[0] for x in a[: order + 1])
    quotient: list[Any] = []
    for k in range(order + 1):
        rest = a[k] if k < len(a) else 0.0
        for j in range(1, min(k, len(b) - 1) + 1):
            rest = rest - b[j] * quotient[k - j]
        quotient.append(rest / b[0])
    return tuple(quotient)


def integer_power(a: Series, exponent: int, order: int) -> Series:
    """aⁿ by repeated squaring: correct also where a vanishes."""
    if exponent < 0:
        return divide(constant(1.0), integer_power(a, -exponent, order), order)
    result, square = constant(1.0), a
    while exponent:
        if exponent & 1:
            result = multiply(result, square, order)
        exponent >>= 1
        if exponent:
            square = multiply(square, square, order)
    return result


def real_power(a: Series, exponent: float, order: int) -> Series:
    """aᵖ for a > 0: k a₀ w_k = Σ (p j − (k − j)) a_j w_{k−j}."""
    base = a[0]
    power = [elementary("pow", base, exponent)]
    for k in range(1, order + 1 if len(a) > 1 else 1):
        total: Any = 0.0
        for j in range(1, min(k, len(a) - 1) + 1):
            total = total + (exponent * j - (k - j)) * (a[j] * power[k - j])
        power.append(total / (k * base))
    return tuple(power)


def exp(u: Series, order: int) -> Series:
    """eᵘ: g = w."""
    return _grown(elementary("exp", u[0]), u, order, lambda w: w[-1])


def log(u: Series, order: int) -> Series:
    """The natural logarithm: g = 1/u."""
    return _integral("log", u, order, lambda o: divide(constant(1.0), u, o))


def sqrt(u: Series, order: int) -> Series:
    """√u: the power ½."""
    return real_power(u, 0.5, order)


def sin(u: Series, order: int) -> Series:
    """Sine, computed together with the cosine."""
    return _twin("sin", "cos", u, order, (1.0, -1.0))


def cos(u: Series, order: int) -> Series:
    """Cosine."""
    return _twin("cos", "sin", u, order, (-1.0, 1.0))


def sinh(u: Series, order: int) -> Series:
    """Hyperbolic sine, computed together with the hyperbolic cosine."""
    return _twin("sinh", "cosh", u, order, (1.0, 1.0))


def cosh(u: Series, order: int) -> Series:
    """Hyperbolic cosine."""
    return _twin("cosh", "sinh", u, order, (1.0, 1.0))


def tan(u: Series, order: int) -> Series:
    """Tangent: g = 1 + w²."""
    return _grown(elementary("tan", u[0]), u, order, lambda w: _product_term(w, w, len(w) - 1) + (len(w) == 1) * 1.0)


def tanh(u: Series, order: int) -> Series:
    """Hyperbolic tangent: g = 1 − w²."""
    return _grown(elementary("tanh", u[0]), u, order, lambda w: (len(w) == 1) * 1.0 - _product_term(w, w, len(w) - 1))


def asin(u: Series, order: int) -> Series:
    """Arc sine: g = 1/√(1 − u²)."""
    return _integral("asin", u, order, lambda o: _inverse_root(u, o, sign=-1.0, shift=1.0))


def acos(u: Series, order: int) -> Series:
    """Arc cosine: g = −1/√(1 − u²)."""
    return _integral("acos", u, order, lambda o: negative(_inverse_root(u, o, sign=-1.0, shift=1.0)))


def atan(u: Series, order: int) -> Series:
    """Arc tangent: g = 1/(1 + u²)."""
    return _integral("atan", u, order, lambda o: divide(constant(1.0), add(constant(1.0), multiply(u, u, o)), o))


def asinh(u: Series, order: int) -> Series:
    """Inverse hyperbolic sine: g = 1/√(u² + 1)."""
    return _integral("asinh", u, order, lambda o: _inverse_root(u, o, sign=1.0, shift=1.0))


def acosh(u: Series, order: int) -> Series:
    """Inverse hyperbolic cosine: g = 1/√(u² − 1)."""
    return _integral("acosh", u, order, lambda o: _inverse_root(u, o, sign=1.0, shift=-1.0))


def atanh(u: Series, order: int) -> Series:
    """Inverse hyperbolic tangent: g = 1/(1 − u²)."""

    def rest(o: int) -> Series:
        return add(constant(1.0), negative(multiply(u, u, o)))

    return _integral("atanh", u, order, lambda o: divide(constant(1.0), rest(o), o))


FUNCTIONS: dict[str, Function] = {
    f.__name__: f for f in (sin, cos, tan, asin, acos, atan, sinh, cosh, tanh, asinh, acosh, atanh, exp, log, sqrt)
}
"""The functions of one argument that a formula may use."""
_NUMPY = {"asin": "arcsin", "acos": "arccos", "atan": "arctan", "asinh": "arcsinh", "acosh": "arccosh"}
_NUMPY |= {"atanh": "arctanh", "pow": "power"}


def elementary(name: str, *arguments: Any) -> Any:
    """The function's value on numbers, arrays, an interval or a rounded number."""
    if isinstance(arguments[0], Rounded):
        return _rounded(name, *arguments)
    if isinstance(arguments[0], Interval):
        return ELEMENTARY[name](*arguments)
    return getattr(np, _NUMPY.get(name, name))(*arguments)


def _rounded(name: str, u: Rounded, *exponent: float) -> Rounded:
    """f(u) with its rounding: f′ is the second coefficient of the series of f over all that u may be."""
    wide = variable(u.widened)
    series = real_power(wide, exponent[0], 1) if exponent else FUNCTIONS[name](wide, 1)
    return u.mapped(ELEMENTARY[name](u.value, *exponent), series[1])


def _product_term(a: Sequence[Any], b: Sequence[Any], k: int) -> Any:
    total: Any = None
    for i in range(max(0, k - len(b) + 1), min(k, len(a) - 1) + 1):
        term = a[i] * b[k - i]
        total = term if total is None else total + term
    return 0.0 if total is None else total


def _weighted_term(u: Series, g: Sequence[Any], k: int) -> Any:
    """(1/k) Σ j u_j g_{k−j}: the k-th coefficient of the series whose derivative is u̇ g."""
    total: Any = None
    for j in range(max(1, k - len(g) + 1), min(k, len(u) - 1) + 1):
        term = (j / k) * (u[j] * g[k - j])
        total = term if total is None else total + term
    return 0.0 if total is None else total


def _grown(first: Any, u: Series, order: int, rate: Callable[[list[Any]], Any]) -> Series:
    """w with w₀ = first and ẇ = u̇ g, where `rate` gives g's next coefficient from the w known so far."""
    if len(u) == 1:
        return (first,)
    w, g = [first], [rate([first])]
    for k in range(1, order + 1):
        w.append(_weighted_term(u, g, k))
        if k < order:
            g.append(rate(w))
    return tuple(w)


def _integral(name: str, u: Series, order: int, rate: Callable[[int], Series]) -> Series:
    """w with ẇ = u̇ g for a series g in u. At order 0 the series g, which may be infinite, is not computed."""
    first = elementary(name, u[0])
    if len(u) == 1 or order == 0:
        return (first,)
    g = rate(order - 1)
    return (first, *(_weighted_term(u, g, k) for k in range(1, order + 1)))


def _twin(name: str, other: str, u: Series, order: int, signs: tuple[float, float]) -> Series:
    """Two functions, each the other's derivative up to a sign: ẇ = ± u̇ v, v̇ = ± u̇ w."""
    w = [elementary(name, u[0])]
    if order == 0 or len(u) == 1:
        return tuple(w)
    v = [elementary(other, u[0])]
    for k in range(1, order + 1):
        w.append(signs[0] * _weighted_term(u, v, k))
        if k < order:
            v.append(signs[1] * _weighted_term(u, w[:k], k))
    return tuple(w)


def _inverse_root(u: Series, order: int, *, sign: float, shift: float) -> Series:
    """1/√(± u² + shift)."""
    square = multiply(u, u, order)
    return real_power(add(constant(shift), square if sign > 0 else negative(square)), -0.5, order)
