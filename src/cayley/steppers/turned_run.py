"""Run a system whose rotations are stored as matrices by steps of unit quaternions."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from cayley.steppers.outcome import Result
from cayley.system.system import State, System
from cayley.system.turned import as_quaternions, embedded, from_quaternions


def run_turned(
    run: Callable[..., Result], system: System, state: State, *, receive: Callable[..., None], **options: Any
) -> Result:
    """Frames hold matrices; what a state remembers holds its quaternions too, so that a run goes on bit for bit.

    Args:
        run: steps the system of quaternions.
        system: that of matrices.
        state: where it starts.
        receive: called with frames of matrices.
        options: of run.
    """
    inner = embedded(system)
    values, memory, size = as_quaternions(system.layout, state.values), None, inner.reference.size
    if state.memory is not None and state.memory.ndim == 1 and len(state.memory) >= size:
        remembered = state.memory[-size:].reshape(inner.reference.shape)
        if np.array_equal(from_quaternions(system.layout, inner.layout, remembered), state.values):
            values, memory = remembered.copy(), state.memory[:-size]

    def receive_turned(values: np.ndarray, momenta: np.ndarray, **more: np.ndarray) -> None:
        receive(from_quaternions(system.layout, inner.layout, values), momenta, **more)

    begin = replace(state, values=values, memory=memory)
    result = run(inner, begin, receive=receive_turned, **options)
    end = result.state
    memory = None if end.memory is None else np.concatenate([end.memory, end.values.reshape(-1)])
    reached = state.values if end is begin else from_quaternions(system.layout, inner.layout, end.values)
    return replace(result, state=replace(end, values=reached, memory=memory))
