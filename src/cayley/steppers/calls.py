"""Call compiled kernels by their address from Numba code."""

from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic


@intrinsic
def call_kernel(typingctx: Any, address: Any, data: Any, uniforms: Any, first: Any, last: Any) -> Any:
    """i64 kernel(ptr data, ptr uniforms, i64 first, i64 last), all given as 64-bit integers.

    The address is an argument, not a constant, so a driver that calls kernels can itself be cached on disk.
    """
    signature = types.int64(types.int64, types.int64, types.int64, types.int64, types.int64)

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        word = ir.IntType(64)
        kind = ir.FunctionType(word, [word] * 4)
        return builder.call(builder.inttoptr(arguments[0], kind.as_pointer()), arguments[1:])

    return signature, generate


@intrinsic
def call_setup(typingctx: Any, address: Any, uniforms: Any) -> Any:
    """Void setup(ptr uniforms), given as 64-bit integers."""
    signature = types.void(types.int64, types.int64)

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        kind = ir.FunctionType(ir.VoidType(), [ir.IntType(64)])
        builder.call(builder.inttoptr(arguments[0], kind.as_pointer()), arguments[1:])
        return context.get_dummy_value()

    return signature, generate
