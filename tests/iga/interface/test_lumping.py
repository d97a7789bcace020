"""Control-point lumping: exact for what is uniform, areas that add up, a tangent, and meshes that it refuses."""

from dataclasses import replace

import numpy as np
import pytest

from iga.bases.lagrange import lagrange_rectangle
from iga.dcb import Problem, build, solve
from iga.delamination.meshes import drawn
from iga.interface.interface import Interface, SearchedInterface
from iga.interface.lumping import lumped
from iga.interface.response import forces, stiffness, traction
from iga.interface.surface import surface
from iga.laws.law import History

PROBLEM = Problem(
    length=6.0,
    arm_thickness=0.5,
    precrack=2.0,
    E1=1000.0,
    E2=900.0,
    G12=300.0,
    nu12=0.2,
    strength=4.0,
    toughness=0.4,
    ductility=4.0,
    penalty=5e3,
    opening=(1.0,),
    width=1.5,
    dofs=900,
    interface_rule="lumped",
)
BONDED = (PROBLEM.length - PROBLEM.precrack) * PROBLEM.width
degrees = pytest.mark.parametrize("degree", [1, 2, 3, 4, 5])
bases = pytest.mark.parametrize("basis", ["nurbs", "lagrange"])


def gauss_twin(problem: Problem) -> Interface:
    """Gauss points on the same meshes."""
    meshes = drawn(problem).meshes
    rule = replace(problem, interface_rule="gauss", interface_points=problem.degree + 1, meshes=meshes)
    return build(rule).system.interface


