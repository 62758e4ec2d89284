"""From a Lagrangian to expressions: call it once on symbols and split it into inertia, strain and load."""

import difflib
import traceback
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import casadi as ca
import numpy as np

from cayley.density.expression import Expression, cross, from_sx, symbols, to_sx, wrap
from cayley.density.fields import Rotation
from cayley.density.force import Force, ForceError, trace_force
from cayley.density.lagrangian import Lagrangian

PARTS = ("inertia", "strain", "load")


@dataclass(frozen=True, slots=True, kw_only=True)
class Density:
    """A Lagrangian as expressions in the values at one point: L = T − W − U.

    T is what vanishes with the velocities, W the terms with derivatives along the interval, U the rest.

    Args:
        lagrangian: what was traced.
        slots: a column of symbols for every field and derivative ("x", "x_t", "x_s", "p", "p_t", "p_s"); that of a
            rotation itself is the variation ε of p (1 + ε/2), zero at the point.
        frames: a 3×3 matrix of symbols for every rotation.
        places: the coordinate along the interval and the time.
        parameters: the distinct non-zero entries of the constants.
        values: their numbers, shape (len(parameters),).
        names: their names, for listings.
        terms: the additive terms of T, W and U, each a factor and an expression.
        constraints: g, a column; empty where nothing is constrained.
        force: the non-conservative forces, or None.
    """

    lagrangian: Lagrangian
    slots: Mapping[str, Expression]
    frames: Mapping[str, Expression]
    places: Mapping[str, Expression]
    parameters: ca.SX
    values: np.ndarray
    names: tuple[str, ...]
    terms: Mapping[str, tuple[tuple[float, ca.SX], ...]]
    constraints: ca.SX = field(default_factory=lambda: ca.SX(0, 1))
    force: Force | None = None
    _cache: dict = field(default_factory=dict, repr=False)

    def gradient(self, part: str, point: Mapping[str, Any], *, only: str = "all") -> dict[str, Expression]:
        """Derivatives of T, W or U with respect to every slot, left-trivialized for rotations.

        Args:
            part: "inertia", "strain" or "load".
            point: values for the slots, "frame of NAME" for rotations, the coordinate and "t"; absent ones are 0. By
                their names ("c.mass") also constants that have other symbols there.
            only: "all", or, of W: "quotients" (terms of difference quotients alone) or "values" (the others).

        Returns: slot name -> gradient, the shape of the slot.
        """
        key = (part, only)
        if key not in self._cache:
            at_point = ca.vertcat(*[to_sx(slot) for slot in self.slots.values()])
            columns = ca.SX.zeros(at_point.shape)
            for factor, total in self._sums(part, only).items():  # ½(a + a) stays a when the factor comes last
                columns += factor * ca.cse(ca.gradient(total, at_point))
            sizes = np.cumsum([0, *[slot.size for slot in self.slots.values()]])
            self._cache[key] = ca.Function(
                part, [self._inputs()], ca.vertsplit(columns, sizes.tolist()), {"allow_free": True}
            )
        found = self._own_constants(self._cache[key].call([self._at(point)]), point)
        return {name: _column(value) for name, value in zip(self.slots, found, strict=True)}

    def value(self, part: str, point: Mapping[str, Any]) -> ca.SX:
        """Value of T, W or U [J or J/m] at a point (see gradient)."""
        found = ca.substitute([self._total(part)], [self._inputs()], [self._at(point)])
        return self._own_constants(found, point)[0]

    def constraint(self, point: Mapping[str, Any]) -> ca.SX:
        """The constraints g at a point (see gradient), a column."""
        found = ca.substitute([self.constraints], [self._inputs()], [self._at(point)])
        return self._own_constants(found, point)[0]

    def forces(self, place: str, kind: str, point: Mapping[str, Any]) -> dict[str, Expression]:
        """Non-conservative forces f at a point, δW = Σ f·δ(slot); those of a rotation's own slot are body moments.

        Args:
            place: "node", "strain" or "spread".
            kind: "still" or "moving".
            point: see gradient; velocities too, and "rate of SLOT" for derivatives along the interval.

        Returns: slot -> f [N or N m, per length on an interval], of slots on which there is one.
        """
        if self.force is None or (place, kind) not in self.force.terms:
            return {}
        terms, key = self.force.terms[place, kind], ("force", place, kind)
        rates = self.force.rates
        if key not in self._cache:
            inputs = ca.vertcat(self._inputs(), *[to_sx(r) for r in rates.values()])
            found = [ca.cse(value) for value in terms.values()]
            self._cache[key] = ca.Function("force", [inputs], found, {"allow_free": True})
        more = [point.get(f"rate of {name}", np.zeros(r.shape)) for name, r in rates.items()]
        at = ca.vertcat(self._at(point), *[to_sx(np.asarray(v, dtype=object)) for v in more])
        found = self._own_constants(self._cache[key].call([at]), point)
        return {name: _column(value) for name, value in zip(terms, found, strict=True)}

    def depends(self, part: str, *slots: str) -> bool:
        """Tell whether a part depends on any of the slots (a rotation's own slot means its frame)."""
        total = self._total(part)
        return bool(ca.depends_on(total, ca.vertcat(*[to_sx(self.slots[s]) for s in slots])))

    @property
    def signature(self) -> str:
        """Text that determines the density and the names of its constants."""
        if "signature" not in self._cache:
            self._cache["signature"] = self._signature()
        found: str = self._cache["signature"]
        return found

    def _signature(self) -> str:
        inputs = ca.vertcat(self._inputs(), self.parameters)
        parts = [factor * term for part in PARTS for factor, term in (*self.terms[part], (1.0, ca.SX(0)))]
        parts += ca.vertsplit(self.constraints) if self.constraints.numel() else []
        text = ca.Function(self.lagrangian.name, [inputs], parts).serialize() + ",".join(self.names)
        if self.force is None:
            return text
        inputs = ca.vertcat(inputs, *[to_sx(r) for r in self.force.rates.values()])
        return text + ca.Function("force", [inputs], self.force.columns).serialize() + self.force.words

    @property
    def timed(self) -> bool:
        """Whether L depends on the time."""
        total = ca.vertcat(*[term for part in PARTS for _, term in self.terms[part]])
        if self.force is not None:
            total = ca.vertcat(total, *self.force.columns)
        return bool(ca.depends_on(total, to_sx(self.places["t"])))

    @property
    def velocities(self) -> tuple[str, ...]:
        """The velocity slot of every field."""
        return tuple(f"{name}_t" for name in self.lagrangian.fields)

    def _sums(self, part: str, only: str) -> dict[float, ca.SX]:
        totals: dict[float, ca.SX] = {}
        for factor, term in self.terms[part]:
            if only == "all" or (only == "values") == self._varies(term):
                totals[factor] = totals.get(factor, ca.SX(0)) + term
        return totals

    def _total(self, part: str) -> ca.SX:
        return sum((factor * total for factor, total in self._sums(part, "all").items()), start=ca.SX(0))

    def _varies(self, term: ca.SX) -> bool:
        own = [to_sx(self.slots[name]) for name in self.lagrangian.fields]
        coordinate = [to_sx(v) for name, v in self.places.items() if name != "t"]
        frames = [ca.vec(to_sx(f)) for f in self.frames.values()]
        return bool(ca.depends_on(term, ca.vertcat(*own, *coordinate, *frames)))

    def _own_constants(self, found: list[ca.SX], point: Mapping[str, Any]) -> list[ca.SX]:
        """Expressions with the constants that a point gives in place of their symbols."""
        pairs = zip(self.names, ca.vertsplit(self.parameters), strict=True)
        own = [(symbol, ca.SX(to_sx(point[name]))) for name, symbol in pairs if name in point]
        if not own:
            return found
        before, after = zip(*own, strict=True)
        replaced: list[ca.SX] = ca.substitute(found, [ca.vertcat(*before)], [ca.vertcat(*after)])
        return replaced

    def _inputs(self) -> ca.SX:
        flat = [*self.slots.values(), *self.frames.values(), *self.places.values()]
        return ca.vertcat(*[to_sx(v.reshape(-1)) for v in flat])

    def _at(self, point: Mapping[str, Any]) -> ca.SX:
        values = [point.get(name, np.zeros(slot.shape)) for name, slot in self.slots.items()]
        values += [point.get(f"frame of {name}", np.eye(3)) for name in self.frames]
        values += [point.get(name, 0.0) for name in self.places]
        return ca.vertcat(*[to_sx(np.asarray(v, dtype=object).reshape(-1)) for v in values])


