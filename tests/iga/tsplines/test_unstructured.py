"""Unstructured control meshes: equal to tensor products where they are one, and what an extraordinary point leaves."""

import numpy as np
import pytest
from unstructured import polygon_mesh, unstructured_mesh

from iga.bases.bspline import open_knots
from iga.bases.nurbs import nurbs_rectangle
from iga.elements.shape_functions import block_basis
from iga.mesh.quadrature import gauss, square

#: Bernstein indices of a bicubic element on its four sides counterclockwise, from the side inwards (3 layers, 4).
TABLE = np.arange(16).reshape(4, 4)
LAYERS = [np.rot90(TABLE, k)[:3] for k in (0, 1, 2, 3)]  # BOTTOM, RIGHT, TOP, LEFT, each in walking order


def structured(turn):
    """The same rectangle as a tensor product and as a bag of faces, each turned as it comes."""
    kv_s, kv_t = open_knots(np.linspace(0, 4, 5), 3), open_knots(np.linspace(0, 3, 4), 3)
    k = np.arange(kv_s.functions * kv_t.functions).reshape(kv_t.functions, kv_s.functions)
    faces = np.stack([k[:-1, :-1], k[:-1, 1:], k[1:, 1:], k[1:, :-1]], -1).reshape(-1, 4)
    return nurbs_rectangle(kv_s, kv_t), np.roll(faces, -turn, axis=1)


def rows(mesh):
    """All Bezier points as rows over the control points (n_e, 16, n_A)."""
    parts = []
    for block in mesh.blocks:
        part = np.zeros((len(block.conn_ea), 16, len(mesh.P_AI)))
        np.put_along_axis(part, block.conn_ea[:, None, :].repeat(16, 1), block.C_eab.swapaxes(1, 2), axis=2)
        parts.append(part)
    return np.concatenate(parts)


@pytest.mark.parametrize("turn", [0, 1, 2, 3])
def test_a_structured_mesh_gives_the_tensor_product(turn):
    tensor, faces = structured(turn)
    mesh = unstructured_mesh(tensor.P_AI, faces)
    assert len(mesh.blocks) == 1 and mesh.blocks[0].conn_ea.shape == tensor.blocks[0].conn_ea.shape
    corners = TABLE[[0, 0, -1, -1], [0, -1, -1, 0]]
    assert np.max(np.abs(rows(mesh)[:, np.roll(corners, turn)] - rows(tensor)[:, corners])) < 1e-14
    turned = np.rot90(TABLE, turn).ravel()  # Bernstein index of the tensor product, from that of the turned face
    assert np.max(np.abs(rows(mesh) - rows(tensor)[:, turned])) < 1e-14


@pytest.mark.parametrize("corners", [3, 4, 5, 6])
def test_functions_around_an_extraordinary_point(corners):
    """2 N + 8 of them, a partition of unity, independent, and an exact outline."""
    mesh = polygon_mesh(corners, 3)
    at_centre = [len(b.conn_ea) for b in mesh.blocks if b.conn_ea.shape[1] == 2 * corners + 8]
    assert at_centre == ([corners] if corners != 4 else [mesh.elements])
    all_rows = rows(mesh)
    assert np.max(np.abs(all_rows.sum(2) - 1.0)) < 1e-15
    sizes = np.linalg.svd(all_rows.reshape(-1, len(mesh.P_AI)), compute_uv=False)
    assert sizes.size == len(mesh.P_AI) and sizes[-1] > 0.02 * sizes[0]
    area = sum(np.sum(block_basis(mesh, block, *square(gauss(4), gauss(4))).dV_eq) for block in mesh.blocks)
    assert area == pytest.approx(corners / 2 * np.sin(2 * np.pi / corners), rel=1e-14)


@pytest.mark.parametrize("corners", [3, 4, 5, 6])
def test_continuity_between_elements(corners):
    """C2 away from the centre, C1 on the edges that end opposite to it, C0 on its spokes: jumps of all functions."""
    mesh = polygon_mesh(corners, 4)
    all_rows = rows(mesh)
    centre = np.argmin(np.linalg.norm(all_rows @ mesh.P_AI, axis=2)[:, TABLE[[0, 0, -1, -1], [0, -1, -1, 0]]], axis=1)
    radius = np.linalg.norm(all_rows @ mesh.P_AI, axis=2).min(1)
    assert np.count_nonzero(radius < 1e-14) == corners and np.all(centre[radius < 1e-14] == 0)
    side = np.stack([all_rows[:, layers] for layers in LAYERS], axis=1)  # (n_e, 4 sides, 3 layers, 4, n_A)
    flat = side.reshape(-1, 3, 4, len(mesh.P_AI))
    ends = np.round(flat[:, 0] @ mesh.P_AI, 9) + 0.0
    of = {(tuple(e[0]), tuple(e[-1])): i for i, e in enumerate(ends)}
    pairs = [(i, of[b, a]) for (a, b), i in of.items() if (b, a) in of and a < b]
    assert len(pairs) == 2 * 16 * corners - 4 * corners
    jump = np.array([[_jumps(flat[i], flat[j])] for i, j in pairs])[:, 0]
    distance = np.array([np.sort(np.linalg.norm(ends[i, [0, -1]], axis=1)) for i, _ in pairs])
    spoke = distance[:, 0] < 1e-9
    near = ~spoke & np.array([min(radius[i // 4], radius[j // 4]) < 1e-14 for i, j in pairs])
    assert np.count_nonzero(spoke) == corners and np.count_nonzero(near) == 2 * corners
    assert np.max(jump[:, 0]) < 1e-15
    assert np.max(jump[~spoke, 1]) < 1e-14
    assert np.max(jump[~spoke & ~near, 2]) < 1e-13
    if corners == 4:
        assert np.max(jump[:, 1:]) < 1e-13
    else:
        assert np.min(jump[spoke, 1]) > 0.05


def _jumps(one, other):
    """Largest jumps of value, derivative and second derivative across a side, for all functions and along it."""
    other = other[:, ::-1]
    outward = [3 * (s[0] - s[1]) for s in (one, other)]
    second = [6 * (s[0] - 2 * s[1] + s[2]) for s in (one, other)]
    jumps = (one[0] - other[0], outward[0] + outward[1], second[0] - second[1])
    return [np.max(np.abs(j)) for j in jumps]
