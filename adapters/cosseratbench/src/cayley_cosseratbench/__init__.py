"""cayley as a solver of cosseratbench: scenarios of the suite as models, runs as its trajectories."""

from cayley_cosseratbench.adapter import CayleySolver

__all__ = ["CayleySolver"]
