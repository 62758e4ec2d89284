"""From where figures in space are seen: along parallel lines, from the front and a little above."""

import numpy as np

from cayley.report.conserved import Array

_AZIMUTH, _ELEVATION = np.radians(-60.0), np.radians(18.0)  # of the eye
# the picture's axes to the right and up, as rows, in space
_VIEW = np.array(
    [
        [-np.sin(_AZIMUTH), np.cos(_AZIMUTH), 0.0],
        [-np.sin(_ELEVATION) * np.cos(_AZIMUTH), -np.sin(_ELEVATION) * np.sin(_AZIMUTH), np.cos(_ELEVATION)],
    ]
)
TOWARD = np.cross(*_VIEW)
"""Unit vector to the eye, shape (3,)."""


def seen(points: Array) -> Array:
    """Places in the picture [m], right and up, shape (..., 2), of points in space."""
    found: Array = points @ _VIEW.T
    return found
