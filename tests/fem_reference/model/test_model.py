"""The assembled model: derivatives against differences, motions without stress, fields that are known."""

import numpy as np
import pytest

pytest.importorskip("dolfinx", reason="DOLFINx is not installed")

from dolfinx import fem
from dolfinx_runs import built, displacement, tangent_error
from opening_specimens import Dcb, Peel

from fem_reference.problem.material import Moduli

SMALL = Dcb(
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
    layers=2,
)


def small(**changes):
    return built(Dcb(**(SMALL.__dict__ | changes)))


@pytest.fixture(scope="module")
def finite():
    return small()


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
    g_q = model.jump(u_n)
    largest_q = np.maximum(g_q, 0.0) * {"unloading": 1.7, "reloading": 1.001}.get(state, 0.5)
    k_q = model.history(largest_q, model.law.intact(model.bonded_q))
    damaged = np.max(largest_q) > model.law.begun
    assert {"open": np.max(g_q) > model.law.failed, "closed": np.min(g_q) < 0}.get(state, damaged)
    direction_n = model.free_n * rng.standard_normal(u_n.size)
    h = 1e-7 * np.min(np.abs(g_q)) / np.max(np.abs(model.jump(direction_n)))
    h = max(h, 1e-8)
    assert tangent_error(model, u_n, k_q, direction_n, h) < 1e-6


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
    assert fem.assemble_scalar(finite.face_energy) == pytest.approx(0.0, abs=1e-12 * W)


def test_loaded_ends_of_arms_count_in_the_j_integral_and_far_ends_against_it(finite):
    """Stretched more towards either end, the arms have more energy there."""
    p = finite.problem
    for far in (False, True):
        from_end = (lambda X: X) if far else (lambda X: X - p.length)
        finite.displace(displacement(finite, lambda X, Y, up, s=from_end: (0.5 * 0.05 / p.length * s(X) ** 2, 0.0 * Y)))
        slope = 0.05 if far else -0.05
        W = 0.5 * p.elasticity_IJ[0, 0] * (slope + 0.5 * slope**2) ** 2 * 2 * p.arm_thickness
        assert fem.assemble_scalar(finite.face_energy) == pytest.approx(-W if far else W, rel=1e-12)


def test_supports_hold_one_point_an_arm(finite):
    held = np.flatnonzero(finite.free_n == 0)
    assert finite.X_nI[held] == pytest.approx(np.array([[SMALL.length, 0.0]] * 3))
    assert sorted(zip(finite.upper_n[held], held % 2, strict=True)) == [(False, 0), (False, 1), (True, 0)]
    A = finite.tangent(bent(finite, 0.3, np.random.default_rng(2)), finite.law.intact(finite.bonded_q))
    x, y = A.createVecs()
    for n in held:
        x.array[:] = 0.0
        x.array[n] = 1.0
        A.mult(x, y)
        assert np.array_equal(y.array, x.array)


def test_the_tie_alone_holds_the_rotation(finite):
    """About the hinge the specimen turns as a whole: nothing but the spring between the far corners resists."""
    turn_n = displacement(finite, lambda X, Y, up: (-Y, X - SMALL.length))
    A = finite.tangent(0 * turn_n, finite.law.intact(finite.bonded_q))
    x, y = A.createVecs()
    x.array[:] = turn_n
    A.mult(x, y)
    spring = SMALL.E1 * SMALL.width * (2 * SMALL.arm_thickness) ** 2
    assert turn_n @ y.array == pytest.approx(spring, rel=1e-9)
    force_n = finite.residual(1e-9 * turn_n, 0.0, finite.law.intact(finite.bonded_q))
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
    assert finite.jump(u_n)[:, 0] == pytest.approx(0.1 * finite.X_q**2 - 0.05 * finite.X_q, rel=1e-12)
    assert np.min(finite.X_q) > SMALL.precrack
    assert np.sum(finite.bond.weight_q) == pytest.approx(SMALL.width * (SMALL.length - SMALL.precrack), rel=1e-13)


def test_bond_forces_are_the_integrals_of_the_tractions(finite):
    f_n = finite.bond.force(finite.X_q[:, None])
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
    lines = Dcb(**(SMALL.__dict__ | {"elements": elements, "precrack": precrack})).specimen().X
    assert lines.size == elements + 1
    assert precrack in lines
    assert lines[0] == 0.0
    assert lines[-1] == SMALL.length
    assert np.all(np.diff(lines) > 0)


PEEL = Peel(
    strip_length=7.0,
    strip_thickness=0.5,
    substrate_length=5.0,
    substrate_thickness=1.2,
    bond_length=3.0,
    width=1.5,
    strip=Moduli(130.0, 9.0, 5.0, 0.3),
    substrate=Moduli(11.0, 11.0, 4.0, 0.2),
    strength=0.04,
    toughness=0.002,
    ductility=5.0,
    elements=11,
)


