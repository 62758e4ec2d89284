"""Nothing passes through anything: not when it is fast and thin, not in a knot that is pulled, not in a twisted rod."""

import math

import numpy as np
import pytest

import cayley as cy
from cayley import damping, loads, supports

STEEL = cy.Material(density=7800.0, youngs_modulus=2e9, poisson_ratio=0.3)
SOFT = cy.Material(density=1100.0, youngs_modulus=1e6, poisson_ratio=0.49)
THIN = 0.002


def wire(name, start, way):
    return cy.Rod(cy.Section.circle(THIN, STEEL), length=0.2, origin=start, direction=way, elements=10, name=name)


SHEET = cy.Mesh(np.array([[-0.3, -0.3, 0], [0.3, -0.3, 0], [0.3, 0.3, 0], [-0.3, 0.3, 0]]), [[0, 1, 2], [0, 2, 3]])
TARGETS = {
    "rod": [],
    "thin cylinder": [cy.Cylinder(0.002, 0.4, axis=(0, 1, 0))],
    "thin box": [cy.Box((0.3, 0.3, 0.002))],
    "sheet": [SHEET],
    "small ball": [cy.Sphere(0.004)],
}


@pytest.mark.filterwarnings("ignore::cayley.ContactDepthWarning")
@pytest.mark.parametrize("target", TARGETS)
def test_a_fast_thin_rod_does_not_pass_through(target):
    """The library takes smaller steps by itself; with a step that is too long it says so."""
    arrow = wire("arrow", (-0.1, 0.0, 0.02), (1, 0, 0))
    parts = [arrow, wire("other", (0.003, -0.103, 0), (0, 1, 0))] if target == "rod" else [arrow]
    model = cy.Model(*parts, obstacles=TARGETS[target], contact=cy.Contact())
    for speed in (10.0, 100.0, 500.0):
        initial = {arrow: {"velocity": np.broadcast_to([0, 0, -speed], (11, 3))}}
        run = cy.simulate(model, 0.06 / speed, save_every=0.003 / speed, initial=initial)
        height = run["arrow"].position.values[:, 5, 2]
        if target == "rod":
            height = height - run["other"].position.values[:, 5, 2]
        assert run.contacts.deepest[-1] > 0.0
        assert height.min() > 0.0
    with pytest.raises(cy.SimulationError, match=r"arrow and .*might pass through; give dt below"):
        cy.simulate(model, 0.06 / speed, dt=3e-6, save_every=0.006 / speed, initial=initial)


def apart(points, radius, skip):
    """Least distance of points along a rod that are more than some elements apart, in diameters."""
    part = np.linspace(0.0, 1.0, 4, endpoint=False)[:, None, None]
    dense = (points[:-1] + part * np.diff(points, axis=0)).transpose(1, 0, 2).reshape(-1, 3)
    far = np.linalg.norm(dense[:, None] - dense, axis=-1)
    number = np.arange(len(dense)) / 4
    far[np.abs(number[:, None] - number) < skip] = np.inf
    return far.min() / (2.0 * radius)


def writhe(points):
    """By Gauss' integral over the middles of elements: it jumps by 2 where a rod passes through itself."""
    ways, middles = np.diff(points, axis=0), 0.5 * (points[1:] + points[:-1])
    r = middles[:, None] - middles
    size = np.linalg.norm(r, axis=-1)
    np.fill_diagonal(size, np.inf)
    return np.einsum("ijk,ijk->", np.cross(ways[:, None], ways[None]), r / size[..., None] ** 3) / (4.0 * np.pi)


def assert_not_through(shapes, radius, skip):
    found = [writhe(points) for points in shapes]
    assert np.abs(np.diff(found)).max() < 1.0
    assert min(apart(points, radius, skip) for points in shapes) > 0.97
    return found


