"""What each support holds, and refusals."""

import numpy as np
import pytest

from cayley.model import supports
from cayley.model.supports import Support

ALL, NONE = (True, True, True), (False, False, False)


def test_pin_and_clamp(rod):
    assert supports.pin(rod.start) == Support(rod.start, ALL, NONE)
    assert supports.clamp(rod.node(2)) == Support(rod.node(2), ALL, ALL)


@pytest.mark.parametrize("value", ["xz", "zx", (True, False, True), [True, False, True], np.array([True, False, True])])
def test_hold_takes_letters_or_truth_values(rod, value):
    mask = (True, False, True)
    assert supports.hold(rod.end, position=value) == Support(rod.end, mask, NONE)
    assert supports.hold(rod.end, rotation=value) == Support(rod.end, NONE, mask)
    assert supports.hold(rod.end, position=value).held_position == mask
    assert all(type(held) is bool for held in supports.hold(rod.end, position=value).held_position)


def test_text(rod):
    assert str(supports.pin(rod.start)) == "pin at mast.start"
    assert str(supports.clamp(rod.end)) == "clamp at mast.end"
    assert str(supports.hold(rod.node(1), position="zy")) == "hold position yz at mast.node(1)"
    assert str(supports.hold(rod.end, position="x", rotation="xy")) == "hold position x, rotation xy at mast.end"
    assert str(supports.hold(rod.end, rotation="xyz")) == "hold rotation xyz at mast.end"
    assert supports.hold(rod.end, position="xyz").kind == "pin"


PORT = "a node of a rod, such as rod.start, rod.end or rod.node(k), or body.centre"
COMPONENTS = 'letters out of "xyz", each once (such as "xz"), or three truth values'


@pytest.mark.parametrize(
    ("call", "error", "line"),
    [
        (lambda rod: supports.pin(rod), TypeError, "Support: port = {rod!r} must be " + PORT),
        (lambda rod: supports.clamp(0), TypeError, "Support: port = 0 must be " + PORT),
        (
            lambda rod: supports.hold(rod.end, position="xw"),
            ValueError,
            f"hold: position = 'xw' must be {COMPONENTS}",
        ),
        (
            lambda rod: supports.hold(rod.end, rotation="xx"),
            ValueError,
            f"hold: rotation = 'xx' must be {COMPONENTS}",
        ),
        (
            lambda rod: supports.hold(rod.end, rotation=(True, False)),
            ValueError,
            f"hold: rotation = (True, False) must be {COMPONENTS}",
        ),
        (
            lambda rod: supports.hold(rod.end, rotation=(1, 0, 0)),
            ValueError,
            f"hold: rotation = (1, 0, 0) must be {COMPONENTS}",
        ),
        (
            lambda rod: supports.hold(rod.end, position=3),
            TypeError,
            f"hold: position = 3 must be {COMPONENTS}",
        ),
        (
            lambda rod: supports.hold(rod.end),
            ValueError,
            'support at mast.end: nothing is held; name components, such as position="xyz" or rotation="xy"',
        ),
    ],
)
def test_refusals(refused, rod, call, error, line):
    refused(lambda: call(rod), error, line.format(rod=rod))
