"""Draw the figures of docs/verification.md and print its measured numbers: python docs/make_figures.py (a minute).

The problems are those of the tests, which it imports.
"""

import sys
from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests"))

import cayley as cy  # noqa: E402
from reference import test_sag, test_slender  # noqa: E402
from reference.straight_rod import predicted_compliance, slender, stiffnesses, tip_compliance  # noqa: E402
from verify.problems import (  # noqa: E402
    TOP,
    TOP_START,
    bend,
    fitted,
    frame_distance,
    heavy_top,
    in_flight,
    rotation_distance,
    slopes,
    thick_rod,
)

IMAGES = ROOT / "docs" / "images"
RULES = (cy.rules.nodal, cy.rules.verlet)
FORMS = ("quaternion", "matrix")
COLORS = {"nodal": "#c0532b", "verlet": "#1f6f8b"}
MARKS = {"quaternion": "o", "matrix": "x"}
FLIGHT: dict[str, Any] = {"velocity": (0.3, -0.2, 0.5), "spin": (1.0, 5.0, -8.0)}


def draw_order() -> None:
    """Error against time step for three problems, and against element length for the rubber pendulum."""
    fig, axes = plt.subplots(1, 3, figsize=(10.5, 3.6), layout="constrained")
    steps = 500 * 2 ** np.arange(6)
    for form in FORMS:
        system = cy.compile(heavy_top, rule=cy.rules.nodal, constants=TOP, rotation=form)
        runs = [cy.integrate(system, TOP_START, t_end=0.5, dt=0.5 / n, save_every=0.5) for n in (*steps, 128 * 4000)]
        last = [run.data["p"].values[-1] for run in runs]
        errors = [rotation_distance(p, last[-1]) for p in last[:-1]]
        report(f"heavy top, {form}", errors)
        axes[0].loglog(0.5 / steps, errors, MARKS[form], color=COLORS["nodal"], fillstyle="none", label=form)
    guide(axes[0], 0.5 / steps, errors)
    axes[0].set(title="heavy top", xlabel="time step [s]", ylabel="error of the quaternion at 0.5 s")
    steps = 1000 * 2 ** np.arange(6)
    for rule in RULES:
        rod, model = thick_rod(10, clamped=False)
        start = {rod: in_flight(rod, bend(rod, 8.0), **FLIGHT)}
        for form in FORMS:
            runs = [
                cy.simulate(model, 0.1, 0.1 / n, rule=rule, save_every=0.1, initial=start, rotation=form)
                for n in (*steps, 256_000)
            ]
            errors = [frame_distance(run, runs[-1], rod)[0] for run in runs[:-1]]
            report(f"rod in flight, {rule}, {form}", errors)
            style = {"color": COLORS[rule.name], "fillstyle": "none", "label": f"{rule}, {form}"}
            axes[1].loglog(0.1 / steps, errors, MARKS[form], **style)
        guide(axes[1], 0.1 / steps, errors)
    axes[1].set(
        title="rubber rod in free flight, 10 elements", xlabel="time step [s]", ylabel="error of position at 0.1 s [m]"
    )
    meshes = np.array([10, 20, 40, 80, 160])
    for rule in RULES:
        found = []
        for n in (*meshes, 640):
            rod, model = thick_rod(int(n))
            start = {rod: bend(rod, 4.0)}
            run = cy.simulate(model, 0.01, 1e-3 / n, rule=rule, save_every=0.01, initial=start)
            found.append(run[rod].position.values[-1, :: n // 10])
        errors = [np.linalg.norm(x - found[-1], axis=-1).max() for x in found[:-1]]
        report(f"rod, step and mesh together, {rule}", errors)
        axes[2].loglog(1.0 / meshes, errors, "o", color=COLORS[rule.name], fillstyle="none", label=str(rule))
        guide(axes[2], 1.0 / meshes, errors)
    axes[2].set(
        title="thick rubber rod, step ∝ element", xlabel="element length [m]", ylabel="error of position at 0.01 s [m]"
    )
    for ax in axes:
        ax.legend(frameon=False, fontsize=8)
    save(fig, "verify_order.png")


def draw_long_runs() -> None:
    """Departure from unit length over 1e6 steps; energy over the same run, and its ripple against the step."""
    fig, ax = plt.subplots(figsize=(6.0, 3.8), layout="constrained")
    rod, model = thick_rod(15, clamped=False)
    start = {rod: in_flight(rod, bend(rod, 1.5), **FLIGHT)}
    energies = {}
    for rule in RULES:
        for form in FORMS:
            run = cy.simulate(model, 50.0, 5e-5, rule=rule, save_every=5e-3, initial=start, rotation=form)
            rows = run.frames.values[..., run.system.layout.rows_of("p")]
            error = np.abs(np.linalg.norm(rows, axis=-1) - 1.0)
            if form == "matrix":
                matrix = rows.reshape(*rows.shape[:-1], 3, 3)
                error = np.abs(matrix.swapaxes(-1, -2) @ matrix - np.eye(3)).max(axis=(-1, -2))
            seen = np.unique(np.geomspace(1, len(error) - 1, 60).astype(int))
            mean, steps = np.sqrt((error[seen] ** 2).mean(axis=1)), run.frames.steps[seen]
            tail = steps >= 1000
            exponent = fitted(steps[tail], mean[tail])
            label = f"{rule}, {form}: n^{exponent:.2f}"
            ax.loglog(steps, mean, MARKS[form], ms=4, color=COLORS[rule.name], fillstyle="none", label=label)
            linear, angular = run.linear_momentum.values, run.angular_momentum.values
            lost = [np.abs(m - m[0]).max(axis=1) / np.linalg.norm(m[0]) for m in (linear, angular)]
            early = run.frames.steps <= 100_000
            print(f"flight {rule} {form}: worst norm {error.max():.1e}, exponent {exponent:.2f}, {run.wall_time:.2f} s")
            by = [f"{[f'{m[until].max():.1e}' for m in lost]}" for until in (early, slice(None))]
            print(f"  linear and angular momentum lost by 1e5 steps {by[0]}, by 1e6 {by[1]}")
            energy = run.energy.values
            slope = np.polyfit(run.time, energy, 1)[0] * run.time[-1]
            print(f"  energy {energy[0]:.3f} J, ripple {np.ptp(energy):.1e} J, line rises by {slope:.1e} J")
            energies[rule.name] = (run.time, energy)
    n = np.array([1e2, 1e6])
    ax.loglog(n, 1.5e-16 * np.sqrt(n), "k-", lw=0.8, label="√n")
    ax.loglog(n, 1.5e-18 * n, "k:", lw=0.8, label="n, what biased rounding would give")
    ax.set(xlabel="steps n", ylabel="‖p‖ − 1, or RᵀR − 1 (rms over nodes)", title="no normalization anywhere")
    ax.legend(frameon=False, fontsize=8)
    save(fig, "verify_norm.png")

    fig, axes = plt.subplots(1, 2, figsize=(9.0, 3.6), layout="constrained")
    rod, model = thick_rod(10)
    start = {rod: bend(rod, 4.0)}
    steps = 250 * 2 ** np.arange(7)
    for rule in RULES:
        ripples = [
            np.ptp(cy.simulate(model, 0.05, 0.05 / n, rule=rule, save_every=2e-4, initial=start).energy.values)
            for n in steps
        ]
        report(f"energy ripple, {rule}", ripples)
        axes[0].loglog(0.05 / steps, ripples, "o", color=COLORS[rule.name], fillstyle="none", label=str(rule))
        guide(axes[0], 0.05 / steps, ripples)
        time, energy = energies[rule.name]
        bins = (energy[1:].reshape(50, -1) / energy[0] - 1.0) * 1e6  # of one second each
        middle = time[1:].reshape(50, -1).mean(axis=1)
        color = COLORS[rule.name]
        axes[1].fill_between(middle, bins.min(axis=1), bins.max(axis=1), color=color, alpha=0.25, lw=0, label=str(rule))
        axes[1].plot(middle, bins.mean(axis=1), color=color, label=f"{rule}, mean of each second")
    axes[0].set(title="bent rubber rod, clamped", xlabel="time step [s]", ylabel="ripple of the energy [J]")
    axes[1].set(
        title="rod in free flight, 1e6 steps", xlabel="time [s]", ylabel="(E − E(0))/E(0) [1e-6]", ylim=(-13, 1)
    )
    axes[0].legend(frameon=False, fontsize=8)
    axes[1].legend(frameon=False, fontsize=8, loc="lower left")
    save(fig, "verify_energy.png")


def draw_locking() -> None:
    """Static tip deflection of a clamped rod, relative to Timoshenko's, against the element length."""
    fig, ax = plt.subplots(figsize=(6.0, 3.8), layout="constrained")
    meshes = np.array([2, 3, 5, 8, 11, 16, 24, 36, 60, 100, 160, 300])
    for radius, mark in ((0.05, "o"), (0.01, "s")):
        section = slender(radius)
        bending, shear = stiffnesses(section)
        exact = 1.0 / (3.0 * bending) + 1.0 / shear
        for rule in RULES:
            found = [tip_compliance(section, 1.0, n, rule) / exact for n in meshes]
            predicted = [predicted_compliance(section, 1.0, n, rule) / exact for n in meshes]
            ax.loglog(1.0 / meshes, predicted, "-", lw=0.8, color=COLORS[rule.name])
            label = f"{rule}, l/d = {0.5 / radius:.0f}"
            ax.loglog(1.0 / meshes, found, mark, ms=4, color=COLORS[rule.name], fillstyle="none", label=label)
            print(f"locking {rule} r {radius}: {dict(zip(meshes.tolist(), np.round(found, 5).tolist(), strict=True))}")
    ax.set(
        xlabel="element length/rod length",
        ylabel="tip deflection/Timoshenko's",
        ylim=(3e-4, 2.0),
        title="clamped rod, tip force",
    )
    ax.text(0.11, 0.35, "lines: EI + GA ds²/4 (nodal), EI (verlet)", transform=ax.transAxes, fontsize=8)
    ax.legend(frameon=False, fontsize=8, loc="lower left")
    save(fig, "verify_locking.png")


def draw_slender() -> None:
    """Errors of three frequencies of a clamped rod against its slenderness; of a sagging rod against its mesh."""
    fig, axes = plt.subplots(1, 2, figsize=(9.0, 3.8), layout="constrained")
    colors = {1: "#1f6f8b", 2: "#c0532b", 3: "#5b8c3a"}
    slenderness = np.geomspace(10, 10_000, 7)
    cases = [(cy.rules.verlet, 20), *((cy.rules.galerkin(time=1, space=m), 24 // m) for m in (2, 3))]
    for rule, elements in (*cases, (cy.rules.nodal, 20)):
        found = np.abs([test_slender.errors(rule, float(ratio), elements)[1] for ratio in slenderness])
        color = colors[rule.degree] if rule != cy.rules.nodal else "0.6"
        for mode, mark in enumerate("osv"):
            label = f"{rule}, {elements} elements" if mode == 0 else None
            axes[0].loglog(slenderness, found[:, mode], f"{mark}-", lw=0.6, ms=4, color=color, mfc="none", label=label)
        print(f"slender {rule}, {elements} elements: errors {[[f'{e:.1e}' for e in row] for row in found]}")
    axes[0].set(xlabel="l √(A/I)", ylabel="relative error", ylim=(1e-10, 1e6), title="frequencies of a clamped rod")
    meshes = np.array([4, 8, 12, 16, 24, 32, 48, 64])
    for length, line in ((0.25, "o-"), (1.0, "s--")):
        for m in (1, 2, 3):
            found = test_sag.errors(length, cy.rules.galerkin(time=1, space=m), meshes)
            label = f"m = {m}, {length} m"
            axes[1].loglog(1.0 / meshes, found, line, lw=0.6, ms=4, color=colors[m], mfc="none", label=label)
            observed = np.round(test_sag.orders(meshes, found), 2)
            print(f"sag m {m}, {length} m: {[f'{e:.1e}' for e in found]}, {observed}")
    axes[1].set(xlabel="element length/rod length", ylabel="error/rod length", title="sag of a clamped rubber rod")
    axes[1].xaxis.set_minor_formatter("")
    for ax, where in zip(axes, ("upper left", "lower right"), strict=True):
        ax.legend(frameon=False, fontsize=7, loc=where)
    save(fig, "verify_slender.png")


def guide(ax: Any, x: np.ndarray, y: Any) -> None:
    """A line of slope 2 through the finest point."""
    x = np.asarray(x)
    ax.loglog(x, y[-1] * (x / x[-1]) ** 2, "k-", lw=0.6, zorder=0)


def report(name: str, errors: Any) -> None:
    """Print errors and observed orders."""
    print(f"{name}: errors {' '.join(f'{e:.1e}' for e in errors)}, orders {np.round(slopes(errors), 2)}")


def save(fig: Any, name: str) -> None:
    """Write a figure to docs/images."""
    IMAGES.mkdir(exist_ok=True)
    fig.savefig(IMAGES / name, dpi=130)
    plt.close(fig)


if __name__ == "__main__":
    draw_order()
    draw_long_runs()
    draw_locking()
    draw_slender()