def test_a_trefoil_that_is_pulled_tight_stays_one():
    radius, u = 0.004, np.linspace(0.35, 2.0 * np.pi - 0.35, 80)
    knot = 0.02 * np.stack([np.sin(u) + 2 * np.sin(2 * u), np.cos(u) - 2 * np.cos(2 * u), -np.sin(3 * u)], axis=1)
    out = np.linspace(0.01, 0.06, 6)[:, None]
    ends = [(knot[k] - knot[k + step]) / np.linalg.norm(knot[k] - knot[k + step]) for k, step in ((0, 1), (-1, -1))]
    points = np.concatenate([(knot[0] + out * ends[0])[::-1], knot, knot[-1] + out * ends[1]])
    section = cy.Section.circle(radius, SOFT)
    rope = cy.Rod.through(section, points, elements=48, name="rope", damping=damping.retardation(1e-3))
    pull = [loads.force(rope.start, (-0.5, 0, 0)), loads.force(rope.end, (0.5, 0, 0))]
    run = cy.simulate(cy.Model(rope, loads=pull, contact=cy.Contact(friction=0.1)), 0.25, save_every=0.01)
    shapes = run[rope].position.values
    found = assert_not_through(shapes, radius, 10)
    assert np.linalg.norm(shapes[-1, -1] - shapes[-1, 0]) > 10.0 * np.linalg.norm(shapes[0, -1] - shapes[0, 0])
    assert found[-1] < -4.0  # an open trefoil pulled tight; untied it would be about 0
    assert run.contacts.number[-1] >= 8


def test_a_twisted_rod_with_slack_coils_up_without_passing_through_itself():
    radius, length, time = 0.006, 0.5, 0.5
    rod = cy.Rod(
        cy.Section.circle(radius, SOFT),
        length=length,
        direction=(1, 0, 0),
        elements=36,
        name="rod",
        damping=damping.retardation(2e-3),
    )

    def turn(t):
        return 2.0 * math.pi * 5.0 * min(t / time, 1.0), 0.0, 0.0

    def shift(t):
        return -0.15 * length * (1.0 - math.cos(math.pi * min(t / (0.3 * time), 1.0))), 0.0, 0.0

    held = [supports.clamp(rod.start), supports.drive(rod.end, position=shift, rotation=turn)]
    aside = loads.force(rod.node(18), (0, 0.02, 0.01))
    model = cy.Model(rod, supports=held, loads=[aside], contact=cy.Contact(friction=0.1))
    run = cy.simulate(model, 1.2 * time, save_every=0.0125)
    found = assert_not_through(run[rod].position.values, radius, 5)
    assert found[-1] > 0.8
    assert run.contacts.number.max() >= 2


TIP = np.array([[0, 0, 0.06], [0.05, 0, -0.03], [-0.03, 0.04, -0.03], [-0.03, -0.04, -0.03]])
FACES = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]]
FLYING = {
    "ball": lambda body: cy.Sphere(0.02, on=body),
    "box": lambda body: cy.Box((0.06, 0.05, 0.04), on=body),
    "cylinder": lambda body: cy.Cylinder(0.02, 0.05, on=body),
    "tetrahedron": lambda body: cy.Mesh(TIP, FACES, on=body),
}
STRUCK = {
    "plate": cy.Box((0.6, 0.6, 0.004)),
    "sheet": SHEET,
    "ball": cy.Sphere(0.02, center=(0.012, 0.021, 0)),
    "box": cy.Box((0.05, 0.05, 0.05), center=(0.012, 0.021, 0)),
}


@pytest.mark.filterwarnings("ignore::cayley.ContactDepthWarning")
@pytest.mark.parametrize("target", STRUCK)
@pytest.mark.parametrize("shape", FLYING)
def test_fast_bodies_do_not_pass_through_and_make_no_energy(shape, target):
    turn = np.array([0.8, 0.3, 0.4, 0.33])
    body = cy.Body(
        mass=0.2,
        inertia=[2e-4, 3e-4, 4e-4],
        position=(0.01, 0.02, 0.3),
        rotation=turn / np.linalg.norm(turn),
        name="body",
    )
    model = cy.Model(
        body,
        loads=[loads.gravity((0, 0, -9.81))],
        obstacles=[FLYING[shape](body), STRUCK[target]],
        contact=cy.Contact(friction=0.2),
    )
    run = cy.simulate(model, 0.006, save_every=1e-4, initial={body: {"velocity": (0, 0, -100.0)}})
    assert run.contacts.deepest[-1] > 0.0
    assert run[body].position.values[:, 2].min() > 0.0
    balance = run.energy_balance
    assert np.abs(balance.defect.values).max() < 0.05 * run.energy.values[0]
