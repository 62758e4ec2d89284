"""The time loop of decoupled rules, written as LLVM IR: all that runs between two saves, and from save to save.

With P the momentum after the inertia of a step and F(qʲ) all forces at a node, one step is

    P + h F(qʲ) = −D₀ T_d(qʲ, qʲ⁺¹)   -> qʲ⁺¹,        P = D₁ T_d(qʲ, qʲ⁺¹),

the force serving the step before and the step after; at a saved frame the momentum is μ = P + h/2 F. The kernels do
this for blocks of nodes; the loop here calls them by address, so one driver serves every system of the same layout.
Where there are forces beside the Lagrangian, a predictor goes over all nodes before (discrete.forced), and
time-dependent loads are handed to it, not to the momenta.
It is IR and not a compiled Python function because it is what a user waits for at the first run (docs/adr/0004).
"""

import contextlib
from collections.abc import Iterator
from typing import Any

from llvmlite import ir

from cayley.codegen.abi import ARGUMENTS, ENTRY, LEVER

I64, DOUBLE, VOID = ir.IntType(64), ir.DoubleType(), ir.VoidType()


def print_driver() -> str:
    """LLVM IR of void advance(ptr arguments); its argument ``failed`` is left at −1 or set to a save."""
    module = ir.Module(name="driver")
    push = _print_push(module)
    function = ir.Function(module, ir.FunctionType(VOID, [I64]), name="advance")
    _Advance(function, push).write()
    return str(module)


class _Writer:
    """A builder with loops, and loads and stores at addresses that are integers."""

    def __init__(self, function: ir.Function) -> None:
        self.function = function
        self.b = ir.IRBuilder(function.append_basic_block("entry"))

    def int(self, value: int) -> ir.Constant:
        return ir.Constant(I64, value)

    def pointer(self, address: Any, index: Any, kind: ir.Type) -> Any:
        place = self.b.add(address, self.b.mul(index, self.int(8)))
        return self.b.inttoptr(place, kind.as_pointer())

    def load(self, address: Any, index: Any, kind: ir.Type = I64) -> Any:
        return self.b.load(self.pointer(address, index, kind))

    def store(self, value: Any, address: Any, index: Any) -> None:
        self.b.store(value, self.pointer(address, index, value.type))

    def call(self, address: Any, *arguments: Any, result: ir.Type = VOID) -> Any:
        kind = ir.FunctionType(result, [a.type for a in arguments])
        return self.b.call(self.b.inttoptr(address, kind.as_pointer()), arguments)

    @contextlib.contextmanager
    def loop(self, start: Any, stop: Any) -> Iterator[Any]:
        """For index in range(start, stop)."""
        b = self.b
        head, body, end = (self.function.append_basic_block(n) for n in ("head", "body", "end"))
        before = b.block
        b.branch(head)
        b.position_at_end(head)
        index = b.phi(I64)
        index.add_incoming(start, before)
        b.cbranch(b.icmp_signed("<", index, stop), body, end)
        b.position_at_end(body)
        yield index
        index.add_incoming(b.add(index, self.int(1)), b.block)
        b.branch(head)
        b.position_at_end(end)

    def smaller(self, a: Any, c: Any) -> Any:
        return self.b.select(self.b.icmp_signed("<", a, c), a, c)

    def larger(self, a: Any, c: Any) -> Any:
        return self.b.select(self.b.icmp_signed(">", a, c), a, c)


