"""The same input gives the same bits, twice in one process and in a process of its own."""

import functools
import hashlib
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import cayley as cy
from verify.problems import thick_rod

TESTS = Path(__file__).parents[1]
CHILD = """
import json
from verify.test_reproducible import CASES
print(json.dumps({name: case() for name, case in CASES.items()}))
"""


def digest(*arrays):
    """A hash of all bits of arrays."""
    found = hashlib.sha256()
    for array in arrays:
        found.update(repr((array.dtype.str, array.shape)).encode())
        found.update(array.tobytes())
    return found.hexdigest()


def run(rule, *, jointed=False, weight=9.81):
    """Of a run under gravity: all frames."""
    rod, model = thick_rod(4)
    if jointed:
        body = cy.Body(mass=1.0, inertia=[0.01, 0.01, 0.02], position=(1, 0, 0), name="body")
        model = cy.Model(rod, body, supports=model.supports, joints=[cy.joints.ball(rod.end, body.centre)])
    model = model.replace(loads=[cy.loads.gravity((0, 0, -weight))])
    frames = cy.simulate(model, 0.1, 1e-3, rule=rule, save_every=0.01).frames
    assert len(frames.times) == 11
    return digest(frames.times, frames.values, frames.momenta)


def rest():
    """The rod under its weight."""
    _, model = thick_rod(4)
    return cy.equilibrium(model.replace(loads=[cy.loads.gravity((0, 0, -9.81))]))


def shapes():
    """Of six modes about it: eigenvalues and vectors."""
    pairs = cy.modes(rest().model, about=rest(), count=6).pairs
    return digest(pairs.values, pairs.vectors)


CASES = {
    "verlet": functools.partial(run, cy.rules.verlet),
    "midpoint with a joint": functools.partial(run, cy.rules.midpoint, jointed=True),
    "equilibrium": lambda: digest(rest().still.values),
    "modes": shapes,
}


@pytest.fixture(scope="module")
def elsewhere(tmp_path_factory):
    """What another process finds, which compiles its kernels anew and orders its sets in another way."""
    more = {
        "PYTHONPATH": os.pathsep.join([str(TESTS), *filter(None, sys.path)]),
        "PYTHONHASHSEED": "7",
        "CAYLEY_CACHE_DIR": str(tmp_path_factory.mktemp("elsewhere")),
    }
    done = subprocess.run(
        [sys.executable, "-c", CHILD], capture_output=True, text=True, check=True, env=os.environ | more
    )
    return json.loads(done.stdout)


@pytest.mark.parametrize("name", CASES)
def test_the_same_bits(name, elsewhere):
    first = CASES[name]()
    assert CASES[name]() == first
    assert elsewhere[name] == first


def test_one_bit_of_the_input_changes_them():
    assert run(cy.rules.verlet, weight=np.nextafter(9.81, 10.0)) != run(cy.rules.verlet)
