"""The assembled model of a bond that slides: derivatives against differences, frames that turn, functionals."""

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("dolfinx", reason="DOLFINx is not installed")

from dolfinx_runs import built, displacement, tangent_error
from sliding_specimens import ARM, ENF, LAW, pulled_apart, under_moments

from fem_reference.model.frame import relative
from fem_reference.problem.law import Law
from fem_reference.problem.loads import Load, Support
from fem_reference.problem.mixed_law import DAMAGE

SMALL = replace(ENF, elements=24, layers=1)


def build(problem):
    return built(problem)


def turned(model, u_n, angle):
    """The body with its displacement turned about the origin."""
    x_nI = (model.X_nI[::2] + u_n.reshape(-1, 2)) @ np.array(
        [[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]]
    )
    return (x_nI - model.X_nI[::2]).ravel()


def moved(model, gap, rng):
    """Bent arms whose faces open (or close) and slide, with a little noise."""

    def field(X, Y, up):
        side = np.where(up, 0.5, -0.5)
        wave = np.sin(0.2 * X)
        return 0.04 * side * (1 + wave) - 0.02 * Y * X / 10, 1e-3 * X**2 + gap * side * (1.2 + wave)

    u_n = displacement(model, field)
    return model.free_n * (u_n + 1e-4 * rng.standard_normal(u_n.size))


@pytest.mark.parametrize(("kinematics", "angle"), [("linear", 0.0), ("finite", 0.0), ("finite", 1.2)])
@pytest.mark.parametrize(
    ("gap", "friction"), [(0.03, 0.0), (-0.004, 0.0), (-0.004, 0.4)], ids=["open", "closed", "rubs"]
)
def test_tangent_is_the_derivative_of_the_residual(kinematics, angle, gap, friction):
    rng = np.random.default_rng(3)
    model = build(replace(SMALL, kinematics=kinematics, bond=replace(LAW, friction=friction)))
    u_n = model.free_n * turned(model, moved(model, gap, rng), angle)
    k_qh = model.law.intact(model.bonded_q)
    k_qh[model.bonded_q, DAMAGE] = rng.uniform(0.0, 0.9, model.bonded_q.sum())
    k_qh[:, 1] = rng.uniform(-0.01, 0.01, k_qh.shape[0])
    direction_n = model.free_n * rng.standard_normal(u_n.size)
    assert tangent_error(model, u_n, k_qh, direction_n, 1e-7) < 1e-6


def test_turning_the_whole_specimen_changes_neither_gap_nor_slip():
    model = build(replace(SMALL, kinematics="finite"))
    u_n = moved(model, 0.03, np.random.default_rng(4))
    turned_n = turned(model, u_n, 1.2)
    assert np.max(np.abs(model.jump(turned_n) - model.jump(u_n))) < 1e-12
    k_qh = model.law.intact(model.bonded_q)
    force_nI, turned_nI = (model.bond_force(v_n, k_qh).reshape(-1, 2) for v_n in (u_n, turned_n))
    c, s = np.cos(1.2), np.sin(1.2)
    assert turned_nI == pytest.approx(force_nI @ np.array([[c, s], [-s, c]]), abs=1e-9 * np.max(np.abs(force_nI)))


def test_forces_of_the_bond_balance_in_the_current_configuration():
    """Of both bodies together, also where the faces are apart: gap and slip are objective."""
    model = build(replace(SMALL, kinematics="finite"))
    u_n = turned(model, moved(model, 0.01, np.random.default_rng(5)), 0.7)
    force_nI, x_nI = (
        model.bond_force(u_n, model.law.intact(model.bonded_q)).reshape(-1, 2),
        (model.X_nI[::2] + u_n.reshape(-1, 2)),
    )
    size = np.sum(np.abs(force_nI))
    assert np.max(np.abs(force_nI.sum(0))) < 1e-12 * size
    assert abs(x_nI[:, 0] @ force_nI[:, 1] - x_nI[:, 1] @ force_nI[:, 0]) < 1e-12 * size * 102.0


