"""Go on with a run in its store, as if it had never stopped."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from cayley.choice.pilot import stepper_of
from cayley.model import Model
from cayley.results.append import attributes
from cayley.results.known import whole_state
from cayley.results.trajectory import Trajectory
from cayley.results.writer import rewind
from cayley.simulation.run import run
from cayley.simulation.saves import Saves, positive
from cayley.steppers import decoupled_run
from cayley.system.system import State, System


def resume(
    path: str | Path,
    t_end: float | None = None,
    *,
    model: Model | None = None,
    system: System | None = None,
    progress: Callable[[float, float], None] | None = None,
    watch: Callable[[System, State], None] | None = None,
) -> Trajectory:
    """Go on with the run in a store: bit for bit what it would have been without the stop.

    It begins at the last frame that is whole and, of rules that remember the step before, at the last one of which that
    is known; frames behind it are run again. Saves are those of the run.

    Args:
        path: the store, written by simulate(..., store=path) or Trajectory.save; killed, full or cut off as may be.
        t_end: end of the run [s]; that which was asked for without it.
        model: the model that ran; needed where loads or motions are functions, which no store holds.
        system: the compiled system, of a run of a Lagrangian of your own.
        progress: called with (fraction done, time [s]) now and then.
        watch: called with the system and its state then.

    Returns: the Trajectory of the whole run.

    Raises:
        FileNotFoundError: if there is no store.
        ValueError: if it is no run, has no whole frame, or t_end is not behind what it has.
    """
    source = Path(path)
    before = Trajectory.open(source, model=model)
    info = before.info
    until = positive("t_end", info.get("t_end", 0.0) if t_end is None else t_end, "s")
    if before.time[-1] >= until * (1.0 - 1e-12) and "damage" not in info:
        raise ValueError(f"{source} has a run up to t = {before.time[-1]:g} s; give a later t_end (cayley: --until)")
    compiled = before.system if system is None else system
    only = before.only
    if only is None:
        remembers = stepper_of(compiled) is not decoupled_run
        last = max(before.memories, default=0) if remembers else len(before.time) - 1
        state, count = replace(before.frames.state(last), memory=before.memories.get(last)), last + 1
    else:
        state, count = whole_state(source, attributes(source), before.outline)
    rewind(source, before.frames, before.outline, before.model, count)
    when: dict[str, Any] = {name: info.get(f"save_{name}") for name in ("every", "steps", "at")}
    saves = Saves(**when, store=source, only=None if only is None else tuple(only.tolist()))
    options: dict[str, Any] = {"model": before.model, "parts": before.spans, "progress": progress, "watch": watch}
    return run(compiled, state, until, None, saves, **options, resumed=True)
