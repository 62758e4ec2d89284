"""The page of modes: the player with a scene for each, and a table to choose from; one HTML file that loads nothing."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from html import escape
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from cayley.lie import quaternion
from cayley.report import vibration
from cayley.report.html import figure_html, section, standing, written
from cayley.report.player import page
from cayley.report.scene import BYTES, Block, Link, Place, Quantity, Scene, Strand
from cayley.report.stage import scene
from cayley.report.swing import swing

_ROUNDING = 1e-12  # of masses, relative to the largest
_NODE = 44  # bytes in a frame: 12 of position, 8 of rotation, 6 of each of four vectors
_FEWEST, _MOST = 12, 24  # frames of a period: with so many the straight way between two is 3 % or 1 % off at most
_LINES = 60  # that show a rod at rest


def write_modes(
    modes: Any, path: str | Path, *, title: str | None = None, scenario_text: str | None = None, diagram: Any = None
) -> Path:
    """Write modes as one HTML file that needs no network: choose one, and it moves.

    Args:
        modes: Modes, one at least.
        path: of the file; an old one is replaced.
        title: of the page.
        scenario_text: the scenario file, to be shown.
        diagram: a Campbell diagram, to be drawn, too.

    Returns: the path.
    """
    lead = f"{len(modes)} of {modes.linear.motions} motions, about {modes.about!r}"
    campbell = [] if diagram is None else [section("Campbell diagram", _campbell(diagram))]
    below = "\n".join([section("Modes", _table(modes)), *campbell, *standing(modes.about, scenario_text=scenario_text)])
    return written(path, page(list(_scenes(modes)), title=title or "Modes", lead=lead, below=below))


def _scenes(modes: Any) -> Iterable[Scene]:
    """A scene for each mode, with as many frames as leave the page small."""
    rest = scene(modes.about.frame, graphs=False)
    nodes = sum(part.position.shape[1] for part in rest.parts)
    count = int(np.clip(BYTES // (len(modes) * nodes * _NODE), _FEWEST, _MOST))
    still = tuple(_outline(rest))
    for k, hertz in enumerate(modes.frequency.values):
        made = scene(swing(modes, k, count), stride=1, name=f"mode {k}: {hertz:.4g} Hz", graphs=False)
        parts = tuple(_compared(part, before) for part, before in zip(made.parts, rest.parts, strict=True))
        note = "The size is chosen for the eye, numbers are those at this size." + (
            "" if hertz > 0.0 else " This mode does not oscillate: its shape is shown swinging."
        )
        yield replace(made, parts=parts, links=made.links + still, note=note, period=True)


def _compared(part: Strand | Block, rest: Strand | Block) -> Strand | Block:
    """A part with what changes in proportion to a mode: displacement and rotation from rest, moment and curvature."""
    turn = quaternion.to_rotation_vector(quaternion.relative(rest.rotation, part.rotation))
    shift = part.position - rest.position
    found = {
        "displacement": Quantity(label="displacement", unit="m", values=shift, axes=("x", "y", "z")),
        "rotation": Quantity(label="rotation", unit="rad", values=np.asarray(turn, dtype=float)),
    }
    found |= {key: part.quantities[key] for key in ("moment", "curvature") if key in part.quantities}
    return replace(part, quantities=found)


def _outline(rest: Scene) -> Iterable[Link]:
    """Lines along the rods at rest."""
    for part in rest.parts:
        if isinstance(part, Strand):
            nodes = part.position.shape[1]
            chosen = np.unique(np.linspace(0, nodes - 1, min(nodes, _LINES + 1)).round().astype(int))
            ends = [Place(part=None, shift=tuple(point.tolist())) for point in part.position[0, chosen]]
            for first, second in pairwise(ends):
                yield Link(name=f"{part.name} at rest", first=first, second=second)


def _table(modes: Any) -> str:
    mass = modes.effective_mass.values[:, :3]
    mass = np.where(mass > _ROUNDING * mass.max(initial=0.0), mass, 0.0)
    rows = zip(modes.frequency.values, modes.damping_ratio.values, modes.moves_most(), mass, strict=True)
    body = "".join(
        f'<tr data-scene="{k}" tabindex="0" aria-selected="false"><td class="value">{k}</td>'
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
