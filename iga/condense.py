"""A linear bulk condensed onto the interface: Newton then works on the interface alone.

With linear kinematics the bulk answers in proportion and pairing and normals stay what they are, so that the few
displacements ``y`` that gaps and opening depend on are all that is unknown. What the others do follows from
``min u'Ku/2 with B u = y``:

    [K B'; B 0] [u; m] = [0; y]      u = U y      stiffness of y: m = -S y

(Guyan 1965, exact here, as loads and tractions act on y alone). No inverse of K is needed, which supports may leave
singular: what they leave free the rows B hold.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import null_space
from scipy.sparse import block_array, coo_array, csc_array, csr_array
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import splu

from iga.bulk import all_values, stiffness_entries
from iga.interface import Contact, contact, forces, pair
from iga.point import Point
from iga.system import System

#: Normals that differ by less than this are one.
STRAIGHT = 1e-12
#: Part of a rigid motion below which a spring does not feel it.
RESISTED = 1e-9
#: Further solutions of the saddle point problem, each for what the last one has left.
REFINEMENTS = 1
#: Work of a dense LU over that of a banded one, for matrices of equal size: n^3 2/3 against 4 n k^2.
DENSE, BANDED = 2.0 / 3.0, 4.0


@dataclass(frozen=True)
class Condensed:
    """The condensed system and the way back to the whole one.

    ``U_dr`` (n_dof, n_r) are the displacements of the whole for each condensed one, ``held_fr`` what the fixed degrees
    of freedom ``fixed_f`` then hold; ``rest`` is the interface of the whole before anything moves.
    """

    system: System
    whole: System
    U_dr: np.ndarray
    held_fr: np.ndarray
    fixed_f: np.ndarray
    rest: Contact

    def expanded(self, point: Point) -> Point:
        """The same point of the path, told in all displacements."""
        whole, state, found = self.whole, point.state, point.response
        u_d, touch = self.U_dr @ state.u_d, replace(self.rest, g_q=found.contact.g_q)
        internal_d = state.load * whole.load_d
        if self.fixed_f.size:
            on_fixed_d = forces(whole.interface, touch, found.p_q, whole.n_dof)
            internal_d[self.fixed_f] = self.held_fr @ state.u_d + on_fixed_d[self.fixed_f]
        springs = 0.5 * float(whole.spring_r @ (whole.springs_rd @ u_d) ** 2)
        response = replace(found, internal_d=internal_d, bulk_energy=found.bulk_energy - springs, contact=touch)
        return replace(point, state=replace(state, u_d=u_d, pairing=self.rest.pairing), response=response)


def condensed(system: System) -> Condensed | None:
    """The system with its bulk condensed; None where that does not pay, or is not possible.

    It pays as long as a dense matrix of the interface is less work than a banded one of the whole.
    """
    interface = system.interface
    if system.kinematics != "linear":
        return None
    rest = contact(interface, np.zeros(system.n_dof), pair(interface))
    B_rd, kept_qd, weight_qd = _rows(system, rest)
    n_r = B_rd.shape[0]
    if DENSE * n_r**3 > BANDED * system.band.n * system.band.k**2:
        return None
    free = np.flatnonzero(system.free_d)
    K_dd = _bulk(system)
    springs = csr_array(system.springs_rd)
    tied_dd = K_dd + springs.T @ (springs * system.spring_r[:, None])
    saddle = block_array([[tied_dd[free][:, free], B_rd[:, free].T], [B_rd[:, free], None]], format="csc")
    try:
        # of SuperLU's orderings the one that fills in least here, and hundreds of solutions follow
        lu = splu(saddle, permc_spec="MMD_ATA")
    except RuntimeError:  # rows that say the same twice
        return None
    U_dr, unit_rr = np.zeros((system.n_dof, n_r)), np.eye(n_r)
    first = lu.solve(np.concatenate([np.zeros((free.size, n_r)), unit_rr]))
    U_dr[free], S_rr = first[: free.size], -first[free.size :]
    for _ in range(REFINEMENTS):
        held_dr = _bulk_forces(system, U_dr)
        left_dr = held_dr + springs.T @ ((springs @ U_dr) * system.spring_r[:, None]) - B_rd.T @ S_rr
        change = lu.solve(np.concatenate([-left_dr[free], unit_rr - B_rd @ U_dr]))
        U_dr[free] += change[: free.size]
        S_rr -= change[free.size :]
    # rigid motions ask for no force: said once more, rounding of the solution does not come into the balance of forces
    rigid_dm = _mechanisms(system, K_dd)
    y_rm, triangle = np.linalg.qr(B_rd @ rigid_dm)
    U_dr += (np.linalg.solve(triangle.T, rigid_dm.T).T - U_dr @ y_rm) @ y_rm.T
    S_rr -= y_rm @ (y_rm.T @ S_rr)
    S_rr -= (S_rr @ y_rm) @ y_rm.T
    at_rest = replace(rest, pairing=None, dof_qd=kept_qd, V_qrd=weight_qd[:, None])
    small = System(
        solids=(),
        interface=replace(interface, master=None, at_rest=at_rest),
        kinematics="linear",
        load_d=np.append(np.zeros(n_r - 1), 1.0),
        free_d=np.ones(n_r, dtype=bool),
        x_d=np.zeros(n_r),
        springs_rd=np.zeros((0, n_r)),
        spring_r=np.zeros(0),
        bulk_dd=0.5 * (S_rr + S_rr.T),
    )
    fixed = np.flatnonzero(~system.free_d)
    held_fr = _bulk_forces(system, U_dr)[fixed] if fixed.size else np.zeros((0, n_r))
    return Condensed(small, system, U_dr, held_fr, fixed, rest)


def _rows(system: System, rest: Contact) -> tuple[csr_array, np.ndarray, np.ndarray]:
    """Displacements that are kept, as rows B (n_r, n_dof), the opening last, and the gaps in them.

    The gap of point q is the sum of ``weight_qd`` times the kept displacements ``kept_qd`` (n_q, n_d): on a straight
    interface those along its normal, of pairs of control points that face each other only how far they are apart.
    """
    interface = system.interface
    n_i, V_qd = rest.n_qi[0], rest.V_qrd[:, 0]
    if np.abs(rest.n_qi - n_i).max() > STRAIGHT:
        kept, kept_qd = _numbered(rest.dof_qd)
        entries = [(np.arange(kept.size), kept, np.ones(kept.size))]
        weight_qd = V_qd
    else:
        facing = interface.master is None and interface.twin_qa is not None
        A, kept_qd = _numbered(interface.conn_qa if facing else rest.dof_qd[:, ::2] // 2)
        entries = _along(A, n_i)
        weight_qd = interface.N_qa if facing else V_qd[:, ::2] * n_i[0] + V_qd[:, 1::2] * n_i[1]
        if facing:
            twin = np.empty(A.size, dtype=int)
            twin[kept_qd] = interface.twin_qa
            entries += _along(twin, -n_i)
    n_r = kept_qd.max() + 2
    opening = np.flatnonzero(system.load_d)
    entries.append((np.full(opening.size, n_r - 1), opening, system.load_d[opening]))
    row, column, value = (np.concatenate([entry[i] for entry in entries]) for i in range(3))
    return csr_array((value, (row, column)), shape=(n_r, system.n_dof)), kept_qd, weight_qd


def _numbered(name_qd: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    names, number = np.unique(name_qd, return_inverse=True)
    return names, number.reshape(name_qd.shape)


def _along(A: np.ndarray, n_i: np.ndarray) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Entries of the rows ``n . u_A``."""
    row = np.arange(A.size)
    return [(row, 2 * A + i, np.full(A.size, n_i[i])) for i in range(2)]