def trace(lagrangian: Lagrangian, constants: Mapping[str, Any]) -> Density:
    """Call a Lagrangian once on symbols.

    Args:
        lagrangian: the Lagrangian.
        constants: numbers, vectors and matrices by name; entries that are exactly zero vanish from the expressions,
            a symmetric matrix stays one.

    Returns: the Density.

    Raises:
        ValueError: if the function fails on symbols, names something unknown, ignores a constant or returns no scalar.
        TypeError: if it branches on a symbol.
    """
    where = f"Lagrangian {lagrangian.name}"
    slots: dict[str, Expression] = {}
    frames: dict[str, Expression] = {}
    offered: dict[str, Any] = {}
    along = lagrangian.interval
    for name, kind in lagrangian.fields.items():
        for suffix in ("", "_t") if along is None else ("", "_t", f"_{along}"):
            slots[name + suffix] = symbols(name + suffix, kind.size)
            offered[name + suffix] = slots[name + suffix]
        if isinstance(kind, Rotation):
            frames[name] = symbols(f"{name}_frame", 3, 3)
            offered[name] = RotationSymbol(frames[name], slots[name])
    places = {name: symbols(name) for name in ((along, "t") if along else ("t",))}
    parameters, arrays = _constants({**lagrangian.defaults, **constants}, where)
    q = _Names(offered | places, f"{where}: unknown name q.{{}}")
    c = _Names(arrays, f"{where}: unknown constant c.{{}}")
    value = _call(lagrangian, q, c, where)
    constraints = _constraints(lagrangian, q, c, slots, places)
    force = _force(lagrangian, q, c, slots, offered, places)
    unused = sorted(set(arrays) - c._used)
    if unused:
        raise ValueError(f"{where}: the constant {unused[0]} is given but never used; it uses {_listed(c._used)}")
    terms = _split(value, slots, [f"{n}_t" for n in lagrangian.fields], [f"{n}_{along}" for n in lagrangian.fields])
    return Density(
        lagrangian=lagrangian,
        slots=slots,
        frames=frames,
        places=places,
        parameters=ca.vertcat(*[p for _, p, _ in parameters]),
        values=np.array([v for _, _, v in parameters]),
        names=tuple(n for n, _, _ in parameters),
        terms=terms,
        constraints=constraints,
        force=force,
    )


