"""Tables of cosseratbench, from what benchmarks/cosseratbench.py collected."""

from collections.abc import Sequence
from typing import Any

Row = dict[str, Any]
WANTED: dict[str, dict[str, float]] = {
    "cantilever": {"tip_deflection_error": 2e-3, "time": 0.05},
    "catenary": {"shape_error": 4.7e-4, "sag_error": 3.6e-4, "time": 0.05},
    "pendulum": {"period_error": 3e-5, "amplitude_change": 5e-6, "time": 0.3},
    "twist": {"critical_twist_error": 6e-3, "time": 5.0},
    "crossing": {"shape_error": 3.5e-4, "lift_error": 5e-4, "time": 1.0},
    "capstan": {"slide": 1e-4, "time": 1.0},
    "pile": {"settling_residual": 1e-4, "time": 5.0},
}
"""Most that each figure of cayley may be in the ordinary case, and its time [s]."""
OBSERVED = {"max_penetration": "sunk in [radii]", "max_rod_overlap": "overlap [radii]"}
"""What the suite observes of contact, in radii of the rods."""


def lines(rows: Sequence[Row], wanted: dict[str, float]) -> tuple[list[str], list[list[str]]]:
    """Head and lines of one experiment.

    Args:
        rows: of one experiment, variant by variant.
        wanted: most that figures of cayley may be in the ordinary case.
    """
    metrics = list(dict.fromkeys(name for row in rows for name in row["metrics"]))
    observed = [name for name in OBSERVED if any(row["observations"].get(name) is not None for row in rows)]
    head = ["variant", "solver", "time [s]", *(name.replace("_", " ") for name in metrics)]
    found = []
    for row in rows:
        bounds = wanted if row["solver"] == "cayley" and row["variant"] == "default" else {}
        told = [figure(row["metrics"].get(name), bounds.get(name)) for name in metrics]
        told += [figure(row["observations"].get(name)) for name in observed]
        if row["outcome"] != "completed":
            told[0] = reason(row)
        found.append([row["variant"], row["solver"], seconds(row["wall_time"], bounds.get("time")), *told])
    return [*head, *(OBSERVED[name] for name in observed)], found


def figure(value: float | None, bound: float | None = None) -> str:
    """A figure with two digits, and whether it keeps its bound to these."""
    if value is None:
        return ""
    kept = "" if bound is None else f" (≤ {bound:.1e}, {'kept' if rounded(value) <= bound else 'MISSED'})"
    return f"{value:.1e}{kept}"


def rounded(value: float) -> float:
    """Size to two digits."""
    return float(f"{abs(value):.1e}")


def seconds(value: float | None, bound: float | None = None) -> str:
    """A time, and whether it keeps its bound."""
    if value is None:
        return ""
    kept = "" if bound is None else f" (≤ {bound:g}, {'kept' if value <= bound else 'MISSED'})"
    return f"{value:.3g}{kept}"


def reason(row: Row) -> str:
    """Why there are no figures."""
    if row["outcome"] == "unsupported":
        return f"has no {', '.join(row['missing'])}"
    at = "" if row["diverged_at"] is None else f" at {row['diverged_at']:.3g} s"
    return f"diverged{at}"
