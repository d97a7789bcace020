"""A linear bulk without the displacements away from its bond, which follow from those on the bond and the load.

With ``u_y = y`` on the bond, a load m along f, the band ``K_rr = L L'`` of the others and ``V = L^-1 [K_ry, f]``,

    V'V = [[G, b], [b', c]],      u_r = K_rr^-1 (m f - K_ry y),      a = f'u = c m - b'y

so that the stiffness of y and the opening a is ``[[K_yy - G + b b' / c, b / c], [b' / c, 1 / c]]`` (Guyan 1965).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array, csr_array, hstack

from iga.algebra.banded import Band, BandCholesky
from iga.elements.bulk import full_matrices, stiffness_of_batches
from iga.interface.contact import dofs
from iga.system.bulk import LinearBulk
from iga.system.system import System


@dataclass(frozen=True)
class Eliminated:
    """The stiffness ``K_dd`` of the displacements y of the unknowns ``kept`` (n_y,) and of the opening, and what leads
    back: the factor, ``columns_dm`` (n_dof, n_y + 1) with the stiffness between all unknowns and y, and the load."""

    K_dd: np.ndarray
    kept: np.ndarray
    factor: BandCholesky
    columns_dm: csr_array

    def __matmul__(self, y: np.ndarray) -> np.ndarray:
        """Displacements (n_dof,) of the whole for those on the bond and the opening (n_y + 1,)."""
        u_d = self.factor.solve((self.columns_dm @ np.append(-y[:-1], self.K_dd[-1] @ y))[:, None])[:, 0]
        u_d[self.kept] = y[:-1]
        return u_d


def eliminated(system: System, bulk: LinearBulk, kept: np.ndarray) -> Eliminated | None:
    """None where the load acts on the bond, where it is held, or the rest can move without a force."""
    if system.load_d[kept].any() or not system.free_d[kept].all():
        return None
    place_d, rest_d, n_y = np.full(system.n_dof, -1), system.free_d.copy(), kept.size
    place_d[kept], rest_d[kept] = np.arange(n_y), False
    band = bulk.numbering([np.flatnonzero(a_d)[None] for a_d in system.springs_rd], system.x_d, rest_d)
    assert isinstance(band, Band)
    half, springs = bulk.assembler(band)(()), system.springs
    np.add.at(half, band.positions(springs.row, springs.column), springs.value)
    factor = band.cholesky(half)
    if factor is None:
        return None
    row_rd = csr_array(system.springs_rd)
    columns_dy = csr_array(row_rd.T * system.spring_r) @ row_rd[:, kept]
    for solid in bulk.solids:
        for e, K_eapb in stiffness_of_batches(solid, bulk.kinematics.moduli):
            d = dofs(solid.basis.conn_ea[e], bulk.d)
            at = np.nonzero(place_d[d] >= 0)
            value, row = full_matrices(K_eapb)[at].ravel(), d[at[0]].ravel()
            column = np.repeat(place_d[d[at]], d.shape[1])
            columns_dy = columns_dy + csr_array(coo_array((value, (row, column)), shape=(system.n_dof, n_y)))
    columns_dm = csr_array(hstack([columns_dy, csr_array(system.load_d[:, None])]))
    products = factor.products(csr_array(columns_dm[band.dof_n]))
    b_y, c = products[:-1, -1], products[-1, -1]
    K_dd = np.block([[columns_dy[kept].toarray() - products[:-1, :-1], np.zeros((n_y, 1))], [np.zeros(n_y + 1)]])
    feels_d = np.append(b_y, 1.0)
    K_dd += np.outer(feels_d, feels_d / c)
    return Eliminated(0.5 * (K_dd + K_dd.T), kept, factor, columns_dm)
