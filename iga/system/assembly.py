"""Assembly of the tangent: where in its lower half the entries of elements, interface points and springs go."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.sparse import coo_array, csr_array

from iga.algebra.banded import Band, Skew
from iga.algebra.dense import Dense
from iga.elements.bulk import half_entries, half_places
from iga.interface.interface import Contact

#: Rows and columns of entries, as degrees of freedom.
Entries = tuple[np.ndarray, np.ndarray]


@dataclass(frozen=True)
class Pattern:
    """The lower half of the tangent, and where in it all entries go.

    ``bulk`` (band.size, n_values) adds up what the elements say; linear kinematics has it in place already. Of
    interface and springs ``positions`` (n_values,) are the places, of the spring across the opening ``held``.
    """

    dof_qd: np.ndarray
    band: Band | Dense
    bulk: csr_array | None
    positions: np.ndarray
    held: np.ndarray

    def half(self, K_qdd: np.ndarray, springs: np.ndarray) -> np.ndarray:
        """Lower half (band.size,) of the stiffness of points and springs, from their matrices and their entries."""
        i, j = _tril(K_qdd.shape[1])
        return np.bincount(self.positions, np.concatenate([K_qdd[:, i, j].ravel(), springs]), self.band.size)


def pattern_of(
    numbering: Band | Dense,
    dof_qd: np.ndarray,
    springs: Entries,
    loaded: np.ndarray,
    conns: Sequence[np.ndarray],
    kept: Pattern | None,
) -> Pattern:
    """Where all entries go when the points touch dof_qd; wider than ``numbering`` where one has slid too far for it.

    Parameters
    ----------
    springs : their entries in the lower half.
    loaded : degrees of freedom that feel the load.
    conns : control points (n_e, n_a) of the elements of each block whose stiffness is not in place already.
    kept : the last pattern; the same sums over elements serve a band as wide.
    """
    touching = lower_half(dof_qd)
    band = numbering.reaching(*touching)
    if not conns:
        bulk = None
    elif kept is not None and kept.band.size == band.size:
        bulk = kept.bulk
    else:
        bulk = element_sums(conns, band)
    return Pattern(dof_qd, band, bulk, _positions(band, touching, springs), _positions(band, lower_half(loaded)))


def element_sums(conns: Sequence[np.ndarray], band: Band | Dense) -> csr_array:
    """Sums (band.size, n_values) of the entries of the element stiffness, of each symmetric pair one."""
    places, columns, first = [], [], 0
    for conn_ea in conns:
        n_e, n_a = conn_ea.shape
        places.append(_positions(band, half_entries(conn_ea)))
        columns.append((first + np.arange(n_e)[:, None] * 3 * n_a**2 + half_places(n_a)).ravel())
        first += 3 * n_e * n_a**2
    place, column = (np.concatenate(parts).astype(np.int32) for parts in (places, columns))
    return coo_array((np.ones(place.size), (place, column)), shape=(band.size, first)).tocsr()


def element_values(parts: Sequence[np.ndarray]) -> np.ndarray:
    """Entries (n_values,) of the element stiffness of all blocks."""
    return parts[0].ravel() if len(parts) == 1 else np.concatenate([K.ravel() for K in parts])


def spring_entries(springs_rd: np.ndarray, spring_r: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rows, columns and values that springs add to the lower half of the tangent."""
    parts = [np.zeros((3, 0))]
    for a_d, k in zip(springs_rd, spring_r, strict=True):
        row, column = lower_half(np.flatnonzero(a_d))
        parts.append(np.stack([row, column, k * a_d[row] * a_d[column]]))
    row, column, value = np.concatenate(parts, axis=1)
    return row.astype(int), column.astype(int), value


def skew_part(touch: Contact, p_q: np.ndarray, K_qdd: np.ndarray) -> Skew | None:
    """What the upper half has more than the lower one: something only at points that slide off the master."""
    if touch.fading_q is None:
        return None
    q = np.flatnonzero(touch.fading_q * p_q)
    if q.size == 0:
        return None
    i, j = np.triu_indices(K_qdd.shape[1], 1)
    d_qd = touch.dof_qd[q]
    row, column, value = d_qd[:, i], d_qd[:, j], K_qdd[q][:, i, j] - K_qdd[q][:, j, i]
    return Skew(row.ravel(), column.ravel(), value.ravel())


def lower_half(d: np.ndarray) -> Entries:
    """Rows and columns (..., n_h) of the lower halves of matrices over the degrees of freedom (..., n_d)."""
    i, j = _tril(d.shape[-1])
    return d[..., i], d[..., j]


@cache
def _tril(n: int) -> Entries:
    return np.tril_indices(n)


def _positions(band: Band | Dense, *entries: Entries) -> np.ndarray:
    return np.concatenate([band.positions(row.ravel(), column.ravel()) for row, column in entries])