class _Advance(_Writer):
    """The loops over saves, groups of steps, and tiles."""

    def __init__(self, function: ir.Function, push: ir.Function) -> None:
        super().__init__(function)
        self.push = push
        self.at = {name: self.load(function.args[0], self.int(i)) for i, name in enumerate(ARGUMENTS)}
        clock = self.at["clock"]
        self.origin, self.h, self.first = (self.load(clock, self.int(i), DOUBLE) for i in range(3))

    def write(self) -> None:
        b, at = self.b, self.at
        failures = b.alloca(I64)
        for kind in ("step", "held"):
            self.set(kind, self.h, self.int(0), self.int(1))
        with self.loop(self.int(0), at["saves"]) as save:
            begin = b.mul(save, at["stride"])
            self.half(begin, -0.5)
            b.store(self.int(0), failures)
            groups = b.sdiv(b.add(at["stride"], b.sub(at["depth"], self.int(1))), at["depth"])
            with self.loop(self.int(0), groups) as group:
                done = b.mul(group, at["depth"])
                together = self.smaller(at["depth"], b.sub(at["stride"], done))
                self.predict(b.add(begin, done), self.h)
                self.wavefront(b.add(begin, done), together, failures)
            self.half(b.add(begin, at["stride"]), 0.5)
            with self.loop(self.int(0), at["fixed_count"]) as k:
                block, row, lane = (self.load(at["fixed"], b.add(b.mul(k, self.int(3)), self.int(i))) for i in range(3))
                self.store(ir.Constant(DOUBLE, 0.0), at["data"], self.place(block, row, lane))
            self.copy(save)
            with b.if_then(b.icmp_signed("!=", b.load(failures), self.int(0)), likely=False):
                self.store(save, at["failed"], self.int(0))
                b.ret_void()
        b.ret_void()

    def wavefront(self, begin: Any, together: Any, failures: Any) -> None:
        """Several steps of all tiles: a tile takes its next step once its right neighbor has taken this one."""
        b, at = self.b, self.at
        fronts = b.sub(b.add(at["tiles"], together), self.int(1))
        with self.loop(self.int(0), fronts) as front:
            low = self.larger(self.int(0), b.add(b.sub(front, at["tiles"]), self.int(1)))
            with self.loop(low, self.smaller(together, b.add(front, self.int(1)))) as k:
                tile, number = b.sub(front, k), b.add(begin, k)
                entries = (self.load(at["places"], tile), self.load(at["places"], b.add(tile, self.int(1))))
                self.loads(entries, number, self.h)
                span = b.mul(tile, self.int(3))
                first, last, held = (self.load(at["spans"], b.add(span, self.int(i))) for i in range(3))
                is_held = b.icmp_signed("!=", held, self.int(0))
                with b.if_then(b.icmp_signed("!=", at["timed"], self.int(0))):
                    for kind in ("step", "held"):
                        self.set(kind, self.h, number, b.add(number, self.int(1)))
                kernel = b.select(is_held, at["held"], at["step"])
                uniforms = b.select(is_held, self.uniforms("held"), self.uniforms("step"))
                bad = self.call(kernel, at["data"], uniforms, first, last, result=I64)
                b.store(b.add(b.load(failures), bad), failures)

    def half(self, number: Any, factor: float) -> None:
        """Add factor × h × all forces to the momenta."""
        b, at = self.b, self.at
        h = b.fmul(self.h, ir.Constant(DOUBLE, factor))
        # going on from a frame its velocities are known; at the end of an interval they are predicted
        self.predict(number, ir.Constant(DOUBLE, 0.0) if factor < 0.0 else self.h)
        self.set("kick", h, number, number)
        self.call(
            at["kick"], at["data"], self.uniforms("kick"), self.int(1), b.add(at["blocks"], self.int(1)), result=I64
        )
        with b.if_then(b.icmp_signed("==", at["predict"], self.int(0))):
            self.loads((self.int(0), at["entry_count"]), number, h)

    def predict(self, number: Any, h: Any) -> None:
        """Find the velocities that forces need, of all nodes; loads come first, as forces."""
        b, at = self.b, self.at
        with b.if_then(b.icmp_signed("!=", at["predict"], self.int(0))):
            self.loads((self.int(0), at["entry_count"]), number, ir.Constant(DOUBLE, 1.0))
            self.set("predict", h, number, b.add(number, self.int(1)))
            last = b.add(at["blocks"], self.int(1))
            self.call(at["predict"], at["data"], self.uniforms("predict"), self.int(1), last, result=I64)

    def loads(self, entries: tuple[Any, Any], number: Any, h: Any) -> None:
        """Add h × time-dependent loads to the momenta of their nodes."""
        b, at = self.b, self.at
        values = b.add(at["table"], b.mul(b.mul(number, at["columns"]), self.int(8)))
        with self.loop(*entries) as e:
            entry = b.add(at["entries"], b.mul(e, self.int(8 * len(ENTRY))))
            scales = b.add(at["scales"], b.mul(e, self.int(8 * 4)))
            scale = b.fmul(h, self.load(scales, self.int(0), DOUBLE))
            block = self.load(entry, self.int(0))
            lane = self.load(entry, self.int(1))
            node = b.add(at["data"], b.mul(self.place(block, self.int(0), lane), self.int(8)))
            row, turn, form, column = (self.load(entry, self.int(i)) for i in range(2, 6))
            vector = b.add(values, b.mul(column, self.int(8)))
            b.call(self.push, [node, at["lanes"], row, turn, form, vector, scale, b.add(scales, self.int(8))])

    def set(self, kind: str, h: Any, number: Any, following: Any) -> None:
        """Give a kernel its step and times."""
        uniforms = self.uniforms(kind)
        for i, value in enumerate((h, self.time(number), self.time(following))):
            self.store(value, uniforms, self.int(i))
        self.call(self.at[f"{kind}_setup"], uniforms)

    def time(self, number: Any) -> Any:
        b = self.b
        steps = b.fadd(self.first, b.sitofp(number, DOUBLE))
        return b.fadd(self.origin, b.fmul(steps, self.h))

    def uniforms(self, kind: str) -> Any:
        row = self.int(("step", "held", "kick", "predict").index(kind))
        return self.b.add(self.at["uniforms"], self.b.mul(self.b.mul(row, self.at["width"]), self.int(8)))

    def place(self, block: Any, row: Any, lane: Any) -> Any:
        b, at = self.b, self.at
        return b.add(b.mul(b.add(b.mul(block, at["rows"]), row), at["lanes"]), lane)

    def copy(self, save: Any) -> None:
        """Copy values and momenta into the frame of a save."""
        b, at = self.b, self.at
        part = b.mul(at["kept"], at["lanes"])
        frame = b.add(at["frames"], b.mul(b.mul(b.mul(save, at["blocks"]), part), self.int(8)))
        with self.loop(self.int(0), at["blocks"]) as block:
            source = self.place(b.add(block, self.int(1)), self.int(0), self.int(0))
            with self.loop(self.int(0), part) as k:
                value = self.load(at["data"], b.add(source, k), DOUBLE)
                self.store(value, frame, b.add(b.mul(block, part), k))


