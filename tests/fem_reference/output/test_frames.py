"""Frames of the DOLFINx model: Lagrange cells by their nodes, in the order and at the places that VTK knows."""

import json
from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("dolfinx", reason="DOLFINx is not installed")

from dolfinx import geometry
from opening_specimens import Dcb, Peel
from ranks import on_ranks
from vtu_files import arrays

from fem_reference.problem.bond_law import HELD
from fem_reference.problem.material import Moduli
from fem_reference.solve import solve_debonding
from verify.cli import main
from verify.fields.cells import grid, vtk_order
from verify.fields.frames import solid_cells

DCB = Dcb(
    length=14.0, arm_thickness=0.2, precrack=4.0, E1=120e3, E2=60e3, G12=30e3, nu12=0.2, plane="strain", strength=4.0,
    toughness=0.1, ductility=12.5, opening=(0.5,), steps=3, elements=28, layers=2,
)  # fmt: skip
PEEL = Peel(
    strip_length=150.0, strip_thickness=2.0, substrate_length=120.0, substrate_thickness=10.0, bond_length=90.0,
    strip=Moduli(250e3, 250e3, 104e3, 0.2), substrate=Moduli(5e3, 5e3, 2.1e3, 0.2), strength=6.0, toughness=0.1,
    ductility=10.0, penalty=1e3, opening=(1.0,), steps=3, elements=30,
)  # fmt: skip


def last_frame(problem):
    """What makes the last frame knows, and the frame."""
    kept = []
    solution = solve_debonding(problem, on_frame=lambda opening, make: kept.append(make))
    assert solution.status == "complete" and len(kept) == len(solution.rows)
    return *kept[-1].args, kept[-1]()


def evaluated(u, X_nI):
    """DOLFINx's own evaluation of a function at places."""
    mesh = u.function_space.mesh
    points = np.column_stack([X_nI, np.zeros(len(X_nI))])
    found = geometry.compute_colliding_cells(
        mesh, geometry.compute_collisions_points(geometry.bb_tree(mesh, 2), points), points
    )
    return u.eval(points, found.array[found.offsets[:-1]]).reshape(len(X_nI), -1)


def shapes(degree, st_nk):
    """VTK's Lagrange shape functions at parameters: products of those that are 1 at one of the even nodes."""
    nodes = np.linspace(0.0, 1.0, degree + 1)
    one = [
        np.stack([np.prod([(x - b) / (a - b) for b in nodes if b != a], axis=0) for a in nodes], -1) for x in st_nk.T
    ]
    return (one[1][:, :, None] * one[0][:, None, :]).reshape(len(st_nk), -1)[:, vtk_order((degree, degree))]


@pytest.mark.parametrize(
    "problem", [replace(DCB, degree=3), replace(DCB, degree=4, kinematics="linear"), replace(PEEL, degree=2)]
)
def test_cells_are_those_of_dolfinx(problem):
    """At points inside of every cell, VTK's functions give the place, and the displacement that DOLFINx has there."""
    model, _, state, frame = last_frame(problem)
    p, st_nk = problem.degree, np.random.default_rng(1).random((3, 2))
    cells = [solid_cells(part, np.zeros(2)) for part in frame["cells"]]
    for body, (part, u) in enumerate(zip(cells, model.displacement, strict=True)):
        found = grid([part])
        n_e, n_b = len(found.types), (p + 1) ** 2
        assert n_e == u.function_space.mesh.topology.index_map(2).size_local
        assert np.all(found.types == 70) and np.all(found.cell_data["body"] == body)
        X, u_b = (v.reshape(n_e, n_b, 3)[..., :2] for v in (found.points, found.point_data["displacement"]))
        N_nb = shapes(p, st_nk)
        places, displaced = (np.concatenate(N_nb @ v) for v in (X, u_b))
        # rectangles: the place goes evenly with the parameters
        corner, size = X[:, 0], X[:, 2] - X[:, 0]
        assert np.all(size > 0)
        assert places == pytest.approx(np.concatenate(corner[:, None] + st_nk * size[:, None]), abs=1e-12)
        model.displace(state.u_n)
        assert displaced == pytest.approx(evaluated(u, places), abs=1e-12)
        assert np.abs(displaced).max() > 1e-5


def test_interface_lies_on_the_upper_face():
    for problem in (DCB, PEEL):
        model, _, state, frame = last_frame(problem)
        bond = frame["bond"]
        assert np.all(np.diff(bond["s_q"]) > 0) and len(bond["s_q"]) == len(state.g_q)
        model.displace(state.u_n)
        upper, lower = (evaluated(u, bond["X_qi"]) for u in model.displacement)
        assert bond["u_qi"] == pytest.approx(upper, abs=1e-13)
        assert bond["gap_q"] == pytest.approx(upper[:, 1] - lower[:, 1], abs=1e-13)
        assert np.array_equal(np.sort(bond["history_q"]), np.sort(state.k_q[:, HELD]))


def test_stress_is_that_of_the_law():
    """Linear: from the gradient of the displacement of a cell; in the thickness through both axes of the material."""
    problem = replace(DCB, kinematics="linear", degree=3)
    *_, frame = last_frame(problem)
    part, nodes = frame["cells"][0], np.linspace(0.0, 1.0, 4)
    size = np.ptp(part["X_ebI"], axis=1)
    st_nk = np.stack(np.meshgrid(nodes, nodes), -1).reshape(-1, 2)
    h = 1e-5
    back = np.argsort(vtk_order((3, 3)))
    H = [
        (shapes(3, st_nk + h * e) - shapes(3, st_nk - h * e))[:, back]
        @ part["u_ebi"]
        / (2 * h * size[:, None, k, None])
        for k, e in enumerate(np.eye(2))
    ]
    strain = np.stack([H[0][..., 0], H[1][..., 1], H[0][..., 1] + H[1][..., 0]], -1)
    stress = strain @ problem.elasticity_IJ
    assert part["stress_eqv"] == pytest.approx(stress, abs=1e-6 * np.abs(stress).max())
    assert np.array_equal(part["along_eqk"], part["stress_eqv"][..., :2])


@pytest.mark.parametrize("ranks", [2])
def test_more_ranks_write_the_frames_of_one(ranks, tmp_path):
    sets = ("load.opening=0.5", "discretization.steps=4", "dolfinx.elements=28")
    words = ["-m", "verify", "solve", "dcb-czm1", "--method", "dolfinx", "--fields", "--frames", "2"]
    words += [word for one in sets for word in ("--set", one)]
    assert main([*words[2:], "--out", str(tmp_path / "1")]) == 0
    on_ranks(ranks, *words, "--out", str(tmp_path / str(ranks)))
    for n in (1, ranks):
        assert json.loads((tmp_path / str(n) / "result.json").read_text())["status"] == "complete"
    for name in ("fields_0002.vtu", "interface_0002.vtu"):
        one, more = (arrays(tmp_path / str(n) / "frames" / name)[0] for n in (1, ranks))
        assert one.keys() == more.keys()
        for key in one:
            size = max(np.abs(one[key]).max(), 1e-6)
            assert np.abs(one[key] - more[key]).max() < 1e-6 * size, (name, key)
