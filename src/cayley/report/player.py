"""The page of the player: scenes, scripts and styles in one HTML text that loads nothing."""

from __future__ import annotations

import base64
import functools
import json
from collections.abc import Sequence
from html import escape
from importlib import resources
from typing import Any

import numpy as np

from cayley.report.pack import chunk, described
from cayley.report.scene import Scene

_STYLES = ("vendor/uPlot.min.css", "page.css", "player.css")
_SCRIPTS = (
    "linear.js",
    "data.js",
    "meshes.js",
    "paint.js",
    "camera.js",
    "obstacles.js",
    "picture.js",
    "plots.js",
    "live.js",
    "player.js",
)
_MAPS = {"size": "viridis", "signed": "coolwarm"}


def page(scenes: Sequence[Scene], *, title: str, lead: str = "", below: str = "", live: bool = False) -> str:
    """A page that plays scenes.

    Args:
        scenes: at least one; with several, a list on the page chooses among them.
        title: of the page, plain text.
        lead: a line below it, plain text.
        below: HTML below the player.
        live: the frames are not on the page but asked for, from `frames?scene=NUMBER&from=FRAME`.

    Returns: HTML.

    Raises:
        ValueError: no scene.
    """
    if not scenes:
        raise ValueError("page: there are no scenes, but must be one at least")
    about = {"scenes": [described(scene) for scene in scenes], "maps": _maps(), "live": live}
    frames = [] if live else [base64.b64encode(chunk(scene)).decode("ascii") for scene in scenes]
    data = [_element("page", "application/json", _json(about))]
    data += [_element(f"frames{k}", "text/plain", text) for k, text in enumerate(frames)]
    styles = "\n".join(asset(name) for name in _STYLES)
    own = "\n".join(asset(name) for name in _SCRIPTS)
    body = (
        f'<header><h1>{escape(title)}</h1><p class="lead">{escape(lead)}</p></header>\n'
        + f"{asset('player.html')}{below}\n"
        + "\n".join(data)
        + f"\n<script>/*\n{asset('vendor/uPlot.LICENSE')}*/\n{asset('vendor/uPlot.iife.min.js')}</script>\n"
        + f'<script>\n"use strict";\n(() => {{\n{own}}})();\n</script>'
    )
    return document(title, body, style=styles)


def document(title: str, body: str, *, style: str) -> str:
    """A whole page.

    Args:
        title: plain text.
        body: HTML.
        style: CSS.
    """
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f'<title>{escape(title)}</title>\n<link rel="icon" href="data:,">\n<style>\n{style}</style>\n</head>\n'
        f"<body>\n{body}\n</body>\n</html>\n"
    )


@functools.cache
def asset(name: str) -> str:
    """The text of a file of the page."""
    return resources.files("cayley.report").joinpath("web").joinpath(name).read_text(encoding="utf-8")


@functools.cache
def _maps() -> dict[str, str]:
    """Color maps: 256 colors of three bytes, in base64."""
    from matplotlib import colormaps

    places = np.linspace(0.0, 1.0, 256)
    return {
        name: base64.b64encode(colormaps[own](places, bytes=True)[:, :3].tobytes()).decode("ascii")
        for name, own in _MAPS.items()
    }


def _element(name: str, kind: str, text: str) -> str:
    return f'<script id="{name}" type="{kind}">{text}</script>'


def _json(value: Any) -> str:
    """JSON that may stand in a script element: no "<", so no end of it."""
    return json.dumps(value, ensure_ascii=False, separators=(",", ":")).replace("<", "\\u003c")
