"""Sections of arms: displacements through the thickness, energy per length with its derivatives.

The state of a section is z = (c, c'), the values of its m unknowns and their slopes along X. Its energy per length U(z)
has the forces f = dU/dz and the stiffness D = df/dz.

Order 1 is the beam of the textbooks: c = (u, w, phi), u_x = u - phi Y, u_y = w with phi anticlockwise; and, with finite
rotations, the strains of Reissner (1972), J. Appl. Math. Phys. 23, eqs. 1-9, of a section that turns as a whole. Order
N > 1 has u_i = sum_n c_in p_n(2 Y / h) with p_0 = 1, p_1 = zeta and, up to p_N, integrals of Legendre polynomials,
P_n - P_{n-2}, that vanish at the faces; and the energy of the plane solid: linear, or of St. Venant and Kirchhoff with
the strains of Green and Lagrange. A bond has to do with p_0 and p_1 alone, and strains are no differences of large
motions.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial import legendre

from verify.theory.arms.problem import Arm, ArmsProblem
from verify.theory.layer import Layer

#: Shear correction factor of a rectangle that is free to warp; it gives the exact shear energy of the parabolic stress
#: (Reissner 1945). Cowper's 10 (1 + nu) / (12 + 11 nu) differs by 1.5 % in a term of 0.1 %.
SHEAR_CORRECTION = 5.0 / 6.0

X, Y, TURN = range(3)


@dataclass(frozen=True)
class Section(ABC):
    """A section of width ``width``, whose middle is at Y = ``middle``."""

    width: float
    thickness: float
    middle: float
    finite: bool

    @property
    @abstractmethod
    def unknowns(self) -> int:
        """Number m of unknowns."""

    @cached_property
    @abstractmethod
    def stiffness(self) -> np.ndarray:
        """D (2m, 2m) of the unstrained section."""

    @abstractmethod
    def respond(self, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, Callable[[], np.ndarray]]:
        """U (...,), f (..., 2m) and what gives D (..., 2m, 2m), at states (..., 2m) with finite strains."""

    @abstractmethod
    def moments(self, component: int) -> np.ndarray:
        """Integrals of a displacement over the height, and of it times Y less ``middle``, as rows (2, m)."""

    @abstractmethod
    def face(self, side: float) -> np.ndarray:
        """Displacements (2, m) of the face on the ``side``, -1 or 1, with small rotations."""

    @cached_property
    @abstractmethod
    def rigid(self) -> np.ndarray:
        """Values (m, 3) of the motions along X and Y and of a small turn about its middle."""

    def mean(self, component: int) -> np.ndarray:
        """Mean of a displacement over the height, (m,); of ``TURN`` the mean rotation -12/h^3 int u_x (Y - middle)."""
        h = self.thickness
        return -12.0 / h**3 * self.moments(X)[1] if component == TURN else self.moments(component)[0] / h

    def energy(self, z: np.ndarray) -> np.ndarray:
        """U (...,)."""
        return self.respond(z)[0] if self.finite else 0.5 * np.einsum("...a,ab,...b->...", z, self.stiffness, z)


@dataclass(frozen=True)
class Beam(Section):
    """Order 1: ``axial`` E A, ``bending`` E I, ``shear`` kappa G A."""

    axial: float
    bending: float
    shear: float

    @property
    def unknowns(self) -> int:
        return 3

    @cached_property
    def stiffness(self) -> np.ndarray:
        return self.respond(np.zeros(6))[2]()

    def respond(self, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, Callable[[], np.ndarray]]:
        """Strains e = (1 + u') cos phi + w' sin phi - 1, g = w' cos phi - (1 + u') sin phi, k = phi'."""
        phi, stretched, rise, bent = z[..., 2], 1.0 + z[..., 3], z[..., 4], z[..., 5]
        c, s = np.cos(phi), np.sin(phi)
        length, slid = stretched * c + rise * s, rise * c - stretched * s
        N, Q, M = self.axial * (length - 1.0), self.shear * slid, self.bending * bent
        f = np.zeros(z.shape)
        U = 0.5 * (N * (length - 1.0) + Q * slid + M * bent)
        f[..., 2], f[..., 3], f[..., 4], f[..., 5] = N * slid - Q * length, N * c - Q * s, N * s + Q * c, M

        def tangent() -> np.ndarray:
            D = np.zeros((*z.shape, 6))
            de = np.stack((slid, c, s), axis=-1)  # by phi, u', w'
            dg = np.stack((-length, -s, c), axis=-1)
            part = self.axial * de[..., :, None] * de[..., None, :] + self.shear * dg[..., :, None] * dg[..., None, :]
            turned = np.stack((-N * length - Q * slid, -N * s - Q * c, N * c - Q * s), axis=-1)
            part[..., 0, :] += turned
            part[..., 1:, 0] += turned[..., 1:]
            D[..., 2:5, 2:5] = part
            D[..., 5, 5] = self.bending
            return D

        return U, f, tangent

    def moments(self, component: int) -> np.ndarray:
        h = self.thickness
        found = np.zeros((2, 3))
        if component == X:
            found[0, 0], found[1, 2] = h, -(h**3) / 12.0
        else:
            found[0, 1] = h
        return found

    def face(self, side: float) -> np.ndarray:
        return np.array([[1.0, 0.0, -side * 0.5 * self.thickness], [0.0, 1.0, 0.0]])

    @cached_property
    def rigid(self) -> np.ndarray:
        return np.eye(3)


