"""The page docs/audit.md."""

from collections.abc import Sequence

import numpy as np

from audit.measures import BACK, DRIFT, FLOW, MOMENTUM, REVERSAL, ROUNDING, STEPS, SYMPLECTIC, WITHIN, Finding
from audit.problems import PROBLEMS
from audit.stiff import Convergence

HEAD = """\
# Audit

What the theory promises for every rule, and what a run of the code keeps. This page is written by `make audit`
(`audit/`), not by hand; the numbers are those of its last run, which took {minutes:.0f} min. A check that falls short is marked
**✗** in the tables and listed under [What falls short](#what-falls-short).

| measure | how | passes |
| --- | --- | --- |
| order | error at the end for four steps, above the round-off; three slopes | each within {within} of the theory |
| momenta | largest change of the momentum maps the problem has symmetries for, over a long run, relative to the largest | < {momentum:.0e} |
| energy | rise of a straight line through the energy of that run, and the ripple, relative to the largest kinetic energy | rise < {drift} of the ripple, or < {rounding:.0e} |
| symplectic | JᵀΩ(z⁺)J − Ω(z) for the Jacobian J of {flow} steps, by differences of order 8, in units in which Ω is 1 | < {symplectic:.0e} |
| reversal | distance from the start after {back} steps, momenta reversed, {back} steps | < {reversal:.0e} |

The long run has {steps:,} steps; of rods under implicit rules {steps:,}/(stages × degree)², since their cost grows like that.
[Length of the long runs](#length-of-the-long-runs) says what each rule ran; so do the tables and the list of what falls short.
The flow is that of one rotation, or of a rod of one element (two, where an element has two nodes only). Errors are those of
positions in m and of entries of rotation matrices.
"""

REFERENCES = {
    "heavy top": "The fast top of Brüls, Cardona, Arnold (2012), 0.5 s; reference: Runge–Kutta of order 8 on Euler's equations.",
    "free asymmetric body": "Moments of inertia 1, 2, 3, near the stable axis, 10 s; reference: Jacobi's elliptic functions.",
    "rod in free flight": "A thick rubber rod of seven nodes, bent, thrown and spinning, 0.1 s; reference: the same terms in "
    "space, five Gauss points in time.",
    "rubber pendulum": "The rod of the benchmarks (1 m, radius 5 mm), pinned, five nodes (four elements of degree 1), bent and "
    "swinging in space, 0.02 s at steps that resolve shear (15,600 rad/s); reference likewise.",
}


def write(found: Sequence[Finding], stiff: Sequence[Convergence], seconds: float) -> str:
    """The whole page in Markdown."""
    parts = [
        HEAD.format(
            minutes=max(1.0, seconds / 60.0),
            within=WITHIN,
            momentum=MOMENTUM,
            drift=DRIFT,
            rounding=ROUNDING,
            flow=FLOW,
            symplectic=SYMPLECTIC,
            back=BACK,
            reversal=REVERSAL,
            steps=STEPS,
        ),
        shortfalls(found, stiff),
        lengths(found),
        "## Order\n\n![Error against time step for every rule](images/audit_order.png)\n",
        "## Energy\n\n![Deviation of the energy over the long runs](images/audit_energy.png)\n",
        unresolved(stiff),
        *(table(problem.name, problem.momenta, found) for problem in PROBLEMS),
    ]
    return "\n".join(parts)


def shortfalls(found: Sequence[Finding], stiff: Sequence[Convergence]) -> str:
    """List everything that did not pass, and what is not there to be measured."""
    ran = [f for f in found if f.run or len(f.errors)]
    lines = []
    for f in ran:
        short = [name for name, good in f.passed.items() if not good]
        if short:
            note = f" ({f.note})" if f.note else ""
            told = ", ".join(f"{n} {value(f, n)}" for n in short)
            lines.append(f"* {f.problem}, `{f.rule}`, {f.form}, long run of {length(f)}: {told}{note}")
    for reason, which in reasons([f for f in found if f not in ran]).items():
        lines.append(f"* Not there: {', '.join(f'`{rule}`' for rule in which)}: {reason}.")
    for c in stiff:
        if np.any(np.abs(c.orders - c.expected) > WITHIN):
            seen = np.array2string(c.orders, precision=1, separator=", ")
            lines.append(f"* Order of `{c.rule}` at steps that leave fast modes unresolved: {seen}, not {c.expected}.")
    checks = sum(len(f.passed) for f in ran)
    good = sum(sum(f.passed.values()) for f in ran)
    return f"## What falls short\n\n{good} of {checks} checks pass.\n\n" + "\n".join(lines or ["Nothing."]) + "\n"


