"""Discrete mechanics: rules, kinematics, and the discrete Euler-Lagrange equations."""
