"""The same curve on one rank and on more."""

import json
from contextlib import redirect_stdout
from io import StringIO

import numpy as np
import pytest
from ranks import on_ranks

pytest.importorskip("dolfinx", reason="DOLFINx is not installed")

#: Of three ranks, one has no point of the short bond; the sliding crack runs from one into the next, and the edge of
#: the solid is on other ranks than its middle.
PROGRAM = """
import json
from dataclasses import replace
from opening_specimens import Dcb
from fem_reference.solve import solve_debonding
from mpi4py import MPI
from sliding_specimens import ENF, LAW
short = Dcb(length=14.0, arm_thickness=0.2, precrack=9.0, E1=120e3, E2=120e3, G12=50e3, nu12=0.2, strength=4.0,
            toughness=0.1, ductility=12.5, elements=28, opening=(1.5,), steps=8)
problems = {
    "snaps back": replace(short, precrack=4.0, strength=6.0, opening=(0.7, 0.5), elements=14, steps=None,
                          snapshot_openings=(0.65,)),
    "slides": replace(ENF, elements=24, layers=1, steps=2, opening=(2.7, 2.5), kinematics="finite",
                      bonded=(33.6, 102.0), snapshot_openings=(2.65,),
                      bond=replace(LAW, toughness=0.4845, shear_toughness=0.8595, friction=0.2)),
    "short bond": short,
    "solid": replace(short, G12=45e3, nu12=0.33, elements=20, opening=(1.8,), steps=3, width=6.0, plane="solid",
                     n_Z=2, snapshot_openings=(1.7,)),
}
names = "s_q gap_q slip_q traction_q shear_q damage_q u_euvi stress_euv front_z front_s front_G".split()
found = {}
for name, problem in problems.items():
    rows = []
    solution = solve_debonding(problem, on_step=rows.append)
    assert bool(rows) == (MPI.COMM_WORLD.rank == 0)
    fields = solution.snapshots[0] if rows and problem.snapshot_openings else {}
    fields = {one: abs(fields[one]).ravel().tolist() for one in names if one in fields}
    found[name] = {"rows": rows, "fields": fields, "dofs": solution.dofs, "status": solution.status,
                   "rejected": solution.rejected_steps}
if rows:
    print("RESULT" + json.dumps(found))
"""

PEEL = """
import json
from fem_reference.problem.material import Moduli
from opening_specimens import Peel as Problem
from fem_reference.solve import solve_debonding
from mpi4py import MPI
problem = Problem(strip_length=150.0, strip_thickness=2.0, substrate_length=120.0, substrate_thickness=10.0,
                  bond_length=90.0, strip=Moduli(250e3, 250e3, 104e3, 0.2), substrate=Moduli(5e3, 5e3, 2.1e3, 0.2),
                  strength=6.0, toughness=0.1, ductility=10.0, penalty=1e3, opening=(2.0, 1.0), steps=12, elements=50,
                  snapshot_openings=(2.0,))
solution = solve_debonding(problem)
if MPI.COMM_WORLD.rank == 0:
    snapshot = solution.snapshots[0]
    fields = {name: float(abs(snapshot[name]).sum()) for name in ("s_q", "gap_q", "u_euvi", "stress_euv")}
    print("RESULT" + json.dumps({"rows": solution.rows, "dofs": solution.dofs, "elements": solution.elements,
                                 "status": solution.status, "fields": fields}))
"""

FAILING = """
from opening_specimens import Dcb as Problem
from fem_reference.solve import solve_debonding
def full(row):
    raise OSError("no room")
problem = Problem(length=14.0, arm_thickness=0.2, precrack=4.0, E1=120e3, E2=120e3, G12=50e3, nu12=0.2, strength=4.0,
                  toughness=0.1, ductility=12.5, opening=(0.1,), steps=4)
solve_debonding(problem, on_step=full)
"""


def on_one(program):
    """What a program finds in this process."""
    with redirect_stdout(StringIO()) as stream:
        exec(program, {})
    return found(stream.getvalue())


def found(printed):
    return json.loads(printed.split("RESULT")[1])


@pytest.fixture(scope="module")
def both():
    return on_one(PROGRAM), found(on_ranks(3, "-c", PROGRAM))


#: Columns whose values are rounding, or numbers of iterations.
OF_ROUNDING = {
    "newton_iterations", "end_opening", "reaction_x", "reaction_y", "arm_force_x", "arm_force_y", "arm_moment",
}  # fmt: skip


@pytest.mark.parametrize("name", ["snaps back", "slides", "short bond", "solid"])
def test_three_ranks_give_the_curve_of_one(name, both):
    alone, together = (one[name] for one in both)
    assert alone["status"] == together["status"] == "complete"
    for key in ("dofs", "rejected"):
        assert together[key] == alone[key]
    opening = [row["opening"] for row in alone["rows"]]
    assert name != "snaps back" or np.min(np.diff(opening[: np.argmax(opening) + 1])) < 0.0
    assert_same_curve(together["rows"], alone["rows"], *alone["rows"][0].keys() - OF_ROUNDING)
    if name == "solid":  # the slope of its load differs by 3e-9
        assert_same_curve(together["rows"], alone["rows"], "front_middle", "front_edge", "J_bond", within=1e-9)
    for field, values in alone["fields"].items():
        assert together["fields"][field] == pytest.approx(
            values, rel=1e-7 if name == "solid" else 1e-6, abs=1e-9 * max(values)
        ), field


def test_a_rank_that_fails_ends_all_of_them():
    """The others would wait for it for ever."""
    with pytest.raises(AssertionError, match=r"(?s)OSError: no room.*MPI_ABORT|MPI_ABORT.*OSError: no room"):
        on_ranks(2, "-c", FAILING)


@pytest.mark.slow
def test_two_ranks_give_the_peel_of_one():
    """The parent has cells of no body beyond the substrate, and end faces that are inside it."""
    alone, together = on_one(PEEL), found(on_ranks(2, "-c", PEEL))
    assert alone["status"] == together["status"] == "complete"
    assert (together["dofs"], together["elements"]) == (alone["dofs"], alone["elements"])
    identities = "tip_opening", "face_slope_top", "face_energy", "interface_force"
    assert_same_curve(together["rows"], alone["rows"], *identities)
    assert together["fields"] == pytest.approx(alone["fields"], rel=1e-6)


def assert_same_curve(rows, expected, *more, within=1e-8):
    names = "opening load crack_length damage_front heading stored_energy dissipated_energy external_work"
    for name in (*names.split(), *more):
        a, b = (np.array([row[name] for row in run]) for run in (expected, rows))
        assert b == pytest.approx(a, rel=within, abs=within * np.max(np.abs(a))), name
