"""The search for contacts finds what a look at all pairs finds, in scenes of all sizes; it leaves out what it must."""

import itertools

import numpy as np
import pytest

import cayley as cy
from cayley.lie import quaternion
from cayley.steppers.contacts import view
from cayley.system.discretize import discretize

RUBBER = cy.Material(density=1100.0, youngs_modulus=2e6, poisson_ratio=0.49)


def rod(start, way, radius, elements=4, name=""):
    length = float(np.linalg.norm(way))
    return cy.Rod(
        cy.Section.circle(radius, RUBBER),
        length=length,
        origin=tuple(start),
        direction=tuple(way),
        elements=elements,
        name=name,
    )


def pairs(model):
    """Owners and elements of the rods that touch, by the engine."""
    system = discretize(model, cy.rules.verlet)
    touching = system.contact
    found = set()
    for a, b in view(system, system.reference, 1.0)[:, :2].astype(int):
        if max(a, b) < touching.segments:
            found.add((int(a), int(b)))
    return found, touching


def distance(p, u, q, v):
    """Of two segments: least of the distances of their ends from the other, and of the lines where they cross."""
    found = []
    for a, b, w in ((p, q, v), (p + u, q, v), (q, p, u), (q + v, p, u)):
        ww = np.sum(w * w, axis=-1)
        t = np.clip(np.sum((a - b) * w, axis=-1) / np.where(ww > 0.0, ww, 1.0), 0.0, 1.0)
        found.append(np.linalg.norm(a - b - t[..., None] * w, axis=-1))
    n = np.cross(u, v)
    nn = np.maximum(np.sum(n * n, axis=-1), 1e-300)
    r = q - p
    s, t = (np.sum(np.cross(r, w) * n, axis=-1) / nn for w in (v, u))
    crossing = (s > 0.0) & (s < 1.0) & (t > 0.0) & (t < 1.0)
    found.append(np.where(crossing, np.abs(np.sum(r * n, axis=-1)) / np.sqrt(nn), np.inf))
    return np.min(found, axis=0)


@pytest.mark.parametrize("scene", ["alike", "many sizes", "far apart", "flat"])
def test_it_finds_all_pairs_of_segments(scene):
    random = np.random.default_rng(7)
    spread = {"alike": 0.2, "many sizes": 0.5, "far apart": 40.0, "flat": 0.3}[scene]
    rods, balls = [], []
    for k in range(60):
        start = spread * random.uniform(-1.0, 1.0, 3) * ([1, 1, 1] if scene != "flat" else [1, 1, 0])
        if scene == "far apart":  # clusters, some at negative places
            start = spread * random.integers(-1, 2, 3) + random.uniform(-0.15, 0.15, 3)
        size = 10.0 ** random.uniform(-1.5, 0.5) if scene == "many sizes" else 0.2
        rods.append(rod(start, size * random.standard_normal(3), 0.05 * size, elements=1 + k % 5, name=f"r{k}"))
        balls.append(cy.Sphere(0.1 * size, center=tuple(start + random.uniform(-0.3, 0.3, 3))))
    found, touching = pairs(cy.Model(*rods, obstacles=balls, contact=cy.Contact(friction=0.5, self_contact=False)))
    system = discretize(cy.Model(*rods), cy.rules.verlet)
    places = system.reference[:, system.layout.rows_of("x")]
    first = np.concatenate([[0], np.cumsum([r.elements + 1 for r in rods])])
    starts = np.concatenate([places[a : b - 1] for a, b in itertools.pairwise(first)] + [[b.center for b in balls]])
    ends = np.concatenate([places[a + 1 : b] for a, b in itertools.pairwise(first)] + [[b.center for b in balls]])
    radii, owner = touching.arrays["radius"], touching.arrays["owner"]
    a, b = np.triu_indices(len(starts), 1)
    near = distance(starts[a], (ends - starts)[a], starts[b], (ends - starts)[b]) < radii[a] + radii[b]
    moving = (owner[a] < len(rods)) | (owner[b] < len(rods))
    wanted = near & (owner[a] != owner[b]) & moving
    assert wanted.sum() > 8
    assert found == set(zip(a[wanted].tolist(), b[wanted].tolist(), strict=True))


def test_neighbors_along_a_rod_do_not_touch_and_others_do():
    """A rod rolled up on a helix of half its thickness touches itself from half a turn of its own on."""
    radius, turns = 0.01, 3

    def helix(s):
        angle = s / 0.03
        return np.stack([0.03 * np.cos(angle), 0.03 * np.sin(angle), 0.25 * radius * angle / np.pi], axis=-1)

    own = cy.Rod.through(
        cy.Section.circle(radius, RUBBER), helix(np.linspace(0, 0.06 * np.pi * turns, 61)), elements=60
    )
    found, touching = pairs(cy.Model(own, contact=cy.Contact()))
    along = touching.arrays["along"]
    apart = np.array([abs(along[a] - along[b]) for a, b in found])
    element = own.length / 60
    assert apart.min() >= 0.8 * np.pi * radius / element
    assert apart.max() >= 40  # two turns on
    none, _ = pairs(cy.Model(own, contact=cy.Contact(friction=0.5, self_contact=False)))
    assert not none


