"""Cross-sections: stiffness and inertia per length, made from a shape and a material or given as they are."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from cayley.model import validate
from cayley.model.material import Material
from cayley.model.validate import Array

_ZETA_5 = 1.0369277551433699263  # Riemann zeta at 5, for the torsion series
_CIRCLE_POINTS = 32
_STIFFNESS_ROWS = "shear 1, shear 2, axial, bend 1, bend 2, twist [N, N m, N m^2]"
_INERTIA_ROWS = "about e1, e2, e3 [kg m]"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Section:
    """A cross-section of a rod: e1 and e2 lie in it, e3 is the rod axis, through the centroid of the shapes made here.

    Usually made by `rectangle`, `circle`, `tube` or `given`. Two sections are equal only if they are the same object.

    Attributes:
        stiffness: C [N, N m, N m^2], shape (6, 6), symmetric and positive definite, read-only; it maps
            (Γ1, Γ2, Γ3, Ω1, Ω2, Ω3) to (shear force 1 and 2, axial force, bending moment 1 and 2, twisting moment).
        mass_per_length: m [kg/m].
        inertia: J, rotary inertia per length about the axis in the body frame [kg m], shape (3, 3), read-only.
        mass_center: where along e1 and e2 the mass center lies, from the axis [m].
        outline: outer contour in the (e1, e2) plane for drawing [m], shape (k, 2), counter-clockwise, the first
            point not repeated, read-only.
        name: a few words that name it in listings.
    """

    stiffness: Array
    mass_per_length: float
    inertia: Array
    outline: Array
    mass_center: tuple[float, float] = (0.0, 0.0)
    name: str = "given"

    def __post_init__(self) -> None:
        """Check and freeze the values."""
        stiffness = validate.positive_definite("Section", "stiffness", self.stiffness, 6, _STIFFNESS_ROWS)
        mass = validate.positive("Section", "mass_per_length", self.mass_per_length, "kg/m")
        inertia = validate.positive_definite("Section", "inertia", self.inertia, 3, _INERTIA_ROWS)
        outline = validate.array("Section", "outline", self.outline, (-1, 2), "points (x, y) [m], shape (k, 2)")
        object.__setattr__(self, "stiffness", stiffness)
        object.__setattr__(self, "mass_per_length", mass)
        object.__setattr__(self, "inertia", inertia)
        object.__setattr__(self, "outline", validate.frozen(outline))
        center = validate.array("Section", "mass_center", self.mass_center, (2,), "2 finite numbers (along e1, e2) [m]")
        object.__setattr__(self, "mass_center", (float(center[0]), float(center[1])))
        if center.any():
            about = inertia - mass * (center @ center * np.eye(3) - np.outer([*center, 0.0], [*center, 0.0]))
            if np.linalg.eigvalsh(about)[0] <= 0.0:
                right = f"greater than that of the mass at mass_center = {self.mass_center!r} (it is about the axis)"
                raise ValueError(validate.wrong("Section", "inertia", inertia.tolist(), right))

    def __repr__(self) -> str:
        """The name and the mass, in one line."""
        return f"Section({self.name!r}, mass_per_length={self.mass_per_length:g})"

    @property
    def first_moment(self) -> Array:
        """S = m (c1, c2, 0), the mass times the place of its center [kg], shape (3,)."""
        return self.mass_per_length * np.array([*self.mass_center, 0.0])

    @classmethod
    def rectangle(
        cls,
        width: float,
        height: float,
        material: Material,
        *,
        shear_correction: float | tuple[float, float] = 5.0 / 6.0,
        torsion: str | float | None = None,
    ) -> Section:
        """A solid rectangle, its width along e1 and its height along e2.

        A = w h,  I1 = ∫ y₂² dA = w h³/12,  I2 = ∫ y₁² dA = h w³/12,
        C = diag(κ₁GA, κ₂GA, EA, EI1, EI2, GIt),  J = ρ diag(I1, I2, I1 + I2)

        Args:
            width: w, extent along e1 [m].
            height: h, extent along e2 [m].
            material: its material.
            shear_correction: κ [-], one number or one for each of e1 and e2.
            torsion: torsion constant It: "polar", the moment I1 + I2, which neglects warping and is too stiff (by 19 %
                for a square, without bound for a strip); "saint-venant", the exact one of a long prism; or a number
                [m^4]. None means "polar", as in Leitz et al. (2014).

        Raises:
            TypeError: a value is not a number, or the material not a Material.
            ValueError: a value is not positive and finite, or an unknown word for torsion.
        """
        owner = "Section.rectangle"
        w = validate.positive(owner, "width", width, "m")
        h = validate.positive(owner, "height", height, "m")
        moments = (w * h**3 / 12.0, h * w**3 / 12.0)
        if torsion is None or isinstance(torsion, str):
            word = "polar" if torsion is None else torsion
            if word not in ("polar", "saint-venant"):
                right = '"polar", "saint-venant" or a number [m^4]'
                raise ValueError(validate.wrong(owner, "torsion", torsion, right))
            constant = sum(moments) if word == "polar" else _saint_venant(w, h)
        else:
            constant = validate.positive(owner, "torsion", torsion, "m^4")
        outline = 0.5 * np.array([[w, h], [-w, h], [-w, -h], [w, -h]])
        kappa = _shear_correction(owner, shear_correction)
        name = f"rectangle {w:g} m x {h:g} m"
        return cls._solid(owner, material, w * h, moments, constant, kappa, outline, name)

    @classmethod
    def circle(
        cls, radius: float, material: Material, *, shear_correction: float | tuple[float, float] | None = None
    ) -> Section:
        """A solid circle.

        A = πr²,  I1 = I2 = πr⁴/4,  It = πr⁴/2,  κ = 6(1 + ν)/(7 + 6ν)

        Args:
            radius: r [m].
            material: its material.
            shear_correction: κ [-], one number or one for each of e1 and e2; None means the value above.

        Raises:
            TypeError: a value is not a number, or the material not a Material.
            ValueError: a value is not positive and finite.

        Source: Cowper (1966), The shear coefficient in Timoshenko's beam theory, Table 1.
        """
        owner = "Section.circle"
        r = validate.positive(owner, "radius", radius, "m")
        return cls._annulus(owner, r, 0.0, material, shear_correction, f"circle of radius {r:g} m")

    @classmethod
    def tube(
        cls,
        *,
        outer_radius: float,
        thickness: float,
        material: Material,
        shear_correction: float | tuple[float, float] | None = None,
    ) -> Section:
        """A round tube of any wall thickness.

        With the inner radius rᵢ = r - t and m = rᵢ/r:
        A = π(r² - rᵢ²),  I1 = I2 = π(r⁴ - rᵢ⁴)/4,  It = 2 I1,
        κ = 6(1 + ν)(1 + m²)² / ((7 + 6ν)(1 + m²)² + (20 + 12ν)m²)

        which ends in 2(1 + ν)/(4 + 3ν) for a thin wall and in the circle's value for a solid bar.

        Args:
            outer_radius: r [m].
            thickness: t, of the wall [m], below the outer radius.
            material: its material.
            shear_correction: κ [-], one number or one for each of e1 and e2; None means the value above.

        Raises:
            TypeError: a value is not a number, or the material not a Material.
            ValueError: a value is not positive and finite, or the wall thicker than the tube.

        Source: Cowper (1966), The shear coefficient in Timoshenko's beam theory, Table 1.
        """
        owner = "Section.tube"
        r = validate.positive(owner, "outer_radius", outer_radius, "m")
        t = validate.positive(owner, "thickness", thickness, "m")
        if t >= r:
            right = f"below outer_radius = {r:g} m (a solid bar is Section.circle)"
            raise ValueError(validate.wrong(owner, "thickness", thickness, right))
        return cls._annulus(owner, r, r - t, material, shear_correction, f"tube of radius {r:g} m, wall {t:g} m")

    @classmethod
    def given(cls, *, stiffness: ArrayLike, mass_per_length: float, inertia: ArrayLike) -> Section:
        """A section known by its stiffness and inertia alone, coupled or not.

        Drawn as the ellipse that has the same mass and the same moments of inertia about e1 and e2.

        Args:
            stiffness: symmetric positive definite, shape (6, 6), order shear 1, shear 2, axial, bend 1, bend 2, twist
                [N, N m, N m^2].
            mass_per_length: [kg/m].
            inertia: symmetric positive definite, per length, in the body frame [kg m], shape (3, 3).

        Raises:
            TypeError: a value is not a number.
            ValueError: a matrix is not of that shape, symmetric and positive definite, or the mass not positive.
        """
        stiff = validate.positive_definite("Section", "stiffness", stiffness, 6, _STIFFNESS_ROWS)
        mass = validate.positive("Section", "mass_per_length", mass_per_length, "kg/m")
        rotary = validate.positive_definite("Section", "inertia", inertia, 3, _INERTIA_ROWS)
        half_axes = 2.0 * np.sqrt(np.array([rotary[1, 1], rotary[0, 0]]) / mass)  # I1 = m b^2/4 and I2 = m a^2/4
        outline = _unit_circle() * half_axes
        return cls(stiffness=stiff, mass_per_length=mass, inertia=rotary, outline=outline)

    @classmethod
    def _annulus(
        cls,
        owner: str,
        outer: float,
        inner: float,
        material: Material,
        shear_correction: float | tuple[float, float] | None,
        name: str,
    ) -> Section:
        nu = _material(owner, material).poisson_ratio
        # outer^2 - inner^2 as a product: a thin wall keeps its digits
        area = math.pi * (outer - inner) * (outer + inner)
        moment = 0.25 * area * (outer**2 + inner**2)
        kappa = _cowper(inner / outer, nu) if shear_correction is None else shear_correction
        pair = _shear_correction(owner, kappa)
        outline = outer * _unit_circle()
        return cls._solid(owner, material, area, (moment, moment), 2.0 * moment, pair, outline, name)

    @classmethod
    def _solid(
        cls,
        owner: str,
        material: Material,
        area: float,
        moments: tuple[float, float],
        torsion: float,
        kappa: tuple[float, float],
        outline: Array,
        name: str,
    ) -> Section:
        matter = _material(owner, material)
        young, shear = matter.youngs_modulus, matter.shear_modulus
        i1, i2 = moments
        shear_area = shear * area
        forces = (kappa[0] * shear_area, kappa[1] * shear_area, young * area)
        stiffness = np.diag([*forces, young * i1, young * i2, shear * torsion])
        inertia = matter.density * np.diag([i1, i2, i1 + i2])
        mass = matter.density * area
        return cls(stiffness=stiffness, mass_per_length=mass, inertia=inertia, outline=outline, name=name)


def _saint_venant(width: float, height: float) -> float:
    """Torsion constant [m^4] of a rectangle, long side a and short side b.

    It = a b³ (1/3 - 64/π⁵ b/a Σ tanh(nπa/2b)/n⁵),  n = 1, 3, 5, ...

    With tanh z = 1 - 2/(e²ᶻ + 1) the slow part of the sum is (31/32) ζ(5), and the rest falls like e⁻ⁿᵖⁱ: five terms
    leave less than 1e-17.

    Source: Timoshenko and Goodier, Theory of Elasticity, art. 109.
    """
    a, b = max(width, height), min(width, height)
    odd = np.arange(1.0, 10.0, 2.0)
    decay = np.exp(-odd * np.pi * a / b)  # of a falling exponential: a thin strip underflows to zero, never overflows
    total = 31.0 / 32.0 * _ZETA_5 - float(np.sum(2.0 * decay / (1.0 + decay) / odd**5))
    return a * b**3 * (1.0 / 3.0 - 64.0 / math.pi**5 * (b / a) * total)


def _cowper(m: float, nu: float) -> float:
    """Shear correction of a tube with m = inner/outer radius (m = 0: circle)."""
    q = (1.0 + m * m) ** 2
    return 6.0 * (1.0 + nu) * q / ((7.0 + 6.0 * nu) * q + (20.0 + 12.0 * nu) * m * m)


def _shear_correction(owner: str, value: float | tuple[float, float]) -> tuple[float, float]:
    if isinstance(value, (tuple, list, np.ndarray)):
        right = "a positive, finite number [-], or two of them"
        first, second = validate.array(owner, "shear_correction", value, (2,), right).tolist()
        if min(first, second) <= 0.0:
            raise ValueError(validate.wrong(owner, "shear_correction", value, right))
        return (first, second)
    kappa = validate.positive(owner, "shear_correction", value, "-")
    return (kappa, kappa)


def _material(owner: str, value: object) -> Material:
    if not isinstance(value, Material):
        raise TypeError(validate.wrong(owner, "material", value, "a Material"))
    return value


def _unit_circle() -> Array:
    angle = 2.0 * np.pi * np.arange(_CIRCLE_POINTS) / _CIRCLE_POINTS
    return np.stack([np.cos(angle), np.sin(angle)], axis=1)