@pytest.fixture(scope="module")
def peeled():
    return built(PEEL)


def stretched(model, upper, lower):
    """Uniform strain E11 of either body, linear in X."""
    return displacement(model, lambda X, Y, up: (np.where(up, upper, lower) * X, 0.0 * Y))


def test_strip_and_substrate_have_their_own_material_and_size(peeled):
    for number, moduli, area in ((0, PEEL.strip, 7.0 * 0.5), (1, PEEL.substrate, 5.0 * 1.2)):
        e = [0.0, 0.0]
        e[number] = 0.05
        peeled.displace(stretched(peeled, *e))
        E11 = 0.05 + 0.5 * 0.05**2
        W = 0.5 * moduli.stiffness_IJ("stress")[0, 0] * E11**2
        assert fem.assemble_scalar(peeled.energy) == pytest.approx(W * area * PEEL.width, rel=1e-12)
        assert fem.assemble_scalar(peeled.face_energy) == pytest.approx(0.0, abs=1e-12 * W)


def test_right_ends_count_in_the_j_integral_and_left_ends_against_it(peeled):
    """Stretched more towards the right, each body has more energy there."""
    half = displacement(peeled, lambda X, Y, up: (np.where(up, 0.01, 0.02) * X**2, 0.0 * Y))
    peeled.displace(half)
    expected = 0.0
    for moduli, slope, height in ((PEEL.strip, 0.02 * 7.0, 0.5), (PEEL.substrate, 0.04 * 5.0, 1.2)):
        E11 = slope + 0.5 * slope**2
        expected += 0.5 * moduli.stiffness_IJ("stress")[0, 0] * E11**2 * height
    assert fem.assemble_scalar(peeled.face_energy) == pytest.approx(expected, rel=1e-12)


def test_the_load_of_a_peel_is_on_the_end_of_the_strip(peeled):
    X, Y = peeled.X_nI.T
    on_face_n = (np.abs(X - 7.0) < 1e-9) & (Y > -1e-9) & peeled.upper_n
    assert not np.any(peeled.load_n[~on_face_n]) and not np.any(peeled.slope_n[~peeled.upper_n])
    u_n = displacement(peeled, lambda X, Y, up: (0 * X, np.where(up, 0.3 * X + 0.1 * Y, 9.0)))
    assert peeled.load_n @ u_n == pytest.approx(0.3 * 7.0 + 0.1 * 0.25, rel=1e-13)
    assert peeled.slope_n @ u_n == pytest.approx(0.3, rel=1e-12)
    assert np.sum(peeled.load_n[1::2]) == pytest.approx(1.0, rel=1e-13)


def test_the_base_is_clamped_and_one_point_of_the_strip_held_lengthwise(peeled):
    X, Y = peeled.X_nI.T
    base_n = ~peeled.upper_n & (np.abs(Y + 1.2) < 1e-9)
    held_n = peeled.free_n == 0
    assert np.all(held_n[base_n])
    (strip,) = np.flatnonzero(held_n & ~base_n)
    assert (X[strip], Y[strip]) == pytest.approx((0.0, 0.0), abs=1e-12)
    assert strip % 2 == 0 and peeled.upper_n[strip]
    assert not np.any(peeled.tie_n)


def test_the_strip_is_bonded_on_the_left_and_free_beyond(peeled):
    assert 0.0 < np.min(peeled.X_q) and np.max(peeled.X_q) < PEEL.bond_length
    assert np.sum(peeled.bond.weight_q) == pytest.approx(PEEL.width * PEEL.bond_length, rel=1e-13)
    u_n = displacement(peeled, lambda X, Y, up: (X, np.where(up, 0.1 * X**2, 0.05 * X)))
    assert peeled.jump(u_n)[:, 0] == pytest.approx(0.1 * peeled.X_q**2 - 0.05 * peeled.X_q, rel=1e-12)


def test_tangent_of_a_peel_is_the_derivative_of_its_residual(peeled):
    rng = np.random.default_rng(3)
    u_n = displacement(peeled, lambda X, Y, up: (-0.2 * Y * X, np.where(up, 0.02 * (X - 1) ** 2 * np.sign(X - 1), 0)))
    u_n = peeled.free_n * (u_n + 1e-4 * rng.standard_normal(u_n.size))
    largest_q = np.maximum(peeled.jump(u_n), 0.0)
    assert np.min(peeled.jump(u_n)) < 0 and np.any((largest_q > peeled.law.begun) & (largest_q < peeled.law.failed))
    k_q = peeled.history(0.5 * largest_q, peeled.law.intact(peeled.bonded_q))
    direction_n = peeled.free_n * rng.standard_normal(u_n.size)
    assert tangent_error(peeled, u_n, k_q, direction_n) < 1e-6
