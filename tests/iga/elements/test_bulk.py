"""The solid: derivatives against differences, rigid motion, patch test, convergence rates."""

import numpy as np
import pytest

from iga.bases.names import BASES
from iga.elements.bulk import element_forces, element_stiffness, full_matrices, gradient, stiffness_entries
from iga.elements.elasticity import isotropic, orthotropic
from iga.elements.kinematics import KINEMATICS, PAIRS, finite_cauchy, finite_moduli, finite_stress
from iga.elements.shape_functions import block_basis
from iga.interface.contact import dofs
from iga.mesh.extraction import Mesh
from iga.mesh.quadrature import gauss, square
from iga.specimen.tmesh_strip import Strip, strip_tmesh
from iga.tsplines.tspline import tspline_rectangle

D_GENERIC = orthotropic(130.0, 9.0, 5.0, 0.3, "stress")


def test_plane_stress_and_strain_matrices_of_an_isotropic_solid():
    E, nu = 3.0, 0.3
    stress = E / (1 - nu**2) * np.array([[1, nu, 0], [nu, 1, 0], [0, 0, (1 - nu) / 2]])
    strain = E / ((1 + nu) * (1 - 2 * nu)) * np.array([[1 - nu, nu, 0], [nu, 1 - nu, 0], [0, 0, (1 - 2 * nu) / 2]])
    assert np.allclose(isotropic(E, nu, "stress"), stress, rtol=1e-13)
    assert np.allclose(isotropic(E, nu, "strain"), strain, rtol=1e-13)


def test_constants_that_store_negative_energy_are_refused():
    with pytest.raises(ValueError, match="negative energy"):
        orthotropic(1.0, 10.0, 1.0, 0.9, "strain")


@pytest.mark.parametrize("kinematics", KINEMATICS)
def test_stress_is_the_derivative_of_energy_and_the_tangent_that_of_stress(kinematics, rng):
    law, h = KINEMATICS[kinematics], 1e-6
    H = 0.3 * rng.standard_normal((2, 2, 11))
    P, A_nIpJ = law.stress(D_GENERIC, H)[0], law.moduli(D_GENERIC, H)
    for j in range(2):
        for J in range(2):
            step = np.zeros_like(H)
            step[j, J] = h
            (P1, W1), (P0, W0) = law.stress(D_GENERIC, H + step), law.stress(D_GENERIC, H - step)
            assert np.max(np.abs((W1 - W0) / (2 * h) - P[j, J])) < 1e-6 * np.max(np.abs(P))
            for p, (i, other) in enumerate(PAIRS):
                if other == j:
                    rate = ((P1 - P0) / (2 * h))[i]
                    assert np.max(np.abs(rate - A_nIpJ[:, :, p, J].T)) < 1e-6 * np.max(np.abs(A_nIpJ))


@pytest.mark.parametrize("angle", [1e-3, 0.7, np.pi])
def test_a_rigid_rotation_is_free_of_stress(angle):
    R = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    P, W = finite_stress(D_GENERIC, (R - np.eye(2))[..., None])
    assert np.max(np.abs(P)) < 1e-13 * D_GENERIC.max() and abs(W[0]) < 1e-25 * D_GENERIC.max()


def test_cauchy_stress_turns_with_the_body(rng):
    H = 0.2 * rng.standard_normal((2, 2, 5))
    Q = np.array([[0.6, -0.8], [0.8, 0.6]])
    turned = np.einsum("ij,jIn->iIn", Q, H + np.eye(2)[..., None]) - np.eye(2)[..., None]
    expected = np.einsum("ik,kln,jl->ijn", Q, finite_cauchy(D_GENERIC, H), Q)
    assert np.allclose(finite_cauchy(D_GENERIC, turned), expected, rtol=1e-12, atol=1e-12)


def warped(mesh: Mesh, amount: float) -> Mesh:
    """The same mesh with its inner control points moved: elements are no longer rectangles."""
    X, Y = mesh.P_AI.T
    bump = amount * np.sin(np.pi * X) * np.sin(np.pi * Y)
    return Mesh(mesh.P_AI + np.stack([bump, -0.7 * bump], -1), mesh.w_A, mesh.blocks, mesh.chains)


