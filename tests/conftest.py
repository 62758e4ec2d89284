"""What all tests share: the machine code goes to a folder of the session; golden files are compared or renewed."""

import os
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from hypothesis import settings

GOLDEN = Path(__file__).parent / "golden"

# No deadline: the first example of a test may compile. Derandomized: a run that passes here passes there.
settings.register_profile("cayley", deadline=None, derandomize=True)
settings.load_profile("cayley")


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--update-golden", action="store_true", help="write the files in tests/golden anew")


@pytest.fixture(scope="session", autouse=True)
def _kernels_of_this_session(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Start from an empty cache of kernels, and leave the user's alone."""
    before = os.environ.get("CAYLEY_CACHE_DIR")
    os.environ["CAYLEY_CACHE_DIR"] = str(tmp_path_factory.mktemp("kernels"))
    yield
    del os.environ["CAYLEY_CACHE_DIR"]
    if before is not None:
        os.environ["CAYLEY_CACHE_DIR"] = before


@pytest.fixture
def golden(request: pytest.FixtureRequest) -> Callable[[str, str], None]:
    """Compare a text with a file in tests/golden; with --update-golden write it instead."""

    def check(name: str, text: str) -> None:
        path = GOLDEN / name
        if request.config.getoption("--update-golden"):
            path.write_text(text, encoding="utf-8")
        assert text == path.read_text(encoding="utf-8"), f"{name} changed; if it should, run pytest --update-golden"

    return check
