"""T-meshes that follow the process zone: fine where damage grows, coarse in its wake and far ahead.

All meshes of a run bisect the same cells, so that elements with points that are being damaged are the same before and
after. Elements change only where damage has not begun or is complete, and history is copied. Displacements are
transferred by `iga.tsplines.transfer`, then brought into equilibrium at the same opening.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from iga.delamination.arms import arm_tmeshes, require_arms, zone_length
from iga.path.control import Prescribed, opening_control
from iga.path.newton import equilibrium
from iga.path.point import Point
from iga.path.solver import MANY_DECIDE, Solver
from iga.specimen.grading import GRADING, number_along
from iga.specimen.problem import Debonding, presses
from iga.specimen.specimen import Specimen
from iga.specimen.tmesh_strip import Strip
from iga.system.state import State
from iga.system.system import Phase
from iga.tsplines.tmesh import TMesh
from iga.tsplines.transfer import transfer


@dataclass(frozen=True)
class Refinement:
    """How the fine part of the mesh follows the damage front; lengths in process zones.

    - ``ahead``: length of the fine part before the front. ``left``: the fine part moves once less than this is left
      before the front; it then begins this far behind the crack tip.
    - ``halvings``: how often a cell can be halved. ``growth``: length of a cell over its distance from the fine part,
      at most.
    - ``same``: two points closer than this part of the specimen's length are the same.
    """

    ahead: float = 0.75
    left: float = 0.25
    halvings: int = 4
    growth: float = 0.7
    same: float = 1e-9


ADAPTIVITY = Refinement()


@dataclass(frozen=True)
class Window:
    """The fine part, from ``start`` to ``end`` along the specimen, and the number of ``roots``: undivided cells on the
    bond."""

    start: float
    end: float
    roots: int


def first_window(problem: Debonding) -> Window:
    """The fine part before anything moves. Its cells are the finest with which no mesh of the run exceeds ``dofs``.

    Raises
    ------
    ValueError : no mesh has so few unknowns, or the arms are not equal.
    """
    require_arms(problem)
    upper, lower = problem.layout.bodies
    if upper != lower:
        raise ValueError("adaptive meshes need equal arms")
    zone, (precrack, length) = zone_length(problem), problem.layout.bonded

    def most(roots: int) -> int:
        starts = np.linspace(precrack, length, 50)
        return max(4 * strip(problem, Window(x - zone, x + ADAPTIVITY.ahead * zone, roots)).functions for x in starts)

    roots = number_along(problem, length - precrack, most, 1, ADAPTIVITY.halvings + 1)
    return Window(precrack, precrack + ADAPTIVITY.ahead * zone, roots)


def strip(problem: Debonding, window: Window) -> Strip:
    """One arm with equal cells in the window and ever longer ones away from it, halved at the interface in the window.

    An element boundary lies at the end of the precrack. Where the arms are pressed together there are short cells at
    the loaded end as well.
    """
    precrack, end = problem.layout.bonded
    bond = end - precrack
    before = max(int(np.ceil(window.roots * precrack / bond)), 1)
    starts, sizes = [], []
    for start, length, roots in ((0.0, precrack, before), (precrack, bond, window.roots)):
        x = start + length * np.arange(roots) / roots
        size: np.ndarray = np.full(roots, length / roots)
        finest = bond / window.roots / 2**ADAPTIVITY.halvings
        for _ in range(ADAPTIVITY.halvings):
            away = np.maximum(np.maximum(window.start - (x + size), x - window.end), 0.0)
            long = size > np.maximum(1.5 * finest, np.minimum(ADAPTIVITY.growth * away, most_at(problem, x)))
            half = 0.5 * size[long]
            x = np.concatenate([x[~long], x[long], x[long] + half])
            size = np.concatenate([size[~long], half, half])
        starts.append(x)
        sizes.append(size)
    x, size = np.concatenate(starts), np.concatenate(sizes)
    order = np.argsort(x)
    x, size = x[order], size[order]
    middle = x + 0.5 * size
    halved = (middle > max(window.start, precrack)) & (middle < window.end) & (size < 1.5 * finest)
    return Strip(np.append(x, end), halved)


def most_at(problem: Debonding, x: np.ndarray) -> np.ndarray:
    """How long (n,) cells at x (n,) may be, where arms are pressed together at the loaded end; infinite elsewhere."""
    return (
        GRADING.pressed * problem.layout.bodies[0].thickness + ADAPTIVITY.growth * x
        if presses(problem)
        else np.full(x.shape, np.inf)
    )


def adapted_tmeshes(problem: Debonding, window: Window) -> tuple[TMesh, ...]:
    """T-meshes of the upper and the lower arm with the fine part in the window."""
    one = strip(problem, window)
    return arm_tmeshes(problem, (one, one))


def followed(problem: Debonding, roots: int, specimen: Specimen, point: Point) -> Window | None:
    """The new window for a converged point, or None where the present mesh is fine far enough beyond the damage
    front."""
    zone, law, end = zone_length(problem), specimen.system.interface.law, specimen.drawn.path_end
    precrack, length = problem.layout.bonded
    X_q, k_q, bonded_q = specimen.places[0][:, 0], point.state.k_q, specimen.system.interface.bonded_q
    damaged, broken = X_q[bonded_q & (k_q > law.begun)], X_q[bonded_q & (k_q >= law.failed)]
    front = float(damaged.max(initial=precrack))
    if end >= length or front < end - ADAPTIVITY.left * zone:
        return None
    tip = float(broken.max(initial=precrack))
    return Window(tip - ADAPTIVITY.left * zone, front + ADAPTIVITY.ahead * zone, roots)


def carried(old: Specimen, new: Specimen, point: Point, phase: Phase) -> State | None:
    """The state of a point on another mesh, in equilibrium at the same opening; None where there is none.

    Points that both meshes share keep their history; the others lie where damage has not begun, or is complete, and
    take it from their neighbours.
    """
    with phase("mesh"):
        u_old = old.pose.components(point.state.u_d.reshape(-1, 2))
        u_new = np.concatenate(
            [
                transfer(before, after) @ u_old[body.points]
                for before, after, body in zip(old.drawn.tmeshes, new.drawn.tmeshes, old.bodies, strict=True)
            ]
        )
    past, start = point.state, new.system.start()
    k_q = _history(old, new, past.k_q, start.k_q)
    if k_q is None:
        return None
    u_d = (u_new @ new.pose.axes_kI).ravel()
    slip_q = None if past.slip_q is None or start.slip_q is None else _beside(old, new, past.slip_q)
    trial = replace(past, u_d=u_d, k_q=k_q, slip_q=slip_q, closed_q=start.closed_q, pairing=start.pairing)
    goal = Prescribed(opening_control(new.system), point.opening, 1e-3 * point.opening)
    found = equilibrium(Solver(new.system, MANY_DECIDE, phase), trial, goal)
    if found is None:
        return None
    return replace(found.state, k_q=found.response.k_q, scale=max(trial.scale, found.response.scale))


def _beside(old: Specimen, new: Specimen, v_q: np.ndarray) -> np.ndarray:
    """Values at the points of the new mesh, interpolated linearly between the neighbours on the old one."""
    X_old, X_new = (specimen.places[0][:, 0] for specimen in (old, new))
    order = np.argsort(X_old)
    return np.interp(X_new, X_old[order], v_q[order])


def _history(old: Specimen, new: Specimen, k_q: np.ndarray, free_q: np.ndarray) -> np.ndarray | None:
    """History at the points of the new mesh, ``free_q`` (n_q,) where there is no bond; None where a point that is being
    damaged would be lost."""
    s_old, s_new = (specimen.places[0][:, 0] for specimen in (old, new))
    held_q, holds_q = old.system.interface.bonded_q, new.system.interface.bonded_q
    order = np.flatnonzero(held_q)[np.argsort(s_old[held_q])]
    s, k = s_old[order], k_q[order]
    right = np.clip(np.searchsorted(s, s_new), 1, len(s) - 1)
    nearest = np.where(s_new - s[right - 1] < s[right] - s_new, right - 1, right)
    same = np.abs(s[nearest] - s_new) < ADAPTIVITY.same * s[-1]
    law = new.system.interface.law
    active = (k > law.begun) & (k < law.failed)
    kept = np.zeros(len(s), dtype=bool)
    kept[nearest[same]] = True
    if np.any(active & ~kept):
        return None
    return np.where(holds_q, np.where(same, k[nearest], np.interp(s_new, s, k)), free_q)
