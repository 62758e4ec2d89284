"""The solver that cosseratbench finds: it chooses a way, and the library its rule, step and damping."""

import hashlib
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cosseratbench.scenario as suite
import numpy as np
from cosseratbench.solver import Capability, Diverged
from cosseratbench.trajectory import Trajectory

import cayley as cy
from cayley.discrete.rules import Rule
from cayley.model.settling import settling, slowest_frequency
from cayley.simulation import advise
from cayley.simulation.run import SAFETY
from cayley.simulation.start import start_of_model
from cayley_cosseratbench.start import element_directors, pieces
from cayley_cosseratbench.translate import Translation, driven, touches, translate

ACCURACY = 1e-5
"""Largest error of positions from steps in time, over the extent, of a motion that is the result itself."""
LARGEST = 0.99
"""Largest part of the limit of explicit steps."""
RESTING = 2e-4
"""Speed, in rod lengths per second, below which a run that only settles has come to rest [1/s]."""
LYING = 4.0
"""Rate of the damping of what lies still at the end, over the slowest frequency."""
PATIENCE = 20.0
"""Longest time that it is given to come to rest, times the slowest frequency."""
STATICS, DAMPED, MOTION, TOUCHING = "statics", "damped run", "motion", "motion with contact"


def _version() -> str:
    """Version of the library with a digest of its sources and of this adapter's, so that no saved run outlives them."""
    digest, folders = hashlib.sha256(), (Path(cy.__file__).parent, Path(__file__).parent)
    for path in sorted(path for folder in folders for kind in ("py", "c", "h") for path in folder.rglob(f"*.{kind}")):
        digest.update(path.read_bytes())
    return f"{cy.__version__}+{digest.hexdigest()[:8]}"


@dataclass(frozen=True, slots=True)
class Plan:
    """The way a scenario is solved.

    Args:
        way: "statics", "damped run", "motion" or "motion with contact".
        rule: where strain is measured along an element, and steps in time.
        elements: of a rod.
    """

    way: str
    rule: Rule
    elements: int

    @property
    def degree(self) -> int:
        """Nodes from one end of an element to the next."""
        return self.rule.degree


