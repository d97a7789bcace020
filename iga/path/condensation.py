"""A linear bulk condensed onto the interface: Newton then works on the interface alone.

With linear kinematics forces are proportional to displacements, and the pairs of contact and their normals do not
change. Only the few displacements ``y`` that determine gaps and opening remain unknown. All others follow from
``min u'Ku/2 with B u = y``:

    [K B'; B 0] [u; m] = [0; y]      u = U y      stiffness of y: m = -S y

(Guyan 1965, exact here, as loads and tractions act on y alone). K may be singular: the rows B fix the rigid motions
that supports leave free.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import null_space
from scipy.sparse import coo_array, csr_array
from scipy.sparse.linalg import splu

from iga.interface.contact import Contact, DenseRows, Rows
from iga.interface.interface import Interface, SettledInterface
from iga.interface.response import forces
from iga.path.point import Point
from iga.system.bulk import CondensedBulk, LinearBulk
from iga.system.elimination import Eliminated, eliminated
from iga.system.system import System

#: Rows, columns and values of a matrix.
Entries = tuple[np.ndarray, np.ndarray, np.ndarray]


@dataclass(frozen=True)
class CondensationLimits:
    """When a bulk is condensed, and what counts as rounding.

    ``straight``: largest difference of the normals of a straight interface. ``alike``: largest difference of the
    functions of two control points that face each other, relative to the largest function. ``felt``: least part of a
    rigid motion that counts as resisted by a spring or measured by a row. ``stiffest``: largest condensed stiffness
    relative to that of the elements; a larger one comes from rows that are linearly dependent up to rounding.
    ``dense`` n^3 and ``banded`` n k^2: operations of a dense LU and of a banded one.
    """

    straight: float = 1e-12
    alike: float = 1e-12
    felt: float = 1e-9
    stiffest: float = 1e9
    dense: float = 2.0 / 3.0
    banded: float = 4.0


CONDENSATION = CondensationLimits()


@dataclass(frozen=True)
class Condensed:
    """The condensed system and the way back to the whole one.

    ``U_dr`` (n_dof, n_r) are the displacements of the whole for a unit of each condensed one, ``held_fr`` the forces of
    the bulk on the fixed degrees of freedom ``fixed_f``; ``rest`` is the reference contact of the whole.
    """

    system: System
    whole: System
    U_dr: np.ndarray | Eliminated
    held_fr: np.ndarray
    fixed_f: np.ndarray
    rest: Contact

    def expanded(self, point: Point) -> Point:
        """The point of the path with the displacements of the whole."""
        whole, state, found = self.whole, point.state, point.response
        u_d, touch = self.U_dr @ state.u_d, replace(self.rest, g_q=found.contact.g_q)
        internal_d = state.load * whole.load_d
        if self.fixed_f.size:
            on_fixed_d = forces(whole.interface, touch, found.pull, whole.n_dof)
            internal_d[self.fixed_f] = self.held_fr @ state.u_d + on_fixed_d[self.fixed_f]
        springs = 0.5 * float(whole.spring_r @ (whole.springs_rd @ u_d) ** 2)
        response = replace(found, internal_d=internal_d, bulk_energy=found.bulk_energy - springs, contact=touch)
        return replace(point, state=replace(state, u_d=u_d, pairing=self.rest.pairing), response=response)


def condensed(system: System) -> Condensed | None:
    """The system with its bulk condensed; None where that does not pay, or is not possible.

    It pays where a dense LU of the interface takes less work than a banded one of the whole.
    """
    bulk, interface = system.bulk, system.interface
    if not isinstance(bulk, LinearBulk) or not isinstance(interface, SettledInterface) or interface.slides:
        return None
    if bulk.d == 3:
        return _of_solid(system, bulk, interface)
    B_rd, gap_rows = _rows(system)
    n_r = B_rd.shape[0]
    if not _pays(system, bulk, n_r):
        return None
    found = _constrained(system, bulk, B_rd)
    if found is None:
        return None
    U_dr, S_rr = _balanced(system, bulk, B_rd, *found)
    small = _small(interface, 0.5 * (S_rr + S_rr.T), DenseRows.of(gap_rows, n_r))
    fixed = np.flatnonzero(~system.free_d)
    held_fr = _bulk_forces(bulk, U_dr)[fixed] if fixed.size else np.zeros((0, n_r))
    return Condensed(small, system, U_dr, held_fr, fixed, interface.rest)


def _of_solid(system: System, bulk: LinearBulk, interface: SettledInterface) -> Condensed | None:
    """A solid in the displacements of the bond; what its fixed unknowns are held by is not asked for."""
    kept, kept_qd = _numbered(interface.rest.dof_qd)
    found = eliminated(system, bulk, kept) if _pays(system, bulk, kept.size + 1) else None
    if found is None:
        return None
    small = _small(interface, found.K_dd, Rows(kept_qd, interface.rest.gap_rows.G_qd))
    return Condensed(small, system, found, np.zeros((0, len(found.K_dd))), np.arange(0), interface.rest)


def _small(interface: SettledInterface, S_rr: np.ndarray, gap_rows: Rows) -> System:
    """The system of the displacements that are kept, the opening last."""
    n_r, at_rest = len(S_rr), replace(interface.rest, pairing=None, gap_rows=gap_rows)
    return System(
        bulk=CondensedBulk(S_rr),
        interface=replace(interface, at_rest=at_rest),
        load_d=np.append(np.zeros(n_r - 1), 1.0),
        free_d=np.ones(n_r, dtype=bool),
        x_d=np.zeros(n_r),
        ahead_d=np.zeros(n_r),
        springs_rd=np.zeros((0, n_r)),
        spring_r=np.zeros(0),
        hold_d=np.append(np.zeros(n_r - 1), 1.0),
    )


def _constrained(system: System, bulk: LinearBulk, B_rd: coo_array) -> tuple[np.ndarray, np.ndarray] | None:
    """Displacements U_dr (n_dof, n_r) for a unit of each row ``B u``, and the stiffness S_rr of the rows.

    None where the rows are linearly dependent, exactly or up to rounding.
    """
    free, n_r = np.flatnonzero(system.free_d), B_rd.shape[0]
    # the rows are scaled to the size of the stiffness: forces would lose half of their digits otherwise
    size = max(float(np.abs(K).max()) for K in bulk.matrices)
    saddle, place = _saddle(system, bulk, size * B_rd)
    held, given_r, U_dr = place[system.n_dof :], np.zeros((free.size + n_r, n_r)), np.zeros((system.n_dof, n_r))
    given_r[held, np.arange(n_r)] = size
    found = _solved(saddle, given_r)
    if found is None:
        return None
    U_dr[free], S_rr = found[place[free]], -size * found[held]
    return (U_dr, S_rr) if np.abs(S_rr).max() < CONDENSATION.stiffest * size else None


def _balanced(
    system: System, bulk: LinearBulk, B_rd: coo_array, U_dr: np.ndarray, S_rr: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """U_dr and S_rr, corrected in place: rigid motions cause no force, to the last digit, and forces are in balance.

    Corrected are rigid motions that no spring resists and those that no row of B measures.
    """
    motions_dm = _rigid_motions(system, bulk)
    rigid_dm = _without(system.springs_rd, motions_dm)
    U_dr -= _resting(system, _without(B_rd, motions_dm), U_dr)
    y_rm, triangle = np.linalg.qr(B_rd @ rigid_dm)
    U_dr += (np.linalg.solve(triangle.T, rigid_dm.T).T - U_dr @ y_rm) @ y_rm.T
    S_rr -= y_rm @ (y_rm.T @ S_rr)
    S_rr -= (S_rr @ y_rm) @ y_rm.T
    return U_dr, S_rr


def _pays(system: System, bulk: LinearBulk, n_r: int) -> bool:
    """Whether n_r dense equations are less work than a banded LU of the whole.

    The size of the elements bounds the bandwidth from below: where that bound suffices the band is not numbered.
    """

    def less(n: int, k: int) -> bool:
        return CONDENSATION.dense * n_r**3 <= CONDENSATION.banded * n * k**2

    least = max(d.shape[1] for d in bulk.element_dofs) - 1
    return less(int(system.free_d.sum()), least) or less(system.band.n, system.band.k)


def _rows(system: System) -> tuple[coo_array, Rows]:
    """Displacements that are kept, as rows B (n_r, n_dof) with the opening last, and the gaps as functions of them.

    On a straight interface only displacements of its control points along the normal are kept; where control points
    face each other in pairs, only the normal distance of each pair.
    """
    interface, rest = system.interface, system.interface.rest
    n_i, G_qd = rest.n_qi[0], rest.gap_rows.G_qd
    if np.abs(rest.n_qi - n_i).max() > CONDENSATION.straight:
        kept, kept_qd = _numbered(rest.dof_qd)
        entries: list[Entries] = [(np.arange(kept.size), kept, np.ones(kept.size))]
        weight_qd = G_qd
    else:
        A_qd, weight_qd = rest.dof_qd[:, ::2] // 2, G_qd[:, ::2] * n_i[0] + G_qd[:, 1::2] * n_i[1]
        facing = _facing(interface, A_qd, weight_qd)
        A, kept_qd = _numbered(A_qd if facing is None else facing[0])
        entries = _along(A, n_i)
        if facing is not None:
            weight_qd = weight_qd[:, : kept_qd.shape[1]]
            twin = np.empty(A.size, dtype=int)
            twin[kept_qd] = facing[1]
            entries += _along(twin, -n_i)
    n_r = kept_qd.max() + 2
    opening = np.flatnonzero(system.load_d)
    entries.append((np.full(opening.size, n_r - 1), opening, system.load_d[opening]))
    row, column, value = (np.concatenate([entry[i] for entry in entries]) for i in range(3))
    return coo_array((value, (row, column)), shape=(n_r, system.n_dof)), Rows(kept_qd, weight_qd)


def _facing(interface: Interface, A_qd: np.ndarray, weight_qd: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
    """Control points (n_q, n_a) of the slave at each point, and those of the master with the same functions there.

    None where the meshes do not match: a gap is then not the difference of the displacements of a pair.
    """
    n_a = interface.conn_qa.shape[1]
    if A_qd.shape[1] != 2 * n_a:
        return None
    slave_qa, twin = A_qd[:, :n_a], np.empty(A_qd.max() + 1, dtype=int)
    for way in (1, -1):
        twin_qa = A_qd[:, n_a:][:, ::way]
        twin[slave_qa] = twin_qa
        sum_qa = weight_qd[:, :n_a] + weight_qd[:, n_a:][:, ::way]
        if (
            np.array_equal(twin[slave_qa], twin_qa)
            and np.abs(sum_qa).max() <= CONDENSATION.alike * np.abs(weight_qd).max()
        ):
            return slave_qa, twin_qa
    return None


def _numbered(name_qd: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    names, number = np.unique(name_qd, return_inverse=True)
    return names, number.reshape(name_qd.shape)


def _along(A: np.ndarray, n_i: np.ndarray) -> list[Entries]:
    """Entries of the rows ``n . u_A``."""
    row = np.arange(A.size)
    return [(row, 2 * A + i, np.full(A.size, n_i[i])) for i in range(2)]


def _without(rows_rd: np.ndarray | coo_array, motions_dm: np.ndarray) -> np.ndarray:
    """Combinations of motions (n_dof, n_m) that change no row (n_r, n_dof)."""
    return motions_dm @ null_space(rows_rd @ motions_dm, rcond=CONDENSATION.felt)


def _resting(system: System, unfelt_dm: np.ndarray, U_dr: np.ndarray) -> np.ndarray:
    """Motions (n_dof, n_r) in U_dr that stretch springs and change no row: without a force the springs undo them."""
    stretched_rm = system.spring_r[:, None] ** 0.5 * (system.springs_rd @ unfelt_dm)
    stretch_rr = system.spring_r[:, None] ** 0.5 * (system.springs_rd @ U_dr)
    return unfelt_dm @ np.linalg.lstsq(stretched_rm, stretch_rr, rcond=CONDENSATION.felt)[0]


def _rigid_motions(system: System, bulk: LinearBulk) -> np.ndarray:
    """Rigid motions (n_dof, n_m) of the bodies without fixed degrees of freedom."""
    bodies, body_d = _bodies(bulk, system.n_dof)
    x_Ai = system.interface.local_AI - system.interface.local_AI.mean(0)
    turn_d = np.stack([-x_Ai[:, 1], x_Ai[:, 0]], -1).ravel() / np.ptp(x_Ai, axis=0).max()
    rigid_dm = np.stack([np.tile([1.0, 0.0], len(x_Ai)), np.tile([0.0, 1.0], len(x_Ai)), turn_d], -1)
    loose = [body for body in range(bodies) if system.free_d[body_d == body].all()]
    return np.concatenate([rigid_dm * (body_d == body)[:, None] for body in loose], axis=1)


def _bulk_forces(bulk: LinearBulk, U_dr: np.ndarray) -> np.ndarray:
    """Forces (n_dof, n_r) of the bulk, by elements: translations of an element, which cause none, are taken out."""
    f_dr = np.zeros_like(U_dr)
    for K, d in zip(bulk.matrices, bulk.element_dofs, strict=True):
        U_eair = U_dr[d].reshape(*d.shape[:1], -1, 2, U_dr.shape[1])
        f = K @ (U_eair - U_eair[:, :1]).reshape(*d.shape, -1)
        gathered = csr_array((np.ones(d.size), (d.ravel(), np.arange(d.size))), shape=(len(U_dr), d.size))
        f_dr += gathered @ f.reshape(d.size, -1)
    return f_dr


def _bodies(bulk: LinearBulk, n_dof: int) -> tuple[int, np.ndarray]:
    """Number of the bodies, and the body of each unknown (n_dof,).

    Bodies are numbered one after the other: one ends at a control point that no element couples to later ones.
    """
    here = np.zeros(n_dof // 2 + 1, dtype=int)
    for conn_ea in bulk.connectivity:
        np.add.at(here, conn_ea.min(1), 1)
        np.subtract.at(here, conn_ea.max(1), 1)
    ends = np.cumsum(here)[:-1] == 0
    return int(ends.sum()), np.repeat(np.cumsum(ends) - ends, 2)


def _saddle(system: System, bulk: LinearBulk, B_rd: coo_array) -> tuple[Entries, np.ndarray]:
    """``[K B'; B 0]`` over the free unknowns and the multipliers, K with its springs; and the equation of each unknown
    and multiplier.

    Entries of one place add up. All are numbered along the specimen, each multiplier after the unknowns of its row: the
    band is narrow, and even in large systems fewer entries fill in than with orders that ignore the pivots (at 6,500
    equations of T-splines a third of the entries, and 15 times faster).
    """
    n_dof, springs_rd, (row, column) = system.n_dof, system.springs_rd, B_rd.coords
    x_m = np.concatenate([system.x_d, np.full(B_rd.shape[0], -np.inf)])
    np.maximum.at(x_m, n_dof + row, system.x_d[column])
    there = np.concatenate([np.flatnonzero(system.free_d), np.arange(n_dof, x_m.size)])
    place = np.full(x_m.size, -1, dtype=np.int32)
    place[there[np.argsort(x_m[there], kind="stable")]] = np.arange(there.size)
    blocks = [*zip(bulk.element_dofs, bulk.matrices, strict=True)]
    # each spring is a block of its own: one block of all would couple both ends of the specimen
    for a_d, spring in zip(springs_rd, system.spring_r, strict=True):
        held = np.flatnonzero(a_d)
        blocks.append((held[None], spring * np.outer(a_d[held], a_d[held])[None]))
    row, column = place[n_dof + row], place[column]
    entries: list[Entries] = [(row, column, B_rd.data), (column, row, B_rd.data)]
    for d, K in blocks:
        at = place[d]
        rows, columns = (np.broadcast_to(v, K.shape).ravel() for v in (at[:, :, None], at[:, None]))
        entries.append((rows, columns, K.ravel()))
    i, j, values = (np.concatenate(parts) for parts in zip(*entries, strict=True))
    if there.size < x_m.size:
        free = (i >= 0) & (j >= 0)
        i, j, values = i[free], j[free], values[free]
    return (i, j, values), place


def _solved(saddle: Entries, given_r: np.ndarray) -> np.ndarray | None:
    """Solutions (n, n_r) of a matrix that is numbered well; None where it is singular."""
    (i, j, values), n = saddle, len(given_r)
    try:
        return splu(coo_array((values, (i, j)), shape=(n, n)).tocsc(), permc_spec="NATURAL").solve(given_r)
    except RuntimeError:
        return None
