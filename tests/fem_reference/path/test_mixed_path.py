"""Paths of specimens whose bond slides: reference curves, identities of mechanics, closed forms, invariance."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("dolfinx", reason="DOLFINx is not installed")

from dolfinx_runs import built, columns, ledger_error
from opening_specimens import Dcb
from sliding_specimens import ARM, ENF, GUIDED, LAW, MMB, ON_ROLLERS, SLB, pulled_apart, under_moments

from fem_reference.model.energy import energies_after
from fem_reference.path import newton
from fem_reference.path.control import opening_control
from fem_reference.path.path import path
from fem_reference.path.state import State
from fem_reference.path.step import departing, step
from fem_reference.path.stride import Counted
from fem_reference.problem.loads import Load, Support
from fem_reference.problem.material import Rectangle
from fem_reference.solve import solve_debonding

REFERENCE = Path(__file__).parents[4] / "shared" / "reference" / "mixed"


@pytest.mark.slow
@pytest.mark.parametrize(("name", "problem"), [("enf", ENF), ("mmb50", MMB)])
def test_curve_is_that_of_the_reference(name, problem):
    """Load, J and initial slope; the reference was computed with elements half as long and three through each arm."""
    file = REFERENCE / f"{name}_as4peek.csv"
    if not file.exists():
        pytest.skip(f"the reference curve {file.name} is not at hand")
    run, known = columns(problem), np.genfromtxt(file, delimiter=",", names=True)
    load = np.interp(known["deflection"], run["opening"], run["load"])
    assert np.max(np.abs(load - known["load"])) < 0.003 * known["load"].max()
    assert run["load_slope"][0] == pytest.approx(known["load"][1] / known["deflection"][1], rel=0.002)
    J = np.interp(known["deflection"], run["opening"], run["J_loads"])
    assert np.max(np.abs(J - known["J_loads"])) < 0.01 * known["J_loads"].max()


@pytest.mark.parametrize("kinematics", ["linear", pytest.param("finite", marks=pytest.mark.slow)])
def test_identities_of_an_enf(kinematics):
    run = columns(replace(ENF, kinematics=kinematics, opening=(4.5,), steps=30))
    assert run["crack_length"][-1] > 48.0
    assert np.max(np.abs(run["J_loads"] - run["J_bond"])) < 0.004 * LAW.shear_toughness
    grows = run["crack_length"] > 39.3
    assert run["J_bond"][grows] == pytest.approx(LAW.shear_toughness, rel=0.004)
    assert run["J_shear"][grows] == pytest.approx(run["J_bond"][grows], rel=0.004)
    assert run["mode_ratio"][1:] == pytest.approx(1.0, abs=1e-3)
    assert ledger_error(run, "external_work") < 1e-4
    peak = run["load"].max()
    assert np.max(np.abs([run["arm_force_x"], run["arm_force_y"]])) < 1e-8 * peak
    assert np.max(np.abs(run["arm_moment"])) < 1e-8 * peak * 102.0
    assert run["support_1"] + run["support_2"] == pytest.approx(run["load"], abs=1e-8 * peak)
    if kinematics == "linear":  # else the places of the rollers move
        assert run["support_1"] == pytest.approx(0.5 * run["load"], abs=1e-6 * peak)
    assert np.all(np.abs(run["tip_slip"][1:]) > 0.0)


def test_a_snap_back_is_followed():
    """With a crack below 0.69 of the half span the deflection turns back; the crack costs its toughness."""
    run = columns(replace(ENF, bonded=(25.0, 102.0), opening=(4.5,), steps=40, elements=102))
    assert np.min(np.diff(run["opening"])) < 0.0
    assert ledger_error(run, "external_work") < 3e-4
    grown = np.flatnonzero(run["crack_length"] > 25.0)[[0, -1]]
    new_crack, lost = (np.diff(run[name][grown])[0] for name in ("crack_length", "dissipated_energy"))
    assert lost == pytest.approx(LAW.shear_toughness * new_crack * ENF.width, rel=0.01)


def test_a_mirrored_enf_slides_the_other_way():
    """Turned over: the load comes from below, the rollers are above; the upper arm is then the lower one."""
    short = replace(ENF, opening=(4.2,), steps=12, elements=102, layers=1)
    over = replace(
        short,
        loads=(Load(1, "bottom", 1.0, (50.5, 51.5)),),
        supports=tuple(Support(0, "top", support.extent) for support in ON_ROLLERS),
    )
    run, mirror = columns(short), columns(over)
    for name in ("opening", "load", "J_loads", "J_bond", "dissipated_energy"):
        assert mirror[name] == pytest.approx(run[name], rel=1e-5, abs=1e-5 * np.max(run[name]))
    assert mirror["tip_slip"] == pytest.approx(-run["tip_slip"], abs=1e-6)
    assert np.max(np.abs(run["tip_slip"])) > 0.02


def test_faces_that_touch_all_at_once_are_found_and_stay():
    """Pushed up, the lower arm bears on the upper one along the precrack; the curve is straight."""
    run = columns(replace(SLB, opening=(-0.4,), steps=None))
    slopes = run["load"][1:] / run["opening"][1:]
    assert np.ptp(slopes) < 1e-6 * slopes[0]
    assert run["dissipated_energy"].max() == 0.0 and ledger_error(run, "external_work") < 1e-6


@pytest.mark.slow
def test_arms_that_bend_are_not_told_to_close_by_less(monkeypatch):
    monkeypatch.setattr(newton, "REFERENCE_NEWTON", replace(newton.REFERENCE_NEWTON, tolerance=0.0, rounding=0.0))
    stopped = solve_debonding(replace(SLB, opening=(-0.4,), steps=1, elements=17, layers=1)).status
    assert "no equilibrium beyond opening 0" in stopped and "more elements" in stopped
    assert "close by less" not in stopped


@pytest.mark.parametrize(
    "moments", [*(pytest.param(one, marks=pytest.mark.slow) for one in ((1.0, -1.0), (1.0, 1.0))), (1.0, 0.0)]
)
def test_j_of_end_moments_is_that_of_three_beams(moments):
    """J = (21 (M1^2 + M2^2) - 6 M1 M2) / (4 w^2 h^3 E), E that of bending in plane strain; for every zone."""
    run = columns(under_moments(*moments, opening=(0.3,), steps=15, elements=204))
    first, second = (m * run["load"] for m in moments)
    D = ARM.moduli.stiffness_IJ("strain")
    young = D[0, 0] - D[0, 1] ** 2 / D[1, 1]
    J = (21 * (first**2 + second**2) - 6 * first * second) / (4 * ENF.width**2 * ARM.thickness**3 * young)
    assert run["J_loads"][1:] == pytest.approx(J[1:], rel=1e-3)
    assert moments != (1.0, -1.0) or run["tip_opening"][-1] > 1e-3
    expected = {(1.0, -1.0): 0.0, (1.0, 1.0): 1.0}.get(moments)
    if expected is not None:
        assert run["J_shear"][-1] / run["J_bond"][-1] == pytest.approx(expected, abs=1e-3)


def test_equal_arms_that_are_pulled_apart_are_a_double_cantilever_beam():
    """By symmetry nothing slides: the model in mode I, which has other matrices and supports, draws the same curve."""
    law = replace(LAW, strength=20.0, shear_strength=25.0)
    arm = replace(ARM, moduli=replace(ARM.moduli, nu23=None))
    pulled = pulled_apart(bodies=(arm, arm), bond=law, kinematics="finite", opening=(10.0,), steps=6, elements=51)
    moduli = {name: getattr(ARM.moduli, name) for name in ("E1", "E2", "G12", "nu12")}
    shared = {name: getattr(pulled, name) for name in ("kinematics", "opening", "steps", "elements", "layers", "width")}
    strength, toughness = {"strength": law.strength}, {"toughness": law.toughness, "penalty": law.penalty}
    ductility = 2.0 * law.toughness * law.stiffness / law.strength**2
    sizes = {"length": ARM.length, "arm_thickness": ARM.thickness, "precrack": 39.3, "plane": "strain"}
    alone = columns(Dcb(**sizes, **moduli, **shared, **strength, **toughness, ductility=ductility))
    run = columns(pulled)
    assert alone["crack_length"][-1] > 45.0
    assert run["load"][-1] == pytest.approx(alone["load"][-1], rel=1e-8)
    assert run["load_slope"][0] == pytest.approx(alone["load_slope"][0], rel=1e-8)
    assert np.max(run["mode_ratio"]) < 1e-9


@pytest.mark.slow
def test_unequal_arms_turn_until_their_loads_are_in_line():
    """In finite kinematics a weak spring alone resists: swapped arms draw the same curve, and the J of both agree."""
    law = replace(LAW, strength=20.0, shear_strength=25.0)
    arms = Rectangle(102.0, 1.0, ARM.moduli), Rectangle(102.0, 2.0, replace(ARM.moduli, E1=60e3))
    problem = pulled_apart(bodies=arms, bond=law, kinematics="finite", opening=(12.0,), steps=6, elements=102)
    run, swapped = columns(problem), columns(replace(problem, bodies=arms[::-1]))
    assert run["crack_length"][-1] > 40.5
    assert np.abs(run["J_loads"] - run["J_bond"]).max() < 0.008 * run["J_bond"].max()
    assert ledger_error(run, "external_work") < 2e-4
    assert 0.003 < run["mode_ratio"][-1] < 0.5
    for name in ("opening", "load", "J_bond", "mode_ratio"):
        assert swapped[name] == pytest.approx(run[name], rel=1e-4, abs=1e-4 * run[name].max())


@pytest.mark.parametrize("steps", [60, None], ids=["counted", "by accuracy"])
def test_friction_is_paid_apart_and_counts_in_the_ledger(steps):
    """Loaded, unloaded and loaded again: faces rub both ways, and the loop is dissipated by friction alone."""
    law = replace(LAW, friction=0.3)
    problem = replace(ENF, bond=law, opening=(4.6, 1.0, 4.6), steps=steps, elements=102, layers=1)
    run = columns(problem)
    assert ledger_error(run, "external_work") < 5e-4
    turns = [np.flatnonzero(run["opening"] == opening) for opening in (4.6, 1.0)]
    loop = slice(turns[0][0], turns[1][-1] + 1)
    rubbed = np.diff(run["friction_energy"][loop])
    assert np.all(rubbed >= 0.0) and rubbed.sum() > 0.0
    damaged = run["dissipated_energy"] - run["friction_energy"]
    assert np.ptp(damaged[loop]) < 1e-6 * damaged[-1]


def test_viscosity_holds_the_bond_together_for_longer():
    """The deflection is the time: the peak grows by it, and the ledger holds step by step."""
    snapping = replace(ENF, bonded=(25.0, 102.0), opening=(4.5,), steps=30, elements=68, layers=1)
    peaks = []
    for viscosity in (0.0, 0.1):
        run = columns(replace(snapping, bond=replace(LAW, viscosity=viscosity)))
        peaks.append(run["load"].max())
        if viscosity:
            assert np.all(np.diff(run["opening"]) > 0.0)
            assert ledger_error(run, "external_work") < 5e-3
    assert peaks[0] < peaks[1]


def test_a_guided_far_end_carries_the_moment():
    """End loaded split: the reactions are the load and its moment about the far end."""
    els = replace(ENF, loads=(Load(0, "top", -1.0, (0.0, 0.5)),), supports=GUIDED, opening=(2.0,), steps=2)
    run = columns(els)
    assert run["support_1"] == pytest.approx(run["load"], rel=1e-6)
    assert run["support_2"][1:] == pytest.approx(-run["load"][1:] * 101.75, rel=1e-5)


@pytest.mark.slow
def test_a_leap_of_the_crack_dissipates_what_its_steps_do(monkeypatch):
    """The profile of the jumps travels with the crack; along straight lines 5 % would be missing."""
    short = replace(MMB, opening=(8.0,), steps=100, elements=102, layers=1)
    model = built(short)
    s_q, states = model.specimen.distance(model.X_q), []
    for state in (point for point in path(model) if isinstance(point, State)):
        tip = np.max(s_q[model.law.held(state.k_q) >= model.law.failed], initial=0.0)
        if tip > ENF.bonded[0] + 1.0:
            states.append(state)
        if tip > ENF.bonded[0] + 2.5:
            break
    start, end = states[0], states[-1]

    def lost():
        found = energies_after(model, (start.g_q, start.k_q), start.bond, (end.g_q, end.k_q))
        return found.dissipated - start.bond.dissipated

    in_steps = end.bond.dissipated - start.bond.dissipated
    assert len(states) > 10 and lost() == pytest.approx(in_steps, rel=2e-3)
    monkeypatch.setattr("fem_reference.model.energy.advance", lambda *_: 0.0)
    assert abs(lost() / in_steps - 1.0) > 0.02


def test_a_step_to_zero_ends_on_the_faces_that_touch_there():
    """The chord of a long step in finite kinematics opens faces that are closed up to the end of the path."""
    law = replace(LAW, strength=5.0, shear_strength=8.0, toughness=0.3, shear_toughness=0.6, irreversible=False)
    law = replace(law, stiffness=2e3, shear_stiffness=2e3, penalty=1e4)
    problem = replace(ENF, bond=law, elements=24, layers=1, kinematics="finite", opening=(1.0,), steps=10)
    model = built(problem)
    _, begun, *_, far = (state for state in path(model) if isinstance(state, State))
    end = step(model, departing(model, far, 0.0, Counted(1.0)), opening_control(model, 0.0), Counted(1.0))
    assert isinstance(end, State) and end.slope == pytest.approx(begun.load / begun.opening, rel=0.01)
