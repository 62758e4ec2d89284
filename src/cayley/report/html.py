"""The report: one HTML file that plays the run, says what it conserved and what it is of; it loads nothing."""

from __future__ import annotations

import base64
import io
import os
import platform
from collections.abc import Iterable, Sequence
from html import escape
from importlib import metadata
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

import cayley
from cayley.report import figures
from cayley.report.cite import citation, cite
from cayley.report.conserved import conservation, saved_parts
from cayley.report.player import page
from cayley.report.stage import scene
from cayley.report.style import style

_LIBRARIES = ("numpy", "casadi", "llvmlite", "xarray", "zarr", "matplotlib")
_MOST_RODS = 4  # whose stress resultants are drawn


def write_report(
    run: Any,
    path: str | Path,
    *,
    scenario_text: str | None = None,
    title: str | None = None,
    notes: Sequence[str] = (),
    times: Sequence[float] | None = None,
    nodes: Sequence[int] | None = None,
) -> Path:
    """Write a run as one HTML file that needs no network; one that saved some parts only shows these.

    Args:
        run: a Trajectory.
        path: of the file; an old one is replaced.
        scenario_text: the scenario file, to be shown.
        title: of the page.
        notes: a heading and paragraphs of plain text.
        times: of the printed snapshots [s]; by default four of equal distance.
        nodes: whose stress resultants are printed; by default the first, the middle and the last of each rod.

    Returns: the path.
    """
    below = "\n".join([*_measured(run, times, nodes), *standing(run, scenario_text=scenario_text, notes=notes)])
    text = page([scene(run)], title=title or "A run", lead=lead(run), below=below)
    return written(path, text)


def written(path: str | Path, text: str) -> Path:
    """Write a file, whole at its path when it is complete."""
    target = Path(path)
    unfinished = target.with_name(target.name + ".part")
    unfinished.write_text(text, encoding="utf-8")
    os.replace(unfinished, target)
    return target


def lead(run: Any) -> str:
    """Length, step and rule of a run, in one line."""
    if len(run.time) == 1:
        return f"One frame, at t = {run.time[0]:g} s."
    span = f"{run.time[-1] - run.time[0]:g} s in {run.steps} steps of {run.dt:.6g} s with the rule {run.rule}"
    return f"{span}, {len(run.time)} frames saved."


def standing(run: Any, *, scenario_text: str | None = None, notes: Sequence[str] = ()) -> Iterable[str]:
    """Sections that do not depend on the frames: notes, model, scenario, how to cite, versions."""
    if notes:
        yield section(notes[0], "".join(f"<p>{escape(text)}</p>" for text in notes[1:]))
    if run.model is not None:
        yield section("Model", folded("Parts, supports, joints and loads", f"<pre>{escape(str(run.model))}</pre>"))
    if scenario_text:
        yield section("Scenario", folded("The file", f"<pre>{escape(scenario_text)}</pre>"))
    cited = "".join(f"<p>{escape(reference)}</p>" for reference in citation())
    yield section("How to cite", cited + folded("BibTeX of the methods of this run", f"<pre>{escape(cite(run))}</pre>"))
    yield f"<footer>{escape(versions())}</footer>"


def _measured(run: Any, times: Sequence[float] | None, nodes: Sequence[int] | None) -> Iterable[str]:
    """The table of conserved quantities, and figures for print."""
    yield section("Conservation", _conservation_table(run))
    if run.model is not None and saved_parts(run):
        drawn = "\n".join(_figures(run, times, nodes))
        yield section("Figures for print", folded("Snapshots and stress resultants", drawn))


def section(heading: str, body: str) -> str:
    """A section with its heading."""
    return f"<section>\n<h2>{escape(heading)}</h2>\n{body}\n</section>"


def _conservation_table(run: Any) -> str:
    rows = "".join(
        f'<tr><td>{escape(row.quantity)}</td><td class="value">{escape(row.value)}</td><td>{escape(row.unit)}</td>'
        f'<td class="note">{escape(row.note)}</td></tr>\n'
        for row in conservation(run)
    )
    head = '<tr><th>quantity</th><th class="value">value</th><th>unit</th><th></th></tr>\n'
    return f'<div class="wide"><table>\n{head}{rows}</table></div>'


def _figures(run: Any, times: Sequence[float] | None, nodes: Sequence[int] | None) -> Iterable[str]:
    caption = (
        "The rods in space, colored by the magnitude of the moment ‖Σ‖. All panels have the same scale along all axes; "
        "the gray line is the shadow on the floor, a ring marks a node held in place. After Leitz, Ober-Blöbaum and "
        "Leyendecker (2014), Figure 4."
    )
    names = saved_parts(run)
    if run.model.bodies or run.model.connections:
        caption += " A box is a body, of the same mass and inertia, with lines to its ports; a diamond is a joint."
    if run.model.obstacles:
        caption += " Obstacles are gray; a body that carries shapes is drawn by them."
    yield figure_html(figures.snapshots(run, times=times), "The model at some times.", caption)
    if len(run.time) == 1:  # an equilibrium
        return
    rods = [(rod, name) for rod in run.model.rods if (name := run.model.name_of(rod)) in names]
    for rod, name in rods[:_MOST_RODS]:
        chosen = [k for k in nodes or () if -rod.elements - 1 <= k <= rod.elements] or None
        yield _resultants(run, name, chosen, f" of {name}" if len(run.model.rods) > 1 else "")


def _resultants(run: Any, name: str, nodes: Sequence[int] | None, which: str) -> str:
    caption = (
        "σ = ∂L/∂x′ in space, the components 1, 2, 3 along x, y, z, and Σ = ∂L/∂Ω about the axes of the "
        "cross-section: the force and the moment that the part of the rod before the node exerts on the part after it. "
        "A free end without a load carries none. After Leitz, Ober-Blöbaum and Leyendecker (2014), Figure 5."
    )
    impulses = (
        f"The discrete momenta of one step of {run.dt:.6g} s, which the paper's Figure 5 seems to show: the force and "
        "the moment times the time step."
    )
    first = figure_html(figures.resultants(run, name, nodes), f"Stress resultants{which} over the time.", caption)
    second = figure_html(
        figures.resultants(run, name, nodes, impulse=True), f"Discrete momenta{which} over the time.", impulses
    )
    return first + folded(f"Stress resultants{which} as momenta over one step", second)


def folded(summary: str, body: str) -> str:
    """What is shown when its summary is clicked."""
    return f"<details><summary>{escape(summary)}</summary>{body}</details>"


def figure_html(figure: Figure, title: str, caption: str) -> str:
    """A figure as a picture in the page, with its caption."""
    picture = io.BytesIO()
    with style():
        figure.savefig(picture, format="svg", metadata={"Date": None, "Creator": None})
    data = base64.b64encode(picture.getvalue()).decode("ascii")
    image = f'<img alt="{escape(title)}" src="data:image/svg+xml;base64,{data}">'
    return f"<figure>{image}<figcaption><b>{escape(title)}</b> {escape(caption)}</figcaption></figure>"


def versions() -> str:
    """Versions of the library, of those it uses, and the machine."""
    libraries = []
    for name in _LIBRARIES:
        try:
            libraries.append(f"{name} {metadata.version(name)}")
        except metadata.PackageNotFoundError:
            continue
    machine = f"Python {platform.python_version()} on {platform.system()} {platform.machine()}"
    return f"cayley {cayley.__version__}, {', '.join(libraries)}; {machine}."
