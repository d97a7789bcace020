"""The general delamination specimen: two arms of one length with a bond, loads and supports on patches."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_reference.problem.loads import Load, Support, action
from fem_reference.problem.material import Rectangles
from fem_reference.problem.problem import Debonding
from fem_reference.problem.specimen import (
    LOWER,
    UPPER,
    Action,
    Body,
    Held,
    Patch,
    Specimen,
    finer_at_first,
)

#: Stiffness of a support, in units of E1 times the width: a million times that of a slender specimen.
SUPPORT_STIFFNESS = 1e3

#: Stiffness against rotation of a specimen that floats in finite kinematics, in units of E1 times the width times the
#: square of the length. The specimen rotates until its loads are in line: the spring must be far weaker than the loads.
FLOATING_STIFFNESS = 1e-12


#: Longest element at an end face under a moment, in thicknesses of the thinner arm. With elements of a third of the
#: thickness J by the loads was 10 % off where an arm rotated by half a radian; with these it had converged.
GRADED_END = 1.0 / 16.0


class Outline(NamedTuple):
    """Loads and supports of the arms, and the X from which a crack is measured."""

    loads: tuple[Load, ...]
    supports: tuple[Support, ...]
    loaded_at: float = 0.0


def arms_on_supports(problem: Debonding, bodies: Rectangles, bonded: tuple[float, float], outline: Outline) -> Specimen:
    """Two arms from X = 0 to one length; their faces can touch along all of it.

    Displacement along X is held at one point of the lower arm. Rigid motions that the supports leave free are held as
    well: along Y at the same point, the rotation by a spring on the far end. Loads in balance cause no forces there.

    Raises
    ------
    ValueError : a bond that opens alone, arms of two lengths, a load or support that is not on the arms, or too few
        elements.
    """
    L = bodies[UPPER].length
    if bodies[LOWER].length != L:
        raise ValueError(f"bodies: must be of one length, got {L} and {bodies[LOWER].length}")
    if not problem.law.slides:
        raise ValueError("bond: must slide under loads on patches, got one that opens alone")
    if problem.load_at != "face":
        raise ValueError(f'load_at: must be "face" for loads on patches, got {problem.load_at}')
    above, below = (np.linspace(0.0, body.thickness, problem.layers + 1) for body in bodies)
    pair = (
        Body(L, above, bodies[UPPER].moduli.stiffness_IJ(problem.plane)),
        Body(L, -below[::-1], bodies[LOWER].moduli.stiffness_IJ(problem.plane)),
    )
    spring = SUPPORT_STIFFNESS * problem.width * max(body.moduli.E1 for body in bodies)
    height = float(above[-1] + below[-1])
    pulls = tuple(action(load, pair, load.share) for load in outline.loads)
    rests = tuple(action(rest, pair, spring * (height**2 if rest.couple else 1.0)) for rest in outline.supports)
    graded = GRADED_END * min(body.thickness for body in pair)
    components, keeps = _rigid_motions(problem, pair, rests, spring)
    return Specimen(
        bodies=pair,
        X=problem.cells.X if problem.cells else _lines(problem, (*pulls, *rests), (bonded[0], L), graded),
        bond=bonded,
        facing=(0.0, L),
        touching=problem.law.contact,
        loads=(0.0, 0.0),
        held=(Held(LOWER, problem.middle(L, 0.0), components), *problem.held_across(pair)),
        hooks=(),
        loaded_at=outline.loaded_at,
        pulls=pulls,
        rests=rests,
        keeps=keeps,
        cells=problem.cells,
        Z=problem.Z,
    )


def _lines(problem: Debonding, actions: tuple[Action, ...], others: tuple[float, float], most: float) -> np.ndarray:
    """Element boundaries, at the ends of all patches and elsewhere; in finite kinematics they are graded towards end
    faces under dead moments.

    The traction of such a moment keeps its direction while the face rotates, which causes a boundary layer of stresses.
    """
    X = problem.lines(_corners(actions, others))
    if problem.kinematics == "finite":
        ends = {patch.place[0][0] for act in actions if act.turn for patch in act.patches}
        X = finer_at_first(X, most) if 0.0 in ends else X
        X = X[-1] - finer_at_first(X[-1] - X[::-1], most)[::-1] if others[1] in ends else X
    return X


def _corners(actions: tuple[Action, ...], others: tuple[float, ...]) -> tuple[float, ...]:
    """Ends of all patches and other places; places that differ by rounding are merged."""
    ends = np.sort([*others, *(X for act in actions for patch in act.patches for X in patch.place[0])])
    apart = np.diff(ends, prepend=-np.inf) > 1e-9 * ends[-1]
    return tuple(float(X) for X in ends[apart][:-1]) + (float(max(others)),)


def _rigid_motions(
    problem: Debonding, pair: tuple[Body, Body], rests: tuple[Action, ...], spring: float
) -> tuple[tuple[int, ...], tuple[Action, ...]]:
    """Displacement components to be held at a point, and a spring against rotation if the supports leave it free."""
    L, height = pair[0].length, pair[0].thickness + pair[1].thickness
    centres = [sum(rest.patches[0].place[0]) / 2.0 for rest in rests if rest.push]
    turns = any(rest.turn for rest in rests) or (bool(centres) and np.ptp(centres) > 1e-6 * L)
    components = (0,) if centres else (0, 1)
    if turns:
        return components, ()
    stiffness = spring * height**2
    if problem.kinematics == "finite":
        stiffness *= FLOATING_STIFFNESS / SUPPORT_STIFFNESS * (L / height) ** 2
    far = tuple(Patch(number, ((L, L), (float(body.Y[0]), float(body.Y[-1])))) for number, body in enumerate(pair))
    middle = 0.5 * (far[UPPER].place[1][1] + far[LOWER].place[1][0])
    return components, (Action(far, push=0.0, turn=12.0 / height**3, middle=middle, factor=stiffness),)
