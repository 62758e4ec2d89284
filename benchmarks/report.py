"""Write the tables of README.md from the JSON files in results/.

Reads every file that is there and replaces what stands between the markers ``<!-- results -->`` and
``<!-- end of results -->``.
"""

import argparse
import json
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

import suite
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


def implicit_cost(record: Record) -> str:
    """Table of the cost of an element and Newton iteration."""
    head = (
        "elements",
        "per element and iteration [µs]",
        "wanted",
        "iterations a step",
        "half the step moves the tip by [m]",
    )
    rows = [
        (
            f"{row['elements']:,}".replace(",", " "),
            ranged(row["us_per_element_iteration"], 2),
            f"{verdict(row['us_per_element_iteration']['median'], record['us_limit'])}; aim {record['us_aim']:g}",
            f"{row['iterations_per_step']:.2f}",
            f"{row['tip_change_at_half_step_m']:.0e}",
        )
        for row in record["rows"]
    ]
    growth = record["growth_of_cost_per_element"]
    told = f" From the fewest to the most elements the cost per element grows {growth:.2f} times." if growth else ""
    return f"Rule `{record['rule']}`, step {record['rows'][0]['dt_s']:g} s, one core.{told}\n\n{table(head, rows)}"


def steel_wire(record: Record) -> str:
    """Table of the steel wire against PyElastica."""
    head = ("program", "step [s]", "time for the run [s]", "times faster", "wanted", "tip error [m]")
    peer = record["pyelastica"]
    whole = peer["whole_run"]
    rows = [
        (
            "cayley, `midpoint`",
            f"{row['dt_s']:.3g}",
            ranged(row["loop_s"], 4),
            ranged(row["times_faster"], 0),
            verdict(row["times_faster"]["median"], row["times_faster_wanted"], least=True),
            f"{row['tip_error_m']:.1e}",
        )
        for row in record["rows"]
    ]
    own = record["verlet"]
    rows.append(("cayley, `verlet`", f"{own['dt_s']:.3g}", f"{own['loop_s']:.2f}", "", "", f"{own['tip_error_m']:.1e}"))
    error = f"{whole['tip_error_m']:.1e}" if whole and whole["tip_error_m"] is not None else "not run"
    scaled = ranged(record["rows"][-1]["pyelastica_loop_s"], 1)
    rows.append(("PyElastica, scaled up", f"{peer['dt_s']:.3g}", scaled, "", "", error))
    if whole:
        rows.append(("PyElastica, whole run", f"{whole['dt_s']:.3g}", f"{whole['loop_s']:.1f}", "", "", error))
    return (
        f"{record['elements']} elements, {record['t_end_s']:g} s; PyElastica {record['peer'].get('pyelastica', '?')},"
        f" timed over {peer['stretch_s']:g} s. The mesh alone makes an error of {record['mesh_error_m']:.1e} m; the"
        f" reference is good to {record['tip_exact_doubt_m']:.0e} m.\n\n{table(head, rows)}"
    )


def work_precision(record: Record) -> str:
    """Times to reach an error, and how far ahead of the best peer."""
    targets = list(record["series"][0]["time_to_error"])
    head = ("program", *(f"{float(target):.0e} m" for target in targets))
    rows = [
        (
            f"cayley, `{each['name']}`" if each["cayley"] else each["name"],
            *(_time_to(each["time_to_error"][target]) for target in targets),
        )
        for each in record["series"]
    ]
    ahead = (
        (
            f"{row['error_m']:.0e} m",
            f"`{row['cayley']}`",
            row["peer"],
            f"{row['times_faster']:.0f}" + "*" * row["extrapolated"],
            verdict(row["times_faster"], row["times_faster_wanted"], least=True) if row["times_faster_wanted"] else "",
        )
        for row in record["ahead"]
    )
    best = table(("tip error", "best of cayley", "best peer", "times faster", "wanted"), ahead)
    peer = ", ".join(f"{name} {number}" for name, number in record["peer"].items())
    return (
        f"Time of the loop [s] to reach a tip error at 1 s; * extrapolated beyond the finest run. {peer}.\n\n"
        f"{table(head, rows)}\n\n{best}\n\n![Work-precision diagram](../docs/images/work_precision.png)"
    )


