"""Bodies in the report: the box that is drawn, what the page says, and what is conserved."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import cayley as cy
from cayley import joints, loads, springs, supports
from cayley.report import write_report
from cayley.report.bodies import body_shape, box_sides
from cayley.report.conserved import load_free, preserved

SIDES = np.array([0.1, 0.4, 0.3])
BOX = cy.Body(
    mass=3.0,
    inertia=3.0 / 12.0 * ((SIDES**2).sum() - SIDES**2),
    position=(0, 0, 1),
    ports={"eye": (0, 0, 0.2)},
    name="box",
)


@pytest.fixture(scope="module")
def run():
    model = cy.Model(BOX, cy.PointMass(mass=1.0), loads=[loads.gravity((0, 0, -9.81))])
    return cy.simulate(model, t_end=0.1, dt=1e-3, initial={BOX: {"angular_velocity": (1, 2, 3)}})


def test_box_has_the_inertia():
    sides, axes = box_sides(BOX)
    assert_allclose(np.sort(sides), np.sort(SIDES), rtol=1e-12)
    assert_allclose(np.abs(axes) @ sides, SIDES, rtol=1e-12)
    rod = cy.Body(mass=1.0, inertia=[1.0, 1.0, 1e-9])
    assert_allclose(np.sort(box_sides(rod)[0])[2], np.sqrt(12.0), rtol=1e-6)


def test_shape(run):
    """Twelve edges as long as the sides, turned with the body; an arm to the port."""
    shape = body_shape(run, BOX, [0, len(run.time) - 1])
    lengths = np.linalg.norm(shape.edges[:, :, 1] - shape.edges[:, :, 0], axis=-1)
    assert_allclose(np.sort(lengths, axis=1), np.tile(np.sort(np.repeat(SIDES, 4)), (2, 1)), rtol=1e-9)
    assert_allclose(shape.arms[1, 0, 1], run.port(BOX, "eye").position[-1], atol=1e-12)
    assert_allclose(shape.edges[1].mean(axis=(0, 1)), run[BOX].position[-1], atol=1e-12)


def test_page(run, tmp_path):
    """A model without rods has a page, too."""
    page = write_report(run, tmp_path / "page.html").read_text(encoding="utf-8")
    assert "A box is a body" in page
    assert "box: rigid body, 3 kg" in page


def test_what_joints_leave():
    """A joint to the ground leaves no momentum alone, one between parts all; drives and dampers work all the time."""
    other = cy.Body(mass=1.0, inertia=[1, 1, 1], position=(0, 0, 1.2))
    free = cy.Model(BOX, other, joints=[joints.ball(BOX.port("eye"), other.centre)])
    assert preserved(free) == ((True,) * 3, (True,) * 3)
    assert preserved(free.replace(supports=[supports.roll(BOX.centre, (0, 0, 1))])) == ((False,) * 3, (False,) * 3)


def test_drives_and_dampers_are_told(run):
    damped = cy.Model(BOX, springs=[springs.linear(BOX.centre, cy.ground.at((0, 0, 0)), damping=1.0)])
    for model, free in ((run.model, True), (damped, False)):
        other = cy.Trajectory(frames=run.frames, info=run.info, outline=run.outline, observed=run.observed, model=model)
        assert load_free(other).free is free
