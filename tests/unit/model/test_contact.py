"""Contact: what it keeps and refuses, radii, who touches whom, and its lines in the listing of a model."""

import copy

import pytest

from cayley.model import Body, Box, Contact, Cylinder, Model, Plane, Rod, Section, contact_radius, supports


@pytest.fixture
def strip(steel):
    return Rod(Section.rectangle(0.03, 0.04, steel), length=1.0, elements=2, name="strip")


@pytest.fixture
def drum():
    return Body(mass=1.0, inertia=[1, 1, 1], name="drum")


def test_who_touches(rod, section, drum):
    other, floor = Rod(section, length=1.0, elements=1), Plane()
    shell, lid = Cylinder(0.1, 1.0, on=drum), Box((1, 1, 1), on=drum)
    contact = Contact(self_contact=[rod], without=[(rod, drum), (floor, other), (lid, floor)])
    assert contact.touches_itself(rod)
    assert not contact.touches_itself(other)
    assert contact.excludes(rod, shell)
    assert contact.excludes(lid, rod)
    assert contact.excludes(other, floor)
    assert contact.excludes(floor, lid)
    assert not contact.excludes(floor, shell)
    assert not contact.excludes(rod, other)
    assert not contact.excludes(rod, rod)
    assert not Contact(without=[(rod, rod)]).touches_itself(rod)
    assert not Contact(self_contact=False).touches_itself(rod)


def test_radii(rod, strip, steel):
    """Of circles and tubes their own, where they taper the largest; others want one, which may override, too."""
    tube = Rod(Section.tube(outer_radius=0.02, thickness=0.001, material=steel), length=1.0, elements=1)
    cone = Rod(lambda s: Section.circle(0.02 - 0.01 * s, steel), length=1.0, elements=2, name="cone")
    model = Model(rod, tube, cone, strip, contact=Contact(radii={strip: 0.02, tube: 0.03}))
    assert [contact_radius(model, part) for part in model.rods] == [0.01, 0.03, 0.02, 0.02]
    assert model.warnings == ("cone touches with its largest radius, 0.02 m, everywhere; least is 0.01 m",)
    assert strip.stations.radius is None
    with pytest.raises(ValueError, match=r"radii={strip: 0.025}\) \(that of the circle around the section\)"):
        Model(strip, obstacles=[Plane()])


def test_a_model_has_contact_where_there_are_obstacles(rod, strip):
    floor = Plane(name="floor")
    model = Model(rod, obstacles=[floor])
    assert model.obstacles == (floor,)
    assert isinstance(model.contact, Contact)
    assert Model(rod).contact is None
    given = Contact(friction=0.2)
    other = model.replace(contact=given)
    assert other.contact is given
    assert other.obstacles == (floor,)
    assert other.replace(supports=[supports.pin(rod.start)]).contact is given
    assert other.replace(obstacles=()).contact is given
    assert other.replace(obstacles=(), contact=None).contact is None
    assert other.replace() == other
    assert Model(strip).contact is None
    copied = copy.deepcopy(Model(rod, strip, contact=Contact(radii={strip: 0.1}, self_contact=[rod])))
    assert contact_radius(copied, copied.rods[1]) == 0.1
    assert copied.contact.touches_itself(copied.rods[0])


def test_listing(rod, strip, drum):
    floor, shell = Plane(friction=0.5), Cylinder(0.1, 1.0, on=drum, name="shell")
    model = Model(
        rod,
        strip,
        drum,
        obstacles=[floor, shell, Plane()],
        contact=Contact(friction=0.3, self_contact=[rod], radii={strip: 0.02}, without=[(strip, floor)]),
    )
    assert model.obstacle_names == ("plane", "shell", "plane2")
    assert str(model).splitlines()[5:] == [
        "  obstacles",
        "    plane: through (0, 0, 0), normal (0, 0, 1), friction 0.5",
        "    shell: cylinder, radius 0.1 m, length 1 m, center (0, 0, 0), axis (0, 0, 1), on drum",
        "    plane2: plane, through (0, 0, 0), normal (0, 0, 1)",
        "  contact",
        "    friction 0.3, penetration 0.01 radii, damping 0.05, self-contact of 1 rod",
        "    radius of strip: 0.02 m",
        "    strip never touches plane",
    ]
    assert repr(model) == "Model(mast, strip, drum; supports=0, loads=0, obstacles=3)"


