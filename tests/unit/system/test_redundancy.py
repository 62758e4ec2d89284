"""Redundant constraints of joints are found and told by name; sound mechanisms are not."""

import numpy as np
import pytest

from cayley.density import library
from cayley.discrete.layout import Layout
from cayley.discrete.representation import REPRESENTATIONS
from cayley.lie import quaternion
from cayley.system import redundancy
from cayley.system.couplings import GROUND, Coupling
from cayley.system.redundancy import redundant

LAYOUT = Layout(library.rigid_body.fields, REPRESENTATIONS["quaternion"])
UNIT = np.array([1.0, 0.0, 0.0, 0.0])


def body(*x: float) -> np.ndarray:
    return np.array([1.0, 0.0, 0.0, 0.0, *x])


def joint(kind: str, name: str, nodes: np.ndarray, first: int, second: int, at: tuple, turn: np.ndarray = UNIT):
    """A joint at a place in space, with a frame in space; all bodies stand unturned."""
    there = np.zeros(3) if second == GROUND else nodes[second, 4:]
    given = np.concatenate([np.array(at) - nodes[first, 4:], turn, np.array(at) - there, turn])
    return Coupling(kind=kind, name=name, first=first, second=second, parameters=given)


def four_bar(last: str) -> tuple[np.ndarray, list[Coupling]]:
    """Three bars in a loop with the ground, hinged about z but for the last joint."""
    nodes = np.array([body(0, 0.5, 0), body(1, 1.2, 0), body(2, 0.7, 0)])
    places = [(0, 0, 0), (0, 1, 0), (2, 1.4, 0), (2, 0, 0)]
    pairs = [(0, GROUND), (0, 1), (1, 2), (2, GROUND)]
    kinds = ["hinge"] * 3 + [last]
    joints = [
        joint(kind, f"j{k}", nodes, *pair, place)
        for k, (kind, pair, place) in enumerate(zip(kinds, pairs, places, strict=True))
    ]
    return nodes, joints


def lines(nodes: np.ndarray, joints: list[Coupling], free: np.ndarray | None = None) -> list[str]:
    mask = np.ones((len(nodes), 6), dtype=bool) if free is None else free
    return redundant(LAYOUT, nodes, mask, joints)


def test_planar_loop_of_hinges():
    """Four hinges about one axis close a loop three times too often: out of the plane, and both turns."""
    found = lines(*four_bar("hinge"))
    assert found == ["j3: along e3, about e2, about e1 follow from j0, j1, j2"]


def test_loop_closed_by_a_link_of_enough_freedom():
    nodes, joints = four_bar("hinge")
    cyclic = quaternion.from_rotation_vector(-2 * np.pi / 3 * np.ones(3) / np.sqrt(3.0))  # e1 -> e3, e2 -> e1
    joints[2] = joint("universal", "j2", nodes, 1, 2, (2, 1.4, 0), cyclic)
    joints[3] = joint("ball", "j3", nodes, 2, GROUND, (2, 0, 0))
    assert lines(nodes, joints) == []


def test_twice_the_same():
    nodes = np.array([body(0, 0, 0), body(1, 0, 0)])
    joints = [joint("weld", "one", nodes, 0, 1, (0.5, 0, 0)), joint("ball", "two", nodes, 0, 1, (0.7, 0, 0))]
    assert lines(nodes, joints) == ["two: along e1, along e2, along e3 follow from one"]


def test_on_what_is_held():
    nodes = np.array([body(0, 0, 0), body(1, 0, 0)])
    free = np.array([[False] * 6, [True] * 6])
    joints = [joint("ball", "to a held node", nodes, 0, GROUND, (0, 0, 0)), joint("weld", "w", nodes, 0, 1, (0, 0, 0))]
    found = lines(nodes, joints, free)
    assert found == ["to a held node: along e1, along e2, along e3 follow from supports"]
    free[0, 3:] = True  # of a pinned node, an offset ball joint still stops two turns
    joints = [joint("ball", "lever", nodes, 0, GROUND, (0, 0, 0.4))]
    free[0] = [True, True, True, False, False, False]
    assert lines(nodes, joints, free) == ["lever: along e3 follows from supports"]


@pytest.mark.parametrize("kind", ["weld", "ball", "hinge", "universal", "slider", "cylindrical", "planar", "link"])
def test_a_tree_is_sound(kind):
    nodes = np.array([body(0, 0, 0), body(1, 0.3, 0.2), body(2, -0.4, 0.9)])
    joints = [joint(kind, "a", nodes, 0, 1, (0.5, 0, 0)), joint(kind, "b", nodes, 1, 2, (1.5, 0, 1))]
    joints.append(joint(kind, "c", nodes, 0, GROUND, (0, 0, 1)))
    if kind == "link":
        for k, j in enumerate(joints):
            far = j.parameters.copy()
            far[7:10] += [1.0, 2.0, 0.5]
            joints[k] = Coupling(kind=kind, name=j.name, first=j.first, second=j.second, parameters=np.append(far, 2.3))
    assert lines(nodes, joints) == []


@pytest.mark.parametrize("dense", [True, False])
def test_both_ways_agree(dense, monkeypatch):
    """A ring of many bodies, welded: six constraints too many, found by projections and by sparse pivots."""
    monkeypatch.setattr(redundancy, "DENSE", 1000 if dense else 0)
    angles = np.linspace(0, 2 * np.pi, 30, endpoint=False)
    nodes = np.array([body(np.cos(a), np.sin(a), 0.0) for a in angles])
    joints = [joint("weld", f"w{k}", nodes, k, (k + 1) % 30, tuple(nodes[k, 4:])) for k in range(30)]
    assert lines(nodes, joints[:-1]) == []
    if dense:
        told = "w29: along e1, along e2, along e3, about e1, about e2, about e3 follow from "
        assert lines(nodes, joints) == [told + "w0, w1, w2, w3, w4, 24 more"]
    else:
        assert sum(line.count("about") + line.count("along") for line in lines(nodes, joints)) == 6
