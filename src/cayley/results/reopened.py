"""The system of a run that was opened from a store: made again from the model that is there."""

from typing import Any

from cayley.discrete.rules import by_name
from cayley.results.forces_record import Unstored
from cayley.system.discretize import discretize
from cayley.system.system import System


def system_of(run: Any) -> System:
    """Compile the model of a run again, for its rule.

    Args:
        run: a Trajectory.

    Raises:
        ValueError: with a Lagrangian of your own, whose function is not in the store.
    """
    if run.model is None:
        raise ValueError(
            "the function of a Lagrangian is not kept in a store, so an opened run of one has no system; compile it "
            "again, and go on with cy.resume(path, system=system) or cy.integrate(system, run.state, t_end=...)"
        )
    for part in run.model.own_parts:
        if isinstance(part.lagrangian.function, Unstored):
            raise ValueError(
                f"the Lagrangian {part.lagrangian.name} of {part.label} is not in the store, only its name; open the "
                "run with model=... to give it again"
            )
    rotation, rule, work = run.outline.layout.representation.name, by_name(run.rule), run.frames.work
    tied = bool(run.model.connections or run.model.springs or run.model.contact)
    # explicit steps with ties or contact account for these in one column, for loads in more, on request
    kept = work is not None and (rule.implicit or not tied or work.shape[1] > 1)
    return discretize(run.model, rule, rotation=rotation, account=kept)
