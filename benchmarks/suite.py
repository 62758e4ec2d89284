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


SLIDES = ("overhang=1.1", "overhang=1.5")
"""Variants of capstan in which the rope is to slide: how far is no error there."""
FINE = "cayley, fine mesh"
"""Solver of the rows that say what the model itself has."""


def compared(rows: Sequence[Row]) -> tuple[str, list[list[str]]]:
    """How cayley compares with the best peer of every figure, and lines of where a peer is nearer to the reference."""
    cases: dict[tuple[str, str], dict[str, Row]] = {}
    for row in rows:
        cases.setdefault((row["experiment"], row["variant"]), {})[row["solver"]] = row
    figures, faster, finished, found = 0, 0, 0, []
    for (experiment, variant), case in cases.items():
        peers = [row for name, row in case.items() if not name.startswith("cayley") and row["outcome"] == "completed"]
        own = case.get("cayley")
        if own is None or own["outcome"] != "completed" or not peers:
            continue
        finished += len(peers)
        faster += sum(own["wall_time"] < row["wall_time"] for row in peers)
        for name in WANTED[experiment]:
            known = [row for row in peers if row["metrics"].get(name) is not None]
            if name == "time" or variant in SLIDES or not known:
                continue
            best = min(known, key=lambda row: abs(row["metrics"][name]))
            figures += 1
            if abs(own["metrics"][name]) > abs(best["metrics"][name]):
                values = [row["metrics"].get(name) for row in (own, best, case.get(FINE, {"metrics": {}}))]
                word = name.replace("_", " ")
                found.append(
                    [f"{experiment}, {variant}", word, *map(figure, values[:2]), best["solver"], figure(values[2])]
                )
    told = (
        f"Of {figures} figures that a peer has, too, cayley is the nearest to the reference in {figures - len(found)}. "
    )
    told += f"It is faster than {faster} of {finished} runs of peers that finish."
    return told, found


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
