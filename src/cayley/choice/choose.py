"""The cheapest rule and step that reach an accuracy."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from cayley.choice.settle import Alternative, Task, outlook, settle
from cayley.discrete.rules import Rule

CHEAP = 0.25
"""Cost of an explicit run [s] that is not worth trials of other rules: those take about as long."""
MARGIN = 0.7
"""A later candidate must cost less than this part of the best so far."""
TRIALS_COST = 2.0
"""Cost of the first trials of an implicit rule, in runs at its largest step."""
THOROUGH, THOROUGH_SECONDS = 5.0, 2.0
"""For a table a rule is looked at if it costs less than so many times the best, or than this [s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Choice:
    """What was chosen.

    Args:
        best: rule, step, cost and expected error.
        others: what else was looked at, each with the reason why it is not the best.
        why: one or two sentences.
    """

    best: Alternative
    others: tuple[Alternative, ...]
    why: str


class Unreached(ValueError):
    """No rule reaches the accuracy; ``tried`` has what was looked at."""

    def __init__(self, message: str, tried: tuple[Alternative, ...]) -> None:
        """Hold the message and the alternatives, each with its reason."""
        super().__init__(message)
        self.tried = tried


def choose(task: Task, rules: Sequence[Rule], *, thorough: bool = False) -> Choice:
    """Choose the cheapest of some rules, with its step.

    A run of an explicit rule costs at least what its step limit says, one of an implicit rule what steps as long as the
    saves allow would cost. In the order of these costs rules are tried, and left out once they can't win. All
    decisions hang on constants that are measured once and on what trials find, not on the time they take: the same
    task gives the same choice.

    Args:
        task: what is to be run.
        rules: the candidates.
        thorough: try all of them, for the sake of a table.

    Returns: the Choice.

    Raises:
        Unreached: if none reaches the accuracy.
    """
    contest = _Contest(task, thorough)
    explicit = [outlook(task, rule) for rule in rules if not rule.implicit]
    contest.promise = min((hope.cost for hope in explicit), default=math.inf)
    if contest.promise <= CHEAP and not thorough:
        contest.enter(explicit)
        if contest.best is not None and contest.best.cost <= CHEAP:  # accuracy may ask for more than the limit does
            return contest.result()
        contest.promise = math.inf
    hopes = [hope for hope in explicit if hope.rule not in contest.tried]
    hopes += [outlook(task, rule) for rule in rules if rule.implicit]
    contest.enter(sorted(hopes, key=lambda hope: hope.cost))
    if contest.best is None:  # then what was too expensive beside the explicit rule may be what there is
        contest.promise = math.inf
        contest.enter([hope for hope in hopes if contest.tried[hope.rule].excessive])
    return contest.result()


class _Contest:
    """The candidates tried so far."""

    def __init__(self, task: Task, thorough: bool) -> None:
        self.task, self.thorough = task, thorough
        self.tried: dict[Rule, Alternative] = {}
        self.best: Alternative | None = None
        self.promise = math.inf

    def enter(self, hopes: Iterable[Alternative]) -> None:
        """Try candidates, those that can win."""
        for hope in hopes:
            implicit = hope.rule.implicit
            rival = min(self.best.cost if self.best else math.inf, self.promise if implicit else math.inf)
            if self.thorough:
                best = self.best.cost if self.best else math.inf
                found = settle(self.task, hope.rule, bound=max(THOROUGH * best, THOROUGH_SECONDS))
            elif hope.cost * (1.0 + TRIALS_COST * implicit) >= rival:
                found = replace(hope, reason=f"not tried, takes at least {hope.cost:.2g} s", excessive=True)
            else:
                found = settle(self.task, hope.rule, bound=MARGIN * rival)
            self.tried[hope.rule] = found
            if not found.reason and found.cost < (self.best.cost if self.best else math.inf):
                self.best = found

    def result(self) -> Choice:
        """The choice, if there is one."""
        best, accuracy = self.best, self.task.accuracy
        rest = (a for a in self.tried.values() if best is None or a.rule is not best.rule)
        others = tuple(sorted(rest, key=lambda a: (bool(a.reason), a.cost)))
        if best is None:
            told = "; ".join(_told(a) for a in others)
            chaotic = any(a.reason and not a.excessive for a in others)
            message = (
                f"accuracy={accuracy:g} is not reached ({told}); {'the motion looks chaotic: ' if chaotic else ''}"
                f"give a shorter t_end or a larger accuracy, or dt and rule"
            )
            raise Unreached(message, others)
        why = (
            f"{best.rule} with dt = {best.dt:.3g} s is the cheapest found to keep positions within {accuracy:g} of the "
            f"extent: {best.steps} steps, about {best.cost:.2g} s"
        )
        others_told = "; ".join(_told(a) for a in others)
        return Choice(best=best, others=others, why=f"{why}. Others: {others_told}." if others else f"{why}.")


def _told(one: Alternative) -> str:
    if one.reason:
        return f"{one.rule} {one.reason}"
    return f"{one.rule} {one.steps} steps of {one.dt:.3g} s, about {one.cost:.2g} s"
