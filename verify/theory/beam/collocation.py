"""Gauss collocation for a boundary value problem y' = f(y) of a few states on given elements.

The stages of every element are eliminated first (all elements at once), which leaves one banded system for the states
at the nodes. Unlike shooting, this is stable for growing and for decaying solutions.
Source: Ascher, Mattheij, Russell (1995), Numerical Solution of Boundary Value Problems for ODEs, sections 5.3 and 7.2.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import solve_banded

STAGES = 8

Rows: TypeAlias = tuple[np.ndarray, np.ndarray]


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
    """A piecewise polynomial with values of ``a`` states.

    x : (n + 1,) nodes; node : (n + 1, a) states there; stage : (n, s, a) states at the Gauss points of the elements.
    """

    x: np.ndarray
    node: np.ndarray
    stage: np.ndarray

    @staticmethod
    def zero(x: np.ndarray, states: int) -> Field:
        return Field(x, np.zeros((len(x), states)), np.zeros((len(x) - 1, STAGES, states)))

    @property
    def states(self) -> int:
        return self.node.shape[1]

    @property
    def stage_x(self) -> np.ndarray:
        """(n, s) positions of the Gauss points."""
        return self.x[:-1, None] + np.diff(self.x)[:, None] * ABSCISSAE

    @property
    def stage_dx(self) -> np.ndarray:
        """(n, s) integration weights."""
        return np.diff(self.x)[:, None] * WEIGHTS

    def samples(self) -> tuple[np.ndarray, np.ndarray]:
        """All nodes and Gauss points in order: positions (m,) and states (m, a)."""
        x = np.concatenate((self.x[:-1, None], self.stage_x), axis=1).ravel()
        y = np.concatenate((self.node[:-1, None], self.stage), axis=1).reshape(-1, self.states)
        return np.append(x, self.x[-1]), np.vstack((y, self.node[-1]))

    def at(self, x: np.ndarray) -> np.ndarray:
        """States (..., a) at ``x`` (...)."""
        e = np.clip(np.searchsorted(self.x, x, side="right") - 1, 0, len(self.x) - 2)
        length = self.x[e + 1] - self.x[e]
        local = (x - self.x[e]) / np.where(length > 0.0, length, 1.0)
        values = np.concatenate((self.node[:-1, None], self.stage, self.node[1:, None]), axis=1)
        return np.einsum("...n,...na->...a", _lagrange(_LOCAL, local), values[e])

    def on(self, x: np.ndarray) -> Field:
        """The same function on other nodes."""
        return Field(x, self.at(x), self.at(Field.zero(x, self.states).stage_x))

    def plus(self, change: Field, factor: float = 1.0) -> Field:
        return Field(self.x, self.node + factor * change.node, self.stage + factor * change.stage)


@dataclass(frozen=True)
class Linearised:
    """One Newton linearisation: a change of the right node and of the stages of an element by that of its left node."""

    x: np.ndarray
    transfer: np.ndarray  # (n, a, a)
    defect: np.ndarray  # (n, a)
    stage_transfer: np.ndarray  # (n, s, a, a)
    stage_defect: np.ndarray  # (n, s, a)


def linearise(field: Field, f: np.ndarray, df: np.ndarray) -> Linearised:
    """Eliminate the stages; ``f`` (n, s, a) are the rates at the stages, ``df`` (n, s, a, a) their derivatives."""
    n, s, states = f.shape
    length = np.diff(field.x)
    system = -np.einsum("e,ij,ejab->eiajb", length, MATRIX, df).reshape(n, s * states, s * states)
    system += np.eye(s * states)
    residual = field.stage - field.node[:-1, None] - np.einsum("e,ij,eja->eia", length, MATRIX, f)
    right = np.concatenate(
        (
            np.broadcast_to(np.tile(np.eye(states), (s, 1)), (n, s * states, states)),
            -residual.reshape(n, s * states, 1),
        ),
        axis=2,
    )
    solved = np.linalg.solve(system, right).reshape(n, s, states, states + 1)
    carried = np.einsum("e,j,ejab,ejbc->eac", length, WEIGHTS, df, solved)
    defect = field.node[:-1] - field.node[1:] + np.einsum("e,j,eja->ea", length, WEIGHTS, f) + carried[..., -1]
    return Linearised(field.x, np.eye(states) + carried[..., :-1], defect, solved[..., :-1], solved[..., -1])


def change(
    linear: Linearised, left: Rows, right: Rows, control: tuple[int, np.ndarray, float], homogeneous: bool = False
) -> Field:
    """Newton correction of a field.

    ``left`` and ``right`` are conditions (b, a) on the correction at the first and the last node with their values
    (b,), ``control`` is (node, condition (a,), value); there are as many conditions as states. ``homogeneous`` drops
    the defects, which gives the tangent of the path.
    """
    n, states = linear.defect.shape
    begins = len(left[1])
    defect = np.zeros_like(linear.defect) if homogeneous else linear.defect
    below, above = states + begins, 2 * states - 1 - begins
    band = np.zeros((below + above + 1, states * (n + 1)))
    rhs = np.zeros(states * (n + 1))
    a = np.arange(states)

    def put(row: ArrayLike, column: np.ndarray, value: ArrayLike) -> None:
        band[above + row - column, column] = value

    def conditions(row: int, node: int, rows: np.ndarray, values: np.ndarray) -> None:
        place = row + np.arange(len(values))
        put(place[:, None], states * node + a, rows)
        rhs[place] = values

    e = np.arange(n)
    first_row = states * e + begins + (e >= control[0])
    rows = first_row[:, None, None] + a[:, None]
    put(rows, states * e[:, None, None] + a, -linear.transfer)
    put(first_row[:, None] + a, states * (e[:, None] + 1) + a, 1.0)
    rhs[first_row[:, None] + a] = defect
    conditions(0, 0, *left)
    conditions(states * control[0] + begins, control[0], control[1][None], np.array([control[2]]))
    conditions(states * n + begins + 1, n, *right)
    node = solve_banded((below, above), band, rhs).reshape(n + 1, states)
    stage = np.einsum("eiab,eb->eia", linear.stage_transfer, node[:-1])
    return Field(linear.x, node, stage if homogeneous else stage + linear.stage_defect)
