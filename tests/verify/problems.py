"""What the verification tests share: problems, measures of error and order, and tools on states."""

import numpy as np

import cayley as cy
from cayley.lie import quaternion
from cayley.system.system import State


@cy.lagrangian(p=cy.Rotation())
def heavy_top(q, c):
    """A body of inertia c.inertia about a fixed point, its weight acting at c.center (body frame)."""
    return 0.5 * cy.dot(q.p_t, c.inertia @ q.p_t) - c.weight * cy.dot(cy.E3, q.p.rotate(c.center))


CENTER = np.array([0.0, 1.0, 0.0])
TOP = {
    "inertia": np.diag([0.234375, 0.46875, 0.234375]) + 15.0 * (np.eye(3) - np.outer(CENTER, CENTER)),
    "weight": 15.0 * 9.81,
    "center": CENTER,
}
TOP_START = {"p": (1, 0, 0, 0), "p_t": (0, 150, -4.61538)}


@cy.lagrangian(p=cy.Rotation())
def free_body(q, c):
    """A free body with inertia c.inertia about its mass center."""
    return 0.5 * cy.dot(q.p_t, c.inertia @ q.p_t)


def thick_rod(elements, *, clamped=True):
    """A rubber rod of 1 m along x, 100 mm thick, so that a few hundred steps a second resolve all its modes."""
    rubber = cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.5)
    section = cy.Section.circle(0.05, rubber, shear_correction=27 / 28)
    rod = cy.Rod(section, length=1.0, direction=(1, 0, 0), normal=(0, 1, 0), elements=elements)
    return rod, cy.Model(rod, supports=[cy.supports.clamp(rod.start)] if clamped else [])


def slopes(errors, ratio=2.0):
    """Observed orders between successive refinements by a ratio, the coarsest first."""
    errors = np.asarray(errors)
    return np.log(errors[:-1] / errors[1:]) / np.log(ratio)


def fitted(x, y):
    """Exponent of the power law y ∝ xⁿ through all points."""
    return np.polyfit(np.log(x), np.log(y), 1)[0]


def assert_order(errors, order=2.0, within=0.2, floor=0.0):
    """Check that every refinement shows the order, and that the finest error is above the round-off."""
    observed = slopes(errors)
    assert errors[-1] > 10.0 * floor, f"the errors {errors} reach the round-off {floor:.1e}"
    assert np.all(np.abs(observed - order) < within), f"errors {np.array(errors)}, orders {observed}"


def rotation_distance(p, q):
    """Largest distance between unit quaternions, p and -p being equal."""
    return np.minimum(np.linalg.norm(p - q, axis=-1), np.linalg.norm(p + q, axis=-1)).max()


def frame_distance(run, other, rod):
    """Largest distance of positions [m] and of rotations [-] at the last frames of two runs of a rod."""
    a, b = run[rod].isel(time=-1), other[rod].isel(time=-1)
    return np.linalg.norm(a.position.values - b.position.values, axis=-1).max(), rotation_distance(
        a.rotation.values, b.rotation.values
    )


def turned_around(state):
    """The same place with all momenta reversed: running on from here is running back in time."""
    return State(values=state.values.copy(), momenta=-state.momenta)


def bend(rod, curvature):
    """Positions and rotations of a rod bent about d1 with the curvature κ sin⁴(π s/l) [1/m], without other strain.

    Smooth at free and clamped ends: curvature and its first three derivatives vanish there.
    """
    s = np.asarray(rod.nodes)
    k = 2.0 * np.pi / s[-1]

    def angle(at):
        return curvature / 4.0 * (1.5 * at - 2.0 * np.sin(k * at) / k + np.sin(2.0 * k * at) / (4.0 * k))

    point, weight = np.polynomial.legendre.leggauss(12)
    within = angle(0.5 * (s[:-1, None] + s[1:, None]) + 0.5 * np.diff(s)[:, None] * point)
    steps = 0.5 * np.diff(s)[:, None] * np.stack([-np.sin(within) @ weight, np.cos(within) @ weight], axis=1)
    local = np.concatenate([np.zeros((1, 3)), np.pad(np.cumsum(steps, axis=0), ((0, 0), (1, 0)))])
    turn = quaternion.from_rotation_vector(np.stack([angle(s), 0 * s, 0 * s], axis=1))
    base = np.asarray(rod.rotation)
    return {
        "position": rod.positions[0] + np.asarray(quaternion.rotate(base, local), dtype=float),
        "rotation": np.asarray(quaternion.multiply(base, turn), dtype=float),
    }


def in_flight(rod, start, velocity, spin):
    """Add a rigid motion to a start: velocity [m/s] at the origin and spin [rad/s], both in space."""
    return start | {
        "velocity": np.asarray(velocity) + np.cross(spin, start["position"]),
        "angular_velocity": np.asarray(
            quaternion.inverse_rotate(start["rotation"], np.broadcast_to(spin, (rod.elements + 1, 3)))
        ),
    }
