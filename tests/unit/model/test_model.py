"""Names, held components, replacement and the listing of a model, and refusals."""

import copy
import subprocess
import sys

import pytest

from cayley.model import Model, Rod, loads, supports

UP = (0.0, 0.0, 1.0)

LISTED = "Model: a part is a list, but must be a Rod or a Body; write Model(*parts)"


def torque(t):
    return (t, 0.0, 0.0)


@pytest.fixture
def nameless(section):
    def make(name=""):
        return Rod(section, length=1.0, elements=3, name=name)

    return make


def test_names(rod, nameless):
    parts = nameless(), rod, nameless("rod2"), nameless()
    model = Model(*parts)
    assert model.names == ("rod", "mast", "rod2", "rod3")
    assert [model.name_of(part) for part in parts] == list(model.names)
    assert model.rods == model.parts == parts
    assert Model(nameless()).names == ("rod",)
    assert model.mass == pytest.approx(rod.mass + 3 * parts[0].mass)


def test_supports_at_one_node_add_up(rod):
    model = Model(
        rod, supports=[supports.hold(rod.end, position="x"), supports.hold(rod.end, position="z", rotation="y")]
    )
    assert model.held(rod.end) == ((True, False, True), (False, True, False))
    assert model.held(rod.start) == ((False, False, False), (False, False, False))


def test_replace(rod, nameless):
    gravity = loads.gravity((0, 0, -9.81))
    model = Model(rod, supports=[supports.pin(rod.start)], loads=[gravity])
    kick = loads.force(rod.end, UP)
    kicked = model.replace(loads=[gravity, kick])
    assert kicked.loads == (gravity, kick)
    assert kicked.supports == model.supports
    assert kicked.parts == model.parts
    assert model.loads == (gravity,)
    assert model.replace(supports=()).supports == ()
    assert model.replace() == model
    arm = nameless("arm")
    assert model.replace(parts=[rod, arm]).names == ("mast", "arm")
    with pytest.raises(TypeError):
        model.replace(load=[gravity])


def test_frozen(rod):
    with pytest.raises(AttributeError):
        Model(rod).loads = ()


def test_copies_stay_whole(rod):
    model = copy.deepcopy(Model(rod, supports=[supports.pin(rod.start)], loads=[loads.force(rod.end, UP)]))
    assert model.supports[0].port.part is model.loads[0].part is model.rods[0]


def test_listing(rod, nameless):
    other = nameless()
    model = Model(
        rod,
        other,
        supports=[supports.clamp(rod.start), supports.hold(other.node(1), position="z")],
        loads=[
            loads.gravity((0, 0, -9.81)),
            loads.moment(other.end, torque, frame="body", until=2.0),
            loads.line_force(rod, UP),
        ],
    )
    assert str(model).splitlines() == [
        "Model: 2 rods, 7 elements, 9 nodes, 7.39845 kg",
        "  parts",
        "    mast: 2 m, 4 elements, circle of radius 0.01 m, 4.9323 kg",
        "    rod: 1 m, 3 elements, circle of radius 0.01 m, 2.46615 kg",
        "  supports",
        "    clamp at mast.start",
        "    hold position z at rod.node(1)",
        "  loads",
        "    gravity (0, 0, -9.81) m/s^2",
        "    moment on rod.end: function torque [N m], body frame, 0 s <= t < 2 s",
        "    line force on mast: (0, 0, 1) N/m, space frame",
    ]
    assert repr(model) == "Model(mast, rod; supports=2, loads=3)"
    assert str(Model(Rod(rod.section, length=1.0, elements=1))).splitlines() == [
        "Model: 1 rod, 1 element, 2 nodes, 2.46615 kg",
        "  parts",
        "    rod: 1 m, 1 element, circle of radius 0.01 m, 2.46615 kg",
        "  warnings",
        "    rod is neither held nor connected to another part; it flies free",
    ]


@pytest.mark.parametrize(
    ("hold", "load"),
    [
        (supports.pin, lambda port: loads.moment(port, UP)),
        (lambda port: supports.hold(port, rotation="xyz"), lambda port: loads.force(port, UP)),
        (lambda port: supports.hold(port, position="z"), lambda port: loads.force(port, (1, 0, 1))),
        (lambda port: supports.hold(port, position="z"), lambda port: loads.force(port, UP, frame="body")),
        (lambda port: supports.hold(port, position="z"), lambda port: loads.force(port, torque)),
        (lambda port: supports.hold(port, position="z"), lambda port: loads.force(port, (0, 0, 0))),
        (lambda port: supports.hold(port, rotation="z"), lambda port: loads.moment(port, UP)),
        (lambda port: supports.hold(port, rotation="xy"), lambda port: loads.moment(port, UP, frame="body")),
    ],
)
def test_loads_that_can_move_a_supported_node(rod, hold, load):
    assert len(Model(rod, supports=[hold(rod.end)], loads=[load(rod.end)]).loads) == 1


