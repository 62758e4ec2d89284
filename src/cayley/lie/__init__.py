"""The rotation group: unit quaternions, the Cayley and exponential maps, matrices of SO(3).

One source runs on NumPy arrays of numbers and on object arrays of CasADi scalars. Components stand on the last
axis (matrices on the last two), any batch shape before them. Quaternions are scalar first (w, x, y, z), with the
Hamilton product, and rotate from the body to space: Λ(p) s = p s p̄. Tangent vectors are body vectors, δp = ½ p η.
"""

from cayley.lie import cayley, exponential, quaternion, rotation

__all__ = ["cayley", "exponential", "quaternion", "rotation"]
