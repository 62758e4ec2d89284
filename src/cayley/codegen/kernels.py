"""Compiled kernels of discrete equations: addresses for the drivers, a listing for people."""

import ctypes
import functools
import hashlib
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np

from cayley.codegen import jit
from cayley.codegen.listing import print_listing
from cayley.codegen.llvm import print_ir
from cayley.discrete.equations import DiscreteEquations
from cayley.discrete.program import Program


class Kernel(NamedTuple):
    """Addresses of the three functions of a compiled program (see print_ir), the width already asked for.

    Args:
        run: i64 run(ptr data, ptr uniforms, i64 first, i64 last).
        setup: void setup(ptr uniforms).
        width: length of the uniforms.
    """

    run: int
    setup: int
    width: int

    def __call__(self, data: np.ndarray, uniforms: np.ndarray, first: int, last: int) -> int:
        """Set up and run on blocks first ... last − 1; returns the number of blocks that did not converge."""
        ctypes.CFUNCTYPE(None, ctypes.c_int64)(self.setup)(uniforms.ctypes.data)
        run = ctypes.CFUNCTYPE(ctypes.c_int64, *[ctypes.c_int64] * 4)(self.run)
        return run(data.ctypes.data, uniforms.ctypes.data, first, last)


@dataclass(frozen=True, slots=True)
class Kernels:
    """Machine code for discrete equations, compiled when first asked for.

    Args:
        equations: what was compiled.
        lanes: doubles in a vector.
    """

    equations: DiscreteEquations
    lanes: int = field(default_factory=jit.lanes)
    _found: dict[str, Kernel] = field(default_factory=dict, repr=False)

    def __getitem__(self, name: str) -> Kernel:
        """The kernel "step", "step_held", "kick" or "observe"."""
        if name not in self._found:
            self._found[name] = compiled(self.equations.program(name), self.lanes, self.equations.signature)
        return self._found[name]

    def ir(self, name: str) -> str:
        """LLVM IR of a kernel."""
        return print_ir(self.equations.program(name), self.lanes)

    def __str__(self) -> str:
        """List the kernel that does most of the work as formulas."""
        return print_listing(self.equations.program(self.equations.main_program), self.lanes)


def compiled(program: Program, lanes: int, signature: str = "") -> Kernel:
    """Machine code of a program by itself; name and signature must determine it, with the sources of this package.

    A process loads it once, if there is a signature.
    """
    if (signature, program.name, lanes) in _LOADED:
        return _LOADED[signature, program.name, lanes]
    names = (program.name, f"{program.name}_setup", f"{program.name}_width")
    key = "\n".join([signature, str(lanes), sources_digest()])
    (run, setup, width), _ = jit.load(names, functools.partial(print_ir, program, lanes), key)
    found = Kernel(run, setup, ctypes.CFUNCTYPE(ctypes.c_int64)(width)())
    if signature:
        _LOADED[signature, program.name, lanes] = found
    return found


_LOADED: dict[tuple[str, str, int], Kernel] = {}
"""Kernels that this process has loaded; their code lives as long as it does anyway."""


def lanes_for(cell: int, cells: int) -> int:
    """Doubles in a vector for a number of cells of so many nodes.

    Those of one node take the widest vectors; longer cells, whose lanes are dear, no more lanes than they fill.
    """
    lanes = jit.lanes()
    while cell > 1 and lanes > 2 and lanes // 2 >= cells:
        lanes //= 2
    return lanes


@functools.cache
def sources_digest() -> str:
    """Hash of the sources that decide what code comes out."""
    root = Path(__file__).parents[1]
    digest = hashlib.sha256()
    for folder in ("lie", "density", "discrete", "codegen"):
        for path in sorted((root / folder).glob("*.py")):
            digest.update(path.name.encode() + path.read_bytes())
    return digest.hexdigest()
