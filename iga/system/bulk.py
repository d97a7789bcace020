"""The bulk: its forces and energy, and its part of the tangent.

There are three kinds. A `FiniteBulk` evaluates its elements in every state, a `LinearBulk` has a constant stiffness, a
`CondensedBulk` has a constant stiffness for the few displacements of the interface.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, Protocol

import numpy as np

from iga.algebra.banded import Band, number
from iga.algebra.dense import Dense
from iga.elements.bulk import Solid, element_forces, energy, full_matrices, gradient, relative, stiffness_of_batches
from iga.elements.kinematics import FINITE, LINEAR, Kinematics
from iga.interface.contact import dofs
from iga.system.assembly import Gradients, add_elements, element_places


@dataclass(frozen=True)
class Rounding:
    """Rounding errors of forces.

    ``of_elements``: relative to the largest entry of an element's stiffness times its relative displacements.
    ``stored``: relative to that entry times the displacements themselves, which are rounded when stored (the measured
    change of the forces is 1.5 to 1.8 roundings). ``lost``: relative to the forces that the unknowns of a condensed
    bulk exert on each other. ``hidden``: least force scale relative to these, with which ``lost`` is within Newton's
    tolerance, 5e-12.
    """

    of_elements: float = 40.0 * float(np.finfo(float).eps)
    stored: float = 4.0 * float(np.finfo(float).eps)
    lost: float = 10.0 * float(np.finfo(float).eps)
    hidden: float = 10.0 * float(np.finfo(float).eps) / 5e-12


ROUNDING = Rounding()


@dataclass(frozen=True)
class BulkResponse:
    """Forces ``internal_d`` (n_dof,) of the bulk, the norm ``scale`` of those of its parts, and the stored energy.

    ``gradients``: displacement gradients of the solids of a finite bulk, from which the tangent is made when needed.
    """

    internal_d: np.ndarray
    scale: float
    energy: float
    gradients: Gradients = ()


class Bulk(Protocol):
    """What a system needs to know of its bulk."""

    kinematics: ClassVar[Kinematics]

    def respond(self, u_d: np.ndarray) -> BulkResponse:
        """Forces and energy at displacements (n_dof,)."""

    def rounding(self, u_d: np.ndarray) -> float:
        """Norm of the change of the forces when the displacements (n_dof,) change by rounding."""

    def numbering(self, groups: Sequence[np.ndarray], x_d: np.ndarray, free_d: np.ndarray) -> Band | Dense:
        """Equations of the free unknowns, numbered along x_d, for groups (n, n_d) of unknowns coupled by others."""

    def assembler(self, band: Band | Dense) -> Callable[[Gradients], np.ndarray]:
        """Makes the lower half (band.size,) of the tangent stiffness from displacement gradients."""


@dataclass(frozen=True)
class ElementBulk(ABC):
    """A bulk of elements, in blocks of one shape."""

    solids: tuple[Solid, ...]
    kinematics: ClassVar[Kinematics]

    @cached_property
    def d(self) -> int:
        """Number of directions and of components."""
        return self.solids[0].basis.d

    @cached_property
    def connectivity(self) -> tuple[np.ndarray, ...]:
        """Control points (n_e, n_a) of the elements of each block."""
        return tuple(solid.basis.conn_ea for solid in self.solids)

    @cached_property
    def element_dofs(self) -> tuple[np.ndarray, ...]:
        """Degrees of freedom (n_e, d n_a) of the elements of each block."""
        return tuple(dofs(conn_ea, self.d) for conn_ea in self.connectivity)

    @cached_property
    def stiffest(self) -> tuple[np.ndarray, ...]:
        """Largest entry (n_e,) of the stiffness of each element in the reference configuration."""
        moduli = self.kinematics.moduli
        return tuple(
            np.concatenate([np.abs(K).max((1, 2, 3)) for _, K in stiffness_of_batches(solid, moduli)])
            for solid in self.solids
        )

    def places(self, band: Band | Dense) -> list[np.ndarray]:
        """Where the entries of the elements (n_e, n_h) of each block go in the lower half of the tangent."""
        return [element_places(conn_ea, self.d, band) for conn_ea in self.connectivity]

    def rounding(self, u_d: np.ndarray) -> float:
        """Long thin elements are stiff across their thickness and amplify the rounding of the displacements."""
        u_Ai, square = u_d.reshape(-1, self.d), 0.0
        for size_e, conn_ea in zip(self.stiffest, self.connectivity, strict=True):
            stretch_e = np.abs(relative(conn_ea, u_Ai)).max((1, 2))
            moved_e = np.abs(u_Ai).take(conn_ea, axis=0).max((1, 2))
            square += float(np.sum((size_e * (ROUNDING.of_elements * stretch_e + ROUNDING.stored * moved_e)) ** 2))
        return square**0.5

    def numbering(self, groups: Sequence[np.ndarray], x_d: np.ndarray, free_d: np.ndarray) -> Band | Dense:
        return number([*self.element_dofs, *groups], x_d, free_d)

    @abstractmethod
    def energy(self, u_d: np.ndarray) -> float:
        """Stored energy at displacements (n_dof,)."""

    @abstractmethod
    def assembler(self, band: Band | Dense) -> Callable[[Gradients], np.ndarray]:
        """Makes the lower half (band.size,) of the tangent stiffness from displacement gradients."""


@dataclass(frozen=True)
class FiniteBulk(ElementBulk):
    """Finite strains: stresses and stiffness follow from the displacement gradients of each state."""

    kinematics = FINITE

    def respond(self, u_d: np.ndarray) -> BulkResponse:
        internal_d, square, stored, gradients = np.zeros(u_d.size), 0.0, 0.0, []
        for solid, d in zip(self.solids, self.element_dofs, strict=True):
            H = gradient(solid.basis, u_d.reshape(-1, self.d))
            P, W = self.kinematics.stress(solid.D, H)
            f = element_forces(solid.basis, P)
            internal_d += np.bincount(d.ravel(), f.ravel(), u_d.size)
            square += float(np.sum(f * f))
            stored += energy(solid.basis, W)
            gradients.append(H)
        return BulkResponse(internal_d, square**0.5, stored, tuple(gradients))

    def energy(self, u_d: np.ndarray) -> float:
        stress, u_Ai = self.kinematics.stress, u_d.reshape(-1, self.d)
        return sum(energy(solid.basis, stress(solid.D, gradient(solid.basis, u_Ai))[1]) for solid in self.solids)

    def assembler(self, band: Band | Dense) -> Callable[[Gradients], np.ndarray]:
        places = self.places(band)

        def assemble(gradients: Gradients) -> np.ndarray:
            half = np.zeros(band.size)
            for solid, place_eh, H in zip(self.solids, places, gradients, strict=True):
                add_elements(half, place_eh, stiffness_of_batches(solid, self.kinematics.moduli, H))
            return half

        return assemble


@dataclass(frozen=True)
class LinearBulk(ElementBulk):
    """Small strains: forces are proportional to the displacements, by one stiffness."""

    kinematics = LINEAR

    @cached_property
    def matrices(self) -> tuple[np.ndarray, ...]:
        """Element stiffness (n_e, d n_a, d n_a) of each block."""
        moduli = self.kinematics.moduli
        return tuple(
            np.concatenate([full_matrices(K) for _, K in stiffness_of_batches(solid, moduli)]) for solid in self.solids
        )

    def respond(self, u_d: np.ndarray) -> BulkResponse:
        internal_d, square = np.zeros(u_d.size), 0.0
        for K, conn_ea, d in zip(self.matrices, self.connectivity, self.element_dofs, strict=True):
            f = K @ relative(conn_ea, u_d.reshape(-1, self.d)).reshape(len(d), -1, 1)
            internal_d += np.bincount(d.ravel(), f.ravel(), u_d.size)
            square += float(np.sum(f * f))
        return BulkResponse(internal_d, square**0.5, 0.5 * float(u_d @ internal_d))

    def energy(self, u_d: np.ndarray) -> float:
        doubled = 0.0
        for K, conn_ea in zip(self.matrices, self.connectivity, strict=True):
            u_ed = relative(conn_ea, u_d.reshape(-1, self.d)).reshape(len(K), -1, 1)
            doubled += float(np.sum(u_ed * (K @ u_ed)))
        return 0.5 * doubled

    def assembler(self, band: Band | Dense) -> Callable[[Gradients], np.ndarray]:
        half = np.zeros(band.size)
        for solid, place_eh in zip(self.solids, self.places(band), strict=True):
            add_elements(half, place_eh, stiffness_of_batches(solid, self.kinematics.moduli))
        return lambda _: half.copy()


@dataclass(frozen=True)
class CondensedBulk:
    """A linear bulk condensed to a few displacements, with the stiffness ``K_dd`` (n_dof, n_dof)."""

    K_dd: np.ndarray
    kinematics: ClassVar[Kinematics] = LINEAR

    @cached_property
    def squares_d(self) -> np.ndarray:
        """Sums (n_dof,) of the squares of the columns of the stiffness."""
        return np.sum(self.K_dd**2, axis=0)

    def held(self, u_d: np.ndarray) -> float:
        """Norm of the forces that the unknowns exert on each other."""
        return float(self.squares_d @ u_d**2) ** 0.5

    def respond(self, u_d: np.ndarray) -> BulkResponse:
        """Forces and energy; ``scale`` is large enough for Newton's tolerance to be above the rounding of forces."""
        internal_d = self.K_dd @ u_d
        scale = max(float(internal_d @ internal_d) ** 0.5, ROUNDING.hidden * self.held(u_d))
        return BulkResponse(internal_d, scale, 0.5 * float(u_d @ internal_d))

    def rounding(self, u_d: np.ndarray) -> float:
        return ROUNDING.lost * self.held(u_d)

    def numbering(self, groups: Sequence[np.ndarray], x_d: np.ndarray, free_d: np.ndarray) -> Dense:
        return Dense(free_d.size)

    def assembler(self, band: Band | Dense) -> Callable[[Gradients], np.ndarray]:
        return lambda _: self.K_dd.ravel().copy()


#: Bulk of a specimen by the name of its kinematics.
BULKS: dict[str, type[FiniteBulk] | type[LinearBulk]] = {"finite": FiniteBulk, "linear": LinearBulk}
