"""Programs of explicit rules with non-conservative forces (Lagrange-d'Alembert), and the account of their work.

With P the momentum between two steps, F the forces that do not depend on velocities and G(q, v) those that do,

    v* = M⁻¹(P + h/2 (F(qʲ) + G(qʲ, M⁻¹P)))                        (predictor, of error h²)
    P + h (F(qʲ) + G(qʲ, v*)) = −D₀ T_d(qʲ, qʲ⁺¹)  -> qʲ⁺¹,         P = D₁ T_d(qʲ, qʲ⁺¹)

so order 2 is kept and nothing is solved. At a saved frame μ = P + h/2 (F + G(v*)); from it a run goes on with the
velocity M⁻¹μ. Each step adds h F·v* to the work of the forces that are not in the Lagrangian, −h G·v* to the loss.

Source: Marsden and West (2001), section 3.2 (forced discrete mechanics); the predictor is Heun's.
"""

from typing import Any

import casadi as ca

from cayley.density.expression import Expression, symbols, to_sx, wrap, zeros
from cayley.density.force import KINDS, MOVING, STILL, STRAIN
from cayley.discrete.forcing import element_forcing, node_forcing
from cayley.discrete.node import node_point
from cayley.discrete.program import Assign, Program, Step
from cayley.discrete.solve import side_by_side
from cayley.discrete.writer import Writer, where_element

Columns = list[Any]
"""A column for every node of a cell."""


