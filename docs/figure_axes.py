"""Draw docs/images/axes.png, the axes of sections and rods in docs/conventions.md: python docs/figure_axes.py."""

from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import cayley as cy
from cayley.lie import quaternion

IMAGES = Path(__file__).resolve().parent / "images"
STEEL = cy.Material(density=7850.0, youngs_modulus=2e11, poisson_ratio=0.3)
COLORS = ("#c0532b", "#1f6f8b", "#5a7d3a")
FILL, LINE = "#e9e6df", "#333333"


def main() -> None:
    """A section with its sizes, one with its centers, and a curved rod with its frames."""
    fig = plt.figure(figsize=(10.5, 3.7), layout="constrained")
    _sizes(fig.add_subplot(1, 3, 1))
    _centers(fig.add_subplot(1, 3, 2))
    _rod(fig.add_subplot(1, 3, 3, projection="3d"))
    fig.savefig(IMAGES / "axes.png", dpi=150)
    plt.close(fig)


def _axes(ax, size: float, at: tuple[float, float] = (0.0, 0.0)) -> None:  # type: ignore[no-untyped-def]
    """e1 to the right, e2 up, e3 out of the page."""
    for k, way in enumerate(((size, 0.0), (0.0, size))):
        tip = (at[0] + way[0], at[1] + way[1])
        ax.annotate("", tip, at, arrowprops={"arrowstyle": "-|>", "color": COLORS[k], "lw": 1.6})
        ax.text(tip[0] + 0.004, tip[1] + 0.004, f"$e_{k + 1}$", color=COLORS[k], fontsize=11)
    ax.plot(*at, "o", ms=9, mfc="white", mec=COLORS[2], mew=1.4, zorder=5)
    ax.plot(*at, "o", ms=2.5, color=COLORS[2], zorder=6)
    ax.set_aspect("equal")
    ax.axis("off")


def _extent(ax, a, b, text: str, shift: tuple[float, float]) -> None:  # type: ignore[no-untyped-def]
    """A dimension line with its name."""
    ax.annotate("", a, b, arrowprops={"arrowstyle": "<->", "color": LINE, "lw": 0.8, "shrinkA": 0, "shrinkB": 0})
    ax.text(0.5 * (a[0] + b[0]) + shift[0], 0.5 * (a[1] + b[1]) + shift[1], text, ha="center", va="center", fontsize=9)


def _sizes(ax) -> None:  # type: ignore[no-untyped-def]
    beam = cy.Section.i_beam(width=0.1, height=0.16, flange=0.016, web=0.012, material=STEEL, torsion="thin-wall")
    ax.fill(*beam.outline.T, fc=FILL, ec=LINE, lw=1.0)
    _axes(ax, 0.04)
    _extent(ax, (-0.05, 0.092), (0.05, 0.092), "width", (0.0, 0.008))
    _extent(ax, (-0.062, -0.08), (-0.062, 0.08), "height", (-0.02, 0.0))
    _extent(ax, (0.058, -0.08), (0.058, -0.064), "flange", (0.023, 0.0))
    _extent(ax, (-0.006, -0.04), (0.006, -0.04), "web", (0.02, -0.006))
    ax.set(xlim=(-0.1, 0.1), ylim=(-0.1, 0.11), title="sizes; $e_3$, the axis, points at you")


def _centers(ax) -> None:  # type: ignore[no-untyped-def]
    b, h, t = 0.08, 0.14, 0.012
    channel = [(0, 0), (b, 0), (b, t), (t, t), (t, h - t), (b, h - t), (b, h), (0, h)]
    section = cy.Section.polygon(channel, STEEL, torsion=1e-7)
    ax.fill(*section.outline.T, fc=FILL, ec=LINE, lw=1.0)
    _axes(ax, 0.045)
    left = section.outline[:, 0].min()
    wide, high = b - 0.5 * t, h - t
    shear = left + 0.5 * t - 3 * wide**2 * t / (6 * wide * t + high * t)
    mass = (0.022, -0.028)
    ax.annotate("", mass, (0, 0), arrowprops={"arrowstyle": "-|>", "color": LINE, "lw": 1.0})
    ax.plot(*mass, "s", color=LINE, ms=5)
    ax.text(mass[0] + 0.005, mass[1] - 0.004, "mass center c", fontsize=9, va="top")
    ax.annotate("", (shear, 0.0), (0, 0), arrowprops={"arrowstyle": "-|>", "color": LINE, "lw": 1.0})
    ax.plot(shear, 0.0, "^", color=LINE, ms=6)
    ax.text(shear, -0.012, "shear\ncenter a", fontsize=9, va="top", ha="center")
    ax.set(xlim=(-0.09, 0.1), ylim=(-0.1, 0.11), title="centers, measured from the axis")


def _rod(ax) -> None:  # type: ignore[no-untyped-def]
    circle = cy.Section.circle(0.02, STEEL)
    rod = cy.Rod.along(
        circle,
        lambda u: (np.cos(u), np.sin(u), 0.25 * u),
        span=(0.0, 3.4),
        elements=5,
        normal=(0, 0, 1),
    )
    fine = rod.reference(np.linspace(0.0, 1.0, 21))[0]
    ax.plot(*fine.T, color=LINE, lw=1.6)
    ax.plot(*rod.positions.T, "o", color=LINE, ms=3.5)
    for p, turn in zip(rod.positions, rod.rotations, strict=True):
        frame = np.asarray(quaternion.to_matrix(turn))
        for k in range(3):
            ax.quiver(*p, *(0.38 * frame[:, k]), color=COLORS[k], lw=1.3, arrow_length_ratio=0.25)
    start, frame = rod.positions[0], rod.frame(0.0)
    for k in range(3):
        ax.text(*(start + 0.5 * frame[:, k]), f"$d_{k + 1}$", color=COLORS[k], fontsize=11)
    ax.text(*(rod.positions[0] + [0.1, -0.4, -0.28]), "start, s = 0", fontsize=9)
    ax.text(*(rod.positions[-1] + [-0.1, 0.1, 0.45]), "end, s = length", fontsize=9)
    ax.set_aspect("equal")
    ax.view_init(24, -52)
    ax.set_axis_off()
    ax.set_title("frames along a rod, $d_3$ its tangent")


if __name__ == "__main__":
    main()