class RotationSymbol:
    """A rotation in the body of a Lagrangian: rotate, inverse_rotate, matrix, and ``@``.

    It stands for Λ(p) varied to first order, Λ(p (1 + ε/2)) s = Λ(p)(s + ε × s), so gradients are left-trivialized.
    """

    __array_ufunc__ = None  # let RotationSymbol's own operators answer before NumPy's

    def __init__(self, frame: Expression, variation: Expression) -> None:
        """Hold the frame Λ(p) and the variation ε."""
        self._frame, self._variation = frame, variation

    def rotate(self, v: Any) -> Expression:
        """Turn a body vector into space: Λ(p) v."""
        v = wrap(np.asarray(v))
        return self._frame @ (v + cross(self._variation, v))

    def inverse_rotate(self, v: Any) -> Expression:
        """Turn a space vector into the body: Λ(p)ᵀ v."""
        turned = self._frame.T @ wrap(np.asarray(v))
        return turned - cross(self._variation, turned)

    @property
    def matrix(self) -> Expression:
        """The matrix Λ(p), shape (3, 3); its columns are the body's axes in space."""
        return wrap(np.stack([_plain_row(self.rotate(e)) for e in np.eye(3)], axis=1))

    def __matmul__(self, other: Any) -> Expression:
        """Matrix product Λ(p) other."""
        return self.matrix @ other

    def __getitem__(self, key: Any) -> Expression:
        """Index the matrix Λ(p)."""
        return self.matrix[key]

    @property
    def T(self) -> Expression:
        """The transposed matrix, Λ(p)ᵀ."""
        return self.matrix.T

    def __array__(self, dtype: Any = None, copy: Any = None) -> np.ndarray:
        """Convert to the matrix, for NumPy's functions."""
        return self.matrix.view(np.ndarray)


