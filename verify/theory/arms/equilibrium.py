"""Equilibrium of arms on their bond, by Newton's method for displacements and jumps of the bond together.

Where the arms give beyond their model, the jump of the bond at a point is an unknown of that point with an equation of
its own, jump of the faces = jump + c traction, which is eliminated in every iteration: no iteration is nested in
another.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from verify.theory.arms.equations import Bordered, Pattern, Step
from verify.theory.arms.interface import History, Interface
from verify.theory.arms.splines import Meshes
from verify.theory.arms.structure import Structure


@dataclass(frozen=True)
class Limits:
    """Limits of Newton's method.

    ``iterations`` : at most
    ``at_first`` : those past the specimen at rest, whose zones of contact are found element by element
    ``circling`` : change of the forces out of balance over two of these, as a part of them, from which a step is halved
    ``residual`` : forces out of balance, as a part of the largest force of the bond
    ``change``, ``moved`` : of the jumps, as a part of those at onset, and of the displacements, as a part of the
        largest before or after the step: after ``small`` iterations with less what is left of the forces is rounding
    """

    iterations: int = 25
    at_first: int = 300
    circling: float = 1e-2
    residual: float = 1e-10
    change: float = 1e-9
    moved: float = 1e-10
    small: int = 3


ARMS_NEWTON = Limits()


@dataclass(frozen=True)
class State:
    """Unknowns (n,), load, reactions (m,), jump (E, q, J) of the bond, the history after the state; how the state
    changes along the path, and by how much progress of the bond with it; norm of the forces out of balance."""

    x: np.ndarray
    load: float
    reactions: np.ndarray
    jump: np.ndarray
    history: History
    along: Step | None = None
    grown: float = 0.0
    growing: float = 0.0
    iterations: int = 0
    residual: float = 0.0

    def between(self, other: State, part: float) -> State:
        """A part of the way to another state, with the history of this one."""
        ways = {name: (getattr(self, name), getattr(other, name)) for name in ("x", "load", "reactions", "jump")}
        return replace(self, **{name: a + part * (b - a) for name, (a, b) in ways.items()})


@dataclass(frozen=True)
class Control:
    """What a step prescribes: ``opening`` times the opening and ``growth`` times the progress of the bond (area), in
    sum ``value``."""

    opening: float
    growth: float
    value: float


@dataclass(frozen=True)
class Model:
    """A structure and the bond between its faces, on one of the ``meshes``, with fine elements on a range of X."""

    structure: Structure
    interface: Interface
    meshes: Meshes
    fine: tuple[float, float]

    @cached_property
    def pattern(self) -> Pattern:
        return Pattern(self.structure)

    @cached_property
    def rest(self) -> State:
        one, face = self.structure, self.interface
        shape = (*face.bonded.shape, face.components)
        return State(np.zeros(one.count), 0.0, np.zeros(len(one.held)), np.zeros(shape), face.intact)

    def opening(self, x: np.ndarray) -> float:
        return float(self.structure.load @ x)

    def progress(self, reached: np.ndarray) -> float:
        """Progress of the bond, the integral of that of its points (area)."""
        return float(np.sum(reached * self.structure.points.weight))


def solve(
    model: Model, guess: State, last: State, control: Control, turning: bool = False, from_rest: bool = False
) -> State | None:
    """The state after ``last`` that meets the control; None where Newton's method does not converge.

    ``turning`` : whether the path turns at ``last``, so that the first tangent is that of no damage
    ``from_rest`` : whether it passes the unloaded specimen, on whose other side other faces touch
    """
    limits, scale = ARMS_NEWTON, model.interface.bond.scale
    state, along, small, norms = guess, None, 0, [np.inf, np.inf]
    with np.errstate(over="ignore", invalid="ignore"):
        for iteration in range((limits.at_first if from_rest else limits.iterations) + 1):
            try:
                off, found = _iterate(
                    model, state, last.history, control, turning and iteration == 0, along is not None
                )
            except (np.linalg.LinAlgError, ValueError):
                return None
            if along is not None and (found is None or small == limits.small):
                return _accepted(model, replace(state, iterations=iteration, residual=off), last, along)
            assert found is not None
            new, along, change = found
            # full steps can open and close the same zones of contact in turn, for ever
            if from_rest and abs(off - norms[-2]) <= limits.circling * off:
                new, change = state.between(new, 0.5), 0.5 * change
            norms.append(off)
            moved, largest = np.abs(new.x - state.x).max(), max(np.abs(new.x).max(), np.abs(last.x).max())
            state = new
            if not np.all(np.isfinite(change)) or np.abs(state.jump / scale).max() > 1e12:
                return None
            small += bool(np.all(np.abs(change) <= limits.change * scale) and moved <= limits.moved * largest)
    return None


def _accepted(model: Model, state: State, last: State, along: Step) -> State:
    """The state with its history, and the rates of progress along the path."""
    history = model.interface.advanced(state.jump, last.jump, last.history)
    _, slope = model.interface.growth(state.jump, last.history)
    rate = float(_growth_row(model, state, slope) @ along.x)
    return replace(state, history=history, along=along, grown=model.progress(history.progress), growing=rate)


def _iterate(
    model: Model, state: State, before: History, control: Control, frozen: bool, may_end: bool
) -> tuple[float, tuple[State, Step, np.ndarray] | None]:
    """One iteration: the norm of the forces out of balance; the new state, how it changes with the control, and the
    change of the jumps, or None where the state is in balance and that ``may_end`` the iteration."""
    one, face = model.structure, model.interface
    y = one.functionals(state.x)
    at = one.faces.jump(y)
    jump = state.jump if face.give.any() else at.value
    now = face.respond(jump, before, frozen)
    D, traction, A, open_ = now.tangent, now.traction, None, 0.0
    if face.give.any():
        A = np.linalg.inv(np.eye(face.components) + face.give[:, None] * D)
        open_ = jump + face.give * traction - at.value
        D = D @ A
        traction = traction - np.einsum("eqij,eqj->eqi", D, open_)
    turned = at.second is not None
    f_y = np.matmul(traction[..., None, :], at.first)[..., 0, :] if turned else traction
    forces, stiffness = one.bulk(state.x)
    of_bond = one.bond_forces(f_y)
    b = one.load * state.load + one.held.T @ state.reactions - forces - of_bond
    off = b.reshape(-1, len(one.per_unknown)) * one.per_unknown
    if may_end and _balanced(model, off, of_bond, open_):
        return float(np.linalg.norm(off)), None
    H = D
    if turned:
        H = at.first.swapaxes(-1, -2) @ D @ at.first + np.sum(traction[..., None, None] * at.second, axis=-3)
    bond, pattern = one.bond_stiffness(H), model.pattern
    finite = one.problem.finite
    band = pattern.banded((*stiffness(), bond), pattern.springs) if finite else pattern.banded([bond], pattern.linear)
    row, e = control.opening * one.load, control.value - control.opening * model.opening(state.x)
    if control.growth:
        reached, slope = face.growth(jump, before)
        by_faces = slope if A is None else np.einsum("eqj,eqjk->eqk", slope, A)
        row = row + control.growth * _row(one, at, by_faces)
        e -= control.growth * (model.progress(reached) - float(np.sum(by_faces * open_ * one.points.weight[..., None])))
    step, along = Bordered(pattern, band).solve(b, -one.held @ state.x, row, e)
    x = state.x + step.x
    if A is None:
        new_jump = one.faces.jump(one.functionals(x)).value
    else:
        moved = one.functionals(step.x)
        change = np.matmul(at.first, moved[..., None])[..., 0] if turned else moved
        new_jump = jump + np.einsum("eqij,eqj->eqi", A, change - open_)
    new = replace(state, x=x, load=state.load + step.load, reactions=state.reactions + step.reactions, jump=new_jump)
    return float(np.linalg.norm(off)), (new, along, new_jump - jump)


def _balanced(model: Model, off: np.ndarray, of_bond: np.ndarray, open_: np.ndarray | float) -> bool:
    """Whether forces out of balance, and faces that do not fit to the bond, are small."""
    units, limit = model.structure.per_unknown, ARMS_NEWTON.residual
    largest = np.abs(of_bond.reshape(-1, len(units)) * units).max()
    fits = np.abs(open_).max() <= limit * model.interface.bond.scale.min()
    return bool(np.abs(off).max() <= limit * largest and fits)


def _row(one: Structure, at: object, by_faces: np.ndarray) -> np.ndarray:
    """Change (n,) of an integral over the interface with weights (E, q, J) on the jumps of the faces."""
    by_y = by_faces if at.second is None else np.matmul(by_faces[..., None, :], at.first)[..., 0, :]  # type: ignore[attr-defined]
    return one.bond_forces(by_y)


def _growth_row(model: Model, state: State, slope: np.ndarray) -> np.ndarray:
    """Change (n,) of the progress of the bond with the unknowns, without what the arms give."""
    one = model.structure
    return _row(one, one.faces.jump(one.functionals(state.x)), slope)
