"""Audit: measure, for every rule, form and problem, what the theory promises, and write docs/audit.md.

Run it with ``make audit`` or ``python -m audit`` at the root of the repository. The problems are those of the tests,
which it imports; the numbers are those of this machine and this run.
"""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests"))
