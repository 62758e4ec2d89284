"""Print a program as LLVM IR: a loop over blocks of lanes, one vector instruction for every operation."""

import struct
from collections.abc import Sequence

import casadi as ca

from cayley.codegen.operations import ARITHMETIC, COMPARISONS, FAST, INTRINSICS, LIBRARY
from cayley.codegen.tape import record
from cayley.discrete.program import Assign, Carry, Newton, Program

ITERATIONS = 12
"""Newton passes before a lane counts as failed."""


class Value(str):
    """Name of an SSA value; uniform ones are scalars that the setup computes."""

    uniform: bool

    def __new__(cls, name: str, *, uniform: bool = False) -> "Value":
        """Make a name."""
        value = super().__new__(cls, name)
        value.uniform = uniform
        return value


def print_ir(program: Program, lanes: int) -> str:
    """LLVM IR of a program: three functions.

    - void name_setup(ptr uniforms): from the uniform inputs, everything that is equal for all nodes; it writes behind
      the inputs. Call it when they have changed.
    - i64 name_width(): how many doubles that needs in all.
    - i64 name(ptr blocks, ptr uniforms, i64 first, i64 last): works on blocks first ... last − 1 of a
      (blocks, rows, lanes) array and returns the number of blocks in which a lane did not converge.

    Args:
        program: what to compute.
        lanes: width of a vector.

    Returns: the text of a module.
    """
    return _Printer(program, lanes).module()