def heavy_top(record: Record) -> str:
    """Table of galerkin rules against DOP853."""
    head = ("method", "step or tolerance", "steps", "time [s]", "error of the rotation", "relative energy error")
    rows = [
        (
            f"`{row['method']}`",
            f"{row['dt_s']:g} s" if "dt_s" in row else f"{row['rtol']:g}",
            str(row["steps"]),
            ranged(row["loop_s"], 2),
            f"{row['error']:.1e}",
            f"{row['energy_error']:.1e}",
        )
        for row in record["rows"]
    ]
    reference = record["reference"]
    return (
        f"The {record['top']} top over {record['t_end_s']:g} s. The reference is `galerkin(time={reference['degree']})`"
        f" with a step of {reference['dt_s']:g} s, good to {reference['doubt']:.0e}.\n\n{table(head, rows)}"
    )


def statics(record: Record) -> str:
    """Equilibria, and modes where they were measured."""
    told, modes = record["statics"], record["modes"]
    rows = [
        (
            name,
            ranged({k: 1e3 * v if k != "repeats" else v for k, v in told[name]["search_s"].items()}, 2),
            str(told[name].get("corrections", told[name].get("iterations"))),
            f"{told[name]['tip_error_m']:.1e}",
        )
        for name in ("cayley", "exudyn")
        if name in told
    ]
    head = ("program", "search [ms]", "corrections", "error of the tip [m]")
    whole = f"The whole call of cayley takes {1e3 * told['cayley']['whole_call_s']['median']:.0f} ms."
    found = f"A cantilever of {told['elements']} elements.\n\n{table(head, rows)}\n\n{whole}"
    if "cayley_s" not in modes:
        return found
    times = [(name, ranged(modes[f"{name}_s"], 3)) for name in ("cayley", "dense", "exudyn") if f"{name}_s" in modes]
    kind = f"{modes['modes']} modes of {modes['elements']} elements, to {modes['largest_difference']:.0e} alike"
    return f"{found}\n\n{kind}.\n\n{table(('program', 'time [s]'), times)}"


def sweep(record: Record) -> str:
    """Table of the rods drawn by chance."""
    outcomes, seconds = record["outcomes"], record["seconds"]
    head = (
        "rods",
        "finished",
        "stopped with a reason",
        "failed",
        "within accuracy",
        "largest error",
        "rules",
        "time each [s]",
    )
    row = (
        str(record["rods"]),
        *(str(outcomes[name]) for name in ("finished", "stopped", "failed")),
        f"{record['within_accuracy']} of {record['checked']} checked",
        f"{record['largest_error']:.1e}" if record["checked"] else "",
        ", ".join(f"`{name}` {count}" for name, count in record["rules"].items()),
        f"{seconds['median']:.2g} (up to {seconds['max']:.2g}), {seconds['sum']:.0f} in all",
    )
    return f"`accuracy={record['accuracy']:g}` and nothing else.\n\n{table(head, [row])}"


