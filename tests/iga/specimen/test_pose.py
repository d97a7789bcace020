"""Wherever a specimen lies, it tells the same of itself."""

from dataclasses import replace

import numpy as np
import pytest
from specimens import PAPER

from iga.dcb import build, solve
from iga.mesh.mirror import from_behind
from tests.iga.elements.test_bulk import unit_square, warped

#: Orthotropic, so that the axes of the material have to turn with the specimen.
FLAT = replace(PAPER, E2=9e3, G12=5e3, nu12=0.3, opening=(0.8,), snapshot_openings=(0.8,), dofs=400, steps=20)

POSED = {"angle": 37.0, "mirror": True, "shift": (1e4, -3e3)}

#: Columns that vanish in a perfect specimen, and what they are small against: force x length.
SMALL = {
    "reaction_x": "load",
    "reaction_y": "load",
    "load_moment": "load",
    "interface_moment": "load",
    "end_opening": "tip_opening",
}


FLATS = [("finite", "nurbs"), ("linear", "nurbs"), ("finite", "lagrange"), ("finite", "tspline")]


def column(solution, name):
    return np.array([row[name] for row in solution.rows])


@pytest.fixture(scope="module", params=FLATS, ids="-".join)
def flat(request):
    kinematics, basis = request.param
    problem = replace(FLAT, kinematics=kinematics, basis=basis)
    return problem, solve(problem)


def test_rows_are_the_same_in_any_pose(flat):
    problem, there = flat
    here = solve(replace(problem, **POSED))
    assert len(here.rows) == len(there.rows)
    for name in set(there.rows[0]) - {"newton_iterations", "residual"}:
        scale = np.abs(column(there, SMALL.get(name, name))).max()
        assert np.max(np.abs(column(here, name) - column(there, name))) < 1e-8 * scale, name


def test_snapshots_are_in_the_own_frame(flat):
    problem, there = flat
    (here,), (plain,) = (map(vars, run.snapshots) for run in (solve(replace(problem, **POSED)), there))
    for name in ("s_q", "gap_q", "traction_q", "damage_q"):
        assert np.allclose(here[name], plain[name], rtol=0.0, atol=1e-7 * np.abs(plain[name]).max()), name
    back = np.s_[:, :, ::-1]  # a mirrored mesh runs backwards
    for name in ("X_euvi", "u_euvi", "stress_euv"):
        assert np.allclose(here[name][back], plain[name], rtol=0.0, atol=1e-7 * np.abs(plain[name]).max()), name


def test_the_specimen_really_lies_there():
    P_AI = build(replace(FLAT, **POSED)).system.interface.P_AI
    middle = 0.5 * (P_AI.min(0) + P_AI.max(0)) - (1e4, -3e3)
    c, s = np.cos(np.radians(37.0)), np.sin(np.radians(37.0))
    assert np.allclose(middle, [-7.0 * c, -7.0 * s], atol=1e-9)
    assert np.allclose(np.ptp(P_AI, axis=0), [14.0 * c + 0.4 * s, 14.0 * s + 0.4 * c], atol=1e-9)


@pytest.mark.parametrize("kind", ["nurbs", "lagrange"])
def test_a_mesh_from_behind_is_the_same_body(kind):
    mesh = warped(unit_square(kind, 3, 2), 0.05)
    back = from_behind(mesh)
    for name, chain in mesh.chains.items():
        assert set(back.chains[name].side_c) == {{"left": "RIGHT", "right": "LEFT"}.get(name, name.upper())}
        assert set(back.chains[name].element_c) == set(chain.element_c)
    (one,), (other,) = mesh.blocks, back.blocks
    assert np.allclose(one.C_eab.reshape(-1, 16, 4, 4)[..., ::-1].reshape(one.C_eab.shape), other.C_eab)
