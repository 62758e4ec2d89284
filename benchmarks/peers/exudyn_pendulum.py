"""The rubber pendulum in EXUDYN, for an interpreter that has it: a line in is a run, a line out its result.

A run is ``{"elements": 20, "dt": 1e-3, "t_end": 1.0, "node": "rotation vector"}``. Beam elements are
ObjectBeamGeometricallyExact, time stepping is generalized alpha. Rod, support and load are those of
``benchmarks/pyelastica.py``. Staying alive between runs lets the programs be timed in turn.
"""

import contextlib
import itertools
import json
import math
import sys
import time
import warnings
from typing import Any

import numpy as np

sys.exudynFast = True  # type: ignore[attr-defined]  # its build without range checks; must stand before the import
warnings.simplefilter("ignore")
with contextlib.redirect_stdout(sys.stderr):  # it says which build it loads
    import exudyn as exu
    from exudyn import itemInterface as items

RADIUS, YOUNGS, DENSITY, GRAVITY = 5e-3, 5e6, 1100.0, 9.81
SHEAR = YOUNGS / (2.0 * (1.0 + 0.5))
NODES = {
    "rotation vector": (items.NodeRigidBodyRotVecLG, [0.0, 0.0, 0.0]),
    "euler parameters": (items.NodeRigidBodyEP, [1.0, 0.0, 0.0, 0.0]),
    "tait-bryan": (items.NodeRigidBodyRxyz, [0.0, 0.0, 0.0]),
}


def section() -> Any:
    """Round section; stiffness in the order axial, shear, shear, twist, bend, bend."""
    area, bend = math.pi * RADIUS**2, math.pi * RADIUS**4 / 4.0
    shear = 27.0 / 28.0 * SHEAR * area
    made = exu.BeamSection()
    stiffness = [YOUNGS * area, shear, shear, 2.0 * SHEAR * bend, YOUNGS * bend, YOUNGS * bend]
    made.stiffnessMatrix = np.diag(stiffness)
    made.inertia = DENSITY * bend * np.diag([2.0, 1.0, 1.0])
    made.massPerLength = DENSITY * area
    return made


def pendulum(elements: int, node: str) -> tuple[Any, int]:
    """Horizontal rubber rod at rest, pinned at the origin, under gravity.

    Args:
        elements: number of elements.
        node: kind of rotation coordinates, a key of NODES.

    Returns: the assembled system and the number of its last node.
    """
    kind, straight = NODES[node]
    system = exu.SystemContainer().AddSystem()
    given, size = section(), 1.0 / elements
    nodes = [system.AddNode(kind(referenceCoordinates=[k * size, 0.0, 0.0, *straight])) for k in range(elements + 1)]
    for ends in itertools.pairwise(nodes):
        beam = items.ObjectBeamGeometricallyExact(nodeNumbers=list(ends), length=size, sectionData=given)
        body = system.AddObject(beam)
        whole = system.AddMarker(items.MarkerBodyMass(bodyNumber=body))
        system.AddLoad(items.LoadMassProportional(markerNumber=whole, loadVector=[0.0, 0.0, -GRAVITY]))
    ground = system.AddNode(items.NodePointGround())
    fixed = system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=ground, coordinate=0))
    for axis in range(3):
        moved = system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=nodes[0], coordinate=axis))
        system.AddObject(items.ObjectConnectorCoordinate(markerNumbers=[fixed, moved]))
    system.Assemble()
    return system, nodes[-1]


def settings(steps: int, t_end: float) -> Any:
    """Generalized alpha with EXUDYN's usual spectral radius, the tangent kept while it serves, nothing written."""
    made = exu.SimulationSettings()
    made.timeIntegration.numberOfSteps = steps
    made.timeIntegration.endTime = t_end
    made.timeIntegration.generalizedAlpha.spectralRadius = 0.9
    made.timeIntegration.newton.useModifiedNewton = True
    made.timeIntegration.verboseMode = 0
    made.solution.file.write = False
    made.linearSolver.solverType = exu.LinearSolverType.EigenSparse
    made.show.computationTime = False
    return made


def run(elements: int, dt: float, t_end: float, node: str = "rotation vector") -> dict[str, Any]:
    """Run to ``t_end`` [s].

    Returns: steps, dt [s], wall_time [s] and the tip [m], null where it failed.
    """
    steps = math.ceil(t_end / dt * (1.0 - 1e-12))
    system, last = pendulum(elements, node)
    given = settings(steps, t_end)
    began = time.perf_counter()
    solved = system.SolveDynamic(given)
    wall_time = time.perf_counter() - began
    tip = np.asarray(system.GetNodeOutput(last, exu.OutputVariableType.Position)).tolist()
    good = solved and all(map(math.isfinite, tip))
    return {"steps": steps, "dt": t_end / steps, "wall_time": wall_time, "tip": tip if good else None}


if __name__ == "__main__":
    exu.config.printToConsole = False
    for line in sys.stdin:
        print(json.dumps(run(**json.loads(line))), flush=True)
