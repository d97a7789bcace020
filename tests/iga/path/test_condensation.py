"""A linear bulk condensed onto the interface, against the same system in all its unknowns."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from specimens import PAPER

import iga.path.condensation
from iga.delamination import build, solve
from iga.path.condensation import _rigid_motions, _rows, _without, condensed
from iga.path.follow import follow
from iga.path.point import End
from iga.path.solver import Solver
from iga.system.system import respond
from tests.iga.test_peel import PEEL

BEAM = replace(PAPER, kinematics="linear", steps=40, dofs=600, opening=(1.5,))
STRIP = replace(PEEL, kinematics="linear", steps=40, dofs=900)

CASES = {
    "twins": BEAM,
    "mirror": replace(BEAM, symmetry=True),
    "Lagrange": replace(BEAM, basis="lagrange"),
    "T-spline": replace(BEAM, basis="tspline"),
    "lumped": replace(BEAM, interface_rule="lumped"),
    "unlike": replace(BEAM, mismatch=1.37),
    "lower slave": replace(BEAM, mismatch=1.37, slave="lower"),
    "posed": replace(BEAM, angle=37.0, mirror=True, shift=(1e3, -2e3)),
    "peel": STRIP,
    "peel unlike": replace(STRIP, mismatch=1.37),
}


@pytest.mark.parametrize("name", CASES)
def test_the_condensed_path_is_that_of_the_whole(name, monkeypatch):
    """All that a run tells, at all its steps, to a part of 1e-7 of the largest value of its kind."""
    problem = CASES[name]
    small = solve(problem)
    monkeypatch.setattr(iga.run, "condensed", lambda system: None)
    whole = solve(problem)
    assert small.status == whole.status == "complete" and len(small.rows) == len(whole.rows)
    for key in small.rows[0]:
        if key == "newton_iterations":
            continue
        a, b = (np.array([row[key] for row in run.rows]) for run in (small, whole))
        scale = np.abs(b).max() + np.abs([row["load"] for row in whole.rows]).max()
        assert np.abs(a - b).max() < 1e-7 * scale, key


def test_unloading_and_closing_come_to_the_same_ends(monkeypatch):
    """Where the programme turns, rounding decides how long the first steps are, and nothing else."""
    problem = replace(BEAM, opening=(1.0, -0.002, 1.5))
    small = solve(problem)
    monkeypatch.setattr(iga.run, "condensed", lambda system: None)
    whole = solve(problem)
    assert small.status == whole.status == "complete"
    for goal in (1.0, -0.002, 0.0, 1.5):
        a, b = ([row for row in run.rows if abs(row["opening"] - goal) < 1e-12] for run in (small, whole))
        assert len(a) == len(b) > 0
        for key in ("load", "dissipated_energy", "contact_energy", "tip_opening"):
            assert a[-1][key] == pytest.approx(b[-1][key], rel=1e-7, abs=1e-9)


@pytest.mark.parametrize("name", CASES)
def test_the_whole_is_in_equilibrium_where_the_condensed_system_is(name):
    problem = CASES[name]
    whole = build(problem).system
    small = condensed(whole)
    points = [item for item in follow(Solver(small.system), problem.opening, 40) if not isinstance(item, End)]
    for point in points[1::8]:
        found = small.expanded(point)
        answer = respond(whole, found.state, decide=False)
        residual_d = np.where(whole.free_d, answer.internal_d - found.state.load * whole.load_d, 0.0)
        assert np.linalg.norm(residual_d) < 1e-8 * answer.scale
        assert np.abs(answer.p_q - found.response.p_q).max() < 1e-6 * problem.strength
        assert whole.load_d @ found.state.u_d == pytest.approx(point.opening, rel=1e-9)


PAIRS = {"cubic": BEAM, "quadratic": replace(BEAM, degree=2, dofs=504), "peel": STRIP}


@pytest.mark.parametrize("narrow", [np.inf, 0.0], ids=["banded", "sparse"])
@pytest.mark.parametrize("problem", PAIRS.values(), ids=PAIRS)
def test_an_opening_that_a_gap_tells_already_is_not_condensed(problem, narrow, monkeypatch):
    """Two rows say the same, exactly or but for rounding: then the stiffness of what is kept has no bound."""
    limits = iga.path.condensation.CondensationLimits(narrow=narrow)
    monkeypatch.setattr(iga.path.condensation, "CONDENSATION", limits)
    system = build(problem).system
    rows, small = _rows(system)[0].tocsr(), condensed(system)
    stiffest = max(np.abs(K).max() for K in system.bulk.matrices)
    assert np.abs(small.system.bulk.K_dd).max() < 1e2 * stiffest
    for row in (0, 7, 15):
        same = np.asarray(rows[[row]].todense()).ravel()
        assert condensed(replace(system, load_d=same)) is None


def test_a_bulk_that_moves_far_or_has_too_many_partners_is_not_condensed():
    assert condensed(build(replace(BEAM, kinematics="finite")).system) is None
    assert condensed(build(replace(BEAM, dofs=40_000)).system) is None


@pytest.mark.parametrize("name", CASES)
def test_of_meshes_that_match_only_differences_are_left(name):
    """One unknown for each control point of the slave, or for every one of both sides, and the opening."""
    system = build(CASES[name]).system
    interface = system.interface
    slave, both = np.unique(interface.conn_qa).size, np.unique(interface.rest.dof_qd // 2).size
    alike = CASES[name].mismatch == 1.0 and not name.startswith("peel")
    assert condensed(system).system.n_dof == 1 + (slave if alike else both)


@pytest.mark.parametrize("name", ["twins", "unlike", "Lagrange"])
def test_the_stiffness_of_the_interface_does_not_depend_on_units(name):
    """Forces in other units, smaller and larger by six digits: those of the stiffness are the same ones."""

    def stiffness(unit):
        problem = CASES[name]
        forces = {key: unit * getattr(problem, key) for key in ("E1", "E2", "G12", "strength", "toughness", "penalty")}
        return condensed(build(replace(problem, **forces)).system).system.bulk.K_dd / unit

    same = stiffness(1.0)
    for unit in (1e-6, 1e6):
        assert np.abs(stiffness(unit) - same).max() < 1e-11 * np.abs(same).max()


def test_a_step_to_a_kink_takes_one_look_at_the_forces():
    """With a linear bulk the law is settled on the way to where a step is to end: nothing is left to Newton."""
    problem = replace(BEAM, steps=None, interface_points=4)
    points = [*follow(Solver(condensed(build(problem).system).system), problem.opening, None, bend=0.05)]
    looks = [point.iterations for point in points[1:] if not isinstance(point, End)]
    assert len(looks) > 5 and max(looks) == 1, looks


def test_without_damage_nothing_bends_and_one_step_goes_to_its_begin():
    """There the load has worked along a line, and all of that work is stored."""
    system = condensed(build(BEAM).system).system
    law = system.interface.law
    first = next(item for item in follow(Solver(system), BEAM.opening, None) if item.opening > 0.0)
    assert first.state.k_q.max() == pytest.approx(law.g_max, rel=1e-2) and first.tangent.growing_q.any()
    line = 0.5 * first.opening * first.state.load
    assert first.external_work == pytest.approx(line, rel=1e-10) == pytest.approx(first.energies.stored, rel=1e-9)


@pytest.mark.parametrize("name", ["twins", "mirror", "unlike", "peel", "posed"])
def test_a_rigid_motion_asks_for_no_force(name):
    """Of what is kept of it, to the last digit of the stiffness: more would be lost of the balance of forces."""
    system = build(CASES[name]).system
    small = condensed(system).system
    B_rd, _ = _rows(system)
    rigid_rm, _ = np.linalg.qr(B_rd @ _without(system.springs_rd, _rigid_motions(system, system.bulk)))
    assert rigid_rm.shape[1] == 2 and np.array_equal(small.bulk.K_dd, small.bulk.K_dd.T)
    assert np.abs(small.bulk.K_dd @ rigid_rm).max() < 5e-16 * np.abs(small.bulk.K_dd).max()


@pytest.mark.parametrize(("kept", "pays"), [(24, True), (25, False)])
@pytest.mark.parametrize("told", ["elements", "band"])
def test_dense_equations_pay_where_they_are_less_work_than_the_band(kept, pays, told):
    """2/3 n^3 operations against 4 n k^2, of 100 unknowns in a band of 5; one element may tell enough."""
    few = 6 if told == "elements" else 2
    bulk = SimpleNamespace(element_dofs=(np.zeros((3, few)), np.zeros((1, 2))))
    band = SimpleNamespace(n=100, k=5 if told == "band" else 0)
    system = SimpleNamespace(band=band, free_d=np.ones(100, dtype=bool))
    assert iga.path.condensation._pays(system, bulk, kept) == pays


@pytest.mark.parametrize("name", CASES)
def test_a_banded_and_a_sparse_factorisation_give_one_stiffness(name, monkeypatch):
    system, found = build(CASES[name]).system, []
    for narrow in (np.inf, 0.0):
        limits = iga.path.condensation.CondensationLimits(narrow=narrow)
        monkeypatch.setattr(iga.path.condensation, "CONDENSATION", limits)
        found.append(condensed(system))
    banded, sparse = (one.system.bulk.K_dd for one in found)
    assert np.abs(banded - sparse).max() < 1e-11 * np.abs(sparse).max()


@pytest.mark.parametrize("name", CASES)
def test_springs_hold_nothing_that_no_row_feels(name):
    """A whole that floats is in balance by itself, to the last digits of its forces and not of its stiffness."""
    system = build(CASES[name]).system
    small = condensed(system)
    rows = _rows(system)[0]
    unfelt_dm = _without(rows, _rigid_motions(system, system.bulk))
    assert unfelt_dm.shape[1] > 0
    held_rm = system.spring_r[:, None] * (system.springs_rd @ small.U_dr)
    on_motions = np.abs((system.springs_rd @ unfelt_dm).T @ held_rm).max()
    assert on_motions < 1e-13 * np.abs(small.system.bulk.K_dd).max()