def test_second_derivatives_of_gap_and_slip():
    z_qa, h = np.random.default_rng(6).standard_normal((20, 4)), 1e-5
    at = relative(z_qa)
    for a in range(4):
        ahead, behind = (relative(z_qa + sign * h * np.eye(4)[a]) for sign in (1, -1))
        assert (ahead.jump_qj - behind.jump_qj) / (2 * h) == pytest.approx(at.dz_qja[..., a], rel=1e-6, abs=1e-6)
        assert (ahead.dz_qja - behind.dz_qja) / (2 * h) == pytest.approx(at.dz_qjab[..., a], rel=1e-6, abs=1e-6)


def test_slip_is_positive_where_the_upper_arm_moves_along_x():
    for kinematics in ("linear", "finite"):
        model = build(replace(SMALL, kinematics=kinematics))
        u_n = displacement(model, lambda X, Y, up: (np.where(up, 0.02, 0.0), np.where(up, 0.01, 0.0)))
        assert model.jump(u_n) == pytest.approx(np.tile([0.01, 0.02], (model.X_q.size, 1)))


def test_loads_and_supports_work_on_the_mean_displacement_and_the_mean_rotation():
    a, b, turn = 0.3, 0.2, 0.01
    model = build(under_moments(1.0, 0.5, elements=24, layers=1))
    acts = model.actions
    u_n = displacement(model, lambda X, Y, up: (0.1 - turn * Y * (1 + X), a + b * X))
    ends = [turn, turn, a + 102.0 * b, turn * 103.0]  # both moments on the left, place and rotation of the right end
    assert acts.mean_kn @ u_n == pytest.approx(ends)
    assert acts.slope_kn @ u_n == pytest.approx([turn, turn, b, turn])
    assert model.load_n @ u_n == pytest.approx(-1.5 * turn)
    assert model.load_n[::2].sum() == pytest.approx(0.0, abs=1e-12)
    on_top = build(replace(SMALL, kinematics="linear"))
    v_n = displacement(on_top, lambda X, Y, up: (0.0 * X, np.where(up, 1.0, 3.0) * X**2))
    assert on_top.actions.mean_kn @ v_n == pytest.approx([51.0**2 + 1 / 12, 3 * 0.25 / 3, 3 * (101.75**2 + 0.25 / 12)])
    assert on_top.load_n.sum() == pytest.approx(-1.0)


def test_motions_that_no_support_resists_are_held():
    """One rigid motion after the other: its smallest stiffness is that of a spring or of a point that is held."""
    few = {"elements": 24, "layers": 1}
    unequal = under_moments(1.0, 0.2, bodies=(ARM, replace(ARM, thickness=4.0)), **few)
    for problem in (SMALL, pulled_apart(**few), under_moments(1.0, 1.0, **few), unequal):
        model = build(problem)
        A = model.tangent(0 * model.load_n, model.law.intact(model.bonded_q)).convert("dense").getDenseArray()
        held = np.flatnonzero(model.free_n == 0.0)
        assert np.array_equal(A[held], np.eye(len(A))[held]), "a point that is held feels no spring"
        assert np.linalg.eigvalsh(0.5 * (A + A.T))[0] > 1e-6


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"loads": (Load(0, "middle", 1.0),)}, "loads: must have the side"),
        ({"loads": (Load(0, "top", 1.0, couple=True),)}, "loads: must have the side left or right"),
        ({"supports": (Support(None, "top"),)}, "supports: must have the side left or right"),
        ({"loads": (Load(0, "top", 1.0, (90.0, 110.0)),)}, "loads: must have an extent in 0 to 102"),
        ({"bond": Law(80.0, 0.969, 10.0, 1e5)}, "bond: must slide"),
        ({"load_at": "node"}, "load_at: must be"),
        ({"elements": 4}, "elements: must be >= 6"),
    ],
)
def test_what_does_not_lie_on_the_arms_is_refused(changes, words):
    with pytest.raises(ValueError, match=words):
        replace(ENF, **changes)