def assembly(record: Record) -> str:
    """Tables of a tree of rods against a chain, and of the factorizations of a lattice."""
    tree, lattice = record["tree"], record["lattice"]
    steps = tree["iterations_per_step"]
    rows = [
        (name, ranged(tree[f"{name}_us_per_element_step"], 2), f"{steps[name]:.2f}", ratio, wanted)
        for name, ratio, wanted in (
            ("tree", ranged(tree["ratio"], 2), verdict(tree["ratio"]["median"], tree["ratio_wanted"])),
            ("chain", "", ""),
        )
    ]
    head = ("assembly", "per element and step [µs]", "iterations a step", "tree over chain", "wanted")
    first = (
        f"{tree['elements']} elements, {tree['joints']} welds, rule `{record['rule']}`, step {tree['dt_s']:g} s. Over "
        f"iterations the tree costs {ranged(tree['ratio_per_iteration'], 2)} times the chain.\n\n{table(head, rows)}"
    )
    residual = lattice["residual"]
    names = (("block LU", "block_lu"), ("SuperLU", "superlu"))
    own = [(name, ranged(lattice[f"{key}_ms"], 1), f"{residual[key]:.0e}") for name, key in names]
    second = table(("factorization", "time [ms]", "residual of a solution"), own)
    told = f"A lattice with {lattice['joints']} welds, {lattice['unknowns']} unknowns, {lattice['entries']} entries."
    return f"{first}\n\n{told}\n\n{second}"


def cosseratbench(record: Record) -> str:
    """A table for each experiment of the suite."""
    programs = ", ".join(f"{name} {number}" for name, number in record["programs"].items())
    found = [f"All figures are the suite's own: its result files, default settings; {programs}."]
    told, nearer = suite.compared(record["rows"])
    head = ("where a peer is nearer", "figure", "cayley", "best peer", suite.FINE, "which peer")
    found.append(f"{told} Where it is not, a fine mesh tells what the model itself has.\n\n{table(head, nearer)}")
    for name in dict.fromkeys(row["experiment"] for row in record["rows"]):
        rows = [row for row in record["rows"] if row["experiment"] == name]
        head, lines = suite.lines(rows, suite.WANTED.get(name, {}))
        found.append(f"**{name}**, {rows[0]['n_elements']} elements\n\n{table(head, lines)}")
    return "\n\n".join(found)


def contact(record: Record) -> str:
    """Table of what contact costs."""
    head = (
        "rods",
        "segments",
        "candidates",
        "contacts",
        "per candidate and step [ns]",
        "search, per segment [ns]",
        "step over that without contact",
        "deepest [radii]",
        "defect of the energy over what is lost",
    )
    rows = [
        (
            *(f"{row[name]:,}".replace(",", " ") for name in ("rods", "segments", "candidates", "contacts")),
            f"{row['contact_ns_per_candidate']:.0f}",
            f"{row['search_ns_per_segment']:.0f}",
            ranged(row["ratio"], 1),
            f"{row['deepest_radii']:.1e}",
            f"{row['defect_of_energy']:.1e}",
        )
        for row in record["piles"]
    ]
    told = f"Rods of {record['elements']} elements in crossed layers of 20, with friction; step {record['dt_s']:g} s."
    return f"{told}\n\n{table(head, rows)}"


SECTIONS: dict[str, tuple[str, Callable[[Record], str]]] = {
    "limit": ("Against hand-written C", limit),
    "pyelastica": ("Against PyElastica", pyelastica),
    "wait": ("The wait", wait),
    "quaternion_matrix": ("Quaternions against matrices", quaternion_matrix),
    "implicit_cost": ("Cost of an implicit step", implicit_cost),
    "steel_wire": ("Steel wire against PyElastica", steel_wire),
    "work_precision": ("Work and precision", work_precision),
    "heavy_top": ("Heavy top", heavy_top),
    "sweep": ("Rods drawn by chance", sweep),
    "assembly": ("Joints and closed loops", assembly),
    "statics": ("Equilibria and modes", statics),
    "contact": ("Contact", contact),
    "cosseratbench": ("The suite cosseratbench", cosseratbench),
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


def _time_to(told: Record) -> str:
    """A time with three digits, marked where it is extrapolated."""
    return "not reached" if told["s"] is None else f"{told['s']:.3g}" + "*" * told["extrapolated"]


def _errors(program: Record) -> str:
    """Distance to the reference and, after it, to the program's own limit."""
    own = program.get("tip_error_to_own_limit_m")
    return f"{program['tip_error_m']:.1e}" + (f" ({own:.1e})" if own is not None else "")


if __name__ == "__main__":
    main()
