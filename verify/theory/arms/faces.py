"""The jump of the bonded faces: functionals y of the unknowns, and gap and slip as functions of them.

Small rotations: y are gap and slip themselves. Finite rotations of arms whose bond opens alone: the gap along Y, for
traction and jump keep their direction there. Where it slides as well:

    s = J . e,  g = J . n,  ds = e . dJ + g dt,  dg = n . dJ - s dt

with the jump J of the displacements and the unit vectors e and n along and across the mean deformed face, which is
turned by the angle t (Ortiz and Pandolfi 1999, Int. J. Numer. Methods Eng. 44, 1267-1282): of sections of order N that
of the mean slope of both faces, y = (J_x, J_y, m_x - 1, m_y); of rigid sections their mean turn, y = (u, w, phi)
of both.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from verify.theory.arms.problem import ArmsProblem
from verify.theory.arms.sections import Base, Beam, Section, X, Y


class Jump(NamedTuple):
    """Jumps (..., J), gap first, with first (..., J, i) and second (..., J, i, i) derivatives, None where zero."""

    value: np.ndarray
    first: np.ndarray
    second: np.ndarray | None


@dataclass(frozen=True)
class Faces:
    """``values`` and ``slopes`` (i, m): the functionals by the unknowns of a function, and by their slopes along X."""

    values: np.ndarray
    slopes: np.ndarray

    @property
    def turns(self) -> bool:
        """Whether slopes count."""
        return bool(np.any(self.slopes))

    @cached_property
    def touched(self) -> np.ndarray:
        """Unknowns (k,) of a function that the functionals have to do with."""
        return np.flatnonzero(np.any(np.vstack((self.values, self.slopes)), axis=0))

    @cached_property
    def parts(self) -> tuple[tuple[np.ndarray, np.ndarray], ...]:
        """Functionals (i',) of values, and of slopes where there are any, with their rows (i', k)."""
        found = []
        for rows in (self.values, self.slopes)[: 2 if self.turns else 1]:
            of = np.flatnonzero(np.any(rows, axis=1))
            found.append((of, rows[np.ix_(of, self.touched)]))
        return tuple(found)

    def jump(self, y: np.ndarray) -> Jump:
        """Of functionals (..., i)."""
        return Jump(y, np.broadcast_to(np.eye(y.shape[-1]), (*y.shape, y.shape[-1])), None)


@dataclass(frozen=True)
class Turned(Faces):
    """Of sections of order N that turn."""

    def jump(self, y: np.ndarray) -> Jump:
        m = y[..., 2:] + np.array([1.0, 0.0])
        length = np.linalg.norm(m, axis=-1, keepdims=True)
        e = m / length
        n = np.stack((-e[..., 1], e[..., 0]), axis=-1)
        turn = n / length  # dt/dm
        bent = -(e[..., :, None] * n[..., None, :] + n[..., :, None] * e[..., None, :]) / length[..., None] ** 2
        return _in_frame(y[..., :2], (e, n), turn, bent)


def _in_frame(J: np.ndarray, frame: tuple[np.ndarray, np.ndarray], turn: np.ndarray, bent: np.ndarray) -> Jump:
    """Gap and slip by (J, m) of a frame that turns by t(m), with dt/dm (..., k) and d2t/dm2 (..., k, k)."""
    e, n = frame
    k = 2 + turn.shape[-1]
    g, s = np.sum(J * n, axis=-1), np.sum(J * e, axis=-1)
    first, second = np.zeros((*g.shape, 2, k)), np.zeros((*g.shape, 2, k, k))
    squared = turn[..., :, None] * turn[..., None, :]
    for j, (value, other, along, across) in enumerate(((g, -s, n, -e), (s, g, e, n))):
        first[..., j, :2], first[..., j, 2:] = along, other[..., None] * turn
        mixed = across[..., :, None] * turn[..., None, :]
        second[..., j, :2, 2:], second[..., j, 2:, :2] = mixed, mixed.swapaxes(-1, -2)
        second[..., j, 2:, 2:] = other[..., None, None] * bent - value[..., None, None] * squared
    return Jump(np.stack((g, s), axis=-1), first, second)


@dataclass(frozen=True)
class Rigid(Faces):
    """Of two rigid sections that turn: faces at u + h/2 sin phi, w + h/2 (1 - cos phi) with h from ``heights``."""

    heights: tuple[float, float]

    def jump(self, y: np.ndarray) -> Jump:
        half = 0.5 * np.array(self.heights)
        phi = y[..., [2, 5]]
        c, s = np.cos(phi), np.sin(phi)
        J = y[..., :2] - y[..., 3:5] + np.stack((s @ half, (1.0 - c) @ half), axis=-1)
        t = phi.mean(axis=-1)
        frame = np.stack((np.cos(t), np.sin(t)), axis=-1), np.stack((-np.sin(t), np.cos(t)), axis=-1)
        inner = _in_frame(J, frame, np.ones((*t.shape, 1)), np.zeros((*t.shape, 1, 1)))
        dJ = np.zeros((*t.shape, 3, 6))  # of (J_x, J_y, t) by y
        dJ[..., 0, 0] = dJ[..., 1, 1] = 1.0
        dJ[..., 0, 3] = dJ[..., 1, 4] = -1.0
        dJ[..., 0, [2, 5]], dJ[..., 1, [2, 5]], dJ[..., 2, [2, 5]] = c * half, s * half, 0.5
        second = dJ.swapaxes(-1, -2)[..., None, :, :] @ inner.second @ dJ[..., None, :, :]
        for i, k in ((0, 2), (1, 5)):
            second[..., k, k] += inner.first[..., 0] * (-s * half)[..., None, i]
            second[..., k, k] += inner.first[..., 1] * (c * half)[..., None, i]
        return Jump(inner.value, inner.first @ dJ, second)


@dataclass(frozen=True)
class Raised(Faces):
    """Of a strip whose rigid sections turn, on a layer: the gap y_0 + h/2 (1 - cos phi), with phi = y_1."""

    height: float

    def jump(self, y: np.ndarray) -> Jump:
        c, s, half = np.cos(y[..., 1]), np.sin(y[..., 1]), 0.5 * self.height
        second = np.zeros((*y.shape[:-1], 1, 2, 2))
        second[..., 0, 1, 1] = half * c
        return Jump(
            (y[..., 0] + half * (1.0 - c))[..., None], np.stack((np.ones_like(s), half * s), -1)[..., None, :], second
        )


def faces_of(problem: ArmsProblem, parts: Sequence[Section]) -> Faces:
    """The faces of a problem."""
    upper = parts[0]
    if problem.mirrored:
        rows = 2.0 * upper.face(-1.0)[[Y]]
        return Faces(rows, np.zeros_like(rows))
    lower = parts[1]
    above, below = upper.face(-1.0), lower.face(1.0)
    jump = np.hstack((above, -below))
    if not problem.bond.slides:
        if problem.finite and isinstance(upper, Beam) and isinstance(lower, Base):
            rows = np.vstack((jump[[Y]], np.eye(jump.shape[1])[[2]]))
            return Raised(rows, np.zeros_like(rows), upper.thickness)
        return Faces(jump[[Y]], np.zeros_like(jump[[Y]]))
    if not problem.finite:
        return Faces(jump[[Y, X]], np.zeros_like(jump))
    if problem.order == 1:
        return Rigid(np.eye(6), np.zeros((6, 6)), (upper.thickness, lower.thickness))
    none = np.zeros_like(jump)
    mean = 0.5 * np.hstack((above, below))
    return Turned(np.vstack((jump, none)), np.vstack((none, mean)))
