"""What interface, system and path need of a traction law, whether it opens alone or slides as well."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, ClassVar, NamedTuple

import numpy as np

#: Time between two steps: none, but laws with viscosity divide by it.
INSTANT = float(np.finfo(float).tiny)


class History(NamedTuple):
    """History of points: ``d`` (n,), the largest gap or, where the bond slides, the damage, 0 to 1; and with friction
    the slip (n,) at which its traction is zero."""

    d: np.ndarray
    slip: np.ndarray | None = None


class Stored(NamedTuple):
    """Energies per area (n,): in cohesion, in contact, in the elastic slip of friction, and dissipated, as far as that
    follows from the history."""

    cohesion: np.ndarray
    contact: np.ndarray
    friction: np.ndarray | float = 0.0
    dissipated: np.ndarray | float = 0.0


class Scaled(NamedTuple):
    """Scaled jump ``x`` (n,), which rises with the progress of damage and has onset and failure at the kinks of the
    law; its derivatives by opening and slip; and ``back`` (n,), the scaled jump that a point has to reach for its
    damage to grow (again). Where the bond opens alone it is the gap, and ``back`` the largest one. Otherwise ``back``
    is at most the onset without damage, and at least failure of a failed point."""

    x: np.ndarray
    by_g: np.ndarray
    by_s: np.ndarray | None
    back: np.ndarray


class Law(ABC):
    """A law for n_c jumps: the gap and, where ``slides``, the slip. Tractions and jumps are (n, n_c).

    A law is a frozen dataclass. ``unbonded`` is the history of points without cohesion; ``begun`` and ``failed`` are
    the histories from which a point is damaged, and has no cohesion left; ``kinks`` the scaled jumps, rising from onset
    to failure, at which slopes jump, ``span`` that over which a point goes from whole to failed; ``stiffest`` the
    largest slope of a traction.
    """

    slides: ClassVar[bool]
    unbonded: ClassVar[float]
    penalty: float
    contact: bool
    irreversible: bool
    friction: float = 0.0
    viscosity: float = 0.0

    @property
    @abstractmethod
    def begun(self) -> float: ...

    @property
    @abstractmethod
    def failed(self) -> float: ...

    @property
    @abstractmethod
    def kinks(self) -> tuple[float, ...]: ...

    @property
    @abstractmethod
    def span(self) -> float: ...

    @property
    @abstractmethod
    def stiffest(self) -> float: ...

    @property
    @abstractmethod
    def g_max(self) -> float:
        """Opening at which damage begins."""

    @property
    @abstractmethod
    def pure_modes(self) -> tuple[tuple[float, float], ...]:
        """Strength and toughness of opening and, where the bond slides, of sliding."""

    @abstractmethod
    def critical(self, B: np.ndarray) -> np.ndarray:
        """Toughness (n,) at mode ratios by energy."""

    @abstractmethod
    def damage(self, d: np.ndarray) -> np.ndarray:
        """Damage, 0 to 1, after a history (n,)."""

    @abstractmethod
    def start(self, n: int) -> History:
        """Points that have not been loaded."""

    @abstractmethod
    def respond(
        self, jump_qc: np.ndarray, past: History, dt: float, closed_q: np.ndarray | None, bonded_q: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray, History]:
        """Tractions (n_q, n_c), their slopes (n_q, n_c, n_c) and the new history after a step of the time ``dt``.

        ``closed_q`` (n_q,) are the points in contact, those with a negative gap if left out; ``bonded_q`` those with
        cohesion, all if left out.
        """

    @abstractmethod
    def stored(self, *jump_and_history: Any) -> Stored:
        """Energies per area (n,) at jumps (n,), with the `History` after them."""

    @abstractmethod
    def scaled(self, *jump_and_history: np.ndarray) -> Scaled:
        """The scaled jump at jumps and histories (n,)."""

    @abstractmethod
    def driven(self, *jump: np.ndarray) -> np.ndarray:
        """The history (n,) on first loading to the jumps (n,)."""

    @abstractmethod
    def nudged(self, d: np.ndarray, driven: np.ndarray, grows: np.ndarray, keeps: np.ndarray) -> np.ndarray:
        """Histories (n,) changed by a rounding: just below ``driven`` where damage ``grows``, just above ``d`` where it
        ``keeps`` its value."""
