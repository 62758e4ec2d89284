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
        word, pointer = ir.IntType(64), ir.IntType(8).as_pointer()
        kind = ir.FunctionType(word, [pointer, pointer, word, word])
        kernel = builder.inttoptr(arguments[0], kind.as_pointer())
        places = [builder.inttoptr(argument, pointer) for argument in arguments[1:3]]
        return builder.call(kernel, [*places, arguments[3], arguments[4]])

    return signature, generate


@intrinsic
def call_setup(typingctx: Any, address: Any, uniforms: Any) -> Any:
    """Void setup(ptr uniforms), given as 64-bit integers."""
    signature = types.void(types.int64, types.int64)

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        pointer = ir.IntType(8).as_pointer()
        kind = ir.FunctionType(ir.VoidType(), [pointer])
        builder.call(builder.inttoptr(arguments[0], kind.as_pointer()), [builder.inttoptr(arguments[1], pointer)])
        return context.get_dummy_value()

    return signature, generate