@pytest.mark.parametrize(
    ("hold", "load", "kind", "quantity"),
    [
        (supports.pin, lambda port: loads.force(port, UP), "force", "position"),
        (supports.clamp, lambda port: loads.force(port, torque), "force", "position"),
        (supports.clamp, lambda port: loads.force(port, UP, frame="body"), "force", "position"),
        (supports.clamp, lambda port: loads.moment(port, UP), "moment", "rotation"),
        (
            lambda port: supports.hold(port, rotation="xyz"),
            lambda port: loads.moment(port, torque),
            "moment",
            "rotation",
        ),
        (lambda port: supports.hold(port, position="z"), lambda port: loads.force(port, UP), "force", "position"),
        (
            lambda port: supports.hold(port, rotation="z"),
            lambda port: loads.moment(port, UP, frame="body"),
            "moment",
            "rotation",
        ),
    ],
)
def test_loads_that_only_pull_at_a_support(refused, nameless, hold, load, kind, quantity):
    first, rod = nameless(), nameless()
    refused(
        lambda: Model(first, rod, supports=[hold(rod.end)], loads=[load(rod.end)]),
        ValueError,
        f"Model: {kind} on rod2.end has no effect, for the {quantity} it acts on is held there; "
        "move it to another node or hold less",
    )


@pytest.mark.parametrize(
    ("call", "error", "line"),
    [
        (lambda rod, other: Model(), ValueError, "Model: there are no parts; give at least one Rod or Body"),
        (
            lambda rod, other: Model([rod]),
            TypeError,
            "Model: a part is a list, but must be a Rod or a Body; write Model(*parts)",
        ),
        (lambda rod, other: Model(rod.section), TypeError, "Model: a part is a Section, but must be a Rod or a Body"),
        (
            lambda rod, other: Model(rod, rod),
            ValueError,
            "Model: the same rod is given twice; give each part once",
        ),
        (
            lambda rod, other: Model(rod, Rod(rod.section, length=1.0, elements=1, name="mast")),
            ValueError,
            "Model: two parts have the name 'mast'; give each a name of its own",
        ),
        (
            lambda rod, other: Model(rod, loads=[loads.force(other.end, UP)]),
            ValueError,
            "Model: force on arm.end belongs to a rod that is not in the model; add it (the model has mast)",
        ),
        (
            lambda rod, other: Model(rod, loads=[loads.line_force(other, UP)]),
            ValueError,
            "Model: line force on arm belongs to a rod that is not in the model; add it (the model has mast)",
        ),
        (
            lambda rod, other: Model(rod, supports=[supports.pin(other.end)]),
            ValueError,
            "Model: pin at arm.end belongs to a rod that is not in the model; add it (the model has mast)",
        ),
        (
            lambda rod, other: Model(rod).name_of(other),
            ValueError,
            "Model: Rod(name='arm', length=1, elements=3, section='circle of radius 0.01 m') is not in the model; "
            "its parts are mast",
        ),
        (
            lambda rod, other: Model(rod, supports=supports.pin(rod.start)),
            TypeError,
            "Model: supports is a Support, but must be a list, such as supports=[supports.pin(rod.start)]",
        ),
        (
            lambda rod, other: Model(rod, loads=loads.gravity(UP)),
            TypeError,
            "Model: loads is a Gravity, but must be a list, such as loads=[loads.gravity((0, 0, -9.81))]",
        ),
        (
            lambda rod, other: Model(rod, supports=[rod.start]),
            TypeError,
            "Model: supports has a Port in it, but wants such as supports.pin(rod.start)",
        ),
        (
            lambda rod, other: Model(rod, loads=[supports.pin(rod.start)]),
            TypeError,
            "Model: loads has a Support in it, but wants such as loads.gravity((0, 0, -9.81))",
        ),
    ],
)
def test_refusals(refused, rod, nameless, call, error, line):
    refused(lambda: call(rod, nameless("arm")), error, line)


def test_import_brings_in_nothing_but_numpy():
    code = (
        "import sys, numpy, cayley; before = set(sys.modules); import cayley.model; "
        "print(*sorted({name.split('.')[0] for name in set(sys.modules) - before}))"
    )
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    assert set(loaded) <= {"cayley", "numpy"} | set(sys.stdlib_module_names)
