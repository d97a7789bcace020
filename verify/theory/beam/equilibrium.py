"""Equilibrium of the arm on its zones: Newton on the states and on the ends of the zones together."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from verify.theory.beam.arm import FORCE, MOMENT, Arm, V
from verify.theory.beam.collocation import Field, Rows, change, linearise
from verify.theory.beam.peeled_strip import LAYER_SHEAR, Strip
from verify.theory.beam.zones import CONTACT, ELASTIC, Ends, Foundation, Zones, find, mesh, peak_force

TOLERANCE = 1e-11
ELSEWHERE = 1e-7
MAX_ITERATIONS = 40

#: The same where nothing shorter can be tried: contact much softer or stiffer than the bond has far waves that move on
#: by a little each time (up to 75 iterations were seen).
PATIENT = 200


@dataclass(frozen=True)
class Model:
    """The problem in the units of the arm."""

    arm: Arm | Strip
    base: Foundation
    ends: Ends

    def nothing_at_ends(self, field: Field) -> tuple[Rows, Rows]:
        """Conditions of the change at both ends: no moment, no shear of a layer, and no force at the far one."""
        layer = [LAYER_SHEAR] if self.arm.states > LAYER_SHEAR else []
        unit = np.eye(self.arm.states)
        first, last = [MOMENT, *layer], [FORCE, MOMENT, *layer]
        return (unit[first], -field.node[0, first]), (unit[last], -field.node[-1, last])


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
    """The deflection of the loaded end, where ``at`` is 0, or the gap (of one arm) there: ``value``. ``front`` fixes
    the place of the damage front; None lets it follow."""

    at: float
    value: float
    front: float | None


def controlled(m: Model, y: np.ndarray, at: float) -> tuple[float, np.ndarray]:
    """What a control at ``at`` prescribes, at states ``y`` (a,), and its derivative (a,)."""
    if at > 0.0:
        gap, by = m.arm.gap(y)
        return float(gap), by
    return float(y[V]), np.eye(m.arm.states)[V]


def settle(m: Model, guess: Field, zones: Zones, control: Control, most: int = MAX_ITERATIONS) -> State | None:
    """Newton on the states and on the ends of the zones, or None where it does not converge in ``most`` iterations."""
    with np.errstate(over="ignore", invalid="ignore"):
        try:
            return _newton(m, guess, zones, control, most)
        except (np.linalg.LinAlgError, ValueError):  # singular, or beyond all numbers
            return None


def _newton(m: Model, field: Field, zones: Zones, control: Control, most: int) -> State | None:
    for iteration in range(1, most + 1):
        x, kind = mesh(m.arm, m.base, zones, peak_force(field))
        field = field.on(x)
        linear = linearise(field, *m.arm.rates(field.stage, m.base.on[kind][:, None]))
        node = int(np.searchsorted(x, control.at))
        left, right = m.nothing_at_ends(field)
        value, by = controlled(m, field.node[node], control.at)
        delta = change(linear, left, right, (node, by, control.value - value))
        field = field.plus(delta)
        if not np.all(np.isfinite(field.node)):
            return None
        if _settled(field, delta):
            left, right = ((rows, np.zeros_like(values)) for rows, values in (left, right))
            tangent = change(linear, left, right, (node, by, 1.0), homogeneous=True)
            return State(field, kind, tangent, _front(m, field, kind, control), iteration)
        zones = find(m.arm, m.base, field, kind, m.ends, control.front)
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
    zones = find(m.arm, m.base, field, kind, m.ends, None)
    return float(zones.bound[:-1][np.isin(zones.kind, (ELASTIC, CONTACT))][0])


def resettle(m: Model, state: State, guess: Field, control: Control) -> State | None:
    """Newton from a guess on the mesh of ``state``, in the zones that the guess has."""
    return settle(m, guess, find(m.arm, m.base, guess, state.kind, m.ends, control.front), control)


def intact(m: Model) -> State | None:
    """The elastic state in which the end of the precrack is about to be damaged, for linear kinematics; or None.

    The penalty goes tenfold a time from the stiffness of the open side to its own, so that the zones of contact are
    found however stiff or soft it is.
    """
    elastic, penalty = m.base.k[[ELASTIC, CONTACT]]
    n = int(np.ceil(abs(np.log10(penalty / elastic)))) if penalty > 0.0 else 0
    field = Field.zero(np.array([0.0, m.ends.length]), m.arm.states)
    precrack, zones = m.ends.precrack, m.ends.untouched()
    for stiffness in np.geomspace(elastic, penalty, n + 1) if n else [penalty]:
        part = replace(m, arm=m.arm.linear(), base=m.base.closing(stiffness))
        found = settle(part, field, zones, Control(precrack, m.base.v_peak, precrack), PATIENT)
        if found is None:
            return None
        state = found
        field, zones = state.field, find(part.arm, part.base, state.field, state.kind, m.ends, precrack)
    return state
