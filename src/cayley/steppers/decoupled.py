"""Call the compiled time loop of decoupled rules (codegen.driver)."""

import ctypes
import functools
from typing import Any

import numpy as np

from cayley.codegen import jit
from cayley.codegen.abi import ARGUMENTS
from cayley.codegen.kernels import sources_digest


def advance(arguments: dict[str, int | np.ndarray]) -> int:
    """Run the driver.

    Args:
        arguments: a number, or an array whose address is passed, for each name in codegen.driver.ARGUMENTS.

    Returns: the save in which a kernel failed, or −1.
    """
    failed = np.array([-1])
    passed = arguments | {"failed": failed}
    values = [passed[name] for name in ARGUMENTS]
    words = [value.ctypes.data if isinstance(value, np.ndarray) else int(value) for value in values]
    block = (ctypes.c_int64 * len(words))(*words)
    _driver()(ctypes.addressof(block))
    return int(failed[0])


@functools.cache
def _driver() -> Any:
    """The driver, compiled once for a machine."""

    def text() -> str:
        from cayley.codegen.driver import print_driver  # its IR builder is slow to import, and seldom needed

        return print_driver()

    (address,), _ = jit.load(("advance",), text, sources_digest())
    return ctypes.CFUNCTYPE(None, ctypes.c_int64)(address)
