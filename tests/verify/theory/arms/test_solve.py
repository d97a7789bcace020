"""The beam on a bond that slides: identities at every step, reference curves, and the beam of one arm."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from tests.verify.theory.arms.specimens import DCB, ENF, LAW, SLB, WIDTH, mmb, moments, on_rollers
from verify.curves.curve import curve_error
from verify.result import CURVE_COLUMNS, steps_from_rows
from verify.support.refusal import Refusal
from verify.theory.arms.problem import ArmsProblem
from verify.theory.arms.solve import model, solve
from verify.theory.arms.structure import rigid
from verify.theory.beam.problem import BeamProblem
from verify.theory.beam.solve import solve as solve_one_arm

REFERENCE = Path(__file__).parents[5] / "shared" / "reference" / "mixed"
PROBLEMS = {"enf_as4peek": on_rollers(ENF, 0.5), "mmb50_as4peek": mmb(44.4, 0.5)}


@cache
def _solved(name: str) -> Mapping[str, np.ndarray]:
    return _steps(PROBLEMS[name])


def _steps(problem: ArmsProblem) -> Mapping[str, np.ndarray]:
    found = solve(problem)
    assert found.status == "complete"
    return steps_from_rows(found.rows)


@pytest.mark.parametrize(("name", "peak"), [("enf_as4peek", 722.2), ("mmb50_as4peek", 251.2)])
def test_curves_of_fine_plane_meshes(name: str, peak: float) -> None:
    """What is left is what beams leave out: 0.3 % of the curve, up to 0.9 % of the peak."""
    s = _solved(name)
    assert s["load"].max() == pytest.approx(peak, rel=0.01)
    file = REFERENCE / f"{name}.csv"
    if file.exists():
        reference = np.loadtxt(file, delimiter=",", skiprows=1)[:, :2].T
        assert curve_error((s["opening"], s["load"]), tuple(reference)) < 0.004


def test_arms_that_move_as_a_whole_have_no_forces() -> None:
    """Not even by rounding, which would add up along the arms to what statics then misses."""
    one = model(ENF)
    moved = rigid(ENF.arms, one.structure.mesh)[:, :2] @ np.array([123.456, 1234.567])
    assert not one.internal(moved, np.zeros_like(one.intact().jump)).any()


@pytest.mark.parametrize("name", PROBLEMS)
def test_identities_at_every_step(name: str) -> None:
    """J by two routes, the ledger, statics of the supports, and balance of the upper arm."""
    s = _solved(name)
    assert set(CURVE_COLUMNS) <= set(s)
    assert np.abs(s["J_loads"] - s["J_bond"]).max() < 4e-6 * LAW.toughness[1]
    assert (
        np.abs(s["external_work"] - s["stored_energy"] - s["dissipated_energy"]).max() < 5e-3 * s["external_work"][-1]
    )
    assert np.abs(s["arm_force_x"]).max() < 1e-6 * s["load"].max()
    assert np.abs(s["arm_force_y"]).max() < 1e-6 * s["load"].max()
    assert np.abs(s["arm_moment"]).max() < 1e-6 * s["load"].max() * ENF.length
    assert s["support_1"] + s["support_2"] == pytest.approx(s["load"], abs=1e-6 * s["load"].max())


def test_j_of_the_enf_is_exact_and_g_iic_while_the_crack_grows() -> None:
    s = _solved("enf_as4peek")
    assert np.abs(s["J_loads"] - s["J_bond"]).max() < 1e-6 * LAW.toughness[1]
    growing = (s["crack_length"] > 40.0) & (s["crack_length"] < 50.0)
    assert growing.any() and s["J_loads"][growing] == pytest.approx(LAW.toughness[1], rel=2e-3)


@pytest.mark.parametrize("pair", [(1.0, -1.0), (1.0, 1.0)])
def test_moments_have_their_j(pair: tuple[float, float]) -> None:
    """J = [21 (M1^2 + M2^2) - 6 M1 M2] / (4 b^2 h^3 E), whatever the zone."""
    s = _steps(moments(*pair))
    arm, (m1, m2) = ENF.arms[0], (side * s["load"] for side in pair)
    J = (21 * (m1**2 + m2**2) - 6 * m1 * m2) / (4 * WIDTH**2 * arm.thickness**3 * arm.young)
    assert s["J_bond"] == pytest.approx(J, rel=1e-4, abs=1e-9)
    assert np.sign(s["tip_opening"][-1]) == (1 if pair[1] < 0 else 0) or pair[1] > 0


def test_a_double_cantilever_is_the_beam_of_one_arm() -> None:
    """A bond much softer than the arms, which one arm takes for rigid across: the same curve."""
    law = replace(LAW, strength=(4.0, 4.0), stiffness=(200.0, 200.0), toughness=(0.3, 0.3))
    two = _steps(replace(DCB, law=law, opening=4.0))
    arm = ENF.arms[0]
    one = BeamProblem(
        102.0, 1.56, 30.0, WIDTH, arm.young, arm.shear, 4.0, 0.3, 2 * 0.3 * 200.0 / 16.0, 1e5, opening=4.0
    )
    s = steps_from_rows(solve_one_arm(one).rows)
    assert curve_error((two["opening"], two["load"]), (s["opening"], s["load"])) < 2e-3
    assert np.all(two["mode_ratio"] < 1e-12)


def test_a_viscosity_is_refused() -> None:
    with pytest.raises(Refusal, match="viscosity"):
        solve(replace(SLB, law=replace(LAW, viscosity=0.1)))
