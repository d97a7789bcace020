"""The same curve on one rank and on more."""

import json
from contextlib import redirect_stdout
from io import StringIO

import numpy as np
import pytest
from ranks import on_ranks

pytest.importorskip("dolfinx", reason="DOLFINx is not installed")

PROGRAM = """
import json
from dataclasses import replace
from opening_specimens import Dcb as Problem
from fem_reference.solve import solve_debonding
from mpi4py import MPI
from sliding_specimens import ENF, LAW
rows = []
problem = Problem(length=14.0, arm_thickness=0.2, precrack=4.0, E1=120e3, E2=120e3, G12=50e3, nu12=0.2, strength=6.0,
                  toughness=0.1, ductility=12.5, opening=(1.0, 0.5, 1.1), elements=14, steps=20,
                  snapshot_openings=(1.0,))
solution = solve_debonding(problem, on_step=rows.append)
chosen = solve_debonding(replace(problem, strength=4.0, elements=28, opening=(0.9, 0.5, 1.0), steps=None,
                                 snapshot_openings=()))
slides = solve_debonding(replace(ENF, elements=48, layers=1, steps=8, opening=(4.2, 3.5), kinematics="finite",
                                 bond=replace(LAW, friction=0.2), snapshot_openings=(4.0,)))
assert bool(rows) == (MPI.COMM_WORLD.rank == 0)
if MPI.COMM_WORLD.rank == 0:
    snapshot = solution.snapshots[0]
    names = ("s_q", "gap_q", "traction_q", "damage_q", "u_euvi", "stress_euv")
    fields = {name: float(abs(snapshot[name]).sum()) for name in names}
    slid = {name: float(abs(slides.snapshots[0][name]).sum()) for name in ("slip_q", "shear_q", "damage_q")}
    print("RESULT" + json.dumps({"rows": rows, "dofs": solution.dofs, "status": solution.status, "fields": fields,
                                 "chosen": chosen.rows, "rejected": chosen.rejected_steps,
                                 "slides": slides.rows, "slid": slid}))
"""

#: The last third of the specimen is bonded: of three ranks, one has no point of the bond.
SHORT_BOND = """
import json
from opening_specimens import Dcb as Problem
from fem_reference.solve import solve_debonding
from mpi4py import MPI
solution = solve_debonding(Problem(length=14.0, arm_thickness=0.2, precrack=9.0, E1=120e3, E2=120e3, G12=50e3, nu12=0.2,
                                   strength=4.0, toughness=0.1, ductility=12.5, elements=28, opening=(1.5,), steps=8))
if MPI.COMM_WORLD.rank == 0:
    print("RESULT" + json.dumps({"rows": solution.rows, "status": solution.status}))
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


#: The edge of the width is on other ranks than its middle.
SOLID = """
import json
from opening_specimens import Dcb as Problem
from fem_reference.solve import solve_debonding
from mpi4py import MPI
problem = Problem(length=14.0, arm_thickness=0.2, precrack=9.0, E1=120e3, E2=120e3, G12=45e3, nu12=0.33, strength=4.0,
                  toughness=0.1, ductility=12.5, elements=20, opening=(2.4, 1.5), steps=6, width=6.0, plane="solid",
                  n_Z=2, snapshot_openings=(2.3,))
solution = solve_debonding(problem)
if MPI.COMM_WORLD.rank == 0:
    snapshot = solution.snapshots[0]
    names = ("front_z", "front_s", "front_G", "gap_q", "traction_q", "u_euvi", "stress_euv")
    fields = {name: abs(snapshot[name]).ravel().tolist() for name in names}
    print("RESULT" + json.dumps({"rows": solution.rows, "dofs": solution.dofs, "status": solution.status,
                                 "fields": fields}))
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


def curve(ranks, program=PROGRAM):
    """Of one rank in this process."""
    if ranks > 1:
        printed = on_ranks(ranks, "-c", program)
    else:
        with redirect_stdout(StringIO()) as stream:
            exec(program, {})
        printed = stream.getvalue()
    return json.loads(printed.split("RESULT")[1])


def test_two_ranks_give_the_curve_of_one():
    alone, together = curve(1), curve(2)
    assert alone["status"] == "complete"
    assert np.min(np.diff([row["opening"] for row in alone["rows"] if row["opening"] > 0.5])) < 0, "it snaps back"
    assert together["status"] == "complete"
    assert together["dofs"] == alone["dofs"]
    assert_same_curve(together["rows"], alone["rows"])
    assert together["fields"] == pytest.approx(alone["fields"], rel=1e-6)
    assert together["rejected"] == alone["rejected"] and len(together["chosen"]) == len(alone["chosen"])
    assert_same_curve(together["chosen"], alone["chosen"], "load_slope", within=1e-7)
    assert together["slid"] == pytest.approx(alone["slid"], rel=1e-6)
    bond = {name for name in alone["slides"][0] if not name.startswith("arm_")} - {"newton_iterations"}
    assert_same_curve(together["slides"], alone["slides"], *bond, within=1e-6)


def test_ranks_without_points_of_the_bond_wait_for_the_others():
    alone, together = curve(1, SHORT_BOND), curve(3, SHORT_BOND)
    assert together["status"] == alone["status"] == "complete"
    assert_same_curve(together["rows"], alone["rows"])


def test_three_ranks_give_the_solid_of_one():
    alone, together = curve(1, SOLID), curve(3, SOLID)
    assert alone["status"] == together["status"] == "complete"
    assert together["dofs"] == alone["dofs"]
    assert_same_curve(together["rows"], alone["rows"], "front_middle", "front_edge", "J_bond", within=1e-9)
    for name, values in alone["fields"].items():
        assert together["fields"][name] == pytest.approx(values, rel=1e-7, abs=1e-9 * max(values)), name


def test_a_rank_that_fails_ends_all_of_them():
    """The others would wait for it for ever."""
    with pytest.raises(AssertionError, match=r"(?s)OSError: no room.*MPI_ABORT|MPI_ABORT.*OSError: no room"):
        on_ranks(2, "-c", FAILING)


@pytest.mark.slow
def test_two_ranks_give_the_peel_of_one():
    """The parent has cells of no body beyond the substrate, and end faces that are inside it."""
    alone, together = curve(1, PEEL), curve(2, PEEL)
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
