"""Write the tables of README.md from the JSON files in results/.

Reads every file that is there and replaces what stands between the markers ``<!-- results -->`` and
``<!-- end of results -->``.
"""

import argparse
import json
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

from harness import HERE, RESULTS

BEGIN, END = "<!-- results -->", "<!-- end of results -->"
Record = dict[str, Any]


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A Markdown table, its columns right-aligned but for the first."""
    lines = [head, ["---", *["---:"] * (len(head) - 1)], *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def ranged(values: dict[str, float], digits: int) -> str:
    """Median with smallest and largest value."""
    median, low, high = (f"{values[key]:.{digits}f}" for key in ("median", "min", "max"))
    return f"{median} ({low} to {high})"


def verdict(value: float, bound: float, *, least: bool = False) -> str:
    """The bound a value is held to, and whether it keeps it."""
    kept = value >= bound if least else value <= bound
    return f"{'≥' if least else '≤'} {bound:g}, {'kept' if kept else 'MISSED'}"


def limit(record: Record) -> str:
    """Table of cayley against hand-written C."""
    head = ("elements", "cayley [ns]", "C [ns]", "ratio", "wanted", "tips differ by [m]")
    rows = [
        (
            f"{row['elements']:,}".replace(",", " "),
            ranged(row["cayley_ns_per_node_step"], 1),
            ranged(row["c_ns_per_node_step"], 1),
            ranged(row["ratio"], 2),
            verdict(row["ratio"]["median"], row["ratio_wanted"]),
            f"{row['tip_difference_m']:.0e}",
        )
        for row in record["rows"]
    ]
    return f"Time per node and step, rule `nodal`; {record['compiler']}.\n\n{table(head, rows)}"


def pyelastica(record: Record) -> str:
    """Table of cayley against PyElastica."""
    programs = ("cayley", "pyelastica")
    head = (
        "elements",
        "step [s]",
        "cayley [µs/step]",
        "PyElastica [µs/step]",
        "times faster",
        "wanted",
        "tip error [m]: cayley",
        "PyElastica",
    )
    rows = []
    for row in record["rows"]:
        wanted = row["times_faster_wanted"]
        faster = row["times_faster"]
        rows.append(
            (
                str(row["elements"]),
                f"{row['dt_s']:.3g}",
                *(ranged(row[name]["us_per_step"], 2) for name in programs),
                ranged(faster, 1),
                verdict(faster["median"], wanted, least=True) if wanted else "",
                *(_errors(row[name]) for name in programs),
            )
        )
    peer = ", ".join(f"{name} {number}" for name, number in record["peer"].items())
    return f"Rule {record['rule']}; {peer}.\n\n{table(head, rows)}"


def quaternion_matrix(record: Record) -> str:
    """Table of quaternions against matrices."""
    head = ("run", "elements", "quaternions [ns]", "matrices [ns]", "ratio", "tips differ by [m]", "error of both [m]")
    rows = [
        (
            row["name"],
            str(row["elements"]),
            *(ranged(row[form]["ns_per_node_step"], 1) for form in ("quaternion", "matrix")),
            ranged(row["quaternion_over_matrix"], 3),
            f"{row['tip_difference_m']:.0e}",
            f"{max(row[form]['tip_error_from_step_m'] for form in ('quaternion', 'matrix')):.0e}",
        )
        for row in record["rows"]
    ]
    return f"Time per node and step, rule `nodal`.\n\n{table(head, rows)}"


def wait(record: Record) -> str:
    """Table of the wait beyond the integration."""
    head = ("process", "cache", "wall time [s]", "integration [s]", "wait [s]", "wanted")
    rows = []
    for name in ("example", "command_line"):
        figures = record[name]
        for state in ("empty", "warm"):
            own = figures[state]
            rows.append(
                (
                    name.replace("_", " "),
                    state,
                    ranged(own["wall_s"], 2),
                    f"{figures['integration_s']:.3f}",
                    ranged(own["wait_s"], 2),
                    verdict(own["wait_s"]["median"], own["wait_limit_s"]),
                )
            )
    spent = "; ".join(
        f"{name.replace('_', ' ')}: " + ", ".join(f"{k} {t:.2f}" for k, t in record[name]["imports_warm_s"].items())
        for name in ("example", "command_line")
    )
    return f"{table(head, rows)}\n\nImports with a warm cache, by package [s]: {spent}."


SECTIONS: dict[str, tuple[str, Callable[[Record], str]]] = {
    "limit": ("Against hand-written C", limit),
    "pyelastica": ("Against PyElastica", pyelastica),
    "wait": ("The wait", wait),
    "quaternion_matrix": ("Quaternions against matrices", quaternion_matrix),
}


def section(path: Path, title: str, body: Callable[[Record], str]) -> str:
    """One benchmark's heading, origin and table."""
    record = json.loads(path.read_text())
    machine = record["machine"]
    origin = (
        f"{record['date'][:10]}, commit `{record['commit'][:12]}{'-dirty' * record['commit'].endswith('-dirty')}`,"
        f" {machine['cpu']}, {machine['cores']} cores, Python {machine['python']}."
    )
    return f"### {title}\n\n{origin}\n\n{body(record)}\n"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--results", type=Path, default=RESULTS, help="folder of the JSON files")
    parser.add_argument("--print", action="store_true", help="print the tables and leave README.md alone")
    given = parser.parse_args()
    paths = {name: given.results / f"{name}.json" for name in SECTIONS}
    parts = [section(paths[name], *SECTIONS[name]) for name in SECTIONS if paths[name].exists()]
    text = "\n".join(parts) or "None yet.\n"
    if given.print:
        print(text)
        return
    readme = HERE / "README.md"
    before, _, rest = readme.read_text().partition(BEGIN)
    _, found, after = rest.partition(END)
    if not found:
        raise SystemExit(f"{readme}: no markers {BEGIN} and {END} to write the tables between")
    readme.write_text(f"{before}{BEGIN}\n\n{text}\n{END}{after}")
    print(f"wrote {readme}")


def _errors(program: Record) -> str:
    """Distance to the reference and, after it, to the program's own limit."""
    own = program.get("tip_error_to_own_limit_m")
    return f"{program['tip_error_m']:.1e}" + (f" ({own:.1e})" if own is not None else "")


if __name__ == "__main__":
    main()
