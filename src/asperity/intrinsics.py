"""Operations of the processor that Python does not have, for compiled loops."""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba.extending import intrinsic

from asperity.compiled import inlined


@inlined
def lowest_bit(bits: Any) -> Any:
    """Position of the lowest bit that is set in a number other than zero."""
    return _trailing_zeros(bits)  # type: ignore[call-arg]


@intrinsic
def _trailing_zeros(typing_context: Any, bits: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.cttz(arguments[0], ir.Constant(ir.IntType(1), 1))

    return bits(bits), generate
