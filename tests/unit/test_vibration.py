"""cy.modes, cy.matrices, cy.frequency_response and cy.campbell on small models: what they return and refuse."""

import numpy as np
import pytest
import xarray as xr

import cayley as cy
from cayley import joints, loads, springs, supports
from cayley.vibration import krylov
from cayley.vibration.eigen import eigenpairs

STEEL = cy.Material(density=7850.0, youngs_modulus=2e11, poisson_ratio=0.3)
TUBE = cy.Section.tube(outer_radius=0.02, thickness=0.002, material=STEEL)
GRAVITY = loads.gravity((0, 0, -9.81))


def frame(elements=4):
    mast = cy.Rod(TUBE, length=2.0, direction=(0, 0, 1), elements=elements, name="mast")
    arm = cy.Rod(TUBE, length=1.0, origin=(0, 0, 2), direction=(1, 0, 0), elements=elements, name="arm")
    bob = cy.Body(
        mass=2.0, inertia=np.diag([0.01, 0.01, 0.01]), position=(1, 0, 1.7), name="bob", ports={"eye": (0, 0, 0.3)}
    )
    return cy.Model(
        mast,
        arm,
        bob,
        supports=[supports.clamp(mast.start)],
        joints=[joints.weld(mast.end, arm.start), joints.ball(arm.end, bob.port("eye"))],
        loads=[GRAVITY],
    )


def oscillator():
    body = cy.Body(mass=2.0, inertia=[0.1, 0.1, 0.1], name="mass", ports={"side": (0, 0.5, 0)})
    tie = springs.bushing(body.centre, stiffness=[50.0, 60.0, 70.0, 1.0, 1.0, 1.0])
    return cy.Model(body, springs=[tie])


@pytest.fixture(scope="module")
def modes():
    return cy.modes(frame(), count=6)


def test_shapes_hang_together(modes):
    assert modes.frequency.dims == ("mode",)
    assert modes.frequency.attrs["units"] == "Hz"
    assert modes.frequency.values[0] == 0.0
    assert np.all(np.diff(modes.frequency.values) >= 0.0)
    assert modes.complete
    tip = modes["arm"].isel(node=-1).displacement
    eye = modes.shape(modes.model.bodies[0].port("eye")).displacement
    assert np.abs(tip - eye).max() < 1e-9
    assert modes["arm"].displacement.dims == ("mode", "node", "axis")
    assert modes[modes.model.bodies[0]].rotation.dims == ("mode", "axis")
    assert np.abs(modes["mast"].displacement.isel(node=0)).max() == 0.0


def test_modes_are_orthonormal_and_real(modes):
    v, linear = modes.pairs.vectors, modes.linear
    assert np.isrealobj(v)
    assert v.T @ (linear.mass @ v) == pytest.approx(np.eye(6), abs=1e-9)
    assert v.T @ (linear.stiffness @ v) == pytest.approx(np.diag(modes.angular_frequency.values**2), abs=1e-3)
    assert np.abs(linear.constraint @ v).max() < 1e-9


def test_text_says_what_moves(modes):
    assert str(modes).splitlines()[1].endswith("bob turns")
    assert "6 of 51 motions" in repr(modes)


def test_a_displaced_state_keeps_its_joints(modes):
    state = modes.state(2, 0.2, 1.0)
    run = cy.simulate(modes.model, start=state, t_end=1e-3, dt=1e-3, rule=cy.rules.midpoint)
    eye = run.port("bob", "eye").position.isel(time=0)
    assert np.abs(run["arm"].position.isel(time=0, node=-1) - eye).max() < 1e-12
    assert modes.about.residual < 1e-6  # the equilibrium is where it was
    with pytest.raises(IndexError, match="no mode 6; there are 6, from 0"):
        modes.state(6, 0.1)


def test_blocks_and_a_dense_matrix_agree(modes, monkeypatch):
    monkeypatch.setattr("cayley.vibration.eigen.DENSE", 0)
    found = eigenpairs(modes.linear, 6)
    assert found.checked
    assert np.abs(found.values) == pytest.approx(modes.angular_frequency.values, rel=1e-8, abs=1e-6)
    damped = cy.modes(oscillator(), count=6)
    turning = cy.modes(oscillator(), count=6, spin=(0, 0, 0.5))
    assert damped.frequency.values[:3] == pytest.approx(np.full(3, np.sqrt(10.0) / (2.0 * np.pi)))
    monkeypatch.undo()
    again = cy.modes(oscillator(), count=6, spin=(0, 0, 0.5))
    assert turning.eigenvalue.values == pytest.approx(again.eigenvalue.values, rel=1e-8)


def test_a_krylov_space_that_is_too_small_is_told():
    diagonal = 1.0 - np.linspace(0.0, 1.0, 4000) ** 4
    with pytest.raises(RuntimeError, match="of 20 modes converged in a Krylov space"):
        krylov.largest(lambda x: diagonal[:, None] * x, 4000, 20, 2, symmetric=True)


def test_stored_and_read_again(modes, tmp_path):
    modes.save(tmp_path / "modes.zarr")
    found = xr.open_zarr(tmp_path / "modes.zarr", consolidated=False)
    assert np.array_equal(found["frequency"].values, modes.frequency.values)
    assert np.array_equal(found["arm.displacement"].values, modes["arm"].displacement.values)


