"""Run the audit on all cores and write docs/audit.md and its images."""

import os
import time
from concurrent.futures import ProcessPoolExecutor

from audit import ROOT, figures, page
from audit.measures import Finding, measure
from audit.problems import PROBLEMS
from audit.rules import EVERYWHERE, ON_INTERVALS, STIFF
from audit.stiff import Convergence, converge
from cayley.discrete.rules import Rule

RODS = (*EVERYWHERE, *ON_INTERVALS)
FORMS = ("quaternion", "matrix")
Case = tuple[int, Rule, str]


def main() -> None:
    """Measure, print as it comes, write."""
    started = time.perf_counter()
    cases = [
        (k, rule, form)
        for k, problem in enumerate(PROBLEMS)
        for rule in (RODS if problem.on_interval else EVERYWHERE)
        for form in FORMS
    ]
    cases.sort(key=lambda case: -len(case[1].time.at) * case[1].degree)  # the long ones first
    with ProcessPoolExecutor(max(1, min(os.cpu_count() or 1, 8))) as pool:
        slow = [pool.submit(converge, rule) for rule in STIFF]
        found = [show(finding) for finding in pool.map(one, cases)]
        stiff: list[Convergence] = [job.result() for job in slow]
    names = [problem.name for problem in PROBLEMS]
    rules, seconds = [str(rule) for rule in RODS], time.perf_counter() - started
    found.sort(key=lambda f: (names.index(f.problem), rules.index(f.rule), FORMS.index(f.form)))
    images = ROOT / "docs" / "images"
    figures.draw_order(found, images / "audit_order.png")
    figures.draw_energy(found, images / "audit_energy.png")
    figures.draw_stiff(stiff, images / "audit_stiff.png")
    (ROOT / "docs" / "audit.md").write_text(page.write(found, stiff, seconds), encoding="utf-8")
    print(f"docs/audit.md written, {seconds:.0f} s")


def one(case: Case) -> Finding:
    """One case, in a process of the pool."""
    k, rule, form = case
    return measure(PROBLEMS[k], rule, form)


def show(finding: Finding) -> Finding:
    """Print a line for a finding."""
    short = ", ".join(name for name, good in finding.passed.items() if not good) or "all well"
    print(
        f"{finding.problem}, {finding.rule}, {finding.form}: {finding.note or short} ({finding.seconds:.1f} s)",
        flush=True,
    )
    return finding


if __name__ == "__main__":
    main()
