"""Equilibrium of the arm: Newton's method for the states and the ends of the zones together."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from verify.theory.beam.arm import FORCE, MOMENT, Arm, V
from verify.theory.beam.collocation import Field, Rows, change, linearise
from verify.theory.beam.peeled_strip import LAYER_SHEAR, Strip
from verify.theory.beam.zones import CONTACT, ELASTIC, Ends, Foundation, Zones, find, mesh, peak_force


@dataclass(frozen=True)
class BeamNewton:
    """When Newton's iterations for the beam stop.

    tolerance : change of the states at the loaded end, in units of their largest values.
    elsewhere : the same at all other nodes. The far waves of opening and closing converge last, and act on the loaded
        end by the square of their size only.
    iterations : iterations before a step is given up and halved.
    first_iterations : the same for the first state, which has no shorter step. If contact is much softer or stiffer
        than the bond, far waves move by a little in each iteration (up to 75 iterations were seen).
    """

    tolerance: float = 1e-11
    elsewhere: float = 1e-7
    iterations: int = 40
    first_iterations: int = 200


BEAM_NEWTON = BeamNewton()


@dataclass(frozen=True)
class Model:
    """The problem in the units of the arm."""

    arm: Arm | Strip
    base: Foundation
    ends: Ends

    def nothing_at_ends(self, field: Field) -> tuple[Rows, Rows]:
        """Conditions on the correction at both ends: no moment, no shear of a layer, and no force at the far end."""
        layer = [LAYER_SHEAR] if self.arm.states > LAYER_SHEAR else []
        unit = np.eye(self.arm.states)
        first, last = [MOMENT, *layer], [FORCE, MOMENT, *layer]
        return (unit[first], -field.node[0, first]), (unit[last], -field.node[-1, last])


@dataclass(frozen=True)
class State:
    """A converged point: field, kind (n,) of its elements, tangent of the path with respect to the controlled
    deflection, position of the damage front, Newton iterations."""

    field: Field
    kind: np.ndarray
    tangent: Field
    front: float
    iterations: int

    def ahead(self, step: float) -> Field:
        return self.field.plus(self.tangent, step)


@dataclass(frozen=True)
class Control:
    """Prescribes ``value``: the deflection of the loaded end if ``at`` is 0, else the gap (of one arm) at ``at``.

    ``front`` is the prescribed position of the damage front; None if it follows from the field.
    """

    at: float
    value: float
    front: float | None


def controlled(m: Model, y: np.ndarray, at: float) -> tuple[float, np.ndarray]:
    """The quantity that a control at ``at`` prescribes, for states ``y`` (a,), and its derivative (a,)."""
    if at > 0.0:
        gap, by = m.arm.gap(y)
        return float(gap), by
    return float(y[V]), np.eye(m.arm.states)[V]


def settle(m: Model, guess: Field, zones: Zones, control: Control, most: int = BEAM_NEWTON.iterations) -> State | None:
    """Newton's method for states and ends of zones; None if it does not converge in ``most`` iterations."""
    with np.errstate(over="ignore", invalid="ignore"):
        try:
            return _newton(m, guess, zones, control, most)
        except (np.linalg.LinAlgError, ValueError):  # singular matrix, or overflow
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
    """Whether the change is below the tolerances of `BEAM_NEWTON`."""
    size, change_n = np.abs(field.node).max(axis=0), np.abs(delta.node)
    return bool(np.all(change_n[0] < BEAM_NEWTON.tolerance * size) and np.all(change_n < BEAM_NEWTON.elsewhere * size))


def _front(m: Model, field: Field, kind: np.ndarray, control: Control) -> float:
    if control.front is not None:
        return control.front
    zones = find(m.arm, m.base, field, kind, m.ends, None)
    return float(zones.bound[:-1][np.isin(zones.kind, (ELASTIC, CONTACT))][0])


def resettle(m: Model, state: State, guess: Field, control: Control) -> State | None:
    """Newton's method from a guess on the mesh of ``state``, with the zones of the guess."""
    return settle(m, guess, find(m.arm, m.base, guess, state.kind, m.ends, control.front), control)


def intact(m: Model) -> State | None:
    """The elastic state at the onset of damage at the end of the precrack, in linear kinematics; None if not found.

    The stiffness of contact goes in factors of ten from that of the open side to the penalty, so that the zones of
    contact are found for any penalty.
    """
    elastic, penalty = m.base.k[[ELASTIC, CONTACT]]
    n = int(np.ceil(abs(np.log10(penalty / elastic)))) if penalty > 0.0 else 0
    field = Field.zero(np.array([0.0, m.ends.length]), m.arm.states)
    precrack, zones = m.ends.precrack, m.ends.untouched()
    for stiffness in np.geomspace(elastic, penalty, n + 1) if n else [penalty]:
        part = replace(m, arm=m.arm.linear(), base=m.base.closing(stiffness))
        found = settle(part, field, zones, Control(precrack, m.base.v_peak, precrack), BEAM_NEWTON.first_iterations)
        if found is None:
            return None
        state = found
        field, zones = state.field, find(part.arm, part.base, state.field, state.kind, m.ends, precrack)
    return state
