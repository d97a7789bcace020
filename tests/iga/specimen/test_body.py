"""Points of the elements of a body: exact on elements that are only continuous, few where the basis is smooth."""

from dataclasses import replace

import numpy as np
import pytest
from specimens import PAPER

import iga.specimen.body
from iga.dcb import build
from iga.elements.bulk import gradient
from iga.elements.kinematics import KINEMATICS
from iga.elements.shape_functions import block_basis
from iga.mesh.extraction import Mesh
from iga.mesh.quadrature import gauss, square
from iga.specimen.body import Body

LENGTH, THICKNESS = PAPER.length, PAPER.arm_thickness


def coefficients(mesh: Mesh) -> np.ndarray:
    """Control points' displacements of u_X = (X / L)^3 Y, u_Y = 0, which every cubic basis holds."""
    rows, values = [], []
    for block in mesh.blocks:
        basis = block_basis(mesh, block, *square(gauss(6), gauss(6)))
        X, Y = np.moveaxis(np.einsum("eqa,eaI->eqI", basis.N_eqa, mesh.P_AI[basis.conn_ea]), -1, 0)
        row = np.zeros((X.size, len(mesh.P_AI)))
        points = np.arange(X.size).reshape(X.shape)
        np.add.at(row, (points[..., None], basis.conn_ea[:, None, :]), basis.N_eqa)
        rows.append(row)
        values.append(((X / LENGTH) ** 3 * Y).ravel())
    u_A = np.linalg.lstsq(np.concatenate(rows), np.concatenate(values), rcond=None)[0]
    return np.stack([u_A, 0.0 * u_A], axis=1)


def stored(body: Body) -> float:
    """Energy of the field above by the body's own points."""
    u_Ai, law = coefficients(body.mesh), KINEMATICS["linear"]
    whole = [law.stress(solid.D, gradient(solid.basis, u_Ai))[1] * solid.basis.dV_eq for solid in body.solids]
    return float(sum(part.sum() for part in whole))


def exact(D: np.ndarray) -> float:
    """int (D_11 (3 X^2 Y / L^3)^2 + G (X / L)^6) / 2 over an arm of width 1 above Y = 0."""
    strain = 9.0 / LENGTH * THICKNESS**3 / 15.0
    return 0.5 * (D[0, 0] * strain + D[2, 2] * LENGTH * THICKNESS / 7.0)


def upper(**changes: object) -> Body:
    return build(replace(PAPER, **changes)).bodies[0]


def along(body: Body) -> set[int]:
    """Points an element along the specimen: all of them, less those through its thickness."""
    through = [block.degrees[1] + 1 for block in body.mesh.blocks]
    return {solid.basis.N_eqa.shape[1] // n for solid, n in zip(body.solids, through, strict=True)}


@pytest.mark.parametrize("given", [False, True])
def test_continuous_elements_have_the_energy_of_a_cubic_field_exactly(given):
    """Of a mesh that somebody gives nothing is known: it is taken for one that is only continuous."""
    meshes = build(replace(PAPER, basis="nurbs", dofs=2000)).bodies if given else ()
    arms = tuple(body.mesh for body in meshes)
    body = upper(meshes=arms, basis="nurbs") if given else upper(basis="lagrange", dofs=2000)
    assert along(body) == {4}
    assert stored(body) == pytest.approx(exact(body.D), rel=1e-10)


@pytest.mark.parametrize("basis", ["nurbs", "tspline"])
def test_smooth_elements_need_a_point_less_along_the_specimen_and_keep_the_order(basis):
    """The only term that three points do not hold is X^6: its error is of the sixth order in the elements' length."""
    body = upper(basis=basis, dofs=2000)
    assert along(body) == {3}
    assert stored(body) == pytest.approx(exact(body.D), rel=1e-5)


def test_smooth_linear_elements_keep_two_points():
    assert along(upper(basis="nurbs", degree=1)) == {2} and along(upper(basis="nurbs", degree=2)) == {2}
    assert along(upper(basis="lagrange", degree=1)) == {2} and along(upper(basis="lagrange", degree=2)) == {3}


ALIKE = [
    pytest.param({}, True, id="two equal arms"),
    pytest.param({"basis": "lagrange", "angle": 37.0, "shift": (3.0, -2.0)}, True, id="turned and moved"),
    pytest.param({"mirror": True}, True, id="mirrored"),
    pytest.param({"mismatch": 1.4}, False, id="other elements"),
    pytest.param({"basis": "tspline"}, False, id="finer towards the other arm"),
]


@pytest.mark.parametrize(("changes", "alike"), ALIKE)
def test_a_body_that_is_another_one_moved_has_the_bases_that_it_would_make_itself(changes, alike, monkeypatch):
    problem = replace(PAPER, **({"basis": "nurbs", "dofs": 480} | changes))
    upper, lower = build(problem).bodies
    assert (lower.solids[0].basis.N_eqa is upper.solids[0].basis.N_eqa) == alike
    monkeypatch.setattr(iga.specimen.body, "_alike", lambda *_: False)
    _, own = build(problem).bodies
    pairs = [(a.basis, b.basis) for a, b in zip(lower.solids + lower.sampled, own.solids + own.sampled, strict=True)]
    for name in ("left", "right"):
        pairs += zip(lower.ends[name], own.ends[name], strict=True)
    for taken, made in pairs:
        assert np.array_equal(taken.conn_ea, made.conn_ea)
        for field in ("N_eqa", "dN_eqIa", "dV_eq", "X_eqI"):
            a, b = getattr(taken, field), getattr(made, field)
            assert np.abs(a - b).max() <= 1e-13 * np.abs(b).max()


def test_the_energy_of_an_end_in_small_strains_is_that_of_its_stresses(rng):
    specimen = build(replace(PAPER, basis="nurbs", kinematics="linear"))
    u_d, law = rng.normal(size=specimen.system.n_dof), KINEMATICS["linear"]
    ends = [(side, gradient(side.basis, u_d.reshape(-1, 2))) for side in specimen.ends.solids]
    by_stress = sum(float(np.sum(law.stress(side.D, H)[1] * side.basis.dV_eq)) for side, H in ends)
    assert specimen.ends.energy(u_d) == pytest.approx(by_stress, rel=1e-12) and by_stress > 0.0
