"""Two arms on a bond that slides: identities at every step, J of the closed forms, friction, reference curves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.verify.theory.arms.specimens import (
    ARM,
    DCB,
    ELS,
    ENF,
    LAW,
    SHARED,
    SLB,
    WIDTH,
    curve,
    dcb,
    ledger_error,
    mmb,
    moments,
    of_scene,
    on_rollers,
    solved,
    steps,
)
from verify.curves.curve import curve_error
from verify.result import CURVE_COLUMNS
from verify.support.refusal import Refusal
from verify.theory.arms.problem import ArmsProblem
from verify.theory.arms.solve import solve
from verify.theory.law import Bilinear

ON_ROLLERS = {"enf_as4peek": on_rollers(ENF, 0.5), "mmb50_as4peek": replace(mmb(44.4, 0.5), zone=1.5)}
RUBBED = replace(LAW, friction=0.4)
PROBLEMS = {
    **ON_ROLLERS,
    "slb": replace(SLB, zone=1.5),
    "els": replace(ELS, opening=15.0),
    "friction": replace(ENF, bond=RUBBED),
    "finite": replace(ENF, kinematics="finite"),
    "finite dcb": replace(DCB, kinematics="finite", opening=4.0, zone=1.0, reach=38.0),
}


@pytest.mark.parametrize(("name", "peak"), [("enf_as4peek", 722.2), ("mmb50_as4peek", 253.9)])
@pytest.mark.parametrize(("order", "limit"), [(1, 0.004), pytest.param(3, 0.003, marks=pytest.mark.slow)])
def test_curves_of_fine_plane_meshes(name: str, peak: float, order: int, limit: float) -> None:
    """The rows of the files step over the peaks, which are of the same meshes.

    Of beams what is left is what they leave out, up to 0.9 % of the peak; of plane arms the falls.
    """
    file = SHARED / "reference" / "mixed" / f"{name}.csv"
    if not file.exists():
        pytest.skip(f"{file.name} is not there")
    reference = np.loadtxt(file, delimiter=",", skiprows=1)[:, :2].T
    problem = of_scene(name.replace("_", "-"), order=order, points=60)
    assert curve_error(curve(problem), tuple(reference), 0.999 * problem.programme[-1]) < limit
    assert curve(problem)[1].max() == pytest.approx(peak, rel=0.01 if order == 1 else 3e-3)


@pytest.mark.parametrize("name", PROBLEMS)
def test_identities_at_every_step(name: str) -> None:
    """J by two routes, the ledger, and of small rotations statics of supports and of the upper arm."""
    problem = PROBLEMS[name]
    s, toughness = steps(problem), LAW.toughness[1]
    assert set(CURVE_COLUMNS) <= set(s) and s["opening"][-1] == pytest.approx(problem.programme[-1])
    assert np.abs(s["J_loads"] - s["J_bond"]).max() < 5e-3 * toughness
    assert np.median(np.abs(s["J_loads"] - s["J_bond"])) < 1e-3 * toughness
    assert (
        ledger_error(problem) < (1e-3 if problem is PROBLEMS["friction"] else 1e-4)
        and np.median(s["newton_iterations"]) <= 5
    )
    assert np.all(np.diff(s["dissipated_energy"]) >= -1e-12)
    if problem.finite:
        return
    for column, unit in (("arm_force_x", 1.0), ("arm_force_y", 1.0), ("arm_moment", problem.length)):
        assert np.abs(s[column]).max() < 1e-6 * s["load"].max() * unit
    if len(problem.supports) == 2 and problem.supports[0].body is not None:
        assert s["support_1"] + s["support_2"] == pytest.approx(s["load"], abs=1e-6 * s["load"].max())


def test_friction_completes_in_a_few_hundred_steps_and_takes_its_part() -> None:
    """The load of sliding rises, part of the work is rubbed off, and nothing is cut again and again."""
    rubbed, plain = (replace(ENF, bond=bond) for bond in (RUBBED, ENF.bond))
    s = steps(rubbed)
    assert len(s["opening"]) < 300 and solved(rubbed).rejected_steps < 30
    assert s["load"].max() > 1.003 * steps(plain)["load"].max()
    assert 0.0 < s["friction_energy"][-1] < 0.2 * s["dissipated_energy"][-1]
    assert np.all(steps(plain)["friction_energy"] == 0.0)


@pytest.mark.parametrize("friction", [0.2, 0.8])
def test_friction_that_turns_keeps_its_ledger(friction: float) -> None:
    """Loaded, unloaded and loaded again, so that points stick on the way back."""
    problem = replace(ENF, bond=replace(LAW, friction=friction), opening=(4.5, 3.0, 5.0))
    assert ledger_error(problem) < 1e-3 and len(steps(problem)["opening"]) < 400


def test_the_ledger_of_a_scene_with_friction() -> None:
    scene = SHARED / "trust" / "enf-beam-ledger.toml"
    if not scene.exists():
        pytest.skip(f"{scene.name} is not there")
    problem = of_scene(scene, points=60)
    assert ledger_error(problem) < 1e-4 and len(steps(problem)["opening"]) < 300


def test_j_of_the_enf_is_g_iic_while_the_crack_grows() -> None:
    s = steps(PROBLEMS["enf_as4peek"])
    growing = (s["crack_length"] > 40.0) & (s["crack_length"] < 50.0)
    assert growing.any() and s["J_loads"][growing] == pytest.approx(LAW.toughness[1], rel=3e-3)


@pytest.mark.parametrize("pair", [(1.0, -1.0), (1.0, 1.0)])
def test_moments_have_their_j(pair: tuple[float, float]) -> None:
    """J = [21 (M1^2 + M2^2) - 6 M1 M2] / (4 b^2 h^3 E), whatever the zone."""
    s = steps(moments(*pair))
    m1, m2 = (side * s["load"] for side in pair)
    J = (21 * (m1**2 + m2**2) - 6 * m1 * m2) / (4 * WIDTH**2 * ARM.thickness**3 * ARM.young)
    assert s["J_loads"] == pytest.approx(J, rel=1e-4, abs=1e-6)
    assert s["J_bond"] == pytest.approx(J, rel=5e-3, abs=1e-3 * J.max())
    assert s["tip_opening"][-1] > 0.0 if pair[1] < 0 else abs(s["tip_slip"][-1]) > 0.0


@pytest.mark.parametrize("kinematics", ["linear", "finite"])
def test_a_double_cantilever_is_that_of_one_arm(kinematics: str) -> None:
    """A bond much softer than the arms, whose give at the root then is nothing: the same curve."""
    law = replace(LAW, strength=(4.0, 4.0), stiffness=(200.0, 200.0), toughness=(0.3, 0.3))
    two = replace(DCB, bond=law, opening=4.0, kinematics=kinematics)
    single = Bilinear(4.0, 0.3, 2 * 0.3 * 200.0 / 16.0, 1e5)
    keys = {"width": WIDTH, "zone": two.zone, "reach": two.reach, "kinematics": kinematics}
    one = dcb(single, ARM, 102.0, 30.0, 4.0, **keys)
    assert curve_error(curve(two), curve(one)) < 3e-3
    assert np.all(steps(two)["mode_ratio"] < 1e-12)


def test_small_deflections_of_finite_arms_are_linear() -> None:
    """The curves of both part with the deflection over the span."""
    both = [curve(replace(ENF, kinematics=kinematics)) for kinematics in ("linear", "finite")]
    assert 1e-5 < curve_error(both[1], both[0], 5.9) < 0.02


@pytest.mark.parametrize("problem", [replace(SLB, bond=replace(LAW, viscosity=0.1))])
def test_a_viscosity_is_refused(problem: ArmsProblem) -> None:
    with pytest.raises(Refusal, match="viscosity"):
        solve(problem)
