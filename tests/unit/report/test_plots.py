"""`run.plot`: the lines are the run's numbers."""

import subprocess
import sys

import numpy as np
import pytest

import cayley as cy


def lines(axes):
    return {line.get_label(): line.get_ydata() for line in axes.lines}


def test_energy(crane):
    (axes,) = crane.plot.energy().axes
    np.testing.assert_array_equal(lines(axes)["$E$ total"], crane.energy.values)
    assert axes.get_ylabel() == "energy [J]"


def test_momenta(crane):
    top, bottom = crane.plot.momenta().axes
    np.testing.assert_array_equal(lines(top)[r"$\Gamma_3$"], crane.linear_momentum[:, 2].values)
    np.testing.assert_array_equal(lines(bottom)[r"$\Pi_1$"], crane.angular_momentum[:, 0].values)


def test_balance(crane):
    (axes,) = crane.plot.balance().axes
    np.testing.assert_array_equal(lines(axes)["work"], crane.work.values)
    np.testing.assert_array_equal(lines(axes)["defect"], crane.energy_balance.defect.values)


def test_along(crane):
    """A panel for each component, a line for each time; fields of elements at their middle."""
    grid = crane.plot.along("moment", "boom", times=[0.0, 0.5]).axes
    assert [axes.get_ylabel() for axes in grid] == ["x [N m]", "y [N m]", "z [N m]"]
    np.testing.assert_array_equal(lines(grid[1])["$t$ = 0.5 s"], crane["boom"].moment[25, :, 1].values)
    first = crane.plot.along("curvature").axes[0].lines[0]
    np.testing.assert_allclose(first.get_xdata(), (np.arange(6) + 0.5) / 6)


def test_over_time(crane):
    (axes,) = crane.plot.over_time("boom", "force", node=2).axes
    np.testing.assert_array_equal(lines(axes)["z"], crane["boom"].force[:, 2, 2].values)
    assert axes.get_title(loc="left").endswith(", node 2")
    (axes,) = crane.plot.over_time("weight", "kinetic_energy").axes
    np.testing.assert_array_equal(lines(axes)["kinetic_energy"], crane["weight"].kinetic_energy.values)
    with pytest.raises(KeyError, match="boom has no 'torque'; it has position"):
        crane.plot.over_time("boom", "torque")


def test_the_others_are_the_same_figures(crane):
    assert len(crane.plot.snapshots(times=[0.0, 1.0]).axes) == 3
    assert len(crane.plot.resultants("mast", nodes=[0]).axes) == 2


def test_notebooks_show_figures_and_tables(crane):
    assert crane.plot.energy()._repr_png_().startswith(b"\x89PNG")
    assert "<td" in crane._repr_html_()
    assert ">mast</td>" in crane._repr_html_()
    assert "ball of mast.end and boom.start" in crane.model._repr_html_()
    rest = cy.equilibrium(cy.Model(crane.model.rods[1], supports=[cy.supports.clamp(crane.model.rods[1].start)]))
    assert ">stable</td>" in rest._repr_html_()


def test_results_load_no_matplotlib():
    code = "import sys, cayley as cy; cy.Trajectory; assert not {'matplotlib', 'cayley.report'} & set(sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True)
