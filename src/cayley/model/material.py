"""An isotropic, linearly elastic material."""

from __future__ import annotations

from dataclasses import dataclass

from cayley.model import validate


@dataclass(frozen=True, slots=True, init=False)
class Material:
    """An isotropic, linearly elastic material: density and two elastic constants.

    G = E / (2 (1 + ν))

    Attributes:
        density: mass per volume ρ [kg/m^3].
        youngs_modulus: E [Pa].
        poisson_ratio: ν [-], in (-1, 0.5].
        shear_modulus: G [Pa].

    Example:
        >>> steel = Material(density=7850.0, youngs_modulus=2e11, poisson_ratio=0.25)
        >>> steel.shear_modulus
        80000000000.0
    """

    density: float
    youngs_modulus: float
    poisson_ratio: float
    shear_modulus: float

    def __init__(
        self,
        *,
        density: float,
        youngs_modulus: float,
        poisson_ratio: float | None = None,
        shear_modulus: float | None = None,
    ) -> None:
        """Take the density, Young's modulus and exactly one of the two other elastic constants.

        Args:
            density: mass per volume [kg/m^3].
            youngs_modulus: Young's modulus [Pa].
            poisson_ratio: Poisson's ratio [-], in (-1, 0.5]; or else
            shear_modulus: shear modulus [Pa], at least youngs_modulus/3 (an isotropic material has no smaller one).

        Raises:
            TypeError: a value is not a number.
            ValueError: a value is out of range, or both or neither of poisson_ratio and shear_modulus are given.
        """
        rho = validate.positive("Material", "density", density, "kg/m^3")
        young = validate.positive("Material", "youngs_modulus", youngs_modulus, "Pa")
        if poisson_ratio is not None and shear_modulus is not None:
            both = f"poisson_ratio = {poisson_ratio!r} and shear_modulus = {shear_modulus!r}"
            raise ValueError(f"Material: {both} are both given; give exactly one of them")
        if poisson_ratio is not None:
            nu = _poisson_ratio(poisson_ratio)
            shear = young / (2.0 * (1.0 + nu))
        elif shear_modulus is not None:
            shear = validate.positive("Material", "shear_modulus", shear_modulus, "Pa")
            nu = _implied_poisson_ratio(young, shear)
        else:
            raise ValueError("Material: neither poisson_ratio nor shear_modulus is given; give exactly one of them")
        for name, value in zip(self.__slots__, (rho, young, nu, shear), strict=True):
            object.__setattr__(self, name, value)


def _poisson_ratio(value: float) -> float:
    nu = validate.number("Material", "poisson_ratio", value, "-")
    if not -1.0 < nu <= 0.5:
        raise ValueError(validate.wrong("Material", "poisson_ratio", value, "above -1 and at most 0.5"))
    return nu


def _implied_poisson_ratio(young: float, shear: float) -> float:
    """ν = E / (2 G) - 1, where G = E/3 computed by the user may come out a rounding error above 0.5."""
    nu = young / (2.0 * shear) - 1.0
    if nu > 0.5 + 1e-9:
        right = f"at least youngs_modulus/3 = {young / 3.0:g} Pa (for other materials use Section.given)"
        raise ValueError(validate.wrong("Material", "shear_modulus", shear, right))
    return min(nu, 0.5)
