"""A rigid body or point mass as the arrays of a chain of one node without an element."""

import numpy as np

from cayley.model.body import Body, PointMass
from cayley.system.rod_arrays import PartArrays


def body_arrays(body: Body | PointMass, gravity: np.ndarray, rod: PartArrays | None) -> PartArrays:
    """The arrays of a body: weight 1, length 0, mass m and inertia J instead of those per length.

    Constants of strain, which nothing reads where there is no element, are those of a rod beside it: what is equal
    everywhere then stays uniform. A point mass has the inertia 1, and its rotation is held (see discretize).

    Args:
        body: the body.
        gravity: acceleration g [m/s²], shape (3,).
        rod: arrays of a rod of the model, or None if there is none.

    Returns: its PartArrays.
    """
    constants = {"stiffness": np.eye(6)[None]} if rod is None else {n: v[-1:] for n, v in rod.constants.items()}
    inertia = body.inertia if isinstance(body, Body) else np.eye(3)
    constants |= {"mass": np.array([body.mass]), "inertia": np.asarray(inertia)[None], "gravity": gravity[None]}
    if "first_moment" in constants:
        constants["first_moment"] = np.zeros((1, 3))  # a body's position is that of its mass center
    x, p = body.place(0)
    named = {"weight": np.ones(1), "1/weight": np.ones(1), "length": np.zeros(1), "here": np.zeros(1)}
    named["inverse"] = np.ones(1) if rod is None else rod.named["inverse"][-1:]
    return PartArrays(named=named, constants=constants, position=x[None], rotation=p[None])
