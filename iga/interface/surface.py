"""A surface as a chain of element sides: rational curves, evaluated at many points at once."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from iga.mesh.bernstein import bernstein_jet
from iga.mesh.extraction import SIDES, Chain, Mesh, on_side

#: Coefficients of an extraction operator below this count as zero.
EXTRACTED = 1e-13


@dataclass(frozen=True)
class Surface:
    """A chain of n_c rational curves of degree p.

    ``C_cab`` (n_c, p+1, p+1) is the homogeneous extraction ``w_A C_Ab`` of each side and ``conn_ca`` (n_c, p+1) its
    control points; ``w_cb`` (n_c, p+1) are the Bezier weights. Whatever the mesh, p + 1 functions live on a side of
    degree p. ``outward`` is +1 where the body lies to the left of the walking direction, -1 where to the right. It may
    be several ``chains`` of as many sides, one after the other.
    """

    degree: int
    C_cab: np.ndarray
    conn_ca: np.ndarray
    w_cb: np.ndarray
    outward: float
    chains: int = 1

    @cached_property
    def sides(self) -> int:
        return len(self.w_cb)

    @cached_property
    def closed(self) -> bool:
        """The last side ends where the first one begins, in the same functions."""
        end, start = self.C_cab[-1][:, -1], self.C_cab[0][:, 0]
        ends, starts = np.abs(end) > EXTRACTED, np.abs(start) > EXTRACTED
        return self.sides > 1 and set(self.conn_ca[-1][ends]) == set(self.conn_ca[0][starts])

    @cached_property
    def polynomial(self) -> bool:
        """All weights equal one: the curves are polynomials."""
        return bool(np.allclose(self.w_cb, 1.0, rtol=0.0, atol=1e-13))

    def bezier_points(self, x_AI: np.ndarray, c_q: np.ndarray | None = None) -> np.ndarray:
        """Homogeneous Bezier points (n_c, p + 1, 2) of a configuration x_AI (n_A, 2) of the control points.

        Of the sides c_q (n_q,) alone where they are given: (n_q, p + 1, 2).
        """
        if c_q is None or len(c_q) > self.sides:
            every_cbi = self.C_cab.swapaxes(1, 2) @ x_AI.take(self.conn_ca, axis=0)
            return every_cbi if c_q is None else every_cbi[c_q]
        return self.C_cab.take(c_q, axis=0).swapaxes(1, 2) @ x_AI.take(self.conn_ca.take(c_q, axis=0), axis=0)

    def coefficients(self, c_q: np.ndarray, xi_q: np.ndarray, orders: int) -> tuple[np.ndarray, ...]:
        """Rational Bernstein values and derivatives (n_q, p + 1) at xi_q on the sides c_q, up to an order of 3 at most.

        Quotient rule (Piegl and Tiller 1997, eq. 4.8): ``r_k = (B^(k) - sum_{i=1..k} binom(k, i) W^(i) r_{k-i}) / W``.
        """
        B = bernstein_jet(self.degree, xi_q, orders)
        if self.polynomial:
            return tuple(B)
        W = [np.sum(self.w_cb[c_q] * b, -1, keepdims=True) for b in B]
        r = [B[0] / W[0]]
        if orders > 0:
            r.append((B[1] - W[1] * r[0]) / W[0])
        if orders > 1:
            r.append((B[2] - 2.0 * W[1] * r[1] - W[2] * r[0]) / W[0])
        if orders > 2:
            r.append((B[3] - 3.0 * W[1] * r[2] - 3.0 * W[2] * r[1] - W[3] * r[0]) / W[0])
        return tuple(r)

    def following(self, c_q: np.ndarray, number_q: np.ndarray) -> np.ndarray:
        """Sides (n_q,) a number of steps further along the chain (negative: back), but not beyond an end of it."""
        further = c_q + number_q
        if self.chains > 1:
            sides = self.sides // self.chains
            return np.clip(further, c_q // sides * sides, c_q // sides * sides + sides - 1)
        return further % self.sides if self.closed else np.clip(further, 0, self.sides - 1)

    def chain(self, number: int) -> Surface:
        """One of the chains."""
        sides = self.sides // self.chains
        here = slice(sides * number, sides * (number + 1))
        return replace(self, C_cab=self.C_cab[here], conn_ca=self.conn_ca[here], w_cb=self.w_cb[here], chains=1)

    def functions(self, c_q: np.ndarray, r_qb: np.ndarray) -> np.ndarray:
        """Basis functions (n_q, p + 1), in the order of ``conn_ca[c_q]``, from coefficients r_qb on the sides c_q."""
        return (self.C_cab.take(c_q, axis=0) @ r_qb[..., None])[..., 0]


def surface(mesh: Mesh, chain: Chain, first: int) -> Surface:
    """The surface of a chain of one body, whose control points are numbered from ``first`` on in the whole model.

    Raises
    ------
    ValueError : sides of different degrees in one chain, or a side on which not p + 1 functions live.
    """
    degrees = {mesh.blocks[b].degrees[1 - SIDES[side][0]] for _, b, side in chain.parts()}
    if len(degrees) != 1:
        raise ValueError(f"a surface needs sides of one degree, got degrees {sorted(degrees)}")
    p = degrees.pop()
    n_c = len(chain.element_c)
    C_cab, conn_ca = np.empty((n_c, p + 1, p + 1)), np.empty((n_c, p + 1), dtype=int)
    for here, number, side in chain.parts():
        block, e = mesh.blocks[number], chain.element_c[here]
        trace_cab = block.C_eab[e][:, :, on_side(block.degrees, side)]
        alive = np.any(np.abs(trace_cab) > EXTRACTED, axis=2)  # files have rounding where nothing should be
        if not np.all(alive.sum(1) == p + 1):
            raise ValueError(f"a side of degree {p} must carry {p + 1} functions, got {sorted(set(alive.sum(1)))}")
        row, a = np.nonzero(alive)
        conn_ca[here] = block.conn_ea[e][row, a].reshape(-1, p + 1)
        C_cab[here] = trace_cab[row, a].reshape(-1, p + 1, p + 1) * mesh.w_A[conn_ca[here]][..., None]
    turned = chain.reversed_c
    C_cab[turned] = C_cab[turned][:, :, ::-1]
    return Surface(p, C_cab, conn_ca + first, C_cab.sum(1), chain.outward)


def normal(tangent_qi: np.ndarray, outward: float) -> np.ndarray:
    """Unit outward normal (n_q, 2): the tangent turned clockwise where the body lies to the left (``outward`` +1)."""
    n = outward * np.stack([tangent_qi[:, 1], -tangent_qi[:, 0]], -1)
    return n / np.sqrt(np.sum(n * n, -1, keepdims=True))
