"""Operations of the processor that Python does not have, for compiled loops.

Places in an array are not checked. Comparisons give one bit for each of `BITS` numbers, the lowest for the
first one; they are false where a number is NaN.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import intrinsic

from asperity.compiled import inlined

BITS = 32
"""Numbers that are compared together."""


@inlined
def lowest_bit(bits: Any) -> Any:
    """Position of the lowest bit that is set in a number other than zero."""
    return _trailing_zeros(bits)  # type: ignore[call-arg]


@inlined
def higher(values: Any, place: int, others: Any, other_place: int) -> Any:
    """Where magnitudes from a place on are above those of an array of the same type from its own place on."""
    return _compare_magnitudes(values, place, others, other_place)  # type: ignore[call-arg]


@inlined
def higher_than(values: Any, place: int, floor: float) -> Any:
    """Where magnitudes from a place on are above a number of their precision."""
    return _compare_magnitudes_with(values, place, floor)  # type: ignore[call-arg]


@inlined
def every_second(values: Any, i: int) -> Any:
    """Number i of every second of an array's numbers, in a form that loops on vectors can take."""
    return _even_number(values, i)  # type: ignore[call-arg]


@inlined
def fetch(values: Any, row: int, part: int, column: int) -> None:
    """Have a number of an array of three axes fetched into the cache, without waiting for it."""
    _prefetch(values, row, part, column)  # type: ignore[call-arg]


@intrinsic
def _trailing_zeros(typing_context: Any, bits: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.cttz(arguments[0], ir.Constant(ir.IntType(1), 1))

    return bits(bits), generate


@intrinsic
def _compare_magnitudes(typing_context: Any, values: Any, place: Any, others: Any, other_place: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        first = _magnitudes(context, builder, signature.args[0], *arguments[:2])
        second = _magnitudes(context, builder, signature.args[2], *arguments[2:])
        return builder.bitcast(builder.fcmp_ordered(">", first, second), ir.IntType(BITS))

    return types.uint32(values, types.intp, others, types.intp), generate


@intrinsic
def _compare_magnitudes_with(typing_context: Any, values: Any, place: Any, floor: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        first = _magnitudes(context, builder, signature.args[0], *arguments[:2])
        nothing, integer = ir.Constant(first.type, ir.Undefined), ir.IntType(32)
        single = builder.insert_element(nothing, arguments[2], ir.Constant(integer, 0))
        zeros = ir.Constant(ir.VectorType(integer, BITS), [0] * BITS)
        second = builder.shuffle_vector(single, nothing, zeros)
        return builder.bitcast(builder.fcmp_ordered(">", first, second), ir.IntType(BITS))

    return types.uint32(values, types.intp, values.dtype), generate


@intrinsic
def _even_number(typing_context: Any, values: Any, i: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        data = context.make_array(signature.args[0])(context, builder, arguments[0]).data
        place = builder.mul(arguments[1], ir.Constant(arguments[1].type, 2), flags=["nsw", "nuw"])
        return builder.load(builder.gep(data, [place], inbounds=True))

    return values.dtype(values, types.intp), generate


@intrinsic
def _prefetch(typing_context: Any, values: Any, row: Any, part: Any, column: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        array = context.make_array(signature.args[0])(context, builder, arguments[0])
        byte, integer = ir.IntType(8).as_pointer(), ir.IntType(32)
        address = builder.bitcast(array.data, byte)
        for place, stride in zip(arguments[1:], cgutils.unpack_tuple(builder, array.strides), strict=True):
            address = builder.gep(address, [builder.mul(place, stride)])
        kind = ir.FunctionType(ir.VoidType(), [byte, integer, integer, integer])
        function = cgutils.get_or_insert_function(builder.module, kind, "llvm.prefetch.p0")
        # To read, into the second cache, data.
        builder.call(function, [address, *(ir.Constant(integer, number) for number in (0, 2, 1))])
        return context.get_dummy_value()

    return types.void(values, types.intp, types.intp, types.intp), generate


def _magnitudes(context: Any, builder: Any, array: Any, values: Any, place: Any) -> Any:
    """A vector of the magnitudes of the numbers of a contiguous array from a place on."""
    number = context.get_value_type(array.dtype)
    vector = ir.VectorType(number, BITS)
    data = context.make_array(array)(context, builder, values).data
    start = builder.bitcast(builder.gep(data, [place]), vector.as_pointer())
    name = f"llvm.fabs.v{BITS}f{array.dtype.bitwidth}"
    magnitude = cgutils.get_or_insert_function(builder.module, ir.FunctionType(vector, [vector]), name)
    return builder.call(magnitude, [builder.load(start, align=array.dtype.bitwidth // 8)])
