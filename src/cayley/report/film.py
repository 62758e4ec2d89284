"""Films of a run by Matplotlib: GIF, or MP4 by the program ffmpeg, the system's or that of the extra "film"."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import animation, rc_context

from cayley.report.snapshots import Contents, color_bar
from cayley.report.style import WIDTH, Drawing, style

_PLAYED = 10.0  # s that a film takes by default
_RIGHT, _EDGE = 0.85, 0.45  # in; for the color bar, and around the picture
_DPI = 100
_HIGHEST = 6.0  # in


def film(run: Any, path: str | Path, *, speed: float | None = None, fps: int = 20, part: Any = None) -> Path:
    """Write a film of a run.

    Args:
        run: a Trajectory of a model.
        path: of the film, ending in .gif or .mp4; an old one is replaced.
        speed: seconds of the run in a second of the film; by default so many that the film takes ten seconds.
        fps: pictures a second.
        part: a rod, its name, or a list of them; by default all rods, bodies and joints.

    Returns: the path.

    Raises:
        ValueError: another ending, a speed or rate that is not positive, or a run without a model.
        RuntimeError: for .mp4 without ffmpeg.
    """
    target, writer = Path(path), _writer(Path(path), fps)
    if run.model is None:
        raise ValueError("animate: a run of a Lagrangian of your own has no parts to draw")
    length = float(run.time[-1] - run.time[0])
    rate = length / _PLAYED if speed is None else speed
    if not rate > 0.0:
        raise ValueError(f"animate: speed is {rate:g}, but must be positive (and the run longer than one frame)")
    times = np.linspace(run.time[0], run.time[-1], max(2, round(length / rate * fps) + 1))
    frames = [int(np.abs(run.time - t).argmin()) for t in times]
    shown = Contents.of(run, part, frames)
    room = shown.room()
    width, height = room.extent
    inches = min((WIDTH - _RIGHT - 2.0 * _EDGE) / width, _HIGHEST / height)  # of a meter
    tall = height * inches + 2.0 * _EDGE
    margin = 0.5 * ((WIDTH - _RIGHT - 2.0 * _EDGE) / inches - width)
    with style(), rc_context({"animation.ffmpeg_path": _ffmpeg() or "ffmpeg"}):
        figure = Drawing(figsize=(WIDTH, tall))
        place = (_EDGE / WIDTH, _EDGE / tall, 1.0 - (2.0 * _EDGE + _RIGHT) / WIDTH, 1.0 - 2.0 * _EDGE / tall)
        axes = figure.add_axes(place)
        if shown.positions:
            color_bar(figure, (1.0 - 0.72 / WIDTH, 0.2, 0.1 / WIDTH, 0.6), shown.scale)
        with writer.saving(figure, str(target), dpi=_DPI):
            for k, frame in enumerate(frames):
                axes.clear()
                room.draw(axes, labeled=True, margin=margin)
                shown.draw(axes, k, room)
                axes.set_title(f"$t$ = {run.time[frame]:.3g} s", loc="center")
                writer.grab_frame()
    return target


def _writer(path: Path, fps: int) -> Any:
    if not fps > 0:
        raise ValueError(f"animate: fps is {fps}, but must be positive")
    if path.suffix == ".gif":
        return animation.PillowWriter(fps=fps)
    if path.suffix != ".mp4":
        raise ValueError(f"animate: {path.name!r} must end in .gif or .mp4")
    if _ffmpeg() is None:
        raise RuntimeError(
            "animate: an .mp4 film needs the program ffmpeg, which is not here; install the extra "
            "(pip install 'cayley[film]') or the program, or give a .gif"
        )
    return animation.FFMpegWriter(fps=fps)


def _ffmpeg() -> str | None:
    """The program: Matplotlib's setting or that of the system, else that of the package imageio-ffmpeg."""
    found = shutil.which(animation.FFMpegWriter.bin_path())
    if found is not None:
        return found
    try:
        from imageio_ffmpeg import get_ffmpeg_exe

        return str(get_ffmpeg_exe())
    except (ImportError, RuntimeError):
        return None