@dataclass(frozen=True)
class Plane(Section):
    """Order N: values (n_y, m') and slopes of the polynomials at Gauss points through the height, with weights.

    Both displacements have the same polynomials, m = 2 m'. ``elastic`` (3, 3) is the stiffness of the solid.
    ``clamped`` is the side of a face that does not move, 0 if there is none.
    """

    elastic: np.ndarray
    order: int
    clamped: float = 0.0

    @property
    def unknowns(self) -> int:
        return 2 * (self.order + (0 if self.clamped else 1))

    @cached_property
    def _coefficients(self) -> np.ndarray:
        """Legendre series (m', N + 1) of the polynomials; (1 - clamped zeta) / 2 for the first two if clamped."""
        found = np.eye(self.order + 1)
        found[2:] -= np.eye(self.order + 1)[:-2]
        free = 0.5 * (found[:1] - self.clamped * found[1:2])
        return np.concatenate((free, found[2:])) if self.clamped else found

    def _polynomials(self, zeta: np.ndarray, slopes: bool = False) -> np.ndarray:
        """Values (..., m'), or derivatives by Y."""
        series = self._coefficients.T
        if slopes:
            series = legendre.legder(series, axis=0) * 2.0 / self.thickness
        return legendre.legval(zeta, series).T

    @cached_property
    def _points(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Weights (n_y,) with the width, values and slopes (n_y, m'); exact where strains are
        small: the quartic part of the energy is that of rotations, which hardly change through the thickness."""
        at, weight = legendre.leggauss(self.order + (2 if self.finite else 1))
        return 0.5 * self.thickness * self.width * weight, self._polynomials(at), self._polynomials(at, slopes=True)

    @cached_property
    def _gradient(self) -> np.ndarray:
        """Displacement gradients (H_xX, H_xY, H_yX, H_yY) at the points by z, (n_y, 4, 2m)."""
        _, N, dN = self._points
        n, m = N.shape
        G = np.zeros((n, 4, 2, 2, m))  # value or slope, component, polynomial
        G[:, 0, 1, 0] = G[:, 2, 1, 1] = N
        G[:, 1, 0, 0] = G[:, 3, 0, 1] = dN
        return G.reshape(n, 4, 4 * m)

    @cached_property
    def stiffness(self) -> np.ndarray:
        B = self._gradient[:, [0, 3, 1]].copy()
        B[:, 2] += self._gradient[:, 2]
        return np.einsum("y,yia,ij,yjb->ab", self._points[0], B, self.elastic, B, optimize=True)

    def respond(self, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, Callable[[], np.ndarray]]:
        weight, G = self._points[0], self._gradient
        flat, (n_y, _, m) = z.reshape(-1, z.shape[-1]), G.shape
        H = (flat @ G.reshape(n_y * 4, m).T).reshape(-1, n_y, 4)
        F = H + np.array([1.0, 0.0, 0.0, 1.0])
        E = np.empty((*H.shape[:2], 3))
        E[..., 0] = H[..., 0] + 0.5 * (H[..., 0] ** 2 + H[..., 2] ** 2)
        E[..., 1] = H[..., 3] + 0.5 * (H[..., 1] ** 2 + H[..., 3] ** 2)
        E[..., 2] = H[..., 1] + H[..., 2] + H[..., 0] * H[..., 1] + H[..., 2] * H[..., 3]
        S = E @ self.elastic
        B = np.zeros((*H.shape[:2], 3, 4))
        B[..., 0, 0::2], B[..., 1, 1::2] = F[..., 0::2], F[..., 1::2]
        B[..., 2, 0::2], B[..., 2, 1::2] = F[..., 1::2], F[..., 0::2]
        P = np.matmul(S[..., None, :], B)[..., 0, :] * weight[:, None]
        f = P.reshape(-1, n_y * 4) @ G.reshape(n_y * 4, m)
        U = 0.5 * np.einsum("nyi,nyi,y->n", S, E, weight)
        shape = z.shape[:-1]

        def tangent() -> np.ndarray:
            A = B.swapaxes(-1, -2) @ (self.elastic @ B)
            for i in (0, 2):
                A[..., i, i] += S[..., 0]
                A[..., i + 1, i + 1] += S[..., 1]
                A[..., i, i + 1] += S[..., 2]
                A[..., i + 1, i] += S[..., 2]
            A *= weight[:, None, None]
            D = G.reshape(n_y * 4, m).T @ (A @ G).reshape(-1, n_y * 4, m)
            return D.reshape(*shape, m, m)

        return U.reshape(shape), f.reshape(z.shape), tangent

    def moments(self, component: int) -> np.ndarray:
        at, weight = legendre.leggauss(self.order + 2)
        N, dY = self._polynomials(at), 0.5 * self.thickness * weight
        found = np.zeros((2, 2, N.shape[1]))
        found[0, component], found[1, component] = dY @ N, (0.5 * self.thickness * at * dY) @ N
        return found.reshape(2, -1)

    def face(self, side: float) -> np.ndarray:
        N = np.zeros(self.unknowns // 2)
        if self.clamped:
            N[0] = side != self.clamped
        else:
            N[:2] = 1.0, side
        return np.kron(np.eye(2), N)

    @cached_property
    def rigid(self) -> np.ndarray:
        found = np.zeros((2, self.unknowns // 2, 3))
        if not self.clamped:
            found[0, 0, X] = found[1, 0, Y] = 1.0
            found[0, 1, TURN] = -0.5 * self.thickness
        return found.reshape(-1, 3)


@dataclass(frozen=True)
class Base(Section):
    """The elastic layer under a strip: its one unknown is the deflection w of its face, U = (k w^2 + g w'^2) / 2."""

    bed: float
    coupling: float

    @property
    def unknowns(self) -> int:
        return 1

    @cached_property
    def stiffness(self) -> np.ndarray:
        return self.width * np.diag([self.bed, self.coupling])

    def respond(self, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, Callable[[], np.ndarray]]:
        f = z @ self.stiffness
        return 0.5 * np.sum(f * z, axis=-1), f, lambda: np.broadcast_to(self.stiffness, (*z.shape, 2))

    def moments(self, component: int) -> np.ndarray:
        return np.zeros((2, 1))

    def face(self, side: float) -> np.ndarray:
        return np.array([[0.0], [1.0]])

    @cached_property
    def rigid(self) -> np.ndarray:
        return np.zeros((1, 3))


def sections(problem: ArmsProblem) -> tuple[Section, ...]:
    """Of all bodies; one that stands for both arms has twice the width."""
    b = problem.width * (2.0 if problem.mirrored else 1.0)
    return tuple(_section(problem, body, 1.0 if i == 0 else -1.0, b) for i, body in enumerate(problem.bodies))


def _section(problem: ArmsProblem, body: Arm | Layer, up: float, b: float) -> Section:
    h = body.thickness
    place = b, h, 0.5 * up * h, problem.finite
    if isinstance(body, Layer):
        strip = problem.arms[0]
        bed, coupling = body.beneath(strip.young * strip.thickness**3 / 12.0, problem.bond.slopes[0])
        return Base(*place, bed, coupling)
    if problem.order == 1:
        return Beam(*place, body.young * b * h, body.young * b * h**3 / 12.0, SHEAR_CORRECTION * body.shear * b * h)
    assert body.stiffness is not None
    return Plane(*place, body.stiffness, problem.order, up if body.clamped else 0.0)
