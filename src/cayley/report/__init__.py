"""Reports of runs: figures, films, a table of conserved quantities, and one HTML file that plays the run.

What draws loads when it is first used: a run without a report imports no Matplotlib.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

_HOMES = {
    "write_report": "html",
    "write_modes": "modes_page",
    "page": "player",
    "conservation": "conserved",
    "citation": "cite",
}
_MODULES = ("figures", "vibration")

__all__ = ["citation", "conservation", "figures", "page", "vibration", "write_modes", "write_report"]


def __getattr__(name: str) -> Any:
    """Import what is asked for."""
    if name in _MODULES:
        return importlib.import_module(f"cayley.report.{name}")
    if name in _HOMES:
        return getattr(importlib.import_module(f"cayley.report.{_HOMES[name]}"), name)
    raise AttributeError(f"module 'cayley.report' has no attribute {name!r}")


if TYPE_CHECKING:
    from cayley.report import figures
    from cayley.report.cite import citation
    from cayley.report.conserved import conservation
    from cayley.report.html import write_report
    from cayley.report.modes_page import write_modes
    from cayley.report.player import page