def test_what_is_excluded_does_not_touch():
    a, b = rod((-0.1, 0, 0), (0.2, 0, 0), 0.01, name="a"), rod((0.01, -0.1, 0.005), (0, 0.2, 0), 0.01, name="b")
    c = rod((-0.01, -0.1, -0.005), (0, 0.2, 0), 0.01, name="c")

    def touching(*, without=(), joints=()):
        found, known = pairs(
            cy.Model(a, b, c, contact=cy.Contact(without=without), **({"joints": joints} if joints else {}))
        )
        return {"".join(sorted(known.owner_of(k) for k in pair)) for pair in found}

    assert touching() == {"ab", "ac"}
    assert touching(without=[(a, b)]) == {"ac"}
    assert touching(without=[(b, a), (a, c)]) == set()


def outside(shape, points):
    """Distance of points from a box or a cylinder: from the nearest place in it."""
    if isinstance(shape, cy.Box):
        local = quaternion.inverse_rotate(np.array(shape.rotation), points - np.array(shape.center))
        half = 0.5 * np.array(shape.size)
        return np.linalg.norm(local - np.clip(local, -half, half), axis=-1)
    axis, local = np.array(shape.axis), points - np.array(shape.center)
    along = local @ axis
    across = np.linalg.norm(local - along[..., None] * axis, axis=-1)
    half = 0.5 * shape.length
    return np.hypot(across - np.minimum(across, shape.radius), along - np.clip(along, -half, half))


def test_it_finds_all_solids_and_how_deep_they_are_touched():
    """A little deep only: inside it is the faces that count.

    Elements so short that they bend around a cylinder touch it with their nodes alone, and may lie deeper between them.
    """
    random = np.random.default_rng(3)
    shapes = [cy.Box((8, 7, 9), center=(0, 0, -4.55)), cy.Cylinder(3.0, 9.0, center=(3.4, 0, 0), axis=(0, 1, 0.1))]
    for _ in range(25):
        center, turn = tuple(random.uniform(-0.5, 0.5, 3)), random.standard_normal(4)
        shapes.append(
            cy.Box(tuple(random.uniform(0.02, 0.2, 3)), center=center, rotation=tuple(turn / np.linalg.norm(turn)))
        )
        center, turn = tuple(random.uniform(-0.5, 0.5, 3)), random.standard_normal(3)
        shapes.append(cy.Cylinder(*random.uniform(0.02, 0.2, 2), center=center, axis=tuple(turn)))
    rods = [rod(random.uniform(-0.5, 0.5, 3), 0.2 * random.standard_normal(3), 0.04, name=f"r{k}") for k in range(60)]
    system = discretize(cy.Model(*rods, obstacles=shapes, contact=cy.Contact()), cy.rules.verlet)
    touching, places = system.contact, system.reference[:, system.layout.rows_of("x")]
    count, ends = touching.segments, places[touching.arrays["node"][touching.arrays["ends"]]]
    deepest = np.full((len(rods), len(shapes)), -np.inf)
    for a, b, _, depth in view(system, system.reference, 1.0)[:, :4]:
        if b >= count:
            pair = touching.arrays["owner"][int(a)], touching.arrays["possessor"][int(b) - count] - len(rods)
            deepest[pair] = max(deepest[pair], depth)
    part = np.linspace(0.0, 1.0, 201)[:, None, None]
    points = ((1.0 - part) * ends[:, 0] + part * ends[:, 1]).reshape(201, len(rods), -1, 3)
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).reshape(len(rods), -1)[:, 0]
    far = np.empty(deepest.shape)
    for k, shape in enumerate(shapes):
        around = isinstance(shape, cy.Cylinder) and lengths**2 <= 2.0 * 0.04 * (shape.radius + 0.04)
        own = np.where(
            around, outside(shape, points[[0, -1]]).min(axis=(0, 2)), outside(shape, points).min(axis=(0, 2))
        )
        far[:, k] = own
    near = (far > 1e-4) & (far < 0.0399)
    assert near.sum() > 40
    np.testing.assert_allclose(deepest[near], 0.04 - far[near], atol=3e-5)
    assert np.all(deepest[far > 0.0401] == -np.inf)


def test_elements_at_a_joint_leave_each_other_alone_and_others_touch():
    """A rod that is folded back at a hinge: it touches what it is hinged to, but not beside the hinge."""
    length, elements = 0.4, 8
    there = rod((0, 0, 0), (length, 0, 0), 0.01, elements=elements, name="there")
    back = rod((length, 0, 0), (-length, 0, 0.005), 0.01, elements=elements, name="back")
    hinge = cy.joints.hinge(there.end, back.start, axis=(0, 1, 0))
    rough = cy.Contact(friction=0.1)
    found, touching = pairs(cy.Model(there, back, joints=[hinge], contact=rough))
    free, _ = pairs(cy.Model(there, back, contact=rough))
    along = touching.arrays["along"]
    assert {(along[a], along[b]) for a, b in free - found} == {(elements - 1, 0)}
    assert {(along[a], along[b]) for a, b in found} >= {(elements - 2, 1), (0, elements - 1)}
    smooth, _ = pairs(cy.Model(there, back, joints=[hinge], contact=cy.Contact()))
    assert {(along[a], along[b]) for a, b in smooth} == {(elements - 2, 0)}  # nearest of all that may touch
