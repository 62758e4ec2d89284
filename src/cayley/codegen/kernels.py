"""Compiled kernels of discrete equations: addresses for the drivers, a listing for people."""

import functools
import hashlib
from dataclasses import dataclass, field
from pathlib import Path

import cayley
from cayley.codegen import jit
from cayley.codegen.llvm import print_ir
from cayley.codegen.listing import print_listing
from cayley.discrete.equations import DiscreteEquations


@dataclass(frozen=True, slots=True)
class Kernels:
    """Machine code for discrete equations, compiled when first asked for.

    Args:
        equations: what was compiled.
        lanes: doubles in a vector.
    """

    equations: DiscreteEquations
    lanes: int = field(default_factory=jit.lanes)
    _addresses: dict[str, int] = field(default_factory=dict, repr=False)

    def address(self, name: str) -> int:
        """Address of the kernel of that name: i64 kernel(ptr data, ptr uniforms, i64 first, i64 last)."""
        if name not in self._addresses:
            key = "\n".join([self.equations.signature, str(self.lanes), sources_digest()])
            ir = functools.partial(self.ir, name)
            self._addresses[name], _ = jit.load(name, ir, key)
        return self._addresses[name]

    def ir(self, name: str) -> str:
        """LLVM IR of a kernel."""
        return print_ir(self.equations.program(name), self.lanes)

    def __str__(self) -> str:
        """List the step kernel as formulas."""
        return print_listing(self.equations.program("step"), self.lanes)


@functools.cache
def sources_digest() -> str:
    """Hash of the sources that decide what code comes out."""
    root = Path(cayley.__file__).parent
    digest = hashlib.sha256()
    for folder in ("lie", "density", "discrete", "codegen"):
        for path in sorted((root / folder).glob("*.py")):
            digest.update(path.name.encode() + path.read_bytes())
    return digest.hexdigest()