def test_a_mesh_turned_inside_out_looks_odd(rod):
    box = Box((1, 1, 1)).mesh
    inside = type(box)(box.vertices, box.triangles[:, ::-1], name="tank")
    assert Model(rod, obstacles=[box]).warnings == ()
    (line,) = Model(rod, obstacles=[inside]).warnings
    assert line.startswith("tank is closed and its triangles are clockwise seen from outside")


FLOOR = Plane(name="floor")


@pytest.mark.parametrize(
    ("call", "error", "line"),
    [
        (lambda r, s, b: Contact(friction=-1), ValueError, "Contact: friction = -1.0 must be a number from 0 [-]"),
        (lambda r, s, b: Contact(damping=2.0), ValueError, "Contact: damping = 2.0 must be a number from 0 to 1"),
        (lambda r, s, b: Contact(penetration=1.5), ValueError, "Contact: penetration = 1.5 must be below 1"),
        (lambda r, s, b: Contact(impact_depth=0), ValueError, "Contact: impact_depth = 0 must be a positive, finite"),
        (lambda r, s, b: Contact(stiffness=0), ValueError, "Contact: stiffness = 0 must be a positive, finite number"),
        (lambda r, s, b: Contact(self_contact=r), TypeError, "must be True, False or a list of rods"),
        (lambda r, s, b: Contact(radii={b: 1.0}), TypeError, "must be a dictionary {rod: radius [m]}"),
        (lambda r, s, b: Contact(radii={r: 0}), ValueError, "radii[Rod 'mast'] = 0 must be a positive"),
        (lambda r, s, b: Contact(without=[r, s]), TypeError, "must be a list of pairs of parts or shapes"),
        (lambda r, s, b: Contact(without=[(b, b)]), ValueError, "without has Body 'drum' twice in a pair"),
        (lambda r, s, b: Contact(allow_overlap=1), TypeError, "allow_overlap = 1 must be True or False"),
        (
            lambda r, s, b: Model(r, obstacles=FLOOR),
            TypeError,
            "Model: obstacles is a Plane, but must be a list, such as obstacles=[Plane()]",
        ),
        (lambda r, s, b: Model(r, contact=True), TypeError, "Model: contact is a bool, but must be a Contact or None"),
        (lambda r, s, b: Model(r, obstacles=[FLOOR, FLOOR]), ValueError, "Plane 'floor' is given twice"),
        (
            lambda r, s, b: Model(r, obstacles=[FLOOR, Plane(name="floor")]),
            ValueError,
            "Model: two obstacles have the name 'floor'; give each a name of its own",
        ),
        (
            lambda r, s, b: Model(r, obstacles=[Box((1, 1, 1), on=b)]),
            ValueError,
            "Model: Box is on Body 'drum', which is not in the model; add it (the model has mast)",
        ),
        (
            lambda r, s, b: Model(r, obstacles=[FLOOR], contact=Contact(without=[(r, b)])),
            ValueError,
            "Model: without of the Contact has Body 'drum', which is not in the model; add it",
        ),
        (
            lambda r, s, b: Model(r, contact=Contact(radii={s: 0.1})),
            ValueError,
            "Model: radii of the Contact has Rod 'strip', which is not in the model; add it (the model has mast)",
        ),
    ],
)
def test_refusals(rod, strip, drum, call, error, line):
    with pytest.raises(error) as caught:
        call(rod, strip, drum)
    assert line in str(caught.value)
    assert "\n" not in str(caught.value)
