"""A vector of numbers as one value in a kernel: a formula for one run is compiled for several runs side by side, too.

    vector + vector, number · vector, √vector, …   the operation in each lane, to the last bit that of one number
    at(array, k, lanes)[i]                         array[k + lanes · i], …, array[k + lanes · i + lanes − 1]

A loop over lanes becomes vector code only if the compiler sees through it; this type is vector code in every case.
"""

import importlib
import operator
from collections.abc import Callable
from typing import Any

import numpy as np
from llvmlite import ir
from numba.core import types

extending: Any = importlib.import_module("numba.extending")
datamodel: Any = importlib.import_module("numba.core.datamodel")
templates: Any = importlib.import_module("numba.core.typing.templates")
typeconv: Any = importlib.import_module("numba.core.typeconv")
cgutils: Any = importlib.import_module("numba.core.cgutils")
NUMBER, PLACE, FLAG = ir.DoubleType(), ir.IntType(32), ir.IntType(1)


class Lanes(types.Type):
    """Something of each lane."""

    def __init__(self, lanes: int) -> None:
        self.lanes = lanes
        super().__init__(f"{type(self).__name__.lower()} of {lanes}")


class Vector(Lanes):
    """A number in each lane."""

    def can_convert_from(self, typingctx: Any, other: Any) -> Any:  # the compiler's name
        """A number becomes a vector of equal numbers where one is needed."""
        return typeconv.Conversion.safe if isinstance(other, types.Float | types.Integer) else None


class Mask(Lanes):
    """What a comparison of vectors gives: a truth value in each lane."""


class Places(Lanes):
    """Vectors that stand one after the other in an array."""


@datamodel.register_default(Vector)
class _VectorModel(datamodel.PrimitiveModel):
    def __init__(self, dmm: Any, fe_type: Any) -> None:
        super().__init__(dmm, fe_type, ir.VectorType(NUMBER, fe_type.lanes))


@datamodel.register_default(Mask)
class _MaskModel(datamodel.PrimitiveModel):
    def __init__(self, dmm: Any, fe_type: Any) -> None:
        super().__init__(dmm, fe_type, ir.VectorType(FLAG, fe_type.lanes))


@datamodel.register_default(Places)
class _PlacesModel(datamodel.PrimitiveModel):
    def __init__(self, dmm: Any, fe_type: Any) -> None:
        super().__init__(dmm, fe_type, NUMBER.as_pointer())


def _defined(operation: Any, count: int, generated: Callable[..., Any], result: type[Lanes] = Vector) -> None:
    """Define an operation of `count` vectors, some of which may be numbers; generated(builder, values) is its code."""

    class _Template(templates.AbstractTemplate):
        key = operation

        def generic(self, args: Any, kws: Any) -> Any:
            vectors = {kind for kind in args if isinstance(kind, Vector)}
            fits = all(isinstance(kind, Vector | types.Float | types.Integer) for kind in args)
            if len(args) != count or not fits or len(vectors) != 1:
                return None
            (vector,) = vectors
            return templates.signature(result(vector.lanes), *[vector] * count)

    templates.builtin_registry.register_global(operation, types.Function(_Template))
    extending.lower_builtin(operation, *[Vector] * count)(
        lambda context, builder, signature, args: generated(builder, args)
    )


def _instruction(name: str) -> Callable[..., Any]:
    return lambda builder, values: getattr(builder, name)(*values)


def _comparison(sign: str) -> Callable[..., Any]:
    return lambda builder, values: builder.fcmp_ordered(sign, *values)


def _whole(name: str) -> Callable[..., Any]:
    """A function that the processor has for vectors, and computes as for a number."""

    def generated(builder: Any, values: Any) -> Any:
        kind = values[0].type
        called = ir.FunctionType(kind, [kind] * len(values))
        return builder.call(cgutils.get_or_insert_function(builder.module, called, f"{name}.v{kind.count}f64"), values)

    return generated


def _by_lane(name: str) -> Callable[..., Any]:
    """A function of a library, called once for each lane."""

    def generated(builder: Any, values: Any) -> Any:
        function, result = builder.module.declare_intrinsic(name, [NUMBER]), ir.Constant(values[0].type, ir.Undefined)
        for lane in range(values[0].type.count):
            place = ir.Constant(PLACE, lane)
            value = builder.call(function, [builder.extract_element(vector, place) for vector in values])
            result = builder.insert_element(result, value, place)
        return result

    return generated


for names, code in (
    ((operator.add, operator.iadd), "fadd"),
    ((operator.sub, operator.isub), "fsub"),
    ((operator.mul, operator.imul), "fmul"),
    ((operator.truediv, operator.itruediv), "fdiv"),
):
    for name in names:
        _defined(name, 2, _instruction(code))
_defined(operator.neg, 1, _instruction("fneg"))
_defined(operator.lt, 2, _comparison("<"), Mask)
_defined(operator.gt, 2, _comparison(">"), Mask)
_defined(np.sqrt, 1, _whole("llvm.sqrt"))
_defined(abs, 1, _whole("llvm.fabs"))
_defined(np.exp, 1, _by_lane("llvm.exp"))
_defined(np.sin, 1, _by_lane("llvm.sin"))
_defined(operator.pow, 2, _by_lane("llvm.pow"))