def _mechanisms(system: System, K_dd: csc_array) -> np.ndarray:
    """Motions (n_dof, n_m) that neither bulk nor springs resist: rigid ones of the bodies that no support holds."""
    bodies, body_d = connected_components(K_dd, directed=False)
    x_Ai = system.interface.local_AI - system.interface.local_AI.mean(0)
    turn_d = np.stack([-x_Ai[:, 1], x_Ai[:, 0]], -1).ravel() / np.ptp(x_Ai, axis=0).max()
    rigid_dm = np.stack([np.tile([1.0, 0.0], len(x_Ai)), np.tile([0.0, 1.0], len(x_Ai)), turn_d], -1)
    loose = [body for body in range(bodies) if system.free_d[body_d == body].all()]
    all_dm = np.concatenate([rigid_dm * (body_d == body)[:, None] for body in loose], axis=1)
    return all_dm @ null_space(system.springs_rd @ all_dm, rcond=RESISTED)


def _bulk_forces(system: System, U_dr: np.ndarray) -> np.ndarray:
    """Forces (n_dof, n_r) of the bulk, element by element: each is blind to its own translation but for rounding."""
    f_dr = np.zeros_like(U_dr)
    for K, d in zip(system.linear_matrices, system.element_dofs, strict=True):
        U_eair = U_dr[d].reshape(*d.shape[:1], -1, 2, U_dr.shape[1])
        f = K @ (U_eair - U_eair[:, :1]).reshape(*d.shape, -1)
        gathered = csr_array((np.ones(d.size), (d.ravel(), np.arange(d.size))), shape=(system.n_dof, d.size))
        f_dr += gathered @ f.reshape(d.size, -1)
    return f_dr


def _bulk(system: System) -> csc_array:
    """Stiffness of the bulk (n_dof, n_dof)."""
    entries = [stiffness_entries(solid.basis.conn_ea) for solid in system.solids]
    entries = [(row.ravel(), column.ravel()) for row, column in entries]
    row, column = (np.concatenate([entry[i] for entry in entries]) for i in range(2))
    values = all_values(system.unloaded_stiffness)
    return coo_array((values, (row, column)), shape=(system.n_dof, system.n_dof)).tocsc()
