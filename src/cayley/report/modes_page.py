"""The page of modes: a table to choose from, and the chosen mode moving; one HTML file that loads nothing."""

from __future__ import annotations

import json
from html import escape
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

from cayley.report import vibration
from cayley.report.html import figure_html, folded, section, versions, write_page
from cayley.report.skeleton import Skeleton

_DIGITS = 5  # of coordinates, relative to the extent: finer than a pixel
_ROUNDING = 1e-12  # of masses, relative to the largest
_STYLE = """
#stage { width: 100%; height: 26rem; display: block; touch-action: none; cursor: grab; border: 1px solid var(--line); }
.controls { display: flex; gap: 1rem; align-items: center; margin: .6rem 0 1rem; }
button { font: inherit; padding: .2rem .9rem; border: 1px solid var(--ink); border-radius: 4px; background: none; }
tr[data-mode] { cursor: pointer; }
tr[aria-selected="true"] td { background: #e8f1f8; }
"""


def write_modes(
    modes: Any, path: str | Path, *, title: str | None = None, scenario_text: str | None = None, diagram: Any = None
) -> Path:
    """Write modes as one HTML file that needs no network: choose one, and it moves.

    Args:
        modes: Modes.
        path: of the file; an old one is replaced.
        title: of the page.
        scenario_text: the scenario file, to be shown.
        diagram: a Campbell diagram, to be drawn, too.

    Returns: the path.
    """
    lead = f"{len(modes)} of {modes.linear.motions} motions, about {modes.about!r}"
    parts = [
        f'<header><h1>{escape(title or "Modes")}</h1><p class="lead">{escape(lead)}</p></header>',
        section("Shapes", _stage() + _table(modes)),
        *([section("Campbell diagram", _campbell(diagram))] if diagram is not None else []),
        section("Model", f"<pre>{escape(str(modes.model))}</pre>"),
        *([section("Scenario", folded("The file", f"<pre>{escape(scenario_text)}</pre>"))] if scenario_text else []),
        f"<footer>{escape(versions())}</footer>",
        f'<script type="application/json" id="modes-data">{_data(modes)}</script>',
        f"<script>\n{resources.files('cayley.report').joinpath('modes.js').read_text(encoding='utf-8')}</script>",
    ]
    return write_page(path, title or "Modes", parts, style=_STYLE)


def _stage() -> str:
    return (
        '<canvas id="stage" role="img" aria-label="The chosen mode in motion, over the equilibrium in gray"></canvas>\n'
        '<div class="controls"><button id="play" type="button">Pause</button>'
        '<label>size <input id="size" type="range" min="0" max="2" step="0.05" value="1"></label>'
        "<span>drag to turn</span></div>\n"
    )


def _table(modes: Any) -> str:
    mass = modes.effective_mass.values[:, :3]
    mass = np.where(mass > _ROUNDING * mass.max(initial=0.0), mass, 0.0)
    rows = zip(modes.frequency.values, modes.damping_ratio.values, modes.moves_most(), mass, strict=True)
    body = "".join(
        f'<tr data-mode="{k}" tabindex="0" aria-selected="false"><td class="value">{k}</td>'
        f'<td class="value">{f:.5g}</td><td class="value">{z:.3g}</td><td>{escape(word)}</td>'
        + "".join(f'<td class="value">{m:.3g}</td>' for m in own)
        + "</tr>\n"
        for k, (f, z, word, own) in enumerate(rows)
    )
    head = (
        '<tr><th class="value">mode</th><th class="value">frequency [Hz]</th><th class="value">damping [-]</th>'
        '<th>moves most</th><th class="value">mass x [kg]</th><th class="value">y</th><th class="value">z</th></tr>\n'
    )
    return f'<div class="wide"><table>\n{head}{body}</table></div>'


def _campbell(diagram: Any) -> str:
    caption = (
        "Frequencies in the frame that turns, each mode followed by its shape. Where a curve meets a dashed line kP, "
        "whatever is fixed in space excites it k times a turn."
    )
    return figure_html(vibration.campbell(diagram), "Frequencies over the speed.", caption)


def _data(modes: Any) -> str:
    """Points, displacements of every mode (real, imaginary) and lines, for modes.js."""
    skeleton = Skeleton.of(modes)
    extent = float(np.ptp(skeleton.points, axis=0).max()) or 1.0
    digits = _DIGITS - int(np.floor(np.log10(extent)))
    shown = float(np.linalg.norm(skeleton.moves, axis=-1).max(initial=0.0))
    found = {
        "points": skeleton.points.round(digits).tolist(),
        "moves": [[u.real.round(digits).tolist(), u.imag.round(digits).tolist()] for u in skeleton.moves],
        "lines": skeleton.lines.tolist(),
        "shown": shown,
    }
    return json.dumps(found, separators=(",", ":"))
