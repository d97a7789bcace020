"""The fine elements follow the process zone: models on meshes about it, and states carried from one to the next."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np

from verify.support.refusal import Refusal
from verify.theory.arms.equilibrium import Model, State
from verify.theory.arms.interface import History, Interface, give_of
from verify.theory.arms.problem import ArmsProblem
from verify.theory.arms.splines import Meshes
from verify.theory.arms.structure import Structure
from verify.theory.mixed_law import MixedBond

#: Fine elements beyond the points whose damage grows, in lengths of the zone: behind them and ahead; and the length
#: ahead from which on they are moved.
FINE_BEHIND, FINE_AHEAD, MOVED_AT = 0.5, 3.0, 1.0


def model(problem: ArmsProblem, size: float | None = None) -> Model:
    """The equations of a problem, with elements of ``size`` about the tip of the bond or by the process zone.

    Raises
    ------
    Refusal : loads that nothing takes, or a law with a viscosity
    """
    if isinstance(problem.bond, MixedBond) and problem.bond.viscosity > 0.0:
        raise Refusal(f"interface.viscosity: must be 0 for beams, got {problem.bond.viscosity:g}")
    tip = min(problem.bonded, key=lambda x: abs(x - problem.loaded_at))
    return _about(Meshes(problem, size=size), (tip, tip))


def followed(model: Model, state: State) -> tuple[Model, State] | None:
    """The model with fine elements about the damage that grows, and the state on it; None where there are some.

    Points of elements that stay keep what they remember; others, whole or broken alike, have it from their neighbours.
    """
    x = model.structure.at_points[(state.history.progress > 0.0) & (state.history.progress < 1.0)]
    if not x.size or _covered(model, float(x.min()), float(x.max())):
        return None
    new, one = _about(model.meshes, (float(x.min()), float(x.max()))), model.structure
    c = state.x if state.along is None else np.column_stack((state.x, state.along.x))
    c = one.mesh.carried(c.reshape(one.mesh.count, -1), new.structure.mesh).reshape(new.structure.count, -1)
    history = History(*(_carried(model, new, getattr(state.history, field.name)) for field in fields(History)))
    jump = new.structure.faces.jump(new.structure.functionals(c[:, 0])).value
    if new.interface.give.any():
        jump = np.stack([_carried(model, new, column) for column in np.moveaxis(state.jump, -1, 0)], axis=-1)
    along = None if state.along is None else replace(state.along, x=c[:, 1])
    moved = replace(state, x=c[:, 0], jump=jump, history=history, along=along, grown=new.progress(history.progress))
    return new, moved


def _covered(model: Model, first: float, last: float) -> bool:
    """Whether fine elements reach from the first to the last point of growing damage, and ahead of them."""
    problem, crossed = model.structure.problem, model.meshes.crossed
    near = MOVED_AT * problem.zone
    if problem.loaded_at < 0.5 * problem.length:
        last += near
    else:
        first -= near
    return bool(model.fine[0] <= max(first, crossed[0]) and min(last, crossed[1]) <= model.fine[1])


def _carried(model: Model, new: Model, values: np.ndarray) -> np.ndarray:
    """Values (E', q) at the points of another mesh by those (E, q) of a mesh, of bonded points and others apart."""
    found = np.zeros(new.interface.bonded.shape)
    for old_ones, new_ones in zip(*([m.interface.bonded, ~m.interface.bonded] for m in (model, new)), strict=True):
        x, at = model.structure.at_points[old_ones], new.structure.at_points[new_ones]
        found[new_ones] = np.interp(at, x, values[old_ones]) if x.size else 0.0
    return found


def _about(meshes: Meshes, damaged: tuple[float, float]) -> Model:
    problem, zone = meshes.problem, meshes.problem.zone
    ahead = problem.loaded_at < 0.5 * problem.length
    before, after = (FINE_BEHIND, FINE_AHEAD) if ahead else (FINE_AHEAD, FINE_BEHIND)
    fine = damaged[0] - before * zone, damaged[1] + after * zone
    structure = Structure.of(problem, meshes.about(*fine))
    low, high = sorted(problem.bonded)
    bonded = (structure.at_points > low) & (structure.at_points < high) & structure.common[:, None]
    bond, give = problem.bond, np.zeros(2 if problem.bond.slides else 1)
    if isinstance(bond, MixedBond) and problem.order == 1:
        give = give_of(problem.arms, bond)
    return Model(structure, Interface(bond, bonded, give, structure.at_points), meshes, fine)