class ForcedWriter(Writer):
    """Writes the programs "predict", "step", "step_held" and "kick" of equations with forces (see rows.forced)."""

    def write(self, name: str) -> Program:
        """Write one program."""
        return self._predict() if name == "predict" else super().write(name)

    def _predict(self) -> Program:
        """Forces at qʲ that do not depend on velocities, and v*."""
        rates, after = self._rates("rate")
        steps, conservative = self._conservative(1.0)
        more, given = self._non_conservative(STILL, rates, after)
        steps += more
        pushed = self._each("pushed", self.layout.dofs)
        own = self._each("still", self.layout.dofs)
        steps.append(Assign(*_pairs(own, [a + b for a, b in zip(given, pushed, strict=True)])))
        total = self._each("total", self.layout.dofs)
        steps.append(Assign(*_pairs(total, [a + b for a, b in zip(conservative, own, strict=True)])))
        more, dragged = self._non_conservative(MOVING, rates, after)
        steps += more
        half = 0.5 * self._place()["h"]
        momenta = [p + half * (f + g) for p, f, g in zip(self.momenta, total, dragged, strict=True)]
        solved, found = self._velocities(self.nodes, momenta, "t", "star")
        stores = [*self._stores("still", own), *self._stores("force", total), *self._stores("predicted", found)]
        stores += self._stores("pushed", [zeros(self.layout.dofs) for _ in self.cell])
        return self._program("predict", [*steps, *solved], stores, [*self._more("pushed", pushed), *self._reads])

    def _step(self, *, held: bool) -> Program:
        """One step of all nodes, and the velocities M⁻¹P after it."""
        steps, kicks, stores = self._kicks()
        given = self._each("given", self.layout.dofs)
        steps.append(Assign(*_pairs(given, [m + k for m, k in zip(self.momenta, kicks, strict=True)])))
        return self._move("step", steps, given, stores, held=held)

    def _drift(self, *, held: bool) -> Program:
        """The same from momenta that forces have been added to."""
        return self._move("drift", [], self.momenta, [], held=held)

    def _move(
        self, name: str, steps: list[Step], given: Columns, stores: list[tuple[int, ca.SX]], *, held: bool
    ) -> Program:
        """From momenta after the kick to the next values, momenta and velocities."""
        pushed = self._each("push", self.layout.dofs)
        scaled = [given[k] * self._weights(k)[1] for k in self.cell]
        steps.append(Assign(*_pairs(pushed, scaled)))
        solutions, ends, momenta = self._moves(given, pushed, held=held)
        steps += side_by_side(solutions)
        after, left = self._each("after", self.layout.rows), self._each("left_over", self.layout.dofs)
        steps.append(Assign(*_pairs([*after, *left], [*ends, *momenta])))
        solved, found = self._velocities(after, left, "t_next", "v_next")
        stores += [*self._at(self.rows.values, after), *self._at(self.rows.momenta, left), *self._stores("rate", found)]
        return self._program(name + "_held" * held, [*steps, *solved], stores, self._reads)

    def _kick(self) -> Program:
        """Add h × forces to the momenta."""
        steps, kicks, stores = self._kicks()
        left = self._each("left_over", self.layout.dofs)
        steps.append(Assign(*_pairs(left, [m + k for m, k in zip(self.momenta, kicks, strict=True)])))
        solved, found = self._velocities(self.nodes, left, "t", "v_next")
        stores += [*self._at(self.rows.momenta, left), *self._stores("rate", found)]
        return self._program("kick", [*steps, *solved], stores, self._reads)

    def _observe_element(self) -> tuple[ca.SX, dict[str, Expression]]:
        """As without forces; those on the two nodes with stresses that the Lagrangian has not, at velocities v*."""
        energy, outputs = super()._observe_element()
        force, length = self.density.force, wrap(self.symbol["length"])
        rates, after = self._rates("predicted")
        for kind in KINDS:
            if force is not None and force.between_nodes(kind):
                points, place, both = self.rule.strain, self._place(), [*rates, after]
                ends = [self.nodes[0], self.next]
                found = element_forcing(self.density, points, self.layout, ends, both, place, kind, where=(STRAIN,))
                for name, more in zip(("left", "right"), found, strict=True):
                    outputs[name] = wrap(outputs[name] + where_element(length, more * length))
        return energy, outputs

    def _kicks(self) -> tuple[list[Step], Columns, list[tuple[int, ca.SX]]]:
        """Steps that find h × all forces with velocities v*, these, and what is stored of their work."""
        rates, after = self._rates("predicted")
        steps, dragged = self._non_conservative(MOVING, rates, after)
        drag, total = self._each("drag", self.layout.dofs), self._each("force", self.layout.dofs)
        steps.append(Assign(*_pairs(drag, dragged)))
        still, account = self._each("still", self.layout.dofs), symbols("account", 2)
        self._reads = [*self._reads, *self._more("force", total), *self._more("still", still)]
        self._reads += self._more("account", [account])
        h = self._place()["h"]
        powers = [sum(_dot(f, v) for f, v in zip(forces, rates, strict=True)) for forces in (still, drag)]
        booked = wrap(to_sx(account) + to_sx(h) * ca.vertcat(powers[0], -powers[1]))
        kicks = [h * (f + g) for f, g in zip(total, drag, strict=True)]
        return steps, kicks, self._stores("account", [booked])

    def _rates(self, name: str) -> tuple[Columns, Expression]:
        """Velocities of the nodes of a cell and of the first of the next, stored under a name."""
        rates, after = self._each("v", self.layout.dofs), symbols("v_after", self.layout.dofs)
        first = self.rows.forced[name].start
        rows = range(first, first + self.layout.dofs)
        self._reads = [*self._more(name, rates), *[(s, i, 1) for s, i in zip(_list(after), rows, strict=True)]]
        return rates, after

    def _non_conservative(self, kind: str, rates: Columns, after: Expression) -> tuple[list[Step], Columns]:
        """Steps that find the non-conservative forces of a kind on the nodes, and these."""
        force = self.density.force
        own = [
            node_forcing(self.density, self.layout, self.nodes[k], rates[k], self._place(k), kind) * self._weights(k)[0]
            for k in self.cell
        ]
        if force is None or not force.between_nodes(kind):
            return [], own
        points, ends = self.rule.strain, [*self.nodes, self.next]
        forces = element_forcing(self.density, points, self.layout, ends, [*rates, after], self._place(), kind)
        steps, pulls, mask = self._from_elements(forces, 1.0, self.rows.forced[f"carried {kind}"], f"{kind}_")
        return steps, [f + pull * mask for f, pull in zip(own, pulls, strict=True)]

    def _velocities(self, nodes: Columns, momenta: Columns, time: str, label: str) -> tuple[list[Step], Columns]:
        """Steps that find M⁻¹ of momenta where a degree of freedom is free, zero elsewhere."""
        solutions, found = [], []
        for k in self.cell:
            point = node_point(self.layout, nodes[k], self.density.lagrangian.interval, self._place(k))
            point["t"] = self._place(k)[time]
            steps, velocity, _ = self.velocity_of(k, point, momenta[k] * self._weights(k)[1], f"{label}{k or ''}")
            solutions.append(steps)
            found.append(velocity)
        return side_by_side(solutions), found

    def _more(self, name: str, values: Columns) -> list[tuple[ca.SX, int, int]]:
        rows = self.rows.forced[name]
        entries = [e for value in values for e in _list(value)]
        return [(s, i, 0) for s, i in zip(entries, range(rows.start, rows.stop), strict=True)]

    def _stores(self, name: str, values: Columns) -> list[tuple[int, ca.SX]]:
        return self._at(self.rows.forced[name], values)

    def _at(self, rows: slice, values: Columns) -> list[tuple[int, ca.SX]]:
        entries = [e for value in values for e in _list(value)]
        return list(zip(range(rows.start, rows.stop), entries, strict=True))


def _pairs(targets: Columns, values: Columns) -> tuple[tuple[ca.SX, ...], tuple[ca.SX, ...]]:
    """Entries of columns of symbols and of values."""
    return tuple(e for t in targets for e in _list(t)), tuple(e for v in values for e in _list(v))


def _dot(a: Expression, b: Expression) -> ca.SX:
    return ca.dot(to_sx(a), to_sx(b))


def _list(value: Expression) -> list[ca.SX]:
    return ca.vertsplit(to_sx(value))


__all__ = ["ForcedWriter"]
