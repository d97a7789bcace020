"""Two arms as Euler-Bernoulli beams that are one beam behind the tip of a crack: estimates for any loads and supports.

Arms of bending stiffness EI_1 and EI_2 slide on each other freely in front of the tip, and push each other where they
meet. Behind it they are one beam: the bond gives way nowhere. Loads and supports act at points.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

#: Depth over the largest displacement from which on arms meet.
MEETS = 1e-9
#: Least distance of two places, over the length.
APART = 1e-9


class Force(NamedTuple):
    """A force upwards or an anticlockwise couple at X on an arm, 0 or 1, or None for both."""

    arm: int | None
    X: float
    couple: bool
    size: float = 0.0


@dataclass(frozen=True)
class BentArms:
    """Two arms from X = 0 to ``length``, cracked up to the tip.

    Parameters
    ----------
    axial : E h of the upper and the lower arm, per width
    thickness : of both
    loads, supports : supports have no size; without any the far end is clamped
    """

    length: float
    width: float
    axial: tuple[float, float]
    thickness: tuple[float, float]
    loads: tuple[Force, ...]
    supports: tuple[Force, ...]

    @property
    def bending(self) -> np.ndarray:
        """E I (3,) of the upper arm, the lower one, and of both as one, about its own axis."""
        (A1, A2), (h1, h2) = self.axial, self.thickness
        one, two = A1 * h1**2 / 12.0, A2 * h2**2 / 12.0
        both = one + two + A1 * A2 / (A1 + A2) * ((h1 + h2) / 2.0) ** 2
        return self.width * np.array([one, two, both])

    def compliance(self, tip: float) -> float:
        """Displacement that the load works on, for a load of 1."""
        return self.bent(tip).opening

    def release(self, tip: float) -> tuple[float, float]:
        """Energy release rate for an opening of 1, and the part of sliding in it.

        From the moments on both sides of the tip: ``2 w G = M1^2/EI_1 + M2^2/EI_2 - (M1 + M2)^2/EI_12``. Equal
        curvatures of both arms make it slide, moments that cancel out make it open (Williams 1988, Int. J. Fract. 36).
        """
        bent = self.bent(tip)
        first, second, both = self.bending
        M1, M2 = bent.moments
        slid = (M1 + M2) ** 2 * (1.0 / (first + second) - 1.0 / both)
        opened = (M1 * second - M2 * first) ** 2 / (first * second * (first + second))
        whole = opened + slid
        return whole / (2.0 * self.width * bent.opening**2), slid / whole if whole > 0.0 else 0.0

    def bent(self, tip: float) -> Bent:
        """Deflections and rotations under a load of 1."""
        near = APART * self.length
        X_n = np.unique([0.0, tip, self.length, *(one.X for one in (*self.loads, *self.supports))])
        X_n = X_n[np.append(True, np.diff(X_n) > near)]  # of ends, tip, loads and supports
        n_tip = int(np.argmin(np.abs(X_n - tip)))
        # unknowns, deflection and rotation of both arms, which are the same from the tip on
        dof_an2 = np.arange(2 * X_n.size).reshape(1, -1, 2).repeat(2, axis=0)
        dof_an2[1, :n_tip] += 2 * X_n.size

        def number(force: Force) -> int:
            return int(dof_an2[force.arm or 0, int(np.argmin(np.abs(X_n - force.X))), int(force.couple)])

        f = np.zeros(int(dof_an2.max()) + 1)
        K, (first, second, both) = np.zeros(2 * f.shape), self.bending
        for n, length in enumerate(np.diff(X_n)):
            for arm, EI in ((0, first), (1, second)) if n < n_tip else ((0, both),):
                dofs = dof_an2[arm, n : n + 2].ravel()
                K[np.ix_(dofs, dofs)] += _beam(EI, length)
        for load in self.loads:
            f[number(load)] += load.size
        held = [number(one) for one in self.supports] or list(dof_an2[0, -1])
        u = _pressed(K, f, sorted(set(held)), dof_an2, X_n < tip - near)
        moments = [0.0, 0.0]  # just in front of the tip
        for arm, EI in enumerate((first, second)) if n_tip else ():
            forces = _beam(EI, X_n[n_tip] - X_n[n_tip - 1]) @ u[dof_an2[arm, n_tip - 1 : n_tip + 1].ravel()]
            moments[arm] = float(forces[3])
        return Bent(float(f @ u), float(np.max(np.abs(u[dof_an2[..., 1]]))), (moments[0], moments[1]))


@dataclass(frozen=True)
class Bent:
    """The arms under a load of 1: its opening, the largest rotation, and the moments of both arms at the tip, above 0
    where they bend upwards to the left."""

    opening: float
    rotation: float
    moments: tuple[float, float]


def _beam(EI: float, l: float) -> np.ndarray:  # noqa: E741
    """Stiffness (4, 4) of a beam on deflection and rotation of both ends."""
    part = np.array([[12.0, 6.0 * l, -12.0, 6.0 * l], [6.0 * l, 4.0 * l * l, -6.0 * l, 2.0 * l * l]])
    rest = np.array([[-12.0, -6.0 * l, 12.0, -6.0 * l], [6.0 * l, 2.0 * l * l, -6.0 * l, 4.0 * l * l]])
    return EI / l**3 * np.concatenate([part, rest])


def _pressed(
    K: np.ndarray, f: np.ndarray, held: Sequence[int], dof_an2: np.ndarray, cracked_n: np.ndarray
) -> np.ndarray:
    """Displacements with the arms pushing each other where they would penetrate, and not pulling."""
    upper, lower = dof_an2[:, cracked_n, 0]
    touch: np.ndarray = np.zeros(upper.size, dtype=bool)
    u: np.ndarray = np.zeros(f.size)
    for _ in range(2 * upper.size + 1):
        one = np.arange(f.size)
        one[lower[touch]] = upper[touch]  # unknowns that are one
        one[np.isin(one, one[held])] = -1
        kept, number = np.unique(one[one >= 0], return_inverse=True)
        T = np.zeros((f.size, kept.size))
        T[one >= 0, number] = 1.0
        u = T @ np.linalg.solve(T.T @ K @ T, T.T @ f)
        apart, left = u[upper] - u[lower], K @ u - f
        push = np.where(np.isin(lower, held), left[upper], -left[lower])  # of the lower arm on the upper one
        met = np.where(touch, push > 0.0, apart < -MEETS * float(np.max(np.abs(u))))
        if np.array_equal(met, touch):
            break
        touch = met
    return u
