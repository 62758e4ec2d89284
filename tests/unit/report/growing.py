"""A run in progress, and a server that shows it."""

import threading
from contextlib import contextmanager

from cayley import Trajectory
from cayley.report.serve import server
from cayley.results.observe import observe


def first_frames(run, count):
    """The run as it was when it had saved that many frames."""
    cut = run.frames.part(slice(count))
    observed = observe(run.system, cut)
    return Trajectory(
        frames=cut, info=run.info, outline=run.outline, observed=observed, model=run.model, parts=run._parts
    )


@contextmanager
def serving(store, **options):
    """A server in a thread of its own, and its address."""
    own = server(store, **options)
    thread = threading.Thread(target=own.serve_forever, daemon=True)
    thread.start()
    try:
        yield f"http://127.0.0.1:{own.server_port}/"
    finally:
        own.shutdown()
        own.server_close()
        thread.join()