def unit_square(kind: str, degree: int, elements: int) -> Mesh:
    breaks = np.linspace(0.0, 1.0, elements + 1)
    if BASES[kind].local:
        return tspline_rectangle(strip_tmesh(Strip(breaks, np.arange(elements) % 2 == 0, 2), (0.0, 1.0), top=False))
    return BASES[kind].rectangle((degree, degree), breaks, breaks)


def with_weights(mesh: Mesh, rng) -> Mesh:
    return Mesh(mesh.P_AI, rng.uniform(0.7, 1.4, len(mesh.P_AI)), mesh.blocks, mesh.chains)


@pytest.mark.parametrize("kinematics", KINEMATICS)
@pytest.mark.parametrize(
    ("kind", "degree"),
    [(kind, degree) for kind, basis in BASES.items() for degree in basis.degrees]
    + [("rational tspline", 3), *(("rational nurbs", degree) for degree in BASES["nurbs"].degrees)],
)
def test_patch(kind, degree, kinematics, rng):
    """A linear field on warped elements: constant stress, and no force on any inner control point."""
    mesh = warped(unit_square(kind.split()[-1], degree, 3), 0.05)
    mesh = with_weights(mesh, rng) if "rational" in kind else mesh
    inside = np.all((mesh.P_AI > 1e-9) & (mesh.P_AI < 1 - 1e-9), axis=1)
    u, stress = mesh.P_AI @ np.array([[0.05, -0.02], [0.03, 0.04]]), []
    f = np.zeros_like(u)
    for block in mesh.blocks:
        basis = block_basis(mesh, block, *square(gauss(14), gauss(14)))
        P, _ = KINEMATICS[kinematics].stress(D_GENERIC, gradient(basis, u))
        stress.append(P.reshape(2, 2, -1))
        np.add.at(f, basis.conn_ea, element_forces(basis, P))
    P = np.concatenate(stress, axis=-1)
    assert np.ptp(P, axis=2).max() < 1e-10 * np.abs(P).max()
    assert np.abs(f[inside]).max() < 1e-10 * np.abs(f).max()


@pytest.mark.parametrize("kind", ["nurbs", "lagrange"])
def test_element_stiffness_is_the_derivative_of_the_element_forces(kind, rng):
    mesh = warped(unit_square(kind, 3, 2), 0.05)
    basis = block_basis(mesh, mesh.blocks[0], *square(gauss(4), gauss(4)))
    u, v, h = 0.1 * rng.standard_normal(mesh.P_AI.shape), rng.standard_normal(mesh.P_AI.shape), 1e-6

    def forces(u):
        return element_forces(basis, finite_stress(D_GENERIC, gradient(basis, u))[0])

    K = element_stiffness(basis, finite_moduli(D_GENERIC, gradient(basis, u)))
    d = dofs(basis.conn_ea)
    expected = ((forces(u + h * v) - forces(u - h * v)) / (2 * h)).reshape(len(d), -1)
    full = full_matrices(K)
    assert np.allclose((full @ v.ravel()[d][..., None])[..., 0], expected, rtol=0, atol=1e-6 * np.abs(expected).max())
    assert np.allclose(full, full.swapaxes(1, 2), rtol=0, atol=1e-12 * np.abs(full).max())
    row, column = stiffness_entries(basis.conn_ea)
    n = u.size
    values = np.concatenate([K, K[:, :, 1:2]], axis=2).ravel()
    scattered = np.bincount((row * n + column).ravel(), values, n * n).reshape(n, n)
    direct = np.zeros((n, n))
    np.add.at(direct, (d[:, :, None], d[:, None, :]), full)
    assert np.allclose(scattered, direct, rtol=0, atol=1e-12 * np.abs(direct).max())


def test_a_matrix_that_all_share_cannot_be_changed():
    with pytest.raises(ValueError, match="read-only"):
        isotropic(120e3, 0.2, "stress")[0, 0] = 0.0
