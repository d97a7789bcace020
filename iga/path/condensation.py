"""A linear bulk condensed onto the interface: Newton then works on the interface alone.

With linear kinematics forces are proportional to displacements, and the pairs of contact and their normals do not
change. Only the few displacements that determine gaps, and the opening, remain unknown; all others follow from them
(`iga.system.elimination`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from iga.interface.contact import Contact, Rows
from iga.interface.interface import SettledInterface
from iga.path.point import Point
from iga.system.bulk import CondensedBulk, LinearBulk
from iga.system.elimination import Eliminated, eliminated
from iga.system.system import System, respond


@dataclass(frozen=True)
class CondensationLimits:
    """When a bulk is condensed, and what counts as rounding.

    ``moves``: part of the largest entry of the rows of the gaps below which a displacement does not move one.
    ``dense`` n^3 and ``banded`` n k^2: operations of a dense LU and of a banded one.
    """

    moves: float = 1e-12
    dense: float = 2.0 / 3.0
    banded: float = 4.0


CONDENSATION = CondensationLimits()


@dataclass(frozen=True)
class Condensed:
    """The condensed ``system`` and the way back to the ``whole`` one."""

    system: System
    whole: System
    eliminated: Eliminated

    def expanded(self, point: Point) -> Point:
        """The point of the path with the displacements of the whole."""
        whole, found, rest = self.whole, point.response, self.whole.interface.rest
        state = replace(point.state, u_d=self.eliminated @ point.state.u_d, pairing=rest.pairing)
        springs = 0.5 * float(whole.spring_r @ (whole.springs_rd @ state.u_d) ** 2)
        held = whole.interface.P_AI.shape[1] == 2 and not whole.free_d.all()  # what holds a solid is not asked for
        internal_d = respond(whole, state, decide=False).internal_d if held else state.load * whole.load_d
        touch = replace(rest, g_q=found.contact.g_q)
        response = replace(found, internal_d=internal_d, bulk_energy=found.bulk_energy - springs, contact=touch)
        return replace(point, state=state, response=response)


def condensed(system: System) -> Condensed | None:
    """The system with its bulk condensed; None where that does not pay, or is not possible.

    It pays where a dense LU of the interface takes less work than a banded one of the whole.
    """
    bulk, interface = system.bulk, system.interface
    if not isinstance(bulk, LinearBulk) or not isinstance(interface, SettledInterface) or interface.slides:
        return None
    rest, G_qd = interface.rest, interface.rest.gap_rows.G_qd
    moves_d = np.abs(G_qd).max(0) > CONDENSATION.moves * np.abs(G_qd).max()
    kept, kept_qd = np.unique(rest.dof_qd[:, moves_d], return_inverse=True)
    found = eliminated(system, bulk, kept) if _pays(system, bulk, kept.size + 1) else None
    if found is None:
        return None
    rows = Rows(kept_qd.reshape(len(G_qd), -1), G_qd[:, moves_d])
    return Condensed(_small(interface, found.K_dd, replace(rest, pairing=None, gap_rows=rows)), system, found)


def _small(interface: SettledInterface, K_dd: np.ndarray, at_rest: Contact) -> System:
    """The system of the displacements that are kept, the opening last."""
    n_r, opening_d = len(K_dd), np.zeros(len(K_dd))
    opening_d[-1] = 1.0
    return System(
        bulk=CondensedBulk(K_dd),
        interface=replace(interface, at_rest=at_rest),
        load_d=opening_d,
        free_d=np.ones(n_r, dtype=bool),
        x_d=np.zeros(n_r),
        ahead_d=np.zeros(n_r),
        springs_rd=np.zeros((0, n_r)),
        spring_r=np.zeros(0),
        hold_d=opening_d,
    )


def _pays(system: System, bulk: LinearBulk, n_r: int) -> bool:
    """Whether n_r dense equations are less work than a banded LU of the whole.

    The size of the elements bounds the bandwidth from below: where that bound suffices the band is not numbered.
    """

    def less(n: int, k: int) -> bool:
        return CONDENSATION.dense * n_r**3 <= CONDENSATION.banded * n * k**2

    least = max(d.shape[1] for d in bulk.element_dofs) - 1
    return less(int(system.free_d.sum()), least) or less(system.band.n, system.band.k)