class _Names:
    """Attribute access to a dictionary, with a helpful message for names that are not in it."""

    def __init__(self, values: Mapping[str, Any], message: str) -> None:
        self._values, self._message, self._used = values, message, set[str]()

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        if name not in self._values:
            near = difflib.get_close_matches(name, self._values, n=1)
            hint = f"; did you mean {near[0]}?" if near else ""
            raise ValueError(f"{self._message.format(name)}, there are {_listed(self._values)}{hint}")
        self._used.add(name)
        return self._values[name]


@contextmanager
def _lines_told(function: Any, where: str) -> Iterator[None]:
    """Tell the line of a function in which something goes wrong."""
    try:
        yield
    except ForceError:
        raise
    except Exception as error:
        if str(error).startswith(where.partition(",")[0]):
            raise ValueError(str(error)) from None
        frame = traceback.extract_tb(error.__traceback__)
        file = getattr(getattr(function, "__code__", None), "co_filename", "")
        line = next((f for f in reversed(frame) if f.filename == file), frame[-1])
        raise ValueError(f"{where}: {error}, in line {line.lineno}: {line.line}") from error


def _call(lagrangian: Lagrangian, q: _Names, c: _Names, where: str) -> ca.SX:
    with _lines_told(lagrangian.function, where):
        value = lagrangian.function(q, c)
    shape = np.shape(value) if not isinstance(value, RotationSymbol) else (3, 3)
    if shape not in ((), (1,)) or value is None:
        raise ValueError(f"{where} returns {'None' if value is None else f'shape {shape}'}; it must return one number")
    return ca.SX(to_sx(value))


def _constraints(
    lagrangian: Lagrangian, q: _Names, c: _Names, slots: Mapping[str, Expression], places: Mapping[str, Expression]
) -> ca.SX:
    """The constraint function on symbols, a column; it may not depend on velocities or time.

    Raises:
        ValueError: if it does, or is no number or vector.
    """
    if lagrangian.constraint is None:
        return ca.SX(0, 1)
    where = f"Lagrangian {lagrangian.name}, its constraint"
    value = lagrangian.constraint(q, c)
    if value is None or np.ndim(value) > 1 or np.size(value) == 0:
        raise ValueError(f"{where} is {value!r}; it must return a number or a vector")
    found = ca.densify(ca.vertcat(*[ca.SX(to_sx(e)) for e in np.atleast_1d(value)]))
    for name in (*[f"{n}_t" for n in lagrangian.fields], "t"):
        if ca.depends_on(found, to_sx(slots.get(name, places["t"]))):
            raise ValueError(f"{where} depends on q.{name}; it may depend on fields and their slopes only")
    return found


def _force(
    lagrangian: Lagrangian,
    q: _Names,
    c: _Names,
    slots: Mapping[str, Expression],
    offered: Mapping[str, Any],
    places: Mapping[str, Expression],
) -> Force | None:
    """The force function on symbols, if there is one."""
    if lagrangian.force is None:
        return None
    where = f"Lagrangian {lagrangian.name}, its force"
    rotations = {name: offered[name] for name, kind in lagrangian.fields.items() if isinstance(kind, Rotation)}
    with _lines_told(lagrangian.force, where):
        found = trace_force(
            lagrangian.force,
            q,
            c,
            where,
            fields=tuple(lagrangian.fields),
            slots=slots,
            rotations=rotations,
            places=places,
            along=lagrangian.interval,
        )
    return found if found.terms else None


