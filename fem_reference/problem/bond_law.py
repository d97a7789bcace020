"""What model and path need of a traction law, whether it opens alone or slides as well."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import ClassVar

import numpy as np


class BondLaw(ABC):
    """A law at the points q of the interface, for jumps (n_q, n_j): the gap and, where it ``slides``, the slip.

    Tractions are (n_q, n_j), histories (n_q, n_h). Where ``bonded_q`` (n_q,) is False the faces can only touch.
    A law is a frozen dataclass. The measure of a jump is a scalar that is compared with `begun` and `failed`.
    """

    slides: ClassVar[bool]
    penalty: float
    contact: bool
    irreversible: bool
    viscosity: float = 0.0

    @property
    @abstractmethod
    def K0(self) -> float:
        """Initial stiffness against opening [stress per length]."""

    @property
    @abstractmethod
    def begun(self) -> float:
        """The measure of a jump at which damage begins."""

    @property
    @abstractmethod
    def failed(self) -> float:
        """The measure of a jump from which a point is open."""

    @property
    @abstractmethod
    def unit(self) -> float:
        """Unit in which steps of the front's measure are measured."""

    @abstractmethod
    def intact(self, bonded_q: np.ndarray) -> np.ndarray:
        """The history (n_q, n_h) before anything has moved."""

    @abstractmethod
    def respond(
        self, jump_qj: np.ndarray, k_qh: np.ndarray, bonded_q: np.ndarray, dt: float
    ) -> tuple[np.ndarray, np.ndarray]:
        """Tractions (n_q, n_j) and their slopes (n_q, n_j, n_j) after a step of the time ``dt`` from the history."""

    @abstractmethod
    def committed(self, jump_qj: np.ndarray, k_qh: np.ndarray, bonded_q: np.ndarray, dt: float) -> np.ndarray:
        """The history (n_q, n_h) after a step to the jumps."""

    @abstractmethod
    def damaged(self, k_qh: np.ndarray, bonded_q: np.ndarray) -> np.ndarray:
        """d (n_q,); 1 where nothing is bonded."""

    @abstractmethod
    def held(self, k_qh: np.ndarray) -> np.ndarray:
        """The measure (n_q,) beyond which damage grows again; 0 before it has grown where the bond slides."""

    @abstractmethod
    def measure(self, jump_qj: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The measure (n_q,) of the jumps, and its derivative (n_q, n_j) at a constant mode ratio."""

    @abstractmethod
    def balance(self, jump_qj: np.ndarray, k_qh: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
        """Energies per area (n_q,): recoverable from cohesion, stored in contact and friction, and dissipated; None for
        the last where it depends on the path. The history is that after the step that led to the jumps."""
