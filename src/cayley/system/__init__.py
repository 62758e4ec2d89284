"""Compiled systems: layout in blocks of lanes, discretization of models, step limits."""
