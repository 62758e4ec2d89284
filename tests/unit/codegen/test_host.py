"""Vectors only as wide as the processor has all instructions for that the compiled steppers may use."""

import pytest

from cayley.codegen.jit import LEVELS, _lanes_of


def told(*names: str, without: tuple[str, ...] = ()) -> str:
    """Features as LLVM writes them."""
    return ",".join([*(f"+{name}" for name in names if name not in without), *(f"-{name}" for name in without)])


def test_whole_levels():
    assert _lanes_of(told("sse2")) == 2
    assert _lanes_of(told("neon", "fp-armv8")) == 2
    assert _lanes_of(told("sse2", *LEVELS[4])) == 4
    assert _lanes_of(told("sse2", *LEVELS[4], *LEVELS[8])) == 8


@pytest.mark.parametrize("missing", LEVELS[4])
def test_without_one_of_level_3(missing):
    """As Sandy Bridge with AVX but not AVX2, or a virtual machine that hides one."""
    assert _lanes_of(told(*LEVELS[4], *LEVELS[8], without=(missing,))) == 2


@pytest.mark.parametrize("missing", LEVELS[8])
def test_without_one_of_level_4(missing):
    """As Knights Landing with AVX-512F but not BW, DQ and VL."""
    assert _lanes_of(told(*LEVELS[4], *LEVELS[8], without=(missing,))) == 4
