"""A configuration, the response of bulk and interface to it, and its energies."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from iga.interface.closest_point import Pairing
from iga.interface.contact import Contact, Rows
from iga.interface.response import Tractions
from iga.laws.law import History

#: Scaled jumps below this are rounding.
STILL = 1e-9


@dataclass(frozen=True)
class State:
    """A configuration: displacements u_d (n_dof,), load, history k_q (n_q,).

    ``scale`` is the largest force scale (see `Response`) of all converged states so far. ``closed_q`` (n_q,), the
    points in contact, and ``pairing``, their closest points on the master, are only the start of the next search.
    Where the bond slides k_q is its damage and ``slip_q`` (n_q,) the history of friction.

    Energies that do not follow from displacements and history: ``lost`` has been dissipated, ``rubbed`` is the part of
    it of friction, and ``kept`` the bond gives back, as it heals. ``dt`` is the time of the step that leads here; it is
    0 for a committed state, whose damage is kept.
    """

    u_d: np.ndarray
    load: float
    k_q: np.ndarray
    closed_q: np.ndarray
    pairing: Pairing | None
    scale: float = 0.0
    slip_q: np.ndarray | None = None
    lost: float = 0.0
    rubbed: float = 0.0
    kept: float = 0.0
    dt: float = 0.0

    @property
    def past(self) -> History:
        """History of the points for the next step."""
        return History(self.k_q, self.slip_q)

    def moved(self, step_d: np.ndarray) -> State:
        """The state after a step (n_dof + 1,) of displacements and load, the load last."""
        return replace(self, u_d=self.u_d + step_d[:-1], load=self.load + float(step_d[-1]))


@dataclass(frozen=True)
class Energies:
    """Energy stored in the bulk with its springs, in cohesion and in contact, and energy dissipated.

    Springs store energy where tractions are tilted and have an axial resultant.
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
    """Forces, energies and contact at displacements u_d (n_dof,).

    ``internal_d`` (n_dof,) forces of bulk, springs and interface; ``scale`` the norm of the forces that the elements
    exert on each other, to which a residual is relative; ``bulk_energy`` without that of springs; ``pull`` the
    tractions and the new history of the interface; ``gradients`` the displacement gradients from which the bulk makes
    its tangent.
    """

    u_d: np.ndarray
    internal_d: np.ndarray
    scale: float
    bulk_energy: float
    contact: Contact
    pull: Tractions
    closed_q: np.ndarray
    gradients: tuple[np.ndarray, ...]

    @property
    def p_q(self) -> np.ndarray:
        return self.pull.p_q

    @property
    def dp_q(self) -> np.ndarray:
        return self.pull.dp_q

    @property
    def k_q(self) -> np.ndarray:
        return self.pull.history.d

    @property
    def x_q(self) -> np.ndarray:
        """The separation (n_q,) that drives the damage of each point: its gap, or, where the bond slides, its scaled
        jump."""
        return self.pull.scaled.x

    @property
    def back_q(self) -> np.ndarray:
        """The value (n_q,) that x_q has to reach before damage grows."""
        return self.pull.scaled.back

    @cached_property
    def x_rows(self) -> Rows:
        """First variation of x_q."""
        rows, scaled = self.contact.jump_rows, self.pull.scaled
        if scaled.by_s is None:  # the gap itself
            return rows[0]
        G_qd = scaled.by_g[:, None] * rows[0].G_qd + scaled.by_s[:, None] * rows[1].G_qd
        return replace(rows[1], G_qd=G_qd)

    def x_rates(self, v_d: np.ndarray) -> np.ndarray:
        """Rates (n_q,) of x_q when the displacements change by v_d (n_dof,).

        The scaled jump is a norm without a derivative at zero: there its rate is the scaled jump of the jumps' rates.
        """
        rates_q, still_q = self.x_rows.rates(v_d), self.x_q < STILL
        if not self.pull.law.slides or not still_q.any():
            return rates_q
        jumps = (rows.rates(v_d) for rows in self.contact.jump_rows)
        return np.where(still_q, self.pull.law.scaled(*jumps, np.zeros(len(rates_q))).x, rates_q)
