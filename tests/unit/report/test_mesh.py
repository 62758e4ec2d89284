"""Surfaces of rods: normals and caps."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cayley.model import Material, Section
from cayley.report.mesh import ring, triangles

STEEL = Material(density=7850.0, youngs_modulus=2e11, poisson_ratio=0.3)
I_BEAM = np.array(
    [[3, 4], [-3, 4], [-3, 3], [-1, 3], [-1, -3], [-3, -3], [-3, -4], [3, -4], [3, -3], [1, -3], [1, 3], [3, 3]]
)


def area(points):
    x, y = np.asarray(points, dtype=float).T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))


@pytest.mark.parametrize(
    "outline", [I_BEAM, Section.circle(0.1, STEEL).outline, Section.rectangle(1, 2, STEEL).outline]
)
def test_caps_fill_the_outline(outline):
    """Triangles, all counter-clockwise, have the area of the polygon, also of one that is not convex."""
    outline = np.asarray(outline, dtype=float)
    parts = [area(outline[list(corners)]) for corners in triangles(outline)]
    assert len(parts) == len(outline) - 2
    assert min(parts) >= 0.0
    assert_allclose(sum(parts), area(outline), rtol=1e-12)


def test_a_rectangle_has_flat_faces():
    around = ring(Section.rectangle(0.2, 0.1, STEEL).outline[None])
    assert_allclose(around.normals[0, :, 0], around.normals[0, :, 1], atol=1e-15)
    assert {tuple(np.round(normal).astype(int)) for normal in around.normals[0, :, 0]} == {
        (1, 0),
        (-1, 0),
        (0, 1),
        (0, -1),
    }


def test_a_circle_is_smooth():
    """Normals point from the center, and neighbor faces share them."""
    outline = Section.circle(0.1, STEEL).outline
    around = ring(outline[None])
    assert_allclose(around.normals[0, :, 0], outline / np.linalg.norm(outline, axis=1)[:, None], atol=1e-12)
    assert_allclose(around.normals[0, :, 1], np.roll(around.normals[0, :, 0], -1, axis=0), atol=1e-12)
