"""Discrete Euler-Lagrange equations of a Lagrangian under a rule, as programs for the compiler."""

import functools
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from typing import Any, TypeVar

from cayley.density import Density
from cayley.discrete.embedded import POINT_PROGRAMS, point_program
from cayley.discrete.forced import ForcedWriter
from cayley.discrete.forcing import force_program
from cayley.discrete.layout import Layout
from cayley.discrete.places import placed, plain
from cayley.discrete.program import Program
from cayley.discrete.representation import REPRESENTATIONS
from cayley.discrete.rows import Rows, assign_rows
from cayley.discrete.rules import Rule
from cayley.discrete.solve import Block
from cayley.discrete.writer import UNIFORMS, Writer

Derived = TypeVar("Derived")


@dataclass(frozen=True, slots=True)
class DiscreteEquations:
    """Discrete Euler-Lagrange equations in position-momentum form; programs are derived when first asked for.

    μ_aʲ + Σ D_(a,j) L_d + h f = 0 gives qʲ⁺¹, and μ_aʲ⁺¹ = Σ D_(a,j+1) L_d.

    Args:
        density: the density they come from.
        rule: the quadrature rule.
        layout: rows of a node.
        rows: rows of a block.
        uniforms: names of the uniform inputs, in order.
        varying: names of inputs that differ from node to node, and NAME@k of what differs within an element (places).

    Source: Leitz, Ober-Blöbaum, Leyendecker (2014), eq. 6; position-momentum form: Marsden and West (2001).
    """

    density: Density
    rule: Rule
    layout: Layout
    rows: Rows
    uniforms: tuple[str, ...]
    varying: frozenset[str]
    _derived: dict[str, Any] = field(default_factory=dict, repr=False)

    def program(self, name: str) -> Program:
        """A program by its name; implicit rules have those of POINT_PROGRAMS.

        With non-conservative forces they have "force_point" and "node_force_point" too (see discrete.forcing).
        """
        if name not in self._derived:
            varying = tuple(n for n in self.density.names if n in self.varying)
            if self.rule.strain.corners and name.startswith(("strain", "force")):
                varying += placed(self.varying)  # both corners are in one evaluation
            if "force_point" in name:
                self._derived[name] = force_program(self.density, self.layout, name, self.rule.strain, varying)
            elif name in POINT_PROGRAMS:
                self._derived[name] = point_program(self.density, self.layout, name, self.rule.strain, varying)
            else:
                self._derived[name] = (ForcedWriter if self.forced else Writer)(self).write(name)
        return self._derived[name]

    def once(self, name: str, make: Callable[[], Derived]) -> Derived:
        """Something else that these equations determine, made when first asked for, and once for all equal ones."""
        if name not in self._derived:
            self._derived[name] = make()
        found: Derived = self._derived[name]
        return found

    @property
    def forced(self) -> bool:
        """Whether an explicit rule takes two sweeps a step and accounts for work (see discrete.forced)."""
        return bool(self.rows.forced)

    @property
    def main_program(self) -> str:
        """Name of the program that does most of the work of a step."""
        if not self.rule.implicit:
            return "step"
        return "strain_point" if self.density.lagrangian.interval else "inertia_point"

    @property
    def blocks(self) -> tuple[Block, ...]:
        """Structure of one node's equations, found from the sparsity of their Jacobian."""
        if "blocks" not in self._derived:
            self._derived["blocks"] = Writer(self).blocks()
        return self._derived["blocks"]

    @property
    def structure(self) -> str:
        """One line on that structure."""
        if self.rule.implicit:
            width = self.layout.dofs * len(self.rule.time.at) * self.rule.degree
            more = self.density.constraints.numel() * len(self.rule.time.at) * self.rule.degree
            unknowns = f"{width} unknowns and {more} multipliers" if more else f"{width} unknowns"
            return f"coupled nodes; {unknowns} {'an element' if more else 'a block'}, block-sparse LU, by Newton"
        words = []
        for block in self.blocks:
            names = ", ".join(self.layout.dof_names[i] for i in block.unknowns)
            words.append(f"{names} {'explicit' if block.linear else 'by Newton'}")
        if self.forced:
            words.append("velocities at steps by a predictor")
        count = self.density.constraints.numel()
        solved = f"; {count} multiplier{'s' * (count > 1)} an element, block-sparse LU, by Newton" if count else ""
        return "decoupled nodes; " + "; ".join(words) + solved

    @property
    def signature(self) -> str:
        """Text that determines every program."""
        if "signature" not in self._derived:
            rule = f"{self.rule!r} {self.layout.representation.name} {sorted(self.varying)}" + " forced" * self.forced
            self._derived["signature"] = f"{rule}\n{self.density.signature}"
        return self._derived["signature"]


