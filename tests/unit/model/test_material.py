"""Two elastic constants from either pair, and refusals."""

import math
import pickle

import pytest

from cayley.model import Material

RHO, E = 1000.0, 5e6


def test_shear_modulus_from_poisson_ratio():
    rubber = Material(density=RHO, youngs_modulus=E, poisson_ratio=0.35)
    assert rubber.poisson_ratio == 0.35
    assert rubber.shear_modulus == pytest.approx(E / 2.7, rel=1e-15)


def test_poisson_ratio_from_shear_modulus():
    rubber = Material(density=RHO, youngs_modulus=E, shear_modulus=2e6)
    assert rubber.shear_modulus == 2e6
    assert rubber.poisson_ratio == pytest.approx(0.25, rel=1e-15)


@pytest.mark.parametrize("young", [5e6, 1.0, 0.1, 7e10, 1.1e9])
def test_incompressible_by_either_constant(young):
    assert Material(density=RHO, youngs_modulus=young, poisson_ratio=0.5).poisson_ratio == 0.5
    assert Material(density=RHO, youngs_modulus=young, shear_modulus=young / 3).poisson_ratio <= 0.5


def test_value_object():
    one, other = (Material(density=RHO, youngs_modulus=E, poisson_ratio=0.5) for _ in range(2))
    assert one == other == pickle.loads(pickle.dumps(one))
    assert hash(one) == hash(other)
    assert repr(one) == (
        "Material(density=1000.0, youngs_modulus=5000000.0, poisson_ratio=0.5, shear_modulus=1666666.6666666667)"
    )
    with pytest.raises(AttributeError):
        one.density = 2.0


@pytest.mark.parametrize(
    ("given", "error", "line"),
    [
        ({"density": -1.0}, ValueError, "Material: density = -1.0 must be a positive, finite number [kg/m^3]"),
        ({"density": 0}, ValueError, "Material: density = 0 must be a positive, finite number [kg/m^3]"),
        ({"density": math.nan}, ValueError, "Material: density = nan must be a positive, finite number [kg/m^3]"),
        ({"density": math.inf}, ValueError, "Material: density = inf must be a positive, finite number [kg/m^3]"),
        ({"density": "1"}, TypeError, "Material: density = '1' must be a positive, finite number [kg/m^3]"),
        ({"density": True}, TypeError, "Material: density = True must be a positive, finite number [kg/m^3]"),
        ({"youngs_modulus": -2}, ValueError, "Material: youngs_modulus = -2 must be a positive, finite number [Pa]"),
        ({"poisson_ratio": 0.51}, ValueError, "Material: poisson_ratio = 0.51 must be above -1 and at most 0.5"),
        ({"poisson_ratio": -1}, ValueError, "Material: poisson_ratio = -1 must be above -1 and at most 0.5"),
        ({"poisson_ratio": math.nan}, ValueError, "Material: poisson_ratio = nan must be a finite number [-]"),
        (
            {"poisson_ratio": None},
            ValueError,
            "Material: neither poisson_ratio nor shear_modulus is given; give exactly one of them",
        ),
        (
            {"shear_modulus": 2e6},
            ValueError,
            "Material: poisson_ratio = 0.3 and shear_modulus = 2000000.0 are both given; give exactly one of them",
        ),
        (
            {"poisson_ratio": None, "shear_modulus": 0.0},
            ValueError,
            "Material: shear_modulus = 0.0 must be a positive, finite number [Pa]",
        ),
        (
            {"poisson_ratio": None, "shear_modulus": 1.5},
            ValueError,
            "Material: shear_modulus = 1.5 must be at least youngs_modulus/3 = 1.66667e+06 Pa "
            "(for other materials use Section.given)",
        ),
    ],
)
def test_refusals(refused, given, error, line):
    refused(
        lambda: Material(**({"density": RHO, "youngs_modulus": E, "poisson_ratio": 0.3} | given)),
        error,
        line,
    )
