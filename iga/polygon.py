"""Regular polygons as unstructured meshes: N sectors of squares around one extraordinary point."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from iga.bspline import open_knots
from iga.extraction import Chain, Mesh
from iga.unstructured import unstructured_mesh


def polygon_mesh(corners: int, n: int, radius: float = 1.0) -> Mesh:
    """Regular polygon about the origin, n x n elements in each sector, with chains ``edge-0`` ... counterclockwise."""
    mesh = unstructured_mesh(*polygon_control(corners, n, radius))
    return replace(mesh, chains=dict(mesh.chains) | _edges(mesh.chains["boundary"], corners))


def polygon_control(corners: int, n: int, radius: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Control points (n_A, 2) and faces (n_f, 4) of a polygon, faces in the order sector, t, s.

    A sector is the quadrilateral of centre, middle of one edge, corner, middle of the next edge. Its control points are
    those that make the bilinear map in the knots, with a ring of zero intervals along the outline, which is exact. The
    centre is an ordinary point for four corners.

    Raises
    ------
    ValueError : fewer than 3 corners, or fewer than 1 element.
    """
    if corners < 3 or n < 1:
        raise ValueError(f"a polygon needs at least 3 corners and 1 element a sector side, got {corners} and {n}")
    reach = open_knots(np.linspace(-1.0, 1.0, 2 * n + 1), 3).greville[n + 1 :]  # n + 2 values, from 0 to 1
    t, s = np.meshgrid(reach, reach, indexing="ij")
    corner = radius * np.exp(2j * np.pi / corners * np.arange(corners))[:, None, None]
    before, after = 0.5 * (corner + np.roll(corner, 1, axis=0)), 0.5 * (corner + np.roll(corner, -1, axis=0))
    z_kji = s * (1 - t) * before + s * t * corner + (1 - s) * t * after
    number_kji = _numbers(corners, n + 2)
    z_A = np.empty(number_kji.max() + 1, dtype=complex)
    z_A[number_kji] = z_kji
    around = (number_kji[:, :-1, :-1], number_kji[:, :-1, 1:], number_kji[:, 1:, 1:], number_kji[:, 1:, :-1])
    return np.stack([z_A.real, z_A.imag], -1), np.stack(around, -1).reshape(-1, 4)


def _numbers(corners: int, m: int) -> np.ndarray:
    """Vertex numbers (corners, m, m) [sector, t, s]: the centre is 0, the row s = 0 is the next sector's row t = 0."""
    own = 1 + np.arange(corners * (m - 1) * m).reshape(corners, m, m - 1)  # s > 0
    spoke = np.roll(own, -1, axis=0)[:, 0, :]
    left = np.concatenate([np.zeros((corners, 1), dtype=int), spoke], axis=1)
    return np.concatenate([left[:, :, None], own], axis=2)


def _edges(outline: Chain, corners: int) -> dict[str, Chain]:
    """The outline cut at its corners, which are where one element has two sides in it."""
    same = (np.roll(outline.block_c, 1) == outline.block_c) & (np.roll(outline.element_c, 1) == outline.element_c)
    first = np.flatnonzero(same)[0]
    order = np.roll(np.arange(same.size), -first).reshape(corners, -1)
    chains = (Chain(outline.block_c[c], outline.element_c[c], outline.side_c[c], outline.outward) for c in order)
    return {f"edge-{i}": chain for i, chain in enumerate(chains)}