class _Printer:
    """State of the text while it is written: lines before the loop and in it, and the value of every symbol."""

    def __init__(self, program: Program, lanes: int) -> None:
        self.program, self.lanes = program, lanes
        self.type = f"<{lanes} x double>"
        self.setup: list[str] = []  # uniform operations
        self.before: list[str] = []  # what the kernel reads of them before its loop
        self.body: list[str] = []
        self.values: dict[str, Value] = {}
        self.declared: set[str] = set()
        self.broadcasts: dict[str, Value] = {}
        self.width = len(program.uniforms)
        self.count = 0
        self.label = "blocks"  # the basic block now written
        self.failures = "%failed"
        self.uniform_rows = {s.name(): i for i, s in enumerate(program.uniforms)}
        self.lane_rows = {s.name(): (row, shift) for s, row, shift in program.lanes}

    def module(self) -> str:
        """Write the whole module."""
        for step in self.program.steps:
            if isinstance(step, Assign):
                self._assign([s.name() for s in step.targets], step.values)
            elif isinstance(step, Carry):
                self._carry(step)
            else:
                self._newton(step)
        self._store()
        rows = self.program.rows * self.lanes
        name = self.program.name
        head = [
            f"define void @{name}_setup(ptr noalias %uniforms) {{",
            *self.setup,
            "  ret void",
            "}",
            f"define i64 @{name}_width() {{",
            f"  ret i64 {self.width}",
            "}",
            f"define i64 @{name}(ptr noalias %data, ptr noalias %uniforms, i64 %first, i64 %last) {{",
            "entry:",
            *self.before,
            "  %some = icmp slt i64 %first, %last",
            "  br i1 %some, label %blocks, label %end",
            "blocks:",
            f"  %block = phi i64 [ %first, %entry ], [ %block.next, %{self.label} ]",
            f"  %failed = phi i64 [ 0, %entry ], [ {self.failures}, %{self.label} ]",
            f"  %offset = mul nsw i64 %block, {rows}",
            "  %base = getelementptr double, ptr %data, i64 %offset",
        ]
        tail = [
            "  %block.next = add nsw i64 %block, 1",
            "  %more = icmp slt i64 %block.next, %last",
            "  br i1 %more, label %blocks, label %end",
            "end:",
            f"  %result = phi i64 [ 0, %entry ], [ {self.failures}, %{self.label} ]",
            "  ret i64 %result",
            "}",
        ]
        return "\n".join([*head, *self.body, *tail, *sorted(self.declared), ""])

    def _new(self, *, uniform: bool = False) -> Value:
        self.count += 1
        return Value(f"%{'u' if uniform else 'v'}{self.count}", uniform=uniform)

    def _emit(self, text: str, *, uniform: bool = False) -> Value:
        """Write one instruction that has a value."""
        value = self._new(uniform=uniform)
        (self.setup if uniform else self.body).append(f"  {value} = {text}")
        return value

    def _vector(self, value: Value) -> Value:
        """The value as a vector; a uniform one is stored by the setup and spread before the loop."""
        if not value.uniform:
            return value
        if value not in self.broadcasts:
            if value.startswith("0x"):
                entries = ", ".join([f"double {value}"] * self.lanes)
                self.broadcasts[value] = Value(f"<{entries}>")
                return self.broadcasts[value]
            place, self.width = self.width, self.width + 1
            n = self.count = self.count + 1
            self.setup += [f"  %s{n} = {_pointer('%uniforms', place)}", f"  store double {value}, ptr %s{n}"]
            zeros = f"<{self.lanes} x i32> zeroinitializer"
            self.before += [
                f"  %p{n} = {_pointer('%uniforms', place)}",
                f"  %u{n} = load double, ptr %p{n}",
                f"  %i{n} = insertelement {self.type} poison, double %u{n}, i32 0",
                f"  %b{n} = shufflevector {self.type} %i{n}, {self.type} poison, {zeros}",
            ]
            self.broadcasts[value] = Value(f"%b{n}")
        return self.broadcasts[value]

    def _symbol(self, name: str) -> Value:
        """The value of a symbol; inputs are read at their first use."""
        if name not in self.values:
            if name in self.uniform_rows:
                pointer = self._emit(_pointer("%uniforms", self.uniform_rows[name]), uniform=True)
                self.values[name] = self._emit(f"load double, ptr {pointer}", uniform=True)
            else:
                row, shift = self.lane_rows[name]
                self.values[name] = self._load(row) if shift == 0 else self._shifted(row)
        return self.values[name]

    def _load(self, row: int) -> Value:
        pointer = self._emit(_pointer("%base", row * self.lanes))
        return self._emit(f"load {self.type}, ptr {pointer}, align {8 * self.lanes}")

    def _shifted(self, row: int) -> Value:
        """Values of the next node: lanes 1, 2, ... and the first of the next block."""
        own = next((v for n, v in self.values.items() if self.lane_rows.get(n) == (row, 0)), None) or self._load(row)
        pointer = self._emit(_pointer("%base", (self.program.rows + row) * self.lanes))
        following = self._emit(f"load double, ptr {pointer}, align {8 * self.lanes}")
        spread = self._emit(f"insertelement {self.type} poison, double {following}, i32 0")
        order = ", ".join(f"i32 {i}" for i in range(1, self.lanes + 1))
        return self._emit(f"shufflevector {self.type} {own}, {self.type} {spread}, <{self.lanes} x i32> <{order}>")

    def _carry(self, step: Carry) -> None:
        order = ", ".join(f"i32 {i}" for i in (self.lanes, *range(self.lanes - 1)))
        for target, source, row in zip(step.targets, step.sources, step.rows, strict=True):
            own = self._vector(self._symbol(source.name()))
            behind = (row - self.program.rows) * self.lanes + self.lanes - 1
            pointer = self._emit(_pointer("%base", behind))
            last = self._emit(f"load double, ptr {pointer}")
            spread = self._emit(f"insertelement {self.type} poison, double {last}, i32 0")
            mask = f"<{self.lanes} x i32> <{order}>"
            self.values[target.name()] = self._emit(f"shufflevector {self.type} {own}, {self.type} {spread}, {mask}")
            self._write(row, own)

    def _write(self, row: int, value: Value) -> None:
        pointer = self._emit(_pointer("%base", row * self.lanes))
        self.body.append(f"  store {self.type} {self._vector(value)}, ptr {pointer}, align {8 * self.lanes}")

    def _assign(self, targets: Sequence[str], values: Sequence[ca.SX]) -> None:
        for name, value in zip(targets, self._evaluate(values), strict=True):
            self.values[name] = value

    def _store(self) -> None:
        found = self._evaluate([value for _, value in self.program.stores])
        for (row, _), value in zip(self.program.stores, found, strict=True):
            self._write(row, value)

    def _newton(self, step: Newton) -> None:
        """A loop that iterates until every lane has converged, lanes that have keeping their values."""
        n = self.count = self.count + 1
        wide = f"<{self.lanes} x i1>"
        starts = [self._vector(self._symbol(s.name())) for s in step.start]
        for name in self._free_inputs([*step.following, step.error, step.bound]):
            if name not in {s.name() for s in step.unknown}:
                self._symbol(name)  # read before the loop, not in it
        previous, loop = self.label, f"newton{n}"
        self.body += [f"  br label %{loop}", f"{loop}:"]
        self.label = loop
        unknown = [Value(f"%n{n}.{i}") for i in range(len(starts))]
        place = len(self.body)
        for symbol, value in zip(step.unknown, unknown, strict=True):
            self.values[symbol.name()] = value
        pairs = [*ca.vertsplit(step.error), *ca.vertsplit(step.bound)]
        found = [self._vector(v) for v in self._evaluate([*step.following, *pairs])]
        following, compared = found[: len(unknown)], found[len(unknown) :]
        count = len(compared) // 2
        open_lanes = self._emit(f"fcmp ugt {self.type} {compared[0]}, {compared[count]}")  # true for NaN as well
        for error, bound in zip(compared[1:count], compared[count + 1 :], strict=True):
            other = self._emit(f"fcmp ugt {self.type} {error}, {bound}")
            open_lanes = self._emit(f"or {wide} {open_lanes}, {other}")
        chosen = [
            self._emit(f"select {wide} %active{n}, {self.type} {new}, {self.type} {old}")
            for new, old in zip(following, unknown, strict=True)
        ]
        active = self._emit(f"and {wide} {open_lanes}, %active{n}")
        bits = self._emit(f"bitcast {wide} {active} to i{self.lanes}")
        some = self._emit(f"icmp ne i{self.lanes} {bits}, 0")
        passes = self._emit(f"add i32 %pass{n}, 1")
        more = self._emit(f"icmp ult i32 {passes}, {ITERATIONS}")
        again = self._emit(f"and i1 {some}, {more}")
        ones = ", ".join(["i1 true"] * self.lanes)
        self.body[place:place] = [
            f"  %pass{n} = phi i32 [ 0, %{previous} ], [ {passes}, %{loop} ]",
            f"  %active{n} = phi {wide} [ <{ones}>, %{previous} ], [ {active}, %{loop} ]",
            *(
                f"  {u} = phi {self.type} [ {start}, %{previous} ], [ {new}, %{loop} ]"
                for u, start, new in zip(unknown, starts, chosen, strict=True)
            ),
        ]
        self.label = f"solved{n}"
        self.body += [f"  br i1 {again}, label %{loop}, label %{self.label}", f"{self.label}:"]
        for symbol, value in zip(step.unknown, chosen, strict=True):
            self.values[symbol.name()] = value
        bad = self._emit(f"zext i1 {some} to i64")
        self.failures = self._emit(f"add i64 {self.failures}, {bad}")

    def _free_inputs(self, values: Sequence[ca.SX]) -> list[str]:
        return [s.name() for s in ca.symvar(ca.vertcat(*values))]

    def _evaluate(self, values: Sequence[ca.SX]) -> list[Value]:
        """Write the operations of expressions; those of uniform operands go to the setup."""
        tape = record(values)
        found: dict[int, Value] = {}
        for operation in tape.operations:
            if operation.code == ca.OP_INPUT:
                found[operation.result] = self._symbol(tape.inputs[operation.operands[0]])
            elif operation.code == ca.OP_CONST:
                found[operation.result] = Value(_hexadecimal(operation.constant), uniform=True)
            else:
                found[operation.result] = self._operation(operation.code, [found[i] for i in operation.operands])
        return [found[i] for i in tape.outputs]

    def _operation(self, code: int, operands: list[Value]) -> Value:
        uniform = all(v.uniform for v in operands)
        divisor = operands[-1]
        if not uniform:
            operands = [self._vector(v) for v in operands]
        kind = "double" if uniform else self.type
        a, b = operands[0], operands[-1]
        one, zero = (Value(_hexadecimal(c), uniform=True) for c in (1.0, 0.0))
        if code == ca.OP_DIV and divisor.uniform and not uniform:
            inverse = self._operation(ca.OP_DIV, [one, divisor])  # one division, in the setup
            return self._operation(ca.OP_MUL, [a, inverse])
        if code in ARITHMETIC:
            return self._emit(f"{ARITHMETIC[code]} {FAST} {kind} {a}, {b}", uniform=uniform)
        if code == ca.OP_SQ:
            return self._emit(f"fmul {FAST} {kind} {a}, {a}", uniform=uniform)
        if code == ca.OP_TWICE:
            return self._emit(f"fadd {FAST} {kind} {a}, {a}", uniform=uniform)
        if code == ca.OP_NEG:
            return self._emit(f"fneg {FAST} {kind} {a}", uniform=uniform)
        if code == ca.OP_INV:
            return self._operation(ca.OP_DIV, [one, a])
        if code in INTRINSICS:
            return self._intrinsic(INTRINSICS[code], kind, operands, uniform=uniform)
        if code in LIBRARY:
            return self._library(LIBRARY[code], operands, uniform=uniform)
        if code in COMPARISONS:
            test = self._emit(f"fcmp {COMPARISONS[code]} {kind} {a}, {b}", uniform=uniform)
            return self._choose(test, one, zero, uniform=uniform)
        if code in (ca.OP_NOT, ca.OP_AND, ca.OP_OR, ca.OP_IF_ELSE_ZERO):
            return self._logic(code, operands, kind, uniform=uniform)
        if code == ca.OP_SIGN:
            size = self._intrinsic("copysign", kind, [one if uniform else self._vector(one), a], uniform=uniform)
            test = self._emit(f"fcmp oeq {kind} {a}, {zero if uniform else self._vector(zero)}", uniform=uniform)
            return self._choose(test, zero, size, uniform=uniform)
        raise NotImplementedError(f"operation {code} of the expression has no counterpart in the compiler")

    def _logic(self, code: int, operands: list[Value], kind: str, *, uniform: bool) -> Value:
        one, zero = (Value(_hexadecimal(c), uniform=True) for c in (1.0, 0.0))
        against = zero if uniform else self._vector(zero)
        tests = [self._emit(f"fcmp une {kind} {v}, {against}", uniform=uniform) for v in operands]
        if code == ca.OP_IF_ELSE_ZERO:
            return self._choose(tests[0], operands[1], zero, uniform=uniform)
        if code == ca.OP_NOT:
            return self._choose(tests[0], zero, one, uniform=uniform)
        bits = "i1" if uniform else f"<{self.lanes} x i1>"
        both = self._emit(f"{'and' if code == ca.OP_AND else 'or'} {bits} {tests[0]}, {tests[1]}", uniform=uniform)
        return self._choose(both, one, zero, uniform=uniform)

    def _choose(self, test: Value, yes: Value, no: Value, *, uniform: bool) -> Value:
        if uniform:
            return self._emit(f"select i1 {test}, double {yes}, double {no}", uniform=True)
        yes, no = self._vector(yes), self._vector(no)
        return self._emit(f"select <{self.lanes} x i1> {test}, {self.type} {yes}, {self.type} {no}")

    def _intrinsic(self, name: str, kind: str, operands: list[Value], *, uniform: bool) -> Value:
        suffix = "f64" if uniform else f"v{self.lanes}f64"
        self.declared.add(f"declare {kind} @llvm.{name}.{suffix}({', '.join([kind] * len(operands))})")
        arguments = ", ".join(f"{kind} {v}" for v in operands)
        return self._emit(f"call {kind} @llvm.{name}.{suffix}({arguments})", uniform=uniform)

    def _library(self, name: str, operands: list[Value], *, uniform: bool) -> Value:
        self.declared.add(f"declare double @{name}({', '.join(['double'] * len(operands))}) #0")
        self.declared.add("attributes #0 = { nounwind memory(none) }")
        if uniform:
            return self._emit(f"call double @{name}({', '.join(f'double {v}' for v in operands)})", uniform=True)
        result = Value("poison")
        for lane in range(self.lanes):
            one = [self._emit(f"extractelement {self.type} {v}, i32 {lane}") for v in operands]
            value = self._emit(f"call double @{name}({', '.join(f'double {v}' for v in one)})")
            result = self._emit(f"insertelement {self.type} {result}, double {value}, i32 {lane}")
        return result


def _pointer(base: str, place: int) -> str:
    return f"getelementptr double, ptr {base}, i64 {place}"


def _hexadecimal(value: float) -> str:
    return f"0x{struct.unpack('<Q', struct.pack('<d', value))[0]:016X}"
