"""Gauss collocation for a boundary value problem y' = f(y) of four states on elements that the caller places.

The stages of every element are eliminated first (all elements at once), which leaves one banded system for the states
at the nodes. Nothing is shot across the domain: growing and decaying solutions are both harmless.
Source: Ascher, Mattheij, Russell (1995), Numerical Solution of Boundary Value Problems for ODEs, sections 5.3 and 7.2.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_banded

STAGES = 8
STATES = 4


def _tableau(stages: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Abscissae c (s,), weights b (s,) and matrix A (s, s) of the Gauss rule on [0, 1]."""
    z, weight = np.polynomial.legendre.leggauss(stages)
    c, b = (z + 1.0) / 2.0, weight / 2.0
    inner = c[:, None] * c[None, :]  # Gauss points of [0, c_i]
    A = np.einsum("i,k,ikj->ij", c, b, _lagrange(c, inner))
    return c, b, A


def _lagrange(nodes: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Lagrange polynomials of ``nodes`` (n,) at ``at`` (...,): (..., n)."""
    difference = at[..., None] - nodes
    columns = []
    for j in range(len(nodes)):
        others = np.arange(len(nodes)) != j
        columns.append(np.prod(difference[..., others] / (nodes[j] - nodes[others]), axis=-1))
    return np.stack(columns, axis=-1)


ABSCISSAE, WEIGHTS, MATRIX = _tableau(STAGES)
_LOCAL = np.concatenate(([0.0], ABSCISSAE, [1.0]))


@dataclass(frozen=True)
class Field:
    """A piecewise polynomial of four states.

    x : (n + 1,) nodes; node : (n + 1, 4) states there; stage : (n, s, 4) states at the Gauss points of the elements.
    """

    x: np.ndarray
    node: np.ndarray
    stage: np.ndarray

    @property
    def stage_x(self) -> np.ndarray:
        """(n, s) positions of the Gauss points."""
        return self.x[:-1, None] + np.diff(self.x)[:, None] * ABSCISSAE

    @property
    def stage_dx(self) -> np.ndarray:
        """(n, s) integration weights."""
        return np.diff(self.x)[:, None] * WEIGHTS

    def samples(self) -> tuple[np.ndarray, np.ndarray]:
        """Every node and Gauss point in order: positions (m,) and states (m, 4)."""
        x = np.concatenate((self.x[:-1, None], self.stage_x), axis=1).ravel()
        y = np.concatenate((self.node[:-1, None], self.stage), axis=1).reshape(-1, STATES)
        return np.append(x, self.x[-1]), np.vstack((y, self.node[-1]))

    def at(self, x: np.ndarray) -> np.ndarray:
        """States (..., 4) at ``x`` (...)."""
        e = np.clip(np.searchsorted(self.x, x, side="right") - 1, 0, len(self.x) - 2)
        length = self.x[e + 1] - self.x[e]
        local = (x - self.x[e]) / np.where(length > 0.0, length, 1.0)
        values = np.concatenate((self.node[:-1, None], self.stage, self.node[1:, None]), axis=1)
        return np.einsum("...n,...na->...a", _lagrange(_LOCAL, local), values[e])

    def on(self, x: np.ndarray) -> Field:
        """The same function on other nodes."""
        moved = Field(x, np.zeros((len(x), STATES)), np.zeros((len(x) - 1, STAGES, STATES)))
        return Field(x, self.at(x), self.at(moved.stage_x))

    def plus(self, change: Field, factor: float = 1.0) -> Field:
        return Field(self.x, self.node + factor * change.node, self.stage + factor * change.stage)


@dataclass(frozen=True)
class Linearised:
    """One Newton linearisation: transfer of a change across each element, and of the stages by the left node."""

    x: np.ndarray
    transfer: np.ndarray  # (n, 4, 4)
    defect: np.ndarray  # (n, 4)
    stage_transfer: np.ndarray  # (n, s, 4, 4)
    stage_defect: np.ndarray  # (n, s, 4)


def linearise(field: Field, f: np.ndarray, df: np.ndarray) -> Linearised:
    """Eliminate the stages, given the rates ``f`` (n, s, 4) and their derivative ``df`` (n, s, 4, 4) at the stages."""
    n, s = f.shape[:2]
    length = np.diff(field.x)
    system = -np.einsum("e,ij,ejab->eiajb", length, MATRIX, df).reshape(n, s * STATES, s * STATES)
    system += np.eye(s * STATES)
    residual = field.stage - field.node[:-1, None] - np.einsum("e,ij,eja->eia", length, MATRIX, f)
    right = np.concatenate((np.broadcast_to(np.tile(np.eye(STATES), (s, 1)), (n, s * STATES, STATES)),
                            -residual.reshape(n, s * STATES, 1)), axis=2)
    solved = np.linalg.solve(system, right).reshape(n, s, STATES, STATES + 1)
    carried = np.einsum("e,j,ejab,ejbc->eac", length, WEIGHTS, df, solved)
    defect = field.node[:-1] - field.node[1:] + np.einsum("e,j,eja->ea", length, WEIGHTS, f) + carried[..., -1]
    return Linearised(field.x, np.eye(STATES) + carried[..., :-1], defect, solved[..., :-1], solved[..., -1])


def change(linear: Linearised, left: tuple[int, float], right: tuple[tuple[int, float], ...],
           control: tuple[int, int, float], homogeneous: bool = False) -> Field:
    """Newton change of a field.

    ``left`` = (state, value) at the first node, ``right`` = two of them at the last, ``control`` = (node, state,
    value); values are those of the change. ``homogeneous`` drops the defects: the tangent of the path.
    """
    n = len(linear.transfer)
    defect = np.zeros_like(linear.defect) if homogeneous else linear.defect
    below, above = 5, 6
    band = np.zeros((below + above + 1, STATES * (n + 1)))
    rhs = np.zeros(STATES * (n + 1))

    def put(row, column, value):
        band[above + row - column, column] = value

    e = np.arange(n)
    first_row = STATES * e + np.where(e < control[0], 1, 2)
    a = np.arange(STATES)
    rows = first_row[:, None, None] + a[:, None]
    put(rows, STATES * e[:, None, None] + a, -linear.transfer)
    put(first_row[:, None] + a, STATES * (e[:, None] + 1) + a, 1.0)
    rhs[first_row[:, None] + a] = defect
    put(0, left[0], 1.0)
    rhs[0] = left[1]
    row = STATES * control[0] + 1
    put(row, STATES * control[0] + control[1], 1.0)
    rhs[row] = control[2]
    for i, (state, value) in enumerate(right):
        put(STATES * n + 2 + i, STATES * n + state, 1.0)
        rhs[STATES * n + 2 + i] = value
    node = solve_banded((below, above), band, rhs).reshape(n + 1, STATES)
    stage = np.einsum("eiab,eb->eia", linear.stage_transfer, node[:-1])
    return Field(linear.x, node, stage if homogeneous else stage + linear.stage_defect)
