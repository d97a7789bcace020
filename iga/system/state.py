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
    points in contact, and ``pairing``, where they met the master, are where the next search starts, not history.
    ``slid`` is history: energy lost with points that slid off the master, beyond their part of the dissipation that
    `iga.system.system.energies` counts.
    """

    u_d: np.ndarray
    load: float
    k_q: np.ndarray
    closed_q: np.ndarray
    pairing: Pairing | None
    scale: float = 0.0
    slid: float = 0.0

    def moved(self, step_d: np.ndarray) -> State:
        """The state after a step (n_dof + 1,) of displacements and load, the load last."""
        return replace(self, u_d=self.u_d + step_d[:-1], load=self.load + float(step_d[-1]))


@dataclass(frozen=True)
class Energies:
    """Energy stored in the bulk with its springs, in cohesion and in contact, and energy dissipated.

    Springs store energy where tilted tractions have a resultant along the specimen.
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

    ``internal_d`` (n_dof,) forces of bulk, springs and interface; ``scale`` the norm of the forces that the elements
    exert on each other, by which a residual is judged; ``bulk_energy`` without that of springs; the interface with
    traction p_q, slope dp_q and new history k_q; displacement ``gradients`` from which the bulk makes its tangent.
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
