"""Cross-sections: stiffness and inertia per length, made from a shape and a material or given as they are."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from cayley.model import formulas, validate
from cayley.model.areas import Areas, areas, closed, refuse_outside
from cayley.model.formulas import ShearCorrection, shear_pair, torsion_constant
from cayley.model.material import Material
from cayley.model.offsets import INERTIA_ROWS, moved_shear, pair, section_inertia
from cayley.model.validate import Array

if TYPE_CHECKING:
    from cayley.model.torsion import Torsion

_CIRCLE_POINTS = 32
_STIFFNESS_ROWS = "shear 1, shear 2, axial, bend 1, bend 2, twist [N, N m, N m^2]"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Section:
    """A cross-section of a rod: e1 and e2 lie in it, e3 is the rod axis, through the centroid of the shapes made here.

    Usually made by `rectangle`, `circle`, `tube`, `ellipse`, `i_beam`, `box`, `polygon` or `given`. Two
    sections are equal only if they are the same object.

    Attributes:
        stiffness: C [N, N m, N m^2], shape (6, 6), symmetric and positive definite, read-only; it maps
            (Γ1, Γ2, Γ3, Ω1, Ω2, Ω3) to (shear force 1 and 2, axial force, bending moment 1 and 2, twisting moment).
        mass_per_length: m [kg/m].
        inertia: J, rotary inertia per length about the axis in the body frame [kg m], shape (3, 3), read-only.
        mass_center: where along e1 and e2 the mass center lies, from the axis [m].
        outline: outer contour in the (e1, e2) plane for drawing [m], shape (k, 2), counter-clockwise, the first
            point not repeated, read-only.
        name: a few words that name it in listings.
        radius: outer radius of a circle or tube, with which a rod touches [m]; None: it is not round.
    """

    stiffness: Array
    mass_per_length: float
    inertia: Array
    outline: Array
    mass_center: tuple[float, float] = (0.0, 0.0)
    name: str = "given"
    radius: float | None = None

    def __post_init__(self) -> None:
        """Check and freeze the values."""
        stiffness = validate.positive_definite("Section", "stiffness", self.stiffness, 6, _STIFFNESS_ROWS)
        mass = validate.positive("Section", "mass_per_length", self.mass_per_length, "kg/m")
        inertia = validate.positive_definite("Section", "inertia", self.inertia, 3, INERTIA_ROWS)
        outline = validate.array("Section", "outline", self.outline, (-1, 2), "points (x, y) [m], shape (k, 2)")
        object.__setattr__(self, "stiffness", stiffness)
        object.__setattr__(self, "mass_per_length", mass)
        object.__setattr__(self, "inertia", inertia)
        object.__setattr__(self, "outline", validate.frozen(outline))
        if self.radius is not None:
            object.__setattr__(self, "radius", validate.positive("Section", "radius", self.radius, "m"))
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
        shear_correction: ShearCorrection = 5.0 / 6.0,
        torsion: str | float | None = None,
    ) -> Section:
        """A solid rectangle, its width along e1 and its height along e2.

        A = w h,  I1 = ∫ y₂² dA = w h³/12,  I2 = ∫ y₁² dA = h w³/12,
        C = diag(κ₁GA, κ₂GA, EA, EI1, EI2, GIt),  J = ρ diag(I1, I2, I1 + I2)

        Args:
            width: w, extent along e1 [m].
            height: h, extent along e2 [m].
            material: its material.
            shear_correction: κ [-], one number or one for each of e1 and e2; "cowper": 10(1 + ν)/(12 + 11ν); "none": 1.
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
        words = {"polar": sum(moments), "saint-venant": formulas.saint_venant(w, h)}
        constant = torsion_constant(owner, "polar" if torsion is None else torsion, words)
        outline = 0.5 * np.array([[w, h], [-w, h], [-w, -h], [w, -h]])
        cowper = formulas.cowper_rectangle(_material(owner, material).poisson_ratio)
        kappa = shear_pair(owner, shear_correction, (cowper, cowper))
        name = f"rectangle {w:g} m x {h:g} m"
        whole = Areas(area=w * h, centroid=(0.0, 0.0), moments=(*moments, 0.0))
        return cls._solid(owner, material, whole, constant, kappa, outline, name)

    @classmethod
    def circle(cls, radius: float, material: Material, *, shear_correction: ShearCorrection | None = None) -> Section:
        """A solid circle.

        A = πr²,  I1 = I2 = πr⁴/4,  It = πr⁴/2,  κ = 6(1 + ν)/(7 + 6ν)

        Args:
            radius: r [m].
            material: its material.
            shear_correction: κ [-], one number or one for each of e1 and e2; None or "cowper": that above; "none": 1.

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
        shear_correction: ShearCorrection | None = None,
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
            shear_correction: κ [-], one number or one for each of e1 and e2; None or "cowper": that above; "none": 1.

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
    def ellipse(
        cls, half_width: float, half_height: float, material: Material, *, shear_correction: ShearCorrection = "cowper"
    ) -> Section:
        """A solid ellipse, half axes a along e1 and b along e2.

        A = πab,  I1 = πab³/4,  I2 = πa³b/4,  It = πa³b³/(a² + b²)

        Args:
            half_width: a [m].
            half_height: b [m].
            material: its material.
            shear_correction: κ [-], one number or one for each of e1 and e2; "cowper": his for an ellipse; "none": 1.

        Raises:
            TypeError: a value is not a number, or the material not a Material.
            ValueError: a value is not positive and finite.

        Source: Timoshenko and Goodier, Theory of Elasticity, art. 106; Cowper (1966).
        """
        owner = "Section.ellipse"
        a = validate.positive(owner, "half_width", half_width, "m")
        b = validate.positive(owner, "half_height", half_height, "m")
        nu = _material(owner, material).poisson_ratio
        area = math.pi * a * b
        whole = Areas(area=area, centroid=(0.0, 0.0), moments=(0.25 * area * b * b, 0.25 * area * a * a, 0.0))
        constant = math.pi * (a * b) ** 3 / (a * a + b * b)
        cowper = (formulas.cowper_ellipse(a / b, nu), formulas.cowper_ellipse(b / a, nu))
        kappa = shear_pair(owner, shear_correction, cowper)
        name = f"ellipse {2.0 * a:g} m x {2.0 * b:g} m"
        return cls._solid(owner, material, whole, constant, kappa, _unit_circle() * [a, b], name)

    @classmethod
    def i_beam(
        cls,
        *,
        width: float,
        height: float,
        flange: float,
        web: float,
        material: Material,
        shear_correction: ShearCorrection = "cowper",
        torsion: str | float = "saint-venant",
    ) -> Section:
        """A doubly symmetric I, its web along e2.

        Args:
            width: b, of the flanges, along e1 [m].
            height: h, overall, along e2 [m].
            flange: their thickness t [m].
            web: its thickness [m].
            material: its material.
            shear_correction: κ [-], one number or one for each of e1 and e2; "cowper": his for a thin-walled I along
                e2, and along e1 that of the two flanges as rectangles, 2bt/A of his for one; "none": 1.
            torsion: "saint-venant", by finite elements (needs scikit-fem); "thin-wall", Σ length × thickness³/3; or a
                number [m^4]. Warping is free.

        Raises:
            TypeError: a value is not a number, or the material not a Material.
            ValueError: a value is not positive and finite, or the flanges or the web fill the outline.
            ImportError: for "saint-venant", scikit-fem is not installed.
        """
        owner = "Section.i_beam"
        b, h, t, w = _sizes(owner, width=width, height=height, flange=flange, web=web)
        _thinner(owner, "web", w, b)
        _thinner(owner, "flange", t, 0.5 * h)
        right = [[w, t - 0.5 * h], [w, 0.5 * h - t], [b, 0.5 * h - t], [b, 0.5 * h]]
        half = np.array([[b, -0.5 * h], [b, t - 0.5 * h], *right]) * [0.5, 1.0]
        outline = np.concatenate([half, -half])
        whole, nu = areas(outline), _material(owner, material).poisson_ratio
        along_web = formulas.cowper_walls(2.0 * b * t / ((h - t) * w), b / (h - t), nu, closed=False)
        cowper = (formulas.cowper_rectangle(nu) * 2.0 * b * t / whole.area, along_web)
        words = {
            "saint-venant": lambda: _torsion(owner, outline, ()).constant,
            "thin-wall": (2.0 * b * t**3 + (h - 2.0 * t) * w**3) / 3.0,
        }
        constant, kappa = torsion_constant(owner, torsion, words), shear_pair(owner, shear_correction, cowper)
        return cls._solid(owner, material, whole, constant, kappa, outline, f"I-beam {b:g} m x {h:g} m")

    @classmethod
    def box(
        cls,
        *,
        width: float,
        height: float,
        flange: float,
        web: float,
        material: Material,
        shear_correction: ShearCorrection = "cowper",
        torsion: str | float = "saint-venant",
    ) -> Section:
        """A rectangular tube, its width along e1 and its height along e2.

        Args:
            width: b, overall, along e1 [m].
            height: h, overall, along e2 [m].
            flange: thickness of the two walls along e1 [m].
            web: thickness of the two walls along e2 [m].
            material: its material.
            shear_correction: κ [-], one number or one for each of e1 and e2; "cowper": his for a thin-walled box;
                "none": 1.
            torsion: "saint-venant", by finite elements (needs scikit-fem); "thin-wall", Bredt's 4A²/Σ(length/thickness)
                of the midlines; or a number [m^4].

        Raises:
            TypeError: a value is not a number, or the material not a Material.
            ValueError: a value is not positive and finite, or the walls fill the outline.
            ImportError: for "saint-venant", scikit-fem is not installed.
        """
        owner = "Section.box"
        b, h, t, w = _sizes(owner, width=width, height=height, flange=flange, web=web)
        _thinner(owner, "web", w, 0.5 * b)
        _thinner(owner, "flange", t, 0.5 * h)
        corners = 0.5 * np.array([[1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]])
        outline, hole = corners * [b, h], corners * [b - 2.0 * w, h - 2.0 * t]
        whole, nu = areas(outline, (hole,)), _material(owner, material).poisson_ratio
        wide, high = b - w, h - t
        m, n = wide * t / (high * w), wide / high
        cowper = [formulas.cowper_walls(m, n, nu, closed=True), formulas.cowper_walls(1 / m, 1 / n, nu, closed=True)]
        words = {
            "saint-venant": lambda: _torsion(owner, outline, (hole,)).constant,
            "thin-wall": 2.0 * (wide * high) ** 2 / (wide / t + high / w),
        }
        constant = torsion_constant(owner, torsion, words)
        kappa = shear_pair(owner, shear_correction, (cowper[1], cowper[0]))
        return cls._solid(owner, material, whole, constant, kappa, outline, f"box {b:g} m x {h:g} m")

    @classmethod
    def polygon(
        cls,
        outline: ArrayLike,
        material: Material,
        *,
        holes: Sequence[ArrayLike] = (),
        axes: str = "given",
        shear_correction: ShearCorrection = 5.0 / 6.0,
        torsion: str | float = "saint-venant",
    ) -> Section:
        """Any polygon with holes; the rod axis passes through its centroid, wherever the outline was drawn.

        C[3:5, 3:5] = E ((I1, −I12), (−I12, I2)),  I1 = ∫ y2² dA,  I2 = ∫ y1² dA,  I12 = ∫ y1 y2 dA

        Args:
            outline: corners around it, either way, shape (k, 2) [m].
            material: its material.
            holes: corners around each hole.
            axes: "given": e1 and e2 as the outline was drawn; "principal": turned so that I12 vanishes.
            shear_correction: κ [-], one number or one for each of e1 and e2; "none": 1. The value for a rectangle is
                taken if nothing is given, for there is no formula.
            torsion: "saint-venant", by finite elements (needs scikit-fem), with the shear center; "polar", I1 + I2,
                which is far too stiff for thin walls; or a number [m^4]. The last two twist about the centroid.

        Raises:
            TypeError: a value is not a number, or the material not a Material.
            ValueError: an outline that is none, a hole outside or across another, or a value out of range.
            ImportError: for "saint-venant", scikit-fem is not installed.
        """
        owner = "Section.polygon"
        ring = closed(owner, "outline", outline)
        inner = [closed(owner, f"holes[{k}]", hole) for k, hole in enumerate(holes)]
        refuse_outside(owner, ring, inner)
        validate.option(owner, "axes", axes, ("given", "principal"))
        whole = areas(ring, inner)
        angle = whole.principal_angle if axes == "principal" else 0.0
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        ring, *inner = [(points - np.array(whole.centroid)) @ turn for points in (ring, *inner)]
        whole = areas(ring, inner)
        center = (0.0, 0.0)
        if torsion == "saint-venant":
            warped = _torsion(owner, ring, inner)
            torsion, center = warped.constant, warped.shear_center
        words = {"saint-venant": 0.0, "polar": whole.moments[0] + whole.moments[1]}
        constant, kappa = torsion_constant(owner, torsion, words), shear_pair(owner, shear_correction, None)
        name = f"polygon of {len(ring)} corners" + (f", {len(inner)} holes" if inner else "")
        return cls._solid(owner, material, whole, constant, kappa, ring, name, center)

    @classmethod
    def given(
        cls,
        *,
        stiffness: ArrayLike,
        mass_per_length: float | None = None,
        inertia: ArrayLike | None = None,
        mass: ArrayLike | None = None,
        mass_center: tuple[float, float] = (0.0, 0.0),
        shear_center: tuple[float, float] = (0.0, 0.0),
    ) -> Section:
        """A section known by its stiffness and inertia alone, coupled or not.

        Drawn as the ellipse that has the same mass and the same moments of inertia about e1 and e2.

        Args:
            stiffness: symmetric positive definite, shape (6, 6), order shear 1, shear 2, axial, bend 1, bend 2, twist
                [N, N m, N m^2].
            mass_per_length: [kg/m].
            inertia: symmetric positive definite, per length, in the body frame, about the mass center [kg m],
                shape (3, 3).
            mass: instead of these two and mass_center: M of ½ v·M v with v = (Λᵀẋ, ω) at the axis, shape (6, 6),
                ((m 1, −hat S), (hat S, J)), S = m (mass center) [kg/m, kg, kg m].
            mass_center: where it lies along e1 and e2, from the axis [m].
            shear_center: where the shear forces and the twist of the stiffness act, along e1 and e2 from the axis [m];
                axial force and bending stay at the axis.

        Raises:
            TypeError: a value is not a number.
            ValueError: a matrix is not of that shape, symmetric and positive definite, or the mass not positive; mass
                given beside the others, or neither.
        """
        owner = "Section"
        stiff = validate.positive_definite(owner, "stiffness", stiffness, 6, _STIFFNESS_ROWS)
        m, center, rotary = section_inertia(owner, mass_per_length, inertia, mass, mass_center)
        at = pair(owner, "shear_center", shear_center)
        about = rotary - m * (center @ center * np.eye(3) - np.outer(center, center))
        half_axes = 2.0 * np.sqrt(np.array([about[1, 1], about[0, 0]]) / m)  # I1 = m b^2/4 and I2 = m a^2/4
        outline = _unit_circle() * half_axes + center[:2]
        shifted = moved_shear(stiff, at) if any(at) else stiff
        place = (float(center[0]), float(center[1]))
        return cls(stiffness=shifted, mass_per_length=m, inertia=rotary, outline=outline, mass_center=place)

    @classmethod
    def _annulus(
        cls,
        owner: str,
        outer: float,
        inner: float,
        material: Material,
        shear_correction: ShearCorrection | None,
        name: str,
    ) -> Section:
        nu = _material(owner, material).poisson_ratio
        # outer^2 - inner^2 as a product: a thin wall keeps its digits
        area = math.pi * (outer - inner) * (outer + inner)
        moment = 0.25 * area * (outer**2 + inner**2)
        cowper = formulas.cowper_tube(inner / outer, nu)
        kappa = "cowper" if shear_correction is None else shear_correction
        both = shear_pair(owner, kappa, (cowper, cowper))
        outline = outer * _unit_circle()
        whole = Areas(area=area, centroid=(0.0, 0.0), moments=(moment, moment, 0.0))
        return cls._solid(owner, material, whole, 2.0 * moment, both, outline, name, radius=outer)

    @classmethod
    def _solid(
        cls,
        owner: str,
        material: Material,
        whole: Areas,
        torsion: float,
        kappa: tuple[float, float],
        outline: Array,
        name: str,
        shear_center: tuple[float, float] = (0.0, 0.0),
        radius: float | None = None,
    ) -> Section:
        """Of one material, referred to its centroid."""
        matter = _material(owner, material)
        young, shear = matter.youngs_modulus, matter.shear_modulus
        i1, i2, i12 = whole.moments
        if abs(i12) <= 1e-12 * (i1 + i2):  # round-off of an outline that is symmetric
            i12 = 0.0
        shear_area = shear * whole.area
        forces = (kappa[0] * shear_area, kappa[1] * shear_area, young * whole.area)
        stiffness = np.diag([*forces, young * i1, young * i2, shear * torsion])
        inertia = matter.density * np.diag([i1, i2, i1 + i2])
        if i12:
            stiffness[3, 4] = stiffness[4, 3] = -young * i12
            inertia[0, 1] = inertia[1, 0] = -matter.density * i12
        if any(shear_center):
            stiffness = moved_shear(stiffness, shear_center)
        mass = matter.density * whole.area
        return cls(
            stiffness=stiffness, mass_per_length=mass, inertia=inertia, outline=outline, name=name, radius=radius
        )


def _sizes(owner: str, **given: Any) -> list[float]:
    return [validate.positive(owner, name, value, "m") for name, value in given.items()]


def _thinner(owner: str, name: str, value: float, most: float) -> None:
    """Refuse walls that leave nothing between them."""
    if value >= most:
        raise ValueError(validate.wrong(owner, name, value, f"below {most:g} m, for there is something between"))


def _torsion(owner: str, outline: Array, holes: Sequence[Array]) -> Torsion:
    from cayley.model.torsion import torsion

    return torsion(owner, outline, holes)


def _material(owner: str, value: object) -> Material:
    if not isinstance(value, Material):
        raise TypeError(validate.wrong(owner, "material", value, "a Material"))
    return value


def _unit_circle() -> Array:
    angle = 2.0 * np.pi * np.arange(_CIRCLE_POINTS) / _CIRCLE_POINTS
    return np.stack([np.cos(angle), np.sin(angle)], axis=1)