def reasons(missing: Sequence[Finding]) -> dict[str, list[str]]:
    """Rules that could not be compiled, by what was said."""
    told: dict[str, list[str]] = {}
    for f in missing:
        said = f.note.replace(f"the rule {f.rule} is", "it is").rstrip(".")
        told.setdefault(said, [])
        if f.rule not in told[said]:
            told[said].append(f.rule)
    return told


def value(f: Finding, name: str) -> str:
    """The number behind a check."""
    return {
        "order": orders(f),
        "momentum": f"{f.momentum:.1e}",
        "energy": f"rise {f.rise:.1e}, ripple {f.ripple:.1e}",
        "symplectic": f"{f.defect:.1e}",
        "reversal": f"{f.back:.1e}",
    }[name]


def orders(f: Finding) -> str:
    """Smallest to largest observed order."""
    low, high = np.min(f.orders), np.max(f.orders)
    return f"{low:.2f}" if f"{low:.2f}" == f"{high:.2f}" else f"{low:.2f} … {high:.2f}"


def length(f: Finding) -> str:
    """Steps of the long run, and of how many where it was shortened."""
    if not f.run:
        return "no steps: it stopped"
    return f"{f.run:,} steps" if f.run >= STEPS else f"{f.run:,} of {STEPS:,} steps"


def lengths(found: Sequence[Finding]) -> str:
    """Steps of the long runs by rule and problem, the least of both forms."""
    names = [problem.name for problem in PROBLEMS]
    lines = [
        "## Length of the long runs\n",
        f"Momenta and energy are measured over this many steps, the fewer of both forms; what is under {STEPS:,} is shortened.\n",
        f"| rule | {' | '.join(names)} |",
        "| --- |" + " --- |" * len(names),
    ]
    for rule in dict.fromkeys(f.rule for f in found):
        cells = []
        for name in names:
            runs = [f.run for f in found if (f.problem, f.rule) == (name, rule)]
            cells.append(("stopped" if not min(runs) else f"{min(runs):,}") if runs else "")
        lines.append(f"| `{rule}` | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def table(name: str, momenta: str, found: Sequence[Finding]) -> str:
    """Table of one problem."""
    lines = [
        f"## {name[0].upper()}{name[1:]}\n",
        f"{REFERENCES[name]} Momentum maps: {momenta}.\n",
        "| rule | form | order | observed | finest error | momenta | energy: rise / ripple | steps | symplectic | reversal |",
        "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |",
    ]
    for f in found:
        if f.problem != name or not (f.run or len(f.errors)):
            continue
        flag = {n: "" if good else " **✗**" for n, good in f.passed.items()}
        smallest = f"{f.errors[-1]:.0e}" if len(f.errors) else "—"
        cells = [
            f"`{f.rule}`",
            f.form,
            str(f.expected),
            orders(f) + flag["order"],
            smallest,
            f"{f.momentum:.0e}{flag['momentum']}",
            f"{f.rise:.0e} / {f.ripple:.0e}{flag['energy']}",
            length(f).removesuffix(" steps"),
            f"{f.defect:.0e}{flag['symplectic']}",
            f"{f.back:.0e}{flag['reversal']}",
        ]
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def unresolved(stiff: Sequence[Convergence]) -> str:
    """What happens at steps far above the explicit limit."""
    head = "\n".join(
        [
            "## Steps that leave fast modes unresolved\n",
            "The orders hold as the step tends to zero: they show once it resolves the fastest mode, here rotation against shear.",
            "Implicit rules are for steps far above that. The tip of the rubber pendulum (10 elements, let go from rest, 1 s):\n",
            "![Error of the tip against steps far above the explicit limit](images/audit_stiff.png)\n",
        ]
    )
    steps = " | ".join(f"{h:.2g}" for h in stiff[0].steps)
    lines = [f"| rule, step [s] | {steps} | orders |", "| --- |" + " --- |" * (len(stiff[0].steps) + 1)]
    for c in stiff:
        seen = ", ".join(f"{o:.1f}" for o in c.orders)
        lines.append(f"| `{c.rule}` | {' | '.join(f'{e:.0e}' for e in c.errors)} | {seen} |")
    return f"{head}\n" + "\n".join(lines) + "\n"