def lifted(interface: Interface, jump_Ai: np.ndarray, symmetry: bool) -> np.ndarray:
    """Displacements (n_dof,): the upper arm by all of the jump, or half of it where its mirror image takes the rest."""
    u_Ai = np.zeros_like(interface.P_AI)
    upper = slice(0, len(u_Ai) // (1 if symmetry else 2))
    u_Ai[upper] = (0.5 if symmetry else 1.0) * jump_Ai[upper]
    return u_Ai.ravel()


@degrees
@bases
@pytest.mark.parametrize("slave", ["upper", "lower"])
def test_areas_add_up_and_the_gap_is_the_jump(basis, degree, slave):
    problem = replace(PROBLEM, basis=basis, degree=degree, slave=slave)
    interface = build(problem).system.interface
    assert interface.dA_q.sum() == pytest.approx(BONDED, rel=1e-12) and np.all(interface.dA_q > 0)
    assert np.all(np.diff(interface.X_qi[:, 0]) > 0)
    jump = np.stack([0.3 + 0 * interface.P_AI[:, 0], 0.01 * interface.P_AI[:, 0] ** 2], -1)
    touch = interface.contact(lifted(interface, jump, False), None)
    assert np.allclose(touch.g_q, 0.01 * interface.X_qi[:, 0] ** 2, rtol=1e-12)
    assert np.allclose(touch.n_qi, [0.0, 1.0 if slave == "upper" else -1.0], atol=1e-12)


@degrees
@bases
@pytest.mark.parametrize("symmetry", [False, True])
def test_a_uniform_gap_gives_the_forces_of_gauss_point_for_point(basis, degree, symmetry):
    problem = replace(PROBLEM, basis=basis, degree=degree, symmetry=symmetry, kinematics="linear")
    by_points, by_nodes = gauss_twin(problem), build(problem).system.interface
    law, R = by_nodes.law, []
    u = lifted(by_nodes, np.broadcast_to([0.0, 0.7 * law.g_max], by_nodes.P_AI.shape), symmetry)
    for interface in (by_points, by_nodes):
        touch = interface.contact(u, interface.pairing)
        pull = traction(interface, touch, interface.start(), touch.g_q < 0)
        assert np.allclose(touch.g_q, 0.7 * law.g_max, rtol=1e-12)
        R.append(forces(interface, touch, pull, u.size))
    assert np.allclose(R[0], R[1], rtol=0, atol=1e-12 * np.abs(R[0]).max())
    assert np.abs(R[1]).sum() / 2.0 == pytest.approx(0.7 * law.pure_modes[0][0] * BONDED, rel=1e-12)


@pytest.mark.parametrize("symmetry", [False, True])
@bases
@degrees
def test_tangent_against_a_central_difference(degree, basis, symmetry, rng):
    system = build(replace(PROBLEM, basis=basis, degree=degree, symmetry=symmetry)).system
    interface, law, h = system.interface, system.interface.law, 1e-7
    u = 1e-3 * rng.standard_normal(system.n_dof)
    k = law.g_max * rng.uniform(0.0, 3.0, interface.points)
    closed = interface.contact(u, None).g_q < 0
    assert closed.any() and not closed.all()

    def residual(u):
        touch = interface.contact(u, None)
        return forces(interface, touch, traction(interface, touch, History(k), closed), system.n_dof)

    touch = interface.contact(u, None)
    pull = traction(interface, touch, History(k), closed)
    d, matrix = touch.dof_qd, np.zeros((system.n_dof, system.n_dof))
    np.add.at(matrix, (d[:, :, None], d[:, None, :]), stiffness(interface, touch, pull))
    v = rng.standard_normal(system.n_dof)
    difference = (residual(u + h * v) - residual(u - h * v)) / (2 * h)
    assert np.allclose(matrix @ v, difference, rtol=0, atol=1e-6 * np.abs(difference).max())
    assert np.allclose(matrix, matrix.T)


def test_meshes_that_do_not_match_are_refused():
    P_AI, surfaces, first = [], [], 0
    for columns, bottom, side in ((4, 0.0, "bottom"), (5, -1.0, "top")):
        mesh = lagrange_rectangle(np.linspace(0, 3, columns), bottom + np.array([0.0, 1.0]), 1)
        surfaces.append(surface(mesh, mesh.chains[side], first))
        P_AI.append(mesh.P_AI)
        first += len(mesh.P_AI)
    slave, master = surfaces
    xi = np.full(slave.sides, 0.5)
    (r,) = slave.coefficients(np.arange(slave.sides), xi, 0)
    P_AI, N_qa = np.concatenate(P_AI), slave.functions(np.arange(slave.sides), r)
    X_qi = np.einsum("qa,qai->qi", N_qa, P_AI[slave.conn_ca])
    law = build(PROBLEM).system.interface.law
    with pytest.raises(ValueError, match='"gauss" or "lobatto" .* .4 control points on .*"lumped"'):
        lumped(
            SearchedInterface(
                N_qa=N_qa,
                dN_qa=np.zeros_like(N_qa),
                d2N_qa=np.zeros_like(N_qa),
                conn_qa=slave.conn_ca,
                dA_q=np.ones(slave.sides),
                X_qi=X_qi,
                P_AI=P_AI,
                law=law,
                bonded_q=np.ones(slave.sides, dtype=bool),
                forward_i=np.array([1.0, 0.0]),
                master=master,
            )
        )


def test_a_control_point_without_an_area_is_refused():
    interface = gauss_twin(PROBLEM)
    beyond_q = interface.X_qi[:, 0] > np.median(interface.X_qi[:, 0])
    away = replace(interface, dA_q=np.where(beyond_q, 0.0, interface.dA_q))
    with pytest.raises(ValueError, match='"gauss" or "lobatto" where a control point has no positive area, got "lump'):
        lumped(away)


@bases
def test_one_arm_against_its_mirror_image_is_the_whole(basis):
    rows = [
        solve(replace(PROBLEM, basis=basis, symmetry=symmetry, opening=(0.5,), steps=5, dofs=512)).rows
        for symmetry in (False, True)
    ]
    loads = [np.array([row["load"] for row in part]) for part in rows]
    assert np.allclose(loads[0], loads[1], rtol=1e-6)
