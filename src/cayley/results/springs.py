"""Energy of the springs of a system at saved frames."""

import numpy as np

from cayley.discrete.joint import evaluator
from cayley.discrete.spring import spring_program
from cayley.results.frames import Frames
from cayley.system.redundancy import ground_values
from cayley.system.system import System


def spring_energy(system: System, frames: Frames) -> np.ndarray:
    """Energy of all springs together [J], shape (m,)."""
    total = np.zeros(len(frames.times))
    ground = np.tile(ground_values(system.layout), (len(total), 1)) if system.springs else total
    for spring in system.springs:
        function = evaluator(spring_program(spring.kind, system.layout, grounded=spring.grounded))
        other = ground if spring.grounded else frames.values[:, spring.second]
        numbers = np.tile(spring.parameters, (len(total), 1))
        total += function(np.hstack([frames.values[:, spring.first], other, numbers]))[:, 0]
    return total