@extending.lower_cast(types.Float, Vector)
@extending.lower_cast(types.Integer, Vector)
def _equal(context: Any, builder: Any, fromty: Any, toty: Any, value: Any) -> Any:
    number = context.cast(builder, value, fromty, types.float64)
    undefined = ir.Constant(ir.VectorType(NUMBER, toty.lanes), ir.Undefined)
    one = builder.insert_element(undefined, number, ir.Constant(PLACE, 0))
    return builder.shuffle_vector(one, one, ir.Constant(ir.VectorType(PLACE, toty.lanes), [0] * toty.lanes))


@extending.intrinsic(prefer_literal=True)
def at(typingctx, array, k, lanes):
    """The vectors in a contiguous array from its place k on; lanes must be a constant."""

    def generate(context, builder, signature, args):
        values = context.make_array(signature.args[0])(context, builder, args[0])
        return builder.gep(values.data, [args[1]])

    return Places(lanes.literal_value)(array, types.intp, lanes), generate


@templates.infer_global(operator.getitem)
class _Get(templates.AbstractTemplate):
    def generic(self, args: Any, kws: Any) -> Any:
        here = isinstance(args[0], Places)
        return templates.signature(Vector(args[0].lanes), args[0], types.intp) if here else None


@templates.infer_global(operator.setitem)
class _Set(templates.AbstractTemplate):
    def generic(self, args: Any, kws: Any) -> Any:
        here = isinstance(args[0], Places)
        return templates.signature(types.none, args[0], types.intp, Vector(args[0].lanes)) if here else None


def _pointer(builder: Any, signature: Any, args: Any) -> Any:
    lanes = signature.args[0].lanes
    first = builder.gep(args[0], [builder.mul(args[1], ir.Constant(args[1].type, lanes))])
    return builder.bitcast(first, ir.VectorType(NUMBER, lanes).as_pointer())


@extending.lower_builtin(operator.getitem, Places, types.Integer)
def _get(context: Any, builder: Any, signature: Any, args: Any) -> Any:
    return builder.load(_pointer(builder, signature, args), align=8)


@extending.lower_builtin(operator.setitem, Places, types.Integer, Vector)
def _set(context: Any, builder: Any, signature: Any, args: Any) -> Any:
    builder.store(args[2], _pointer(builder, signature, args), align=8)
    return context.get_dummy_value()


@extending.intrinsic
def written_soon(typingctx, array, k):
    """Have the line of the cache fetched that holds place k of a contiguous array, or lies behind its end."""

    def generate(context, builder, signature, args):
        values, byte = context.make_array(signature.args[0])(context, builder, args[0]), ir.IntType(8).as_pointer()
        kind = ir.FunctionType(ir.VoidType(), [byte, PLACE, PLACE, PLACE])
        fetch = cgutils.get_or_insert_function(builder.module, kind, f"llvm.prefetch.{byte.intrinsic_name}")
        line = builder.bitcast(builder.gep(values.data, [args[1]]), byte)
        builder.call(fetch, [line, *(ir.Constant(PLACE, number) for number in (1, 3, 1))])  # to write; near; data
        return context.get_dummy_value()

    return types.none(array, types.intp), generate


@extending.intrinsic
def mostly(typingctx, condition):
    """A condition that mostly holds: what is computed where it does not is kept out of the way of all else."""

    def generate(context, builder, signature, args):
        kind = ir.FunctionType(FLAG, [FLAG, FLAG])
        expected = cgutils.get_or_insert_function(builder.module, kind, "llvm.expect.i1")
        return builder.call(expected, [args[0], ir.Constant(FLAG, 1)])

    return types.boolean(types.boolean), generate


@extending.intrinsic
def _first(typingctx, vector):
    first = ir.Constant(PLACE, 0)
    return types.float64(vector), lambda context, builder, signature, args: builder.extract_element(args[0], first)


@extending.intrinsic
def _all(typingctx, mask):
    def generate(context, builder, signature, args):
        bits = builder.bitcast(args[0], ir.IntType(signature.args[0].lanes))
        return builder.icmp_unsigned("==", bits, ir.Constant(bits.type, -1))

    return types.boolean(mask), generate


@extending.intrinsic
def _select(typingctx, mask, yes, no):
    vector = Vector(mask.lanes)
    return vector(mask, vector, vector), lambda context, builder, signature, args: builder.select(*args)


def shared(value: Any) -> Any:
    """The number that all lanes have in common: the first; of a number, itself."""
    return value


def everywhere(condition: Any) -> Any:
    """Whether a condition holds in every lane."""
    return condition


def choose(condition: Any, yes: Any, no: Any) -> Any:
    """One of two values, in each lane by itself."""
    return yes if condition else no


@extending.overload(shared)
def _shared(value):
    return (lambda value: _first(value)) if isinstance(value, Vector) else (lambda value: value)


@extending.overload(everywhere)
def _everywhere(condition):
    return (lambda condition: _all(condition)) if isinstance(condition, Mask) else (lambda condition: condition)


@extending.overload(choose)
def _choose(condition, yes, no):
    if isinstance(condition, Mask):
        return lambda condition, yes, no: _select(condition, yes, no)
    return lambda condition, yes, no: yes if condition else no
