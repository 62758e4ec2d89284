"""The text of a small scenario, to be spoiled."""

import pytest

SMALL = """
title = "A small one"

[material.rubber]
density = 1000.0
youngs_modulus = 5e6
poisson_ratio = 0.35

[section.square]
shape = "rectangle"
width = 0.01
height = 0.01
material = "rubber"

[[rod]]
name = "beam"
section = "square"
length = 1.0
elements = 4
direction = [0, 0, -1]
normal = [1, 0, 0]

[[support]]
kind = "pin"
at = "beam.start"

[[load]]
kind = "gravity"
acceleration = [0, 0, -9.81]

[[load]]
kind = "moment"
at = "beam.start"
value = ["0.1*sin(pi*t/2)", 0, 0]
frame = "body"
until = 0.01

[run]
t_end = 0.02
rule = "nodal"
save_every = 0.001
"""


@pytest.fixture
def small():
    return SMALL


@pytest.fixture
def spoiled():
    """The small scenario with some text replaced and some added."""

    def spoil(old="", new="", added=""):
        assert old in SMALL
        return SMALL.replace(old, new, 1) + added

    return spoil
