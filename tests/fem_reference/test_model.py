"""The assembled model: derivatives against differences, motions without stress, fields that are known."""

from contextlib import nullcontext

import numpy as np
import pytest

pytest.importorskip("dolfinx", reason="DOLFINx is not installed")

from dolfinx import fem
from mpi4py import MPI

from fem_reference.dcb import Problem
from fem_reference.model import build_model

SMALL = Problem(
    length=6.0,
    arm_thickness=0.5,
    precrack=2.1,
    width=1.5,
    E1=130.0,
    E2=9.0,
    G12=5.0,
    nu12=0.3,
    strength=0.04,
    toughness=0.002,
    ductility=5.0,
    penalty=2.0,
    elements=9,
    elements_across=2,
)


def small(**changes):
    return build_model(Problem(**(SMALL.__dict__ | changes)), lambda name: nullcontext(), MPI.COMM_SELF)


@pytest.fixture(scope="module")
def finite():
    return small()


def displacement(model, field):
    """Nodal values of a field u(X, Y, upper) -> (u_x, u_y)."""
    X, Y = model.X_nI[::2].T
    return np.stack(field(X, Y, model.upper_n[::2]), axis=1).ravel()


def bent(model, opening, rng):
    """Bent arms, ``opening`` apart at the loaded end and closed further on, with a little noise on all free nodes."""
    u_n = displacement(model, lambda X, Y, up: (0.1 * Y * X, np.where(up, 1.0, -1.0) * opening * (1 - 0.25 * X) ** 3))
    return model.free_n * (u_n + 1e-3 * opening * rng.standard_normal(u_n.size))


@pytest.mark.parametrize("kinematics", ["linear", "finite"])
@pytest.mark.parametrize("state", ["open", "closed", "softening", "unloading", "reloading"])
def test_tangent_is_the_derivative_of_the_residual(kinematics, state):
    model, rng = small(kinematics=kinematics), np.random.default_rng(1)
    opening = {"open": 2.0, "closed": -0.3, "softening": 0.3, "unloading": 0.3, "reloading": 0.3}[state]
    u_n = bent(model, opening, rng)
    g_q = model.bond.gap(u_n)
    k_q = np.maximum(g_q, 0.0) * {"unloading": 1.7, "reloading": 1.001}.get(state, 0.5)
    damaged = np.max(k_q) > model.law.g_peak
    assert {"open": np.max(g_q) > model.law.g_open, "closed": np.min(g_q) < 0}.get(state, damaged)
    direction_n = model.free_n * rng.standard_normal(u_n.size)
    h = 1e-7 * np.min(np.abs(g_q)) / np.max(np.abs(model.bond.gap(direction_n)))
    h = max(h, 1e-8)
    ahead_n, behind_n = (model.residual(u_n + s * h * direction_n, 0.0, k_q) for s in (1, -1))
    change_n = (ahead_n - behind_n) / (2 * h)
    A = model.tangent(u_n, k_q)
    x, y = A.createVecs()
    x.array[:] = direction_n
    A.mult(x, y)
    assert np.linalg.norm(y.array - change_n) < 1e-6 * np.linalg.norm(change_n)


def test_rigid_rotation_leaves_finite_arms_without_stress(finite):
    c, s = np.cos(0.8), np.sin(0.8)
    u_n = displacement(finite, lambda X, Y, up: ((c - 1) * X - s * Y, s * X + (c - 1) * Y))
    stretched_n = displacement(finite, lambda X, Y, up: (0.8 * X, 0.0 * Y))
    assert np.linalg.norm(finite.bulk_force(u_n)) < 1e-12 * np.linalg.norm(finite.bulk_force(stretched_n))


def test_turning_a_stretched_arm_stores_nothing_more(finite):
    """Fibres turn with the arm: an orthotropic sheet tells strain in the reference from strain in the current axes."""
    c, s, e = np.cos(0.8), np.sin(0.8), 0.05
    energies = []
    for turn in (np.eye(2), np.array([[c, -s], [s, c]])):
        H = turn @ np.diag([1 + e, 1.0]) - np.eye(2)
        finite.displace(
            displacement(finite, lambda X, Y, up, H=H: (H[0, 0] * X + H[0, 1] * Y, H[1, 0] * X + H[1, 1] * Y))
        )
        energies.append(fem.assemble_scalar(finite.energy))
    p, E11 = finite.problem, e + 0.5 * e**2
    W = 0.5 * p.elasticity_IJ[0, 0] * E11**2
    assert energies == pytest.approx([W * 2 * p.length * p.arm_thickness * p.width] * 2, rel=1e-12)
    assert fem.assemble_scalar(finite.face_energy) == pytest.approx(W * 2 * p.arm_thickness, rel=1e-12)


