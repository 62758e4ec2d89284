"""The screw rules: circles and helices exact on any mesh, order 2, momenta kept, explicit and implicit."""

import numpy as np
import pytest

import cayley as cy
from cayley import supports
from cayley.lie import exponential, quaternion

RUBBER = cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.4)
SECTION = cy.Section.circle(0.02, RUBBER)
E3 = np.array([0.0, 0.0, 1.0])


def helix(strain, curvature):
    """Position and rotation along a rod of constant strain: x' = Λ (e3 + Γ), p' = ½ p Ω from the origin."""

    def rotation(s):
        return exponential.exp(s * curvature)

    def position(s):
        nodes, weights = np.polynomial.legendre.leggauss(40)
        at = 0.5 * s * (nodes + 1.0)
        return 0.5 * s * weights @ quaternion.rotate(exponential.exp(at[:, None] * curvature), E3 + strain)

    return {"position": position, "rotation": rotation}


def start(elements, strain, curvature, rule=cy.rules.screw, **rest):
    rod = cy.Rod(SECTION, length=1.0, elements=elements)
    run = cy.simulate(cy.Model(rod), 1e-6, 1e-7, rule=rule, initial={rod: helix(strain, curvature) | rest})
    return run[rod].isel(time=0), run


@pytest.mark.parametrize("rule", [cy.rules.screw, cy.rules.screw_midpoint], ids=str)
@pytest.mark.parametrize("elements", [3, 4, 7])
def test_full_circle_is_exact(rule, elements):
    """A rod bent to a closed circle by end moments: the moment is EI κ in every node, and no force anywhere."""
    curvature = np.array([0.0, 2.0 * np.pi, 0.0])
    rod, run = start(elements, np.zeros(3), curvature, rule)
    moment = SECTION.stiffness[4, 4] * 2.0 * np.pi
    inner = rod.isel(node=slice(1, -1))
    np.testing.assert_allclose(inner.moment.values, np.tile([0, moment, 0], (elements - 1, 1)), atol=1e-12 * moment)
    assert np.abs(inner.force.values).max() < 1e-9
    np.testing.assert_allclose(rod.curvature.values, np.tile(curvature, (elements, 1)), atol=1e-12)
    assert float(run.potential_energy[0]) == pytest.approx(0.5 * moment * 2.0 * np.pi, rel=1e-12)


def test_helix_is_exact():
    """Constant shear, stretch, bending and twist at once, with large turns inside an element."""
    strain, curvature = np.array([0.03, -0.02, 0.05]), np.array([1.5, -2.0, 4.0])
    rod, run = start(4, strain, curvature)
    np.testing.assert_allclose(rod.strain.values, np.tile(strain, (4, 1)), atol=1e-12)
    np.testing.assert_allclose(rod.curvature.values, np.tile(curvature, (4, 1)), atol=1e-12)
    both = np.concatenate([strain, curvature])
    assert float(run.potential_energy[0]) == pytest.approx(0.5 * both @ SECTION.stiffness @ both, rel=1e-12)


@pytest.mark.parametrize("rotation", ["quaternion", "matrix"])
def test_momenta_and_energy_of_a_free_rod(rotation):
    rod = cy.Rod(SECTION, length=1.0, elements=6)
    initial = {
        rod: helix(np.zeros(3), np.array([0.5, 1.0, 0.3]))
        | {"velocity": lambda s: np.array([s, 1.0 - s, 0.5]), "angular_velocity": (1.0, 2.0, -1.0)}
    }
    run = cy.simulate(cy.Model(rod), 1.0, rule=cy.rules.screw, initial=initial, rotation=rotation)
    for momentum in (run.linear_momentum.values, run.angular_momentum.values):
        assert np.abs(momentum - momentum[0]).max() < 1e-11 * np.abs(momentum).max()
    assert np.ptp(run.energy) < 2e-2 * float(run.kinetic_energy[0])


def test_order_in_time_and_agreement_with_the_implicit_rule():
    rod = cy.Rod(SECTION, length=0.5, direction=(1, 0, 0), elements=5)
    model = cy.Model(rod, supports=[supports.clamp(rod.start)], loads=[cy.loads.gravity((0, 0, -9.81))])

    def tip(rule, steps):
        run = cy.simulate(model, 0.1, 0.1 / steps, rule=rule, save_every=0.1)
        return run.frames.values[-1, -1, 4:7]

    exact = tip(cy.rules.screw, 64000)
    errors = [np.linalg.norm(tip(cy.rules.screw, n) - exact) for n in (2000, 4000, 8000, 16000)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.abs(orders - 2.0).max() < 0.2
    assert np.linalg.norm(tip(cy.rules.screw_midpoint, 4000) - exact) < 1e-5


def test_a_density_without_a_pose_is_refused():
    with pytest.raises(
        ValueError, match=r"string: the rule screw is for a pose; declare one, such as pose=\('p', 'x'\)"
    ):
        cy.compile(
            cy.densities.string,
            rule=cy.rules.screw,
            domain=cy.Interval(0.0, 1.0, elements=4),
            constants=dict(mass=1.0, stiffness=1.0, gravity=np.ones(3)),
        )


@pytest.mark.parametrize("pose", [("x", "p"), ("p",), ("p", "y"), "px"])
def test_a_wrong_pose_is_refused(pose):
    with pytest.raises(TypeError, match=r"pose is .*; give the names of a rotation and of a vector of size 3"):
        cy.lagrangian(p=cy.Rotation(), x=cy.Vector(3), y=cy.Vector(2), s=cy.Interval, pose=pose)