def test_matrices_and_their_rows():
    model = frame()
    found = cy.matrices(model)
    assert found.mass.shape == found.stiffness.shape == (60, 60)
    assert found.constraint.shape == (9, 60)
    assert found.damping.nnz == found.gyroscopic.nnz == 0
    table = found.table()
    assert table["part"][0] == "mast"
    assert table["node"][0] == 1
    assert set(table["dof"][:6]) == {"x", "y", "z", "turn about d1", "turn about d2", "turn about d3"}
    moves = table["dof"] == "z"
    arm = 1.0 * TUBE.mass_per_length
    assert found.mass.diagonal()[moves].sum() == pytest.approx(2.0 + 3.0 * arm - 0.25 * arm)  # less the clamped node's
    turning = cy.matrices(oscillator(), spin=3.0)
    assert np.abs((turning.gyroscopic + turning.gyroscopic.T).toarray()).max() == 0.0
    assert np.abs(turning.gyroscopic.toarray()).max() == pytest.approx(2.0 * 3.0 * 2.0)  # Coriolis: 2 m Ω


def test_an_oscillator_under_a_harmonic_force():
    model = oscillator()
    body = model.bodies[0]
    hertz = np.array([0.0, 0.5, 2.0])
    omega = 2.0 * np.pi * hertz
    push = loads.force(body.centre, (3.0, 0, 0))
    found = cy.frequency_response(model, load=push, frequencies=hertz, at=body)
    assert found.displacement.sel(axis="x").values == pytest.approx(3.0 / (50.0 - 2.0 * omega**2), rel=1e-12)
    assert np.abs(found.displacement.sel(axis=["y", "z"])).max() == 0.0
    damped = cy.frequency_response(model, load=push, frequencies=hertz, at=body, damping_ratio=0.1, phase=0.5 * np.pi)
    expected = 3.0j / (50.0 - 2.0 * omega**2 + 2j * 0.1 * 10.0 * omega)
    assert damped.displacement.sel(axis="x").values == pytest.approx(expected, rel=1e-12)
    side = cy.frequency_response(
        model, load=loads.moment(body.centre, (0, 0, 1.0)), frequencies=0.0, at=body.port("side")
    )
    assert side.displacement.values[0] == pytest.approx([-0.5, 0, 0])
    assert side.rotation.values[0] == pytest.approx([0, 0, 1.0])


def test_a_cantilever_gives_way_as_by_hand():
    rod = cy.Rod(TUBE, length=2.0, direction=(1, 0, 0), elements=4, damping=cy.damping.retardation(1e-4))
    model = cy.Model(rod, supports=[supports.clamp(rod.start)])
    tip = cy.frequency_response(model, load=loads.force(rod.end, (0, 0, 1.0)), frequencies=[0.0], at=rod)
    stiffness = TUBE.stiffness
    by_hand = 8.0 / (3.0 * stiffness[3, 3]) * (1.0 - 1.0 / 4.0 / 4.0**2) + 2.0 / stiffness[0, 0]  # strains constant
    assert tip.displacement.sel(axis="z").values[0, -1].real == pytest.approx(by_hand, rel=1e-6)


def test_a_campbell_diagram_follows_modes():
    found = cy.campbell(oscillator(), np.linspace(0.0, 3.0, 7), 3)
    assert found.frequency.dims == ("speed", "mode")
    assert found.damping_ratio.values == pytest.approx(np.zeros((7, 3)))
    assert "3 modes, 7 speeds from 0 to 3 rad/s" in repr(found)
    turns = np.sqrt(10.0)
    assert found.eigenvalue.imag[0] == pytest.approx([turns] * 3)
    assert found.crossings(1) == pytest.approx([np.sqrt(5.0)], rel=1e-3)  # tilts with |ω − Ω|, ω² − Ω ω = 10


@pytest.mark.parametrize(
    ("call", "told"),
    [
        (lambda m: cy.modes("frame"), "is no Model"),
        (lambda m: cy.modes(m, count=0), "count is 0; give a whole number"),
        (lambda m: cy.modes(m, about="rest"), "start is a str"),
        (lambda m: cy.modes(m, about=cy.equilibrium(m), spin=1.0), "spin and an equilibrium are given"),
        (lambda m: cy.campbell(m, "fast"), "speeds is 'fast'"),
        (lambda m: cy.campbell(m, [1.0], axis=(0, 0, 0)), "axis is"),
        (lambda m: cy.frequency_response(m, load="push", frequencies=1.0, at="mass"), "load is 'push'"),
        (lambda m: cy.frequency_response(m, load=push(m), frequencies=[-1.0], at="mass"), "frequencies is"),
        (lambda m: cy.frequency_response(m, load=push(m), frequencies=[1.0], at="mas"), "no part 'mas'; it has mass"),
        (lambda m: cy.frequency_response(m, load=push(m), frequencies=[1.0], at="mass", phase="x"), "phase is 'x'"),
        (lambda m: cy.frequency_response(m, load=push(m), frequencies=1.0, at="mass", damping_ratio=-1), "is -1; give"),
    ],
)
def test_what_is_refused(call, told):
    with pytest.raises((TypeError, ValueError, KeyError), match=told):
        call(oscillator())


def test_gravity_across_the_spin_is_refused():
    with pytest.raises(ValueError, match=r"gravity \(0, 0, -9.81\) m/s\^2 is not along the spin"):
        cy.modes(frame(), spin=(1.0, 0.0, 0.0))


def push(model):
    return loads.force(model.bodies[0].centre, (1.0, 0, 0))
