"""A steel rod of four elements along e1, and a check that a refusal is exactly one known line."""

from collections.abc import Callable
from typing import Any

import pytest

from cayley.model import Material, Rod, Section


@pytest.fixture
def steel() -> Material:
    return Material(density=7850.0, youngs_modulus=2e11, poisson_ratio=0.3)


@pytest.fixture
def section(steel: Material) -> Section:
    return Section.circle(0.01, steel)


@pytest.fixture
def rod(section: Section) -> Rod:
    return Rod(section, length=2.0, direction=(1, 0, 0), elements=4, name="mast")


@pytest.fixture
def refused() -> Callable[[Callable[[], Any], type[Exception], str], None]:
    def check(call: Callable[[], Any], error: type[Exception], line: str) -> None:
        with pytest.raises(error) as caught:
            call()
        assert str(caught.value) == line
        assert "\n" not in line

    return check
