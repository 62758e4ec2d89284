"""`cayley view`: the page of a run over HTTP on this machine, which follows the run while it grows."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import fields, replace
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs, urlsplit

import numpy as np

from cayley.model import Model
from cayley.report.html import lead, standing
from cayley.report.pack import chunk
from cayley.report.player import page
from cayley.report.scene import Scene
from cayley.report.stage import default_stride, scene
from cayley.results.journal import journals
from cayley.results.observe import Observations, observe
from cayley.results.trajectory import Trajectory

_MOST_FRAMES = 400  # in one answer: the page asks again until there are no more
_HOST = "127.0.0.1"
_TRIES, _MOMENT = 4, 0.25  # s; a chunk is written in less


class Source:
    """A store that may grow, and the scene of what it holds."""

    def __init__(self, store: Path, model: Model | None = None) -> None:
        """Open the store, with the model that ran if it is at hand.

        Raises:
            FileNotFoundError: if there is nothing.
            ValueError: if it is no run.
        """
        self.store, self.model = store, model
        self._lock = threading.Lock()
        self._seen = self._signature()
        self.run = self._opened()
        self.stride = default_stride(self.run)
        self._scene = scene(self.run, stride=self.stride)

    def scene(self) -> Scene:
        """The scene, with the frames that have been added to the store."""
        with self._lock:
            signature = self._signature()
            if signature != self._seen:
                try:
                    self.run = grown(self.run, Trajectory.open(self.store, model=self.model))
                    self._scene = scene(self.run, stride=self.stride)
                    self._seen = signature
                except (OSError, ValueError):  # it is being written; the next question comes in a second
                    pass
            return self._scene

    def _opened(self) -> Trajectory:
        """The store, which may be in the middle of a change: then a moment later."""
        for _ in range(_TRIES - 1):
            try:
                return Trajectory.open(self.store, model=self.model)
            except ValueError:
                time.sleep(_MOMENT)
        return Trajectory.open(self.store, model=self.model)

    def _signature(self) -> tuple[tuple[int, int, int], ...]:
        """What changes when the store does."""
        described = [self.store.joinpath(*group, "zarr.json") for group in ((), ("time",), ("checkpoint",))]
        found = [file.stat() for file in (*described, *journals(self.store)) if file.exists()]
        return tuple((one.st_mtime_ns, one.st_ino, one.st_size) for one in found)


def grown(before: Trajectory, now: Trajectory) -> Trajectory:
    """A run in progress, opened again: only its new frames are observed, and the system is not made again."""
    count, times = len(before.time), now.time
    if "observed" in vars(now) or len(times) < count or not np.array_equal(times[:count], before.time):
        return now
    if now.only is not None:
        return _grown_parts(before, now)
    more = observe(before.system, now.frames.part(slice(count, None)))
    joined = {
        one.name: np.concatenate([getattr(before.observed, one.name), getattr(more, one.name)])
        for one in fields(Observations)
        if one.name != "held" and getattr(more, one.name) is not None
    }
    seen = replace(before.observed, **joined)
    return Trajectory(
        frames=now.frames, info=now.info, system=before.system, observed=seen, model=now.model, parts=now._parts
    )


def _grown_parts(before: Trajectory, now: Trajectory) -> Trajectory:
    """The same of a run that saves some nodes only: frames with all of them are in its journal."""
    if now.late is None or now.only is None:
        return now
    vars(now)["system"] = before.system
    known, stored = len(before.time), len(now.time) - len(now.late.times)
    if known == len(now.time):
        vars(now)["observed"] = before.observed
    elif known >= stored:
        more = observe(before.system, now.late.part(slice(known - stored, None)))
        vars(now)["observed"] = before.observed.then(more.at_nodes(now.only))
    return now


def server(
    store: Path,
    *,
    port: int = 0,
    title: str = "A run",
    scenario_text: str | None = None,
    model: Model | None = None,
) -> ThreadingHTTPServer:
    """A server of the page of a run, on this machine only; call its `serve_forever`.

    Args:
        store: of the run, finished or in progress.
        port: 0: any that is free.
        title: of the page.
        scenario_text: the scenario file, to be shown.
        model: the model that ran, if it is at hand: loads that are functions of time are not whole in a store.

    Raises:
        FileNotFoundError: if there is no store.
        ValueError: if it is no run.
        OSError: if the port is taken.
    """
    source = Source(store, model)

    def text() -> str:
        below = "\n".join(standing(source.run, scenario_text=scenario_text))
        return page([source.scene()], title=title, lead=lead(source.run), below=below, live=True)

    return ThreadingHTTPServer((_HOST, port), _handler(source, text))


def _handler(source: Source, text: Callable[[], str]) -> type[BaseHTTPRequestHandler]:
    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            """Answer with the page, or with frames."""
            asked = urlsplit(self.path)
            if asked.path == "/":
                self._answer(HTTPStatus.OK, "text/html; charset=utf-8", text().encode("utf-8"))
            elif asked.path == "/frames":
                self._frames(parse_qs(asked.query))
            else:
                self.send_error(HTTPStatus.NOT_FOUND)

        def _frames(self, asked: dict[str, list[str]]) -> None:
            given = asked.get("from", [""])[0]
            if not given.isdecimal():
                return self.send_error(HTTPStatus.BAD_REQUEST, "from must be the number of a frame")
            found, first = source.scene(), int(given)
            if first > len(found.time):  # another, shorter run is there now
                return self._answer(HTTPStatus.RESET_CONTENT)
            if first == len(found.time):
                return self._answer(HTTPStatus.NO_CONTENT)
            data = chunk(found, first, first + _MOST_FRAMES)
            return self._answer(HTTPStatus.OK, "application/octet-stream", data)

        def _answer(self, status: HTTPStatus, kind: str = "text/plain", body: bytes = b"") -> None:
            self.send_response(status)
            self.send_header("Content-Type", kind)
            self.send_header("Content-Length", str(len(body)))
            self.send_header("Cache-Control", "no-store")
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, format: str, *args: Any) -> None:
            """Say nothing about every question."""

    return Handler
