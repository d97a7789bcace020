"""Assembly of the tangent: where in its lower half the entries of elements, interface points and springs go."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cache

import numpy as np

from iga.algebra.banded import Band, Skew
from iga.algebra.dense import Dense
from iga.elements.bulk import batches, half_entries, half_places
from iga.interface.interface import Interface
from iga.interface.response import stiffness, unsymmetric
from iga.system.state import Response

#: Rows and columns of entries, as degrees of freedom.
Entries = tuple[np.ndarray, np.ndarray]
#: Displacement gradients of the solids of a bulk.
Gradients = tuple[np.ndarray, ...]


@dataclass(frozen=True)
class Springs:
    """Springs of a system: ``row``, ``column`` and ``value`` of their entries in the lower half of the tangent.

    ``loaded`` are the degrees of freedom of one more spring, which holds the opening: those of the load.
    """

    row: np.ndarray
    column: np.ndarray
    value: np.ndarray
    loaded: np.ndarray

    @staticmethod
    def of(springs_rd: np.ndarray, spring_r: np.ndarray, loaded: np.ndarray) -> Springs:
        """Entries of springs of stiffness spring_r (n_r,) on the displacements ``springs_rd @ u`` (n_r,)."""
        parts = [np.zeros((3, 0))]
        for a_d, k in zip(springs_rd, spring_r, strict=True):
            row, column = lower_half(np.flatnonzero(a_d))
            parts.append(np.stack([row, column, k * a_d[row] * a_d[column]]))
        row, column, value = np.concatenate(parts, axis=1)
        return Springs(row.astype(int), column.astype(int), value, loaded)

    def held(self, band: Band | Dense) -> np.ndarray:
        """Places of the lower half of ``f f'``, f the load."""
        return _positions(band, lower_half(self.loaded))


@dataclass(frozen=True)
class Pattern:
    """Where all entries of the tangent go in its lower half, while the points depend on the unknowns ``dof_qd``, groups
    of ``each`` successive ones on the same.

    ``numbering`` is that of the equations, ``band`` the same as wide as these points need it, ``held`` the places of
    the spring that holds the opening. ``bulk`` makes the lower half of the stiffness of the bulk from its displacement
    gradients, a new array each time; ``positions`` are the places of interface and springs, and ``values`` the entries
    of the springs. ``twice`` are entries of the interface that count twice: they are off the diagonal of a group's own
    matrix but on the diagonal of the tangent. They occur where ``dof_qd`` names an unknown twice, as two sides of a way
    along the master share it.
    """

    dof_qd: np.ndarray
    each: int
    numbering: Band | Dense
    band: Band | Dense
    held: np.ndarray
    bulk: Callable[[Gradients], np.ndarray]
    positions: np.ndarray
    values: np.ndarray
    twice: np.ndarray

    @staticmethod
    def of(
        numbering: Band | Dense,
        dof_qd: np.ndarray,
        springs: Springs,
        assembler: Callable[[Band | Dense], Callable[[Gradients], np.ndarray]],
        kept: Pattern | None,
    ) -> Pattern:
        """The pattern of a numbering, whose band is widened where a point has slid too far for it.

        Parameters
        ----------
        assembler : makes ``bulk`` for a band.
        kept : the last pattern; its ``bulk`` serves a band of the same numbering and width.
        """
        each = in_a_row(dof_qd)
        touching = lower_half(dof_qd[::each])
        band = numbering.reaching(dof_qd)
        same = kept is not None and kept.numbering is numbering and kept.band.size == band.size
        bulk = kept.bulk if kept is not None and same else assembler(band)
        positions = _positions(band, touching, (springs.row, springs.column))
        i, j = _tril(dof_qd.shape[1])
        twice = np.flatnonzero((touching[0] == touching[1]) & (i != j))
        return Pattern(dof_qd, each, numbering, band, springs.held(band), bulk, positions, springs.value, twice)

    def tangent(self, interface: Interface, response: Response) -> tuple[np.ndarray, Skew | None]:
        """The lower half (band.size,) of the tangent at a response, and the upper half minus the lower one."""
        touch = response.contact.within(self.dof_qd.shape[1])
        K_gdd = stiffness(interface, touch, response.pull, self.each)
        i, j = _tril(K_gdd.shape[1])
        entries = np.concatenate([K_gdd[:, i, j].ravel(), self.values])
        entries[self.twice] *= 2.0
        half = self.bulk(response.gradients)
        np.add.at(half, self.positions, entries)
        g = np.unique(unsymmetric(touch, response.pull) // self.each)
        return half, skew_part(self.dof_qd[g * self.each], K_gdd[g]) if g.size else None


def element_places(conn_ea: np.ndarray, d: int, band: Band | Dense) -> np.ndarray:
    """Where the entries `half_places` (n_e, n_h) of the stiffness of elements go in the lower half of the tangent."""
    (n_e, n_a), numbers = conn_ea.shape, np.int32 if band.size <= np.iinfo(np.int32).max else np.int64
    place_eh = np.empty((n_e, half_places(n_a, d).size), numbers)
    for e in batches(n_e):
        place_eh[e] = band.positions(*half_entries(conn_ea[e], d))
    return place_eh


def add_elements(half: np.ndarray, place_eh: np.ndarray, parts: Iterable[tuple[slice, np.ndarray]]) -> None:
    """Add the stiffness (n_e, n_a, n_p, n_a) of elements, batch by batch, to the lower half (band.size,) in place."""
    for e, K_eapb in parts:
        d = 2 if K_eapb.shape[2] == 3 else 3
        entries_eh = K_eapb.reshape(len(K_eapb), -1).take(half_places(K_eapb.shape[1], d), axis=1)
        np.add.at(half, place_eh[e].ravel(), entries_eh.ravel())


def skew_part(dof_qd: np.ndarray, K_qdd: np.ndarray) -> Skew:
    """Upper halves of some matrices (n_q, n_d, n_d) over dof_qd minus their lower ones."""
    i, j = np.triu_indices(K_qdd.shape[1], 1)
    row, column, value = dof_qd[:, i], dof_qd[:, j], K_qdd[:, i, j] - K_qdd[:, j, i]
    return Skew(row.ravel(), column.ravel(), value.ravel())


def in_a_row(dof_qd: np.ndarray) -> int:
    """The largest size of groups of successive points, all alike, whose unknowns dof_qd (n_q, n_d) are the same."""
    changes = np.flatnonzero((dof_qd[1:] != dof_qd[:-1]).any(axis=1)) + 1
    return int(np.gcd.reduce([len(dof_qd), *changes]))


def lower_half(d: np.ndarray) -> Entries:
    """Rows and columns (..., n_h) of the lower halves of matrices over the degrees of freedom (..., n_d)."""
    i, j = _tril(d.shape[-1])
    return d[..., i], d[..., j]


@cache
def _tril(n: int) -> Entries:
    return np.tril_indices(n)


def _positions(band: Band | Dense, *entries: Entries) -> np.ndarray:
    return np.concatenate([band.positions(row.ravel(), column.ravel()) for row, column in entries])
