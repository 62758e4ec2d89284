"""Steppers: one file a scheme, driven by compiled kernels."""
