"""How a stretch of steps ended."""

import enum
from dataclasses import dataclass

import numpy as np

from cayley.system.system import State


class Outcome(enum.Enum):
    """What a stepper reports; the values are the messages."""

    FINISHED = "finished"
    NOT_CONVERGED = "the equations of a step were not solved: Newton's method did not converge"
    NOT_FINITE = "the state is no longer finite: the motion blew up"
    REDUNDANT = (
        "a constraint says there what others and the supports say already "
        "(a straight rod without stretch, held at both ends?)"
    )
    TENSE = (
        "multipliers are too large there for steps of the rule screw_midpoint this long, which tend to be unstable; "
        "take midpoint"
    )
    FAST = "what touches there comes nearer by too much of its radius in one step: it might pass through"
    DEEP = "what touches there sinks in deeper than is wanted, for contacts are as stiff as the step lets them be"
    CROWDED = "there are more contacts at once than a run remembers"

    @property
    def hasty(self) -> bool:
        """Whether what touches wants a smaller step."""
        return self in (Outcome.FAST, Outcome.DEEP)


@dataclass(frozen=True, slots=True)
class Result:
    """Outcome of a stretch of steps.

    Args:
        outcome: how it ended.
        state: the last good saved state.
        step: number of the step that failed, or the last one.
        node: node that failed, or -1.
        history: of a step that was not solved, relative correction and largest residual [N s, N m s] of the last
            iterations, shape (k, 2); NaN where there was none.
        partners: what touches too fast or sinks in too deep, in words.
    """

    outcome: Outcome
    state: State
    step: int
    node: int = -1
    history: np.ndarray | None = None
    partners: str = ""