def test_supports_hold_one_point_an_arm(finite):
    held = np.flatnonzero(finite.free_n == 0)
    assert finite.X_nI[held] == pytest.approx(np.array([[SMALL.length, 0.0]] * 3))
    assert sorted(zip(finite.upper_n[held], held % 2, strict=True)) == [(False, 0), (False, 1), (True, 0)]
    A = finite.tangent(bent(finite, 0.3, np.random.default_rng(2)), 0 * finite.X_q)
    x, y = A.createVecs()
    for n in held:
        x.array[:] = 0.0
        x.array[n] = 1.0
        A.mult(x, y)
        assert np.array_equal(y.array, x.array)


def test_the_tie_alone_holds_the_rotation(finite):
    """About the hinge the specimen turns as a whole: nothing but the spring between the far corners resists."""
    turn_n = displacement(finite, lambda X, Y, up: (-Y, X - SMALL.length))
    A = finite.tangent(0 * turn_n, 0 * finite.X_q)
    x, y = A.createVecs()
    x.array[:] = turn_n
    A.mult(x, y)
    spring = SMALL.E1 * SMALL.width * (2 * SMALL.arm_thickness) ** 2
    assert turn_n @ y.array == pytest.approx(spring, rel=1e-9)
    force_n = finite.residual(1e-9 * turn_n, 0.0, 0 * finite.X_q)
    assert np.linalg.norm(force_n - 1e-9 * y.array) < 1e-6 * np.linalg.norm(1e-9 * y.array)


@pytest.mark.parametrize("kinematics", ["linear", "finite"])
def test_patch_of_uniform_strain_has_forces_on_its_boundary_only(kinematics):
    model = small(kinematics=kinematics)
    u_n = displacement(model, lambda X, Y, up: (0.02 * X + 0.01 * Y, 0.03 * X - 0.04 * Y))
    f_n = model.bulk_force(u_n)
    X, Y = np.abs(model.X_nI.T)
    p = model.problem
    inside_n = (X > 1e-9) & (X < p.length - 1e-9) & (Y > 1e-9) & (Y < p.arm_thickness - 1e-9)
    assert inside_n.any()
    assert np.max(np.abs(f_n[inside_n])) < 1e-12 * np.max(np.abs(f_n))


def test_pulled_arm_carries_the_stress_of_its_material():
    model, e = small(kinematics="linear"), 1e-3
    f_n = model.bulk_force(displacement(model, lambda X, Y, up: (e * X, -SMALL.nu12 * e * Y)))
    at_end_n = (np.abs(model.X_nI[:, 0] - SMALL.length) < 1e-9) & model.upper_n
    expected = SMALL.E1 * e * SMALL.arm_thickness * SMALL.width
    assert np.sum(f_n[at_end_n][::2]) == pytest.approx(expected, rel=1e-12)
    assert np.sum(f_n[at_end_n][1::2]) == pytest.approx(0.0, abs=1e-12 * expected)


def test_gap_is_found_where_it_is(finite):
    u_n = displacement(finite, lambda X, Y, up: (0.3 * X, np.where(up, 0.1 * X**2, 0.05 * X)))
    assert finite.bond.gap(u_n) == pytest.approx(0.1 * finite.X_q**2 - 0.05 * finite.X_q, rel=1e-12)
    assert np.min(finite.X_q) > SMALL.precrack
    assert np.sum(finite.bond.weight_q) == pytest.approx(SMALL.width * (SMALL.length - SMALL.precrack), rel=1e-13)


def test_bond_forces_are_the_integrals_of_the_tractions(finite):
    f_n = finite.bond.force(finite.X_q)
    half = 0.5 * SMALL.width * (SMALL.length**2 - SMALL.precrack**2)
    assert np.sum(f_n[finite.upper_n][1::2]) == pytest.approx(half, rel=1e-12)
    assert np.sum(f_n[~finite.upper_n][1::2]) == pytest.approx(-half, rel=1e-12)
    assert not np.any(f_n[::2])


def test_unit_load_is_uniform_on_both_faces_and_measures_the_opening(finite):
    on_face_n = np.abs(finite.X_nI[:, 0]) < 1e-9
    assert not np.any(finite.load_n[~on_face_n])
    for arm_n, sign in ((finite.upper_n, 1.0), (~finite.upper_n, -1.0)):
        assert np.sum(finite.load_n[arm_n][1::2]) == pytest.approx(sign, rel=1e-13)
    u_n = displacement(finite, lambda X, Y, up: (X, 0.3 * Y + np.where(up, 0.7, 0.0)))
    assert finite.load_n @ u_n == pytest.approx(0.7 + 0.3 * SMALL.arm_thickness, rel=1e-13)
    assert finite.slope_n @ displacement(finite, lambda X, Y, up: (X, 0.3 * X)) == pytest.approx(0.6, rel=1e-12)


@pytest.mark.parametrize(("elements", "precrack"), [(9, 2.1), (112, 4.0), (2, 0.01), (5, 5.99)])
def test_an_element_ends_where_the_precrack_ends(elements, precrack):
    lines = Problem(**(SMALL.__dict__ | {"elements": elements, "precrack": precrack})).specimen().X
    assert lines.size == elements + 1
    assert precrack in lines
    assert lines[0] == 0.0
    assert lines[-1] == SMALL.length
    assert np.all(np.diff(lines) > 0)