def _constants(constants: Mapping[str, Any], where: str) -> tuple[list[tuple[str, ca.SX, float]], dict[str, Any]]:
    """Give every distinct non-zero entry of the constants a symbol."""
    parameters: list[tuple[str, ca.SX, float]] = []
    arrays: dict[str, Any] = {}
    for name, given in constants.items():
        try:
            number = np.asarray(given, dtype=float)
        except (TypeError, ValueError):
            raise ValueError(f"{where}: constant {name} is {given!r}; give a number, a vector or a matrix") from None
        if not np.all(np.isfinite(number)):
            raise ValueError(f"{where}: constant {name} has an entry that is not finite: {given!r}")
        entries = np.empty(number.shape, dtype=object)
        symmetric = number.ndim == 2 and number.shape[0] == number.shape[1] and np.array_equal(number, number.T)
        for index in np.ndindex(*number.shape):
            if symmetric and index[0] > index[1]:
                entries[index] = entries[index[::-1]]
            elif number[index] == 0.0:
                entries[index] = ca.SX(0)
            else:
                label = f"c.{name}" + ("[" + ",".join(map(str, index)) + "]" if index else "")
                entries[index] = ca.SX.sym(label)
                parameters.append((label, ca.SX(entries[index]), float(number[index])))
        arrays[name] = wrap(entries)
    return parameters, arrays


def _split(
    value: ca.SX, slots: Mapping[str, Expression], velocities: Iterable[str], gradients: Iterable[str]
) -> dict[str, tuple[tuple[float, ca.SX], ...]]:
    """Sort the additive terms of L into those of T, W and U."""
    v = ca.vertcat(*[to_sx(slots[n]) for n in velocities])
    g = ca.vertcat(*[to_sx(slots[n]) for n in gradients if n in slots])
    parts: dict[str, list[tuple[float, ca.SX]]] = {name: [] for name in PARTS}
    for factor, found in _additive(value):
        term = found
        if ca.depends_on(term, v):
            rest = ca.substitute(term, v, ca.SX.zeros(v.shape))
            parts["inertia"].append((factor, term if rest.is_zero() else term - rest))
            term = rest
        if not term.is_zero():
            parts["strain" if g.numel() and ca.depends_on(term, g) else "load"].append((-factor, term))
    return {name: tuple(terms) for name, terms in parts.items()}


def _additive(value: ca.SX) -> list[tuple[float, ca.SX]]:
    """List the terms of a sum with their constant factors."""
    terms: list[tuple[float, ca.SX]] = []
    stack = [(1.0, value)]
    while stack:
        factor, term = stack.pop()
        if term.is_constant() or term.is_symbolic():
            terms.append((factor, term))
        elif term.is_op(ca.OP_ADD):
            stack += [(factor, term.dep(1)), (factor, term.dep(0))]
        elif term.is_op(ca.OP_SUB):
            stack += [(-factor, term.dep(1)), (factor, term.dep(0))]
        elif term.is_op(ca.OP_NEG):
            stack.append((-factor, term.dep(0)))
        elif term.is_op(ca.OP_TWICE):
            stack.append((2 * factor, term.dep(0)))
        elif term.is_op(ca.OP_MUL) and term.dep(0).is_constant():
            stack.append((factor * float(term.dep(0)), term.dep(1)))
        else:
            terms.append((factor, term))
    return terms


def _column(value: ca.SX) -> Expression:
    return wrap(np.atleast_1d(from_sx(ca.densify(value))))


def _plain_row(value: Expression) -> np.ndarray:
    return value.view(np.ndarray)


def _listed(names: Iterable[str]) -> str:
    return ", ".join(sorted(names)) or "none"
