"""A heavy top over 1000 s: error and energy error against time, ``galerkin`` of 1 to 5 stages and SciPy's DOP853.

The top is symmetric, 15 kg, its center of mass a meter from the fixed point. The default spins a hundredth as fast,
so that it sways far instead of circling; ``--fast`` is the quick one. SciPy's right-hand side is compiled by cayley's
code generator, so that its time is that of its stepping loop. Errors are to the finest galerkin run, whose own error is
told beside.
"""

import argparse
import ctypes
import math
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
from harness import spread, write
from scipy.integrate import DOP853

import cayley as cy
from cayley.codegen.kernels import compiled
from cayley.discrete.joint import plain_program

T_END = 1000.0
SAVES = 100
CENTER = np.array([0.0, 1.0, 0.0])
MASS, GRAVITY = 15.0, 9.81
INERTIA = np.diag([0.234375, 0.46875, 0.234375]) + MASS * (np.eye(3) - np.outer(CENTER, CENTER))
SPIN = {"slow": (0.0, 1.5, -0.0461538), "fast": (0.0, 150.0, -4.61538)}
"""Angular velocity at the start [rad/s]."""
STEPS = {
    "slow": {1: (4e-3, 2e-3, 1e-3), 2: (0.04, 0.02, 0.01), 3: (0.1, 0.05, 0.025), 4: (0.2, 0.1, 0.05), 5: (0.2, 0.1)},
    "fast": {1: (5e-4,), 2: (5e-3, 2.5e-3), 3: (0.01, 5e-3), 4: (0.02, 0.01), 5: (0.02, 0.01)},
}
"""Time steps by degree in time [s]."""
TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
"""Relative tolerances of SciPy; the absolute one is a hundredth."""
REFERENCE = {"slow": (5, 0.05, 0.04), "fast": (5, 4e-3, 5e-3)}
"""Degree and step of the reference, and the step of the run that tells its error [s]."""


@cy.lagrangian(p=cy.Rotation())
def heavy_top(q, c):  # type: ignore[no-untyped-def]
    """A body of inertia c.inertia about a fixed point, its weight acting at c.center (body frame)."""
    return 0.5 * cy.dot(q.p_t, c.inertia @ q.p_t) - c.weight * cy.dot(cy.E3, q.p.rotate(c.center))


@dataclass(frozen=True, slots=True)
class Run:
    """One run to the end.

    Args:
        wall_time: of the loop alone [s].
        steps: number of steps.
        rotation: at the end, shape (4,).
        energy_error: largest |E − E(0)| at SAVES times, relative to ``scale`` [-].
    """

    wall_time: float
    steps: int
    rotation: np.ndarray
    energy_error: float

    def error(self, exact: np.ndarray) -> float:
        """Distance of the rotations, min ‖p ∓ q‖ [-]."""
        p = self.rotation
        return float(min(np.linalg.norm(p - exact), np.linalg.norm(p + exact)))


class Slope:
    """Time derivative of (rotation wxyz, body angular velocity), compiled by cayley's code generator."""

    def __init__(self) -> None:
        """Compile; weight at (0, 1, 0), inertia diagonal."""
        state = [ca.SX.sym(name) for name in ("w", "x", "y", "z", "a", "b", "c")]
        w, x, y, z, a, b, c = state
        first, second, third = np.diag(INERTIA)
        up_x, up_z = 2.0 * (x * z - w * y), w * w - x * x - y * y + z * z  # of e3 seen from the body
        pull = MASS * GRAVITY
        rates = [
            -0.5 * (x * a + y * b + z * c),
            0.5 * (w * a + y * c - z * b),
            0.5 * (w * b + z * a - x * c),
            0.5 * (w * c + x * b - y * a),
            (-pull * up_z + (second - third) * b * c) / first,
            (third - first) * c * a / second,
            (pull * up_x + (first - second) * a * b) / third,
        ]
        kernel = compiled(plain_program("heavy_top_slope", state, rates), 2, repr(rates))
        self._data, self._uniforms = np.ones((3, 14, 2)), np.zeros(max(1, kernel.width))
        self._given, self._found = self._data[1, :7, 0], self._data[1, 7:, 0]
        ctypes.CFUNCTYPE(None, ctypes.c_int64)(kernel.setup)(self._uniforms.ctypes.data)
        self._run = ctypes.CFUNCTYPE(ctypes.c_int64, *[ctypes.c_int64] * 4)(kernel.run)
        self._arguments = (self._data.ctypes.data, self._uniforms.ctypes.data, 1, 2)

    def __call__(self, t: float, y: np.ndarray) -> np.ndarray:
        """The derivative at y; the time does not matter."""
        self._given[:] = y
        self._run(*self._arguments)
        return self._found.copy()


