"""A configuration, the response of bulk and interface to it, and its energies."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from iga.interface.closest_point import Pairing
from iga.interface.contact import Contact


@dataclass(frozen=True)
class State:
    """A configuration: displacements u_d (n_dof,), load, history k_q (n_q,).

    ``scale`` is the largest force scale (see `Response`) of all converged states so far. ``closed_q`` (n_q,), the
    points in contact, and ``pairing``, where they met the master, are where the next search starts, not history. ``slid`` is history again: what has gone with points that slid off the master, beyond what
    `iga.system.system.energies` would count of them as dissipated.
    """

    u_d: np.ndarray
    load: float
    k_q: np.ndarray
    closed_q: np.ndarray
    pairing: Pairing | None
    scale: float = 0.0
    slid: float = 0.0

    def moved(self, step_d: np.ndarray) -> State:
        """Displacements and load moved on by a step (n_dof + 1,), the load last."""
        return replace(self, u_d=self.u_d + step_d[:-1], load=self.load + float(step_d[-1]))


@dataclass(frozen=True)
class Energies:
    """What the work has become: stored in bulk and springs, in cohesion and in contact, and dissipated.

    A spring that carries what tilted tractions pull lengthwise stores some, too.
    """

    bulk: float
    cohesive: float
    contact: float
    dissipated: float

    @property
    def stored(self) -> float:
        return self.bulk + self.cohesive + self.contact

    @property
    def total(self) -> float:
        return self.stored + self.dissipated


@dataclass(frozen=True)
class Response:
    """Forces, energies and contact in a configuration.

    ``internal_d`` (n_dof,) forces of bulk and interface; ``scale`` the norm of the forces that the elements hold
    against each other, by which a residual is judged; ``bulk_energy``; the interface with traction p_q, slope dp_q and
    new history k_q; the displacement gradients of the solids, of which a tangent is made once one is asked for.
    """

    internal_d: np.ndarray
    scale: float
    bulk_energy: float
    contact: Contact
    p_q: np.ndarray
    dp_q: np.ndarray
    k_q: np.ndarray
    closed_q: np.ndarray
    gradients: tuple[np.ndarray, ...]
