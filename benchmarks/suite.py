"""Tables of cosseratbench, from what benchmarks/cosseratbench.py collected."""

from collections.abc import Callable, Sequence
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
        peers = [row for row in case.values() if not row["solver"].startswith("cayley") and _finished(row)]
        own = case.get("cayley")
        if own is None or not _finished(own):
            continue
        finished += len(peers)
        faster += sum(own["wall_time"] < row["wall_time"] for row in peers)
        model = case.get(FINE) or cases.get((experiment, "default"), {}).get(FINE) or {"metrics": {}}
        for name in sorted(WANTED[experiment].keys() - {"time"}) if variant not in SLIDES else ():
            best = min((row for row in peers if name in row["metrics"]), key=_size(name), default=None)
            figures += best is not None
            if best is not None and _size(name)(own) > _size(name)(best):
                values = [figure(row["metrics"].get(name)) for row in (own, best, model)]
                found.append([f"{experiment}, {variant}", name.replace("_", " "), *values, best["solver"]])
    told = (
        f"Of {figures} figures that a peer has, too, cayley is the nearest to the reference in {figures - len(found)}. "
    )
    return f"{told}It is faster than {faster} of {finished} runs of peers that finish.", found


def _finished(row: Row) -> bool:
    return bool(row["outcome"] == "completed")


def _size(name: str) -> Callable[[Row], float]:
    """Size of a figure of a row."""
    return lambda row: float(abs(row["metrics"][name]))


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
        found.append([row["variant"], row["solver"], figure(row["wall_time"], bounds.get("time"), ".3g"), *told])
    return [*head, *(OBSERVED[name] for name in observed)], found


def figure(value: float | None, bound: float | None = None, form: str = ".1e") -> str:
    """A figure, and whether it keeps its bound to the digits shown."""
    if value is None:
        return ""
    shown, kept = f"{value:{form}}", ""
    if bound is not None:
        kept = f" (≤ {bound:{form}}, {'kept' if abs(float(shown)) <= bound else 'MISSED'})"
    return f"{shown}{kept}"


def reason(row: Row) -> str:
    """Why there are no figures."""
    if row["outcome"] == "unsupported":
        return f"has no {', '.join(row['missing'])}"
    at = "" if row["diverged_at"] is None else f" at {row['diverged_at']:.3g} s"
    return f"diverged{at}"