def energy(y: np.ndarray) -> float:
    """Energy of (rotation wxyz, body angular velocity) [J]."""
    w, x, yy, z = y[:4]
    height = 2.0 * (yy * z + w * x)
    return float(0.5 * y[4:] @ INERTIA @ y[4:] + MASS * GRAVITY * height)


def scale(name: str) -> float:
    """What energy errors are divided by [J]: the kinetic energy at the start plus the weight times its arm."""
    spin = np.array(SPIN[name])
    return float(0.5 * spin @ INERTIA @ spin) + MASS * GRAVITY


def ours(name: str, degree: int, dt: float, t_end: float) -> Run:
    """Run the top in cayley."""
    constants = {"inertia": INERTIA, "weight": MASS * GRAVITY, "center": CENTER}
    system = cy.compile(heavy_top, rule=cy.rules.galerkin(time=degree), constants=constants)
    start = {"p": (1, 0, 0, 0), "p_t": SPIN[name]}
    run = cy.integrate(system, start, t_end=t_end, dt=dt, save_every=t_end / SAVES)
    drift = np.abs(run.energy.values - run.energy.values[0]).max() / scale(name)
    return Run(run.wall_time, run.steps, run.data["p"].isel(time=-1).values, float(drift))


def scipys(name: str, tolerance: float, t_end: float) -> Run:
    """Run the top in SciPy's DOP853, saving as often as cayley does by its dense output."""
    start = np.array([1.0, 0.0, 0.0, 0.0, *SPIN[name]])
    slope = Slope()
    times = np.linspace(0.0, t_end, SAVES + 1)[1:]
    began, steps, saved = time.perf_counter(), 0, []
    solver = DOP853(slope, 0.0, start, t_end, rtol=max(tolerance, 1e-13), atol=0.01 * tolerance)
    while solver.status == "running":
        solver.step()
        steps += 1
        while len(saved) < SAVES and times[len(saved)] <= solver.t:
            now = times[len(saved)]
            saved.append(solver.y if now == solver.t else solver.dense_output()(now))
    wall_time = time.perf_counter() - began
    drift = max(abs(energy(y) - energy(start)) for y in saved) / scale(name)
    last = solver.y[:4]
    return Run(wall_time, steps, last / np.linalg.norm(last), drift)


def row(method: str, setting: str, value: float, runs: list[Run], exact: np.ndarray) -> dict[str, Any]:
    """One row of the table, and a line on the screen."""
    times, first = spread([each.wall_time for each in runs]), runs[0]
    print(
        f"{method:22s} {setting} {value:<7g} {times['median']:8.3f} s, {first.steps:8d} steps:"
        f" error {first.error(exact):.1e}, energy {first.energy_error:.1e}"
    )
    return {
        "method": method,
        setting: value,
        "steps": first.steps,
        "loop_s": times,
        "error": first.error(exact),
        "energy_error": first.energy_error,
    }


def measure(name: str, t_end: float, repeats: int) -> dict[str, Any]:
    """All runs of one top, in turn, as often as asked."""
    degree, fine, coarse = REFERENCE[name]
    best = ours(name, degree, fine, t_end)
    doubt = ours(name, degree, coarse, t_end).error(best.rotation)
    print(f"reference galerkin(time={degree}), step {fine:g} s: differs by {doubt:.1e} from the one with {coarse:g} s")
    cases = [(r, dt) for r, steps in STEPS[name].items() for dt in steps]
    mine: dict[tuple[int, float], list[Run]] = {case: [] for case in cases}
    theirs: dict[float, list[Run]] = {tolerance: [] for tolerance in TOLERANCES}
    for _ in range(repeats):
        for case, tolerance in zip(cases, (*TOLERANCES, *[math.nan] * len(cases)), strict=False):
            mine[case].append(ours(name, *case, t_end))
            if tolerance in theirs:
                theirs[tolerance].append(scipys(name, tolerance, t_end))
    rows = [row(f"galerkin(time={r})", "dt_s", dt, runs, best.rotation) for (r, dt), runs in mine.items()]
    rows += [row("DOP853", "rtol", tolerance, runs, best.rotation) for tolerance, runs in theirs.items()]
    return {
        "top": name,
        "spin_rad_per_s": SPIN[name],
        "t_end_s": t_end,
        "reference": {"degree": degree, "dt_s": fine, "doubt": doubt},
        "rows": rows,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fast", action="store_true", help="the top of 150 rad/s instead of the slow one")
    parser.add_argument("--t-end", type=float, default=T_END, help="end of the runs [s]")
    parser.add_argument("--repeats", type=int, default=2)
    parser.add_argument("--out", type=Path, help="folder of the JSON file")
    given = parser.parse_args()
    figures = measure("fast" if given.fast else "slow", given.t_end, given.repeats)
    write("heavy_top", figures, to=given.out)


if __name__ == "__main__":
    main()