class CayleySolver:
    """cayley, with the choices of the library.

    What is quasi-static, not driven and touches nothing is solved by statics. Other quasi-static scenarios are runs
    with the library's settling damping, of the explicit rule screw at its step limit. A motion that is the result
    itself takes elements of degree 2 between the nodes of the suite, with implicit steps of order 4 chosen by
    ``accuracy``.
    """

    name = "cayley"
    backend_version = _version()
    capabilities = frozenset(Capability)

    def __init__(self, time_step_scale: float = 1.0) -> None:
        """Take the factor of the step.

        A step over the limit of the explicit rule is one of its implicit sibling, or, with contact, the limit.
        """
        self.scale = float(time_step_scale)

    def settings(self, scenario: suite.Scenario, *, n_elements: int, n_frames: int) -> dict[str, Any]:
        """The choices for a scenario, as JSON values."""
        plan = self._plan(scenario, n_elements)
        found: dict[str, Any] = {"way": plan.way, "rule": str(plan.rule), "elements": plan.elements}
        if plan.way == STATICS:
            return found
        case = translate(scenario, plan.elements, plan.degree)
        frame = scenario.duration / (n_frames - 1)
        step = self._step(scenario, plan, case, frame)
        rate = 2.0 * slowest_frequency(case.model) if scenario.quasi_static else 0.0
        found |= {"time_step": frame / np.ceil(frame / step * (1.0 - 1e-12)), "damping_rate": rate}
        if _still(scenario, frame) is not None:
            found["damping_rate_to_rest"] = _resting_rate(case)
        return found

    def run(self, scenario: suite.Scenario, *, n_elements: int, n_frames: int) -> Trajectory:
        """Simulate a scenario, see cosseratbench.solver.Solver.

        Raises:
            Diverged: the run stopped.
            NotImplementedError: the scenario asks for something that is not there.
        """
        plan = self._plan(scenario, n_elements)
        case = translate(scenario, plan.elements, plan.degree)
        try:
            poses = _rest(case, plan) if plan.way == STATICS else self._run(scenario, plan, case, n_frames)
        except cy.SimulationError as error:
            raise Diverged(str(error), time=float(error.partial.time[-1])) from error
        except (cy.EquilibriumError, cy.SettleError) as error:
            raise Diverged(str(error)) from error
        times = np.linspace(0.0, scenario.duration, n_frames)
        shown = _shown(len(poses[0][0]), n_frames)
        poses = [(x[shown], p[shown]) for x, p in poses]
        return Trajectory(times, tuple(x for x, _ in poses), tuple(element_directors(*pair) for pair in poses))

    def _plan(self, scenario: suite.Scenario, n_elements: int) -> Plan:
        even = n_elements % 2 == 0
        if scenario.quasi_static and not driven(scenario) and not touches(scenario):
            # an element of degree 2 has a node in its middle: a rod has one there in any case
            middle = cy.rules.midpoint if even else cy.rules.galerkin(time=1, space=2)
            return Plan(STATICS, middle, n_elements)
        if not scenario.quasi_static and not touches(scenario):
            return Plan(MOTION, cy.rules.galerkin(time=2, space=2), n_elements // 2 if even else n_elements)
        rule = cy.rules.screw if self.scale <= 1.0 or touches(scenario) else cy.rules.screw_midpoint
        obstacles = bool(scenario.obstacles)
        cut = max(pieces(spec, n_elements, obstacles=obstacles) for spec in scenario.rods) if touches(scenario) else 1
        return Plan(DAMPED if scenario.quasi_static else TOUCHING, rule, cut * n_elements)

    def _step(self, scenario: suite.Scenario, plan: Plan, case: Translation, frame: float) -> float:
        """Upper bound of the step [s]: the library's choice times the scale."""
        if plan.way == MOTION:
            options: dict[str, Any] = {"rule": plan.rule, "save_every": frame, "initial": case.initial}
            return self.scale * advise(case.model, scenario.duration, ACCURACY, **options).best.dt
        model = settling(case.model) if scenario.quasi_static else case.model
        system, state = start_of_model(model, "quaternion", case.initial)(cy.rules.screw)
        wanted = self.scale * SAFETY
        return (wanted if plan.rule.implicit else min(wanted, LARGEST)) * system.stable_dt(state)

    def _run(self, scenario: suite.Scenario, plan: Plan, case: Translation, n_frames: int) -> list[Any]:
        frame = scenario.duration / (n_frames - 1)
        options: dict[str, Any] = {"rule": plan.rule, "save_every": frame, "settle": scenario.quasi_static}
        if self.scale != 1.0:
            options["dt"] = self._step(scenario, plan, case, frame)
        elif plan.way == MOTION:
            options["accuracy"] = ACCURACY
        if scenario.quasi_static and not driven(scenario):
            options["rest"] = RESTING
        still = _still(scenario, frame)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", cy.ContactDepthWarning)  # the suite measures depths itself
            run = cy.simulate(case.model, still or scenario.duration, initial=case.initial, **options)
            poses = [run.poses(rod) for rod in case.rods]
            if still is not None:
                longest = max(scenario.duration - still, PATIENCE / slowest_frequency(case.model))
                options |= {"settle": _resting_rate(case), "rest": RESTING, "start": run}
                run = cy.simulate(case.model, still + frame * np.ceil(longest / frame), **options)
                poses = [_joined(pair, run.poses(rod)) for pair, rod in zip(poses, case.rods, strict=True)]
        return poses


def _joined(before: Any, after: Any) -> tuple[np.ndarray, np.ndarray]:
    """Positions and rotations of a run and of one that goes on from it."""
    position, rotation = (np.concatenate([b, a[1:]]) for b, a in zip(before, after, strict=True))
    return position, rotation


def _still(scenario: suite.Scenario, frame: float) -> float | None:
    """Time of the first frame from which on no end is driven, if what lies on something is to come to rest then [s]."""
    ends = [motion.times[-1] for rod in scenario.rods for motion in (rod.start_motion, rod.end_motion) if motion]
    if not scenario.quasi_static or not scenario.obstacles or not ends or max(ends) >= scenario.duration:
        return None
    return float(frame * np.ceil(max(ends) / frame))


def _resting_rate(case: Translation) -> float:
    """Damping while a heap comes to rest [1/s]: what hangs and lies there is shorter than the rod, and faster."""
    return LYING * slowest_frequency(case.model)


def _shown(found: int, wanted: int) -> np.ndarray:
    """Which of the frames of a run are shown: what rests goes on resting; of what comes to rest later, the end."""
    if found <= wanted:
        return np.minimum(np.arange(wanted), found - 1)
    return np.append(np.arange(wanted - 2), [found - 2, found - 1])


def _rest(case: Translation, plan: Plan) -> list[Any]:
    """Poses at the start and at rest, shape (2, nodes, ...)."""
    rest = cy.settle(case.model, initial=case.initial, rule=plan.rule)
    pairs = [((start["position"], start["rotation"]), rest.poses(rod)) for rod, start in case.initial.items()]
    return [tuple(np.stack(both) for both in zip(*pair, strict=True)) for pair in pairs]
