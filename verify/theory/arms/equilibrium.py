"""Equilibrium of the arms on their bond, by Newton's method for displacements and jumps of the bond together.

The jump of the bond at a point is an unknown of that point, with an equation of its own, beam jump = (g, s) + c (p, t),
which is eliminated in every iteration: no iteration is nested in another.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from verify.theory.arms.equations import Bordered
from verify.theory.arms.interface import History, Interface
from verify.theory.arms.structure import Structure


@dataclass(frozen=True)
class Limits:
    """Limits of Newton's method.

    ``iterations`` : at most
    ``at_first`` : those from the specimen at rest, whose zones of contact are found element by element
    ``change`` : of the jumps in the last one, as a part of those at onset; the error after it is of its square
    ``rounding`` : the same as a part of the largest displacement, of which the jumps are differences
    """

    iterations: int = 20
    at_first: int = 300
    change: float = 1e-7
    rounding: float = 1e-8


ARMS_NEWTON = Limits()


@dataclass(frozen=True)
class Direction:
    """How a state changes with the parameter of its path: unknowns, load, jumps (E, q, 2) of the bond."""

    x: np.ndarray
    load: float
    jump: np.ndarray


@dataclass(frozen=True)
class State:
    """Unknowns (n,), load, reactions (m,), and the jump (E, q, 2) of the bond; the history is that after the state."""

    x: np.ndarray
    load: float
    reactions: np.ndarray
    jump: np.ndarray
    history: History
    direction: Direction | None = None
    iterations: int = 0


@dataclass(frozen=True)
class Control:
    """What a step prescribes: the progress of the bond at a point (element, point), or else the opening."""

    value: float
    at: tuple[int, int] | None = None


@dataclass(frozen=True)
class Model:
    """A structure and the bond between its arms."""

    structure: Structure
    interface: Interface

    def intact(self) -> State:
        one = self.structure
        shape = self.interface.bonded.shape
        history = History.start(self.interface.bonded)
        return State(np.zeros(one.mesh.count), 0.0, np.zeros(len(one.held)), np.zeros((*shape, 2)), history)

    @cached_property
    def _products(self) -> np.ndarray:
        """Products (q i j, a b) of the jumps, of which stiffnesses of the interface are sums."""
        B = self.structure.jump_qia
        return np.einsum("qia,qjb->qijab", B, B).reshape(B.shape[0] * 4, -1)

    def stiffness(self, D_eqij: np.ndarray) -> np.ndarray:
        """Stiffness (E, 30, 30) with the tangent of the interface (E, q, 2, 2)."""
        D = D_eqij * self.structure.weight_eq[:, :, None, None]
        K = self.structure.stiffness_eab
        return K + (D.reshape(len(D), -1) @ self._products).reshape(K.shape)

    def beam_jump(self, x: np.ndarray) -> np.ndarray:
        """Jump (E, q, 2) of the faces of the beams."""
        return np.einsum("qia,ea->eqi", self.structure.jump_qia, x[self.structure.mesh.dofs_el], optimize=True)

    def internal(self, x: np.ndarray, traction: np.ndarray) -> np.ndarray:
        """Forces (n,) of the arms and of tractions (E, q, 2) of the interface.

        An element that moves as a whole has none: left in, rounding of its motion adds up along the arms.
        """
        one, mesh = self.structure, self.structure.mesh
        forces = np.einsum("eab,eb->ea", one.stiffness_eab, mesh.within(x))
        forces += np.einsum("qia,eqi,eq->ea", one.jump_qia, traction, one.weight_eq, optimize=True)
        return np.bincount(mesh.dofs_el.ravel(), forces.ravel(), mesh.count)

    def traction(self, state: State, before: History) -> np.ndarray:
        """(p, t) at all points, (E, q, 2)."""
        now = self.interface.tractions(state.jump[..., 0], state.jump[..., 1], before)
        return np.stack((now.p, now.t), axis=-1)


def solve(model: Model, guess: State, last: State, control: Control) -> State | None:
    """The state after ``last`` that meets the control; None where Newton's method does not converge."""
    limits, scale = ARMS_NEWTON, model.interface.scale
    state, before = guess, last.history
    for iteration in range(1, (limits.iterations if guess.iterations else limits.at_first) + 1):
        try:
            state, direction, change = _iterate(model, state, before, control)
        except np.linalg.LinAlgError:
            return None
        if not np.all(np.isfinite(change)) or np.abs(state.jump / scale).max() > 1e12:
            return None
        if np.all(np.abs(change) <= np.maximum(limits.change * scale, limits.rounding * np.abs(state.x).max())):
            history = model.interface.advanced(state.jump, last.jump, before)
            return replace(state, history=history, direction=direction, iterations=iteration)
    return None


def _iterate(model: Model, state: State, before: History, control: Control) -> tuple[State, Direction, np.ndarray]:
    """One iteration: the new state, how it changes with the control, and the change of the jumps."""
    one, face, give = model.structure, model.interface, np.array(model.interface.give)
    g, s = state.jump[..., 0], state.jump[..., 1]
    traction, D = model.traction(state, before), face.tangent(g, s, before)
    A = np.linalg.inv(np.eye(2) + give[:, None] * D)  # change of the bond's jump by that of the beams
    open_el = state.jump + give * traction - model.beam_jump(state.x)
    DA = D @ A
    effective = traction - np.einsum("eqij,eqj->eqi", DA, open_el)
    equations = Bordered(one, model.stiffness(DA))
    b = one.load * state.load + one.held.T @ state.reactions - model.internal(state.x, effective)
    row, e, rate = _control(model, state, A, open_el, control)
    dx, dP, dR = equations.solve(b, -one.held @ state.x, row, 0.0, e)
    tx, tP, _ = equations.solve(np.zeros_like(b), np.zeros(len(one.held)), row, 0.0, rate)
    change = np.einsum("eqij,eqj->eqi", A, model.beam_jump(dx) - open_el)
    direction = Direction(tx, float(tP), np.einsum("eqij,eqj->eqi", A, model.beam_jump(tx)))
    new = replace(
        state, x=state.x + dx, load=state.load + float(dP), reactions=state.reactions + dR, jump=state.jump + change
    )
    return new, direction, change


def _control(
    model: Model, state: State, A: np.ndarray, open_el: np.ndarray, control: Control
) -> tuple[np.ndarray, float, float]:
    """Row (n,), right-hand side, and its rate with the parameter."""
    one = model.structure
    if control.at is None:
        return one.load, control.value - float(one.load @ state.x), 1.0
    e, q = control.at
    jump, scale = state.jump[e, q], model.interface.scale
    step = 1e-6 * scale
    shifts = np.array(
        [
            jump + np.array([step[0], 0.0]),
            jump - np.array([step[0], 0.0]),
            jump + np.array([0.0, step[1]]),
            jump - np.array([0.0, step[1]]),
        ]
    )
    r = model.interface.progress(shifts[:, 0], shifts[:, 1])
    slope = np.array([(r[0] - r[1]) / (2.0 * step[0]), (r[2] - r[3]) / (2.0 * step[1])])
    along = slope @ A[e, q]
    now = float(model.interface.progress(jump[0], jump[1]))
    row = np.zeros(one.mesh.count)
    row[one.mesh.dofs_el[e]] = along @ one.jump_qia[q]
    return row, control.value - now + float(along @ open_el[e, q]), 1.0