def _print_push(module: ir.Module) -> ir.Function:
    """One load on one node: turned as its form says, scaled, added to three rows of its momentum.

    With a lever a, the load F, turned, is one off the node, and its moment a × F is added.
    """
    kind = ir.FunctionType(VOID, [I64, I64, I64, I64, I64, I64, DOUBLE, I64])
    function = ir.Function(module, kind, name="push")
    function.linkage = "internal"
    w = _Writer(function)
    b = w.b
    node, lanes, row, turn, full_form, vector, scale, lever = function.args
    form = b.and_(full_form, w.int(LEVER - 1))
    has_lever = b.icmp_signed(">=", full_form, w.int(LEVER))

    def at(base: Any, i: int) -> Any:
        return b.mul(b.add(base, w.int(i)), lanes)

    def deliver(values: list[Any]) -> None:
        places = [at(row, i) for i in range(3)]
        with b.if_else(has_lever, likely=False) as (levered, straight):
            with levered:
                _add(w, node, places, _cross(b, [w.load(lever, w.int(i), DOUBLE) for i in range(3)], values))
            with straight:
                _add(w, node, places, values)
        b.branch(done)

    given = [b.fmul(scale, w.load(vector, w.int(i), DOUBLE)) for i in range(3)]
    zero = ir.Constant(DOUBLE, 0.0)
    idle = [b.fcmp_ordered("==", g, zero) for g in given]
    done = function.append_basic_block("done")
    work, plain, by_quaternion, by_matrix = (
        function.append_basic_block(n) for n in ("work", "plain", "quaternion", "matrix")
    )
    b.cbranch(b.and_(b.and_(idle[0], idle[1]), idle[2]), done, work)
    b.position_at_end(work)
    turns = b.switch(form, plain)
    for value, place in ((1, by_quaternion), (2, by_quaternion), (3, by_matrix), (4, by_matrix)):
        turns.add_case(w.int(value), place)

    b.position_at_end(plain)
    deliver(given)

    b.position_at_end(by_quaternion)
    p = [w.load(node, at(turn, i), DOUBLE) for i in range(4)]
    two = ir.Constant(DOUBLE, 2.0)
    real = b.fmul(p[0], b.select(b.icmp_signed("==", form, w.int(2)), two, ir.Constant(DOUBLE, -2.0)))
    once = _cross(b, p[1:], given)
    twice = _cross(b, p[1:], once)
    turned = [b.fadd(g, b.fadd(b.fmul(real, u), b.fmul(two, v))) for g, u, v in zip(given, once, twice, strict=True)]
    deliver(turned)

    b.position_at_end(by_matrix)
    m = [[w.load(node, at(turn, 3 * i + k), DOUBLE) for k in range(3)] for i in range(3)]
    body = b.icmp_signed("==", form, w.int(3))  # space to body: the transposed matrix
    turned = []
    for i in range(3):
        factors = [b.select(body, m[k][i], m[i][k]) for k in range(3)]
        first, second, third = (b.fmul(f, g) for f, g in zip(factors, given, strict=True))
        turned.append(b.fadd(b.fadd(first, second), third))
    deliver(turned)

    b.position_at_end(done)
    b.ret_void()
    return function


def _add(w: _Writer, base: Any, places: list[Any], values: list[Any]) -> None:
    for place, value in zip(places, values, strict=True):
        w.store(w.b.fadd(w.load(base, place, DOUBLE), value), base, place)


def _cross(b: ir.IRBuilder, u: list[Any], v: list[Any]) -> list[Any]:
    return [b.fsub(b.fmul(u[i], v[k]), b.fmul(u[k], v[i])) for i, k in ((1, 2), (2, 0), (0, 1))]
