"""How the figures look: light, with colors that the color-blind tell apart (Okabe and Ito, 2008)."""

from __future__ import annotations

import io
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import matplotlib as mpl
from matplotlib.figure import Figure

BLUE, VERMILION, GREEN = "#0072B2", "#D55E00", "#009E73"
AXES = (BLUE, VERMILION, GREEN)  # x, y, z
INK, MUTED, GRID = "#1a1a1a", "#6b6b6b", "#e4e4e4"
SHADE, SHADOW = "#f2f0eb", "#c4c4c4"  # the time in which loads act; what a rod throws on the floor
SOLID = "#d9d5cc"  # obstacles
MAP = "viridis"
WIDTH = 7.4  # in

_PARAMETERS: dict[Any, Any] = {
    "font.family": "DejaVu Sans",  # comes with Matplotlib, so that a figure looks the same everywhere
    "font.size": 8.5,
    "mathtext.fontset": "dejavusans",
    "axes.edgecolor": MUTED,
    "axes.labelcolor": INK,
    "axes.titlesize": 8.5,
    "axes.titlelocation": "left",
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": GRID,
    "grid.linewidth": 0.6,
    "lines.linewidth": 1.1,
    "lines.solid_capstyle": "round",
    "xtick.color": MUTED,
    "ytick.color": MUTED,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "xtick.major.size": 3.0,
    "ytick.major.size": 3.0,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "legend.frameon": False,
    "axes.formatter.limits": (-3, 4),
    "axes.formatter.useoffset": False,
    "svg.fonttype": "path",
    "svg.hashsalt": "cayley",
    "path.simplify": True,
    "path.simplify_threshold": 0.03,
}


@contextmanager
def style() -> Iterator[None]:
    """Draw with this style, and leave the user's settings as they are."""
    with mpl.rc_context(_PARAMETERS):
        yield


class Drawing(Figure):
    """A figure that notebooks show without pyplot."""

    def _repr_png_(self) -> bytes:
        picture = io.BytesIO()
        self.savefig(picture, format="png", dpi=110)
        return picture.getvalue()
