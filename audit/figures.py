"""The figures of the audit."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from audit.measures import Finding
from audit.stiff import Convergence

COLORS = {2: "#1f6f8b", 4: "#c0532b", 6: "#5b8c3a", 8: "#7a4a91"}
MARKS = {
    "nodal": "s",
    "verlet": "o",
    "midpoint": "D",
    "nodal_midpoint": "v",
    "screw": "^",
    "screw_midpoint": "<",
    "spectral(space=2)": ">",
    "spectral(space=3)": "p",
    "galerkin(time=1)": "+",
    "galerkin(time=2)": "o",
    "galerkin(time=3)": "o",
    "galerkin(time=4)": "o",
    "galerkin(time=1, space=2)": "x",
    "galerkin(time=2, space=2)": "x",
    "galerkin(time=3, space=3)": "x",
}


def draw_order(found: Sequence[Finding], path: Path) -> None:
    """Error against step for every rule that ran, a panel for each problem, with lines of the promised slope."""
    names = list(dict.fromkeys(f.problem for f in found))
    fig, axes = plt.subplots(1, len(names), figsize=(13.0, 4.4), layout="constrained")
    for ax, name in zip(axes, names, strict=True):
        for f in found:
            if f.problem != name or not len(f.errors) or f.form != "quaternion":
                continue
            style = {"color": COLORS[f.expected], "fillstyle": "none", "ms": 6}
            ax.loglog(f.steps, f.errors, MARKS.get(f.rule, "."), label=f.rule, **style)
            line = f.errors[-1] * (f.steps / f.steps[-1]) ** f.expected
            ax.loglog(f.steps, line, "-", lw=0.7, color=COLORS[f.expected], zorder=0)
        ax.set(title=name, xlabel="time step [s]")
    axes[0].set_ylabel("error at the end")
    handles, labels = axes[-1].get_legend_handles_labels()
    fig.legend(handles, labels, loc="outside lower center", ncols=6, frameon=False, fontsize=8)
    fig.suptitle("Points: measured, quaternion form. Lines: slope of the order promised, 2, 4, 6 and 8", fontsize=10)
    save(fig, path)


def draw_energy(found: Sequence[Finding], path: Path) -> None:
    """Energy of the long runs, a panel for each problem."""
    names = list(dict.fromkeys(f.problem for f in found))
    chosen = ("nodal", "verlet", "midpoint", "galerkin(time=2)", "galerkin(time=3)", "galerkin(time=4)")
    palette = dict(zip(chosen, ("#999999", "#1f6f8b", "#c0532b", "#5b8c3a", "#7a4a91", "#000000"), strict=True))
    fig, axes = plt.subplots(1, len(names), figsize=(13.0, 4.2), layout="constrained")
    for ax, name in zip(axes, names, strict=True):
        for f in found:
            if f.problem == name and f.form == "quaternion" and f.rule in chosen and f.run:
                share, width = np.arange(len(f.times)) / (len(f.times) - 1), 20
                deviation = np.maximum(np.abs(f.energies), 1e-17)[1:]
                deviation = deviation[: len(deviation) // width * width].reshape(-1, width).max(axis=1)
                ax.semilogy(share[1::width][: len(deviation)], deviation, color=palette[f.rule], lw=1.0, label=f.rule)
        ax.set(title=name, xlabel="part of the long run; its length is in the tables", ylim=(1e-16, 1e-2))
    axes[0].set_ylabel("largest |E − E(0)| of 20 frames, over the largest T")
    handles, labels = axes[-1].get_legend_handles_labels()
    fig.legend(handles, labels, loc="outside lower center", ncols=6, frameon=False, fontsize=8)
    save(fig, path)


def draw_stiff(stiff: Sequence[Convergence], path: Path) -> None:
    """Error of the tip against the step, far above the explicit limit."""
    fig, ax = plt.subplots(figsize=(6.0, 4.2), layout="constrained")
    for c in stiff:
        ax.loglog(c.steps, c.errors, "o-", color=COLORS[c.expected], fillstyle="none", lw=0.8, label=c.rule)
        first = int(np.flatnonzero(np.isfinite(c.errors))[0])
        line = c.errors[first] * (c.steps / c.steps[first]) ** c.expected
        ax.loglog(c.steps, line, ":", lw=1.0, color=COLORS[c.expected])
    ax.set(
        title="rubber pendulum, 10 elements, let go from rest",
        xlabel="time step [s] (explicit limit 1.3e-4 s)",
        ylabel="error of the tip at 1 s [m]",
        ylim=(1e-11, 1e-1),
    )
    ax.text(0.97, 0.04, "dotted: the slope promised for resolved steps", transform=ax.transAxes, fontsize=8, ha="right")
    ax.legend(frameon=False, fontsize=8, loc="upper left")
    save(fig, path)


def save(fig: Any, path: Path) -> None:
    """Write a figure."""
    path.parent.mkdir(exist_ok=True)
    fig.savefig(path, dpi=130)
    plt.close(fig)
