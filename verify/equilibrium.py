"""Equilibrium of the arm on its zones: Newton on the states and on the ends of the zones together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from verify.arm import FORCE, MOMENT, Arm, V
from verify.collocation import STAGES, STATES, Field, change, linearise
from verify.zones import ELASTIC, Foundation, Zones, find, mesh, peak_force, start

TOLERANCE = 1e-11
ELSEWHERE = 1e-7
MAX_ITERATIONS = 40


@dataclass(frozen=True)
class Model:
    """The problem in the units of the arm."""

    arm: Arm
    base: Foundation
    precrack: float
    length: float


@dataclass(frozen=True)
class State:
    """A converged point: the field, the kind (n,) of its elements, the tangent of the path with respect to the
    controlled deflection, the place of the damage front, and Newton's iterations."""

    field: Field
    kind: np.ndarray
    tangent: Field
    front: float
    iterations: int

    def ahead(self, step: float) -> Field:
        return self.field.plus(self.tangent, step)


@dataclass(frozen=True)
class Control:
    """The deflection ``value`` at ``at``. ``front`` fixes the place of the damage front; None lets it follow."""

    at: float
    value: float
    front: float | None


def settle(m: Model, guess: Field, zones: Zones, control: Control) -> State | None:
    """Newton on the states and on the ends of the zones, or None where it does not converge."""
    with np.errstate(over="ignore", invalid="ignore"):
        try:
            return _newton(m, guess, zones, control)
        except np.linalg.LinAlgError:
            return None


def _newton(m: Model, field: Field, zones: Zones, control: Control) -> State | None:
    for iteration in range(1, MAX_ITERATIONS + 1):
        x, kind = mesh(m.arm, m.base, zones, peak_force(field))
        field = field.on(x)
        linear = linearise(field, *m.arm.rates(field.stage, m.base.k[kind][:, None], m.base.c[kind][:, None]))
        node = int(np.searchsorted(x, control.at))
        left, right = field.node[0], field.node[-1]
        delta = change(linear, (MOMENT, -left[MOMENT]), ((FORCE, -right[FORCE]), (MOMENT, -right[MOMENT])),
                       (node, V, control.value - field.node[node, V]))
        field = field.plus(delta)
        if not np.all(np.isfinite(field.node)):
            return None
        if _settled(field, delta):
            tangent = change(linear, (MOMENT, 0.0), ((FORCE, 0.0), (MOMENT, 0.0)), (node, V, 1.0), homogeneous=True)
            return State(field, kind, tangent, _front(m, field, kind, control), iteration)
        zones = find(m.arm, m.base, field, kind, m.precrack, control.front)
    return None


def _settled(field: Field, delta: Field) -> bool:
    """Whether the loaded end no longer changes, nor anything else by much.

    The far waves of opening and closing settle last, and act back on the load by the square of their size.
    """
    size = np.abs(field.node).max(axis=0)
    return bool(np.all(np.abs(delta.node[0]) < TOLERANCE * size) and np.all(np.abs(delta.node) < ELSEWHERE * size))


def _front(m: Model, field: Field, kind: np.ndarray, control: Control) -> float:
    if control.front is not None:
        return control.front
    zones = find(m.arm, m.base, field, kind, m.precrack, None)
    return float(zones.bound[:-1][zones.kind >= ELASTIC][0])


def resettle(m: Model, state: State, guess: Field, control: Control) -> State | None:
    """Newton from a guess on the mesh of ``state``, in the zones that the guess has."""
    return settle(m, guess, find(m.arm, m.base, guess, state.kind, m.precrack, control.front), control)


def intact(m: Model) -> State:
    """The elastic state in which the end of the precrack is about to be damaged, for linear kinematics.

    The penalty is raised tenfold a time, from the stiffness of the open side, so that the zones of contact are found
    however stiff it is.
    """
    elastic, penalty = m.base.k[3:]
    n = max(0, int(np.ceil(np.log10(penalty / elastic)))) if penalty > elastic else 0
    field = Field(np.array([0.0, m.length]), np.zeros((2, STATES)), np.zeros((1, STAGES, STATES)))
    zones, state = start(m.precrack, m.length), None
    for stiffness in np.geomspace(elastic, penalty, n + 1) if n else [penalty]:
        k = np.append(m.base.k[:4], stiffness)
        base = Foundation(k, m.base.c, m.base.v_peak, m.base.v_open, m.base.contact)
        part = Model(Arm(m.arm.shear, m.arm.stretch, False), base, m.precrack, m.length)
        state = settle(part, field, zones, Control(m.precrack, m.base.v_peak, m.precrack))
        if state is None:
            raise ArithmeticError("the zones of contact of the undamaged arm were not found")
        field, zones = state.field, find(part.arm, base, state.field, state.kind, m.precrack, m.precrack)
    return state
