"""A cantilever at rest in EXUDYN, for an interpreter that has it: a line in is a run, a line out its result.

A run is ``{"elements": 1000, "force": 2.0, "load_steps": 1}`` for an equilibrium, the force in EI/l², or
``{"elements": 200, "modes": 20}`` for the frequencies of the straight rod. Beam elements are
ObjectBeamGeometricallyExact. Rod and load are those of ``benchmarks/statics.py``.
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

LENGTH, RADIUS, YOUNGS, POISSON, DENSITY = 1.0, 0.01, 2e11, 0.3, 7850.0
AREA, BEND = math.pi * RADIUS**2, math.pi * RADIUS**4 / 4.0
SHEAR = YOUNGS / (2.0 * (1.0 + POISSON))


def cantilever(elements: int, force: float) -> tuple[Any, list[int]]:
    """A round steel rod along x, clamped, with a dead force along z at its tip; the system and its nodes."""
    system = exu.SystemContainer().AddSystem()
    section, size = exu.BeamSection(), LENGTH / elements
    section.stiffnessMatrix = np.diag(
        [YOUNGS * AREA, *[SHEAR * AREA] * 2, 2.0 * SHEAR * BEND, YOUNGS * BEND, YOUNGS * BEND]
    )
    section.inertia = DENSITY * BEND * np.diag([2.0, 1.0, 1.0])
    section.massPerLength = DENSITY * AREA
    kind, straight = items.NodeRigidBodyRotVecLG, [0.0, 0.0, 0.0]
    nodes = [system.AddNode(kind(referenceCoordinates=[k * size, 0.0, 0.0, *straight])) for k in range(elements + 1)]
    for ends in itertools.pairwise(nodes):
        system.AddObject(items.ObjectBeamGeometricallyExact(nodeNumbers=list(ends), length=size, sectionData=section))
    ground = system.AddNode(items.NodePointGround())
    fixed = system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=ground, coordinate=0))
    for axis in range(6):
        moved = system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=nodes[0], coordinate=axis))
        system.AddObject(items.ObjectConnectorCoordinate(markerNumbers=[fixed, moved]))
    tip = system.AddMarker(items.MarkerNodePosition(nodeNumber=nodes[-1]))
    load = force * YOUNGS * BEND / LENGTH**2
    system.AddLoad(items.LoadForceVector(markerNumber=tip, loadVector=[0.0, 0.0, load]))
    system.Assemble()
    return system, nodes


def settings(load_steps: int) -> Any:
    """A static solution, nothing written; errors relative to the first residual as in its own examples of beams."""
    made = exu.SimulationSettings()
    made.staticSolver.numberOfLoadSteps = load_steps
    made.staticSolver.newton.relativeTolerance = 1e-9
    made.staticSolver.newton.maxIterations = 50
    made.staticSolver.verboseMode = 0
    made.solution.file.write = False
    made.linearSolver.solverType = exu.LinearSolverType.EigenSparse
    made.show.computationTime = False
    return made


def rest(elements: int, force: float, load_steps: int) -> dict[str, Any]:
    """The tip [m] at rest, null where none was found, the time of the solver and its iterations."""
    system, nodes = cantilever(elements, force)
    given = settings(load_steps)
    began = time.perf_counter()
    try:
        solved = system.SolveStatic(given)
    except Exception:
        solved = False
    wall_time = time.perf_counter() - began
    tip = np.asarray(system.GetNodeOutput(nodes[-1], exu.OutputVariableType.Position)).tolist()
    iterations = int(system.sys["staticSolver"].it.newtonStepsCount) if "staticSolver" in system.sys else 0
    good = solved and all(map(math.isfinite, tip))
    return {"steps": iterations, "dt": 0.0, "wall_time": wall_time, "tip": tip if good else None}


def modes(elements: int, count: int) -> dict[str, Any]:
    """The lowest frequencies [Hz], as "tip", of the rod without load, and the time of the solver."""
    system, _ = cantilever(elements, 0.0)
    began = time.perf_counter()
    found = exu.solver.ComputeODE2Eigenvalues(
        system,
        useSparseSolver=True,
        numberOfEigenvalues=count,
        ignoreAlgebraicEquations=True,
        constrainedCoordinates=list(range(6)),
        convert2Frequencies=True,
    )[0]
    wall_time = time.perf_counter() - began
    return {"steps": len(found), "dt": 0.0, "wall_time": wall_time, "tip": sorted(map(float, found))}


if __name__ == "__main__":
    exu.config.printToConsole = False
    for line in sys.stdin:
        asked = json.loads(line)
        told = modes(asked["elements"], asked["modes"]) if "modes" in asked else rest(**asked)
        print(json.dumps(told), flush=True)