def derive(
    density: Density, rule: Rule, *, rotation: str = "quaternion", varying: Iterable[str] = (), account: bool = False
) -> DiscreteEquations:
    """Derive the discrete Euler-Lagrange equations of a density under a rule.

    Args:
        density: traced Lagrangian.
        rule: quadrature rule.
        rotation: "quaternion" or "matrix".
        varying: names of uniform inputs and constants that differ from node to node, and NAME@k of those that differ
            within an element (see discrete.places).
        account: keep account of the work of time-dependent loads, as is done with forces beside the Lagrangian.

    Raises:
        ValueError: if the rotation form is unknown, or velocities are coupled with derivatives along the interval.

    Source: Leitz, Ober-Blöbaum, Leyendecker (2014), eq. 6; position-momentum form: Marsden and West (2001).
    """
    if rotation not in REPRESENTATIONS:
        raise ValueError(f"rotation is {rotation!r}; give one of {', '.join(REPRESENTATIONS)}")
    lagrangian = density.lagrangian
    along = lagrangian.interval
    slopes = [f"{name}_{along}" for name in lagrangian.fields] if along else []
    if rule.strain.screw and along and lagrangian.pose is None:
        raise ValueError(
            f"Lagrangian {lagrangian.name}: the rule {rule} is for a pose; declare one, such as pose=('p', 'x')"
        )
    if slopes and density.depends("inertia", *slopes):
        raise ValueError(
            f"Lagrangian {lagrangian.name}: velocities are coupled with derivatives along {along} in one term, so the "
            f"nodes do not decouple under the rule {rule.name}; no rule couples them there yet, write the term without"
        )
    if density.constraints.numel() and rule.strain.corners:
        raise ValueError(
            f"Lagrangian {lagrangian.name}: the rule {rule}, with its corners in space, is not there for constrained "
            f"densities; use verlet, screw, spectral, midpoint, screw_midpoint or galerkin"
        )
    if density.constraints.numel() and rotation != "quaternion":
        raise ValueError(f"rotation is {rotation!r}, but constrained densities are there for quaternions only, yet")
    layout = Layout(lagrangian.fields, REPRESENTATIONS[rotation])
    candidates = [*UNIFORMS, *(["inverse"] if along else []), *density.names]
    unknown = sorted({plain(name) for name in varying} - set(candidates))
    if unknown:
        raise ValueError(f"varying names {unknown[0]!r}; inputs are {', '.join(candidates)}")
    uniforms = tuple(name for name in candidates if name not in set(varying))
    by_node = [name for name in candidates if name not in uniforms] + list(placed(varying))
    forced = not rule.implicit and (density.force is not None or account)
    rows = assign_rows(layout, by_node, rule.cell, interval=along is not None, forced=forced)
    found = DiscreteEquations(density, rule, layout, rows, uniforms, frozenset(varying))
    return replace(found, _derived=_derived(found.signature))


@functools.lru_cache(maxsize=64)
def _derived(signature: str) -> dict[str, Any]:
    """What was derived from equations of the same text: a model made again, with other numbers, waits for nothing."""
    return {"signature": signature}


__all__ = ["UNIFORMS", "DiscreteEquations", "Rows", "derive"]
