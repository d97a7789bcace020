"""The cohesive beam: the arm of a DCB as a shear-flexible beam on the bilinear law, solved to rounding.

By symmetry one arm is enough, the gap is twice its deflection. In each zone (free, open, softening, elastic, contact)
the equations are smooth, and linear for linear kinematics; the mesh keeps its nodes on the ends of the zones, so that
nothing is ever integrated across a kink. The path is followed by the place of the damage front, which only advances:
snap-backs of load or opening are no event. Since the traction is continuous from zone to zone, a small error in the
place of an end of a zone does not change the solution to first order, and Newton on states and ends is quadratic.

Source: Skec, Alfano, Jelenic (2019), Int. J. Fract. 215, 67-89, for the linear beam; here with contact, a free far
end, and with geometrically exact kinematics.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from verify.arm import FORCE, MOMENT, SHEAR_CORRECTION, Arm, V
from verify.collocation import Field, change, linearise
from verify.law import Bilinear
from verify.rows import Units, row, snapshot
from verify.zones import Foundation, Zones, find, mesh, peak_force, start

TOLERANCE = 1e-10
MAX_ITERATIONS = 40
SMALLEST_STEP = 1e-7


@dataclass(frozen=True)
class BeamProblem:
    """A double cantilever beam under a monotone opening.

    ``young`` is the effective axial modulus (plane strain: E / (1 - nu^2); orthotropic: E1), ``shear`` the shear
    modulus (orthotropic: G12). ``opening`` is the end of the programme, or the programme; it must not unload.
    ``irreversible`` false books what damage costs as stored. ``points`` is roughly the number of rows.
    """

    length: float
    arm_thickness: float
    precrack: float
    width: float
    young: float
    shear: float
    strength: float
    toughness: float
    ductility: float
    penalty: float
    contact: bool = True
    kinematics: str = "linear"
    opening: float | Sequence[float] = 1.0
    points: int = 150
    irreversible: bool = True
    snapshot_openings: tuple[float, ...] = ()

    @property
    def law(self) -> Bilinear:
        return Bilinear(self.strength, self.toughness, self.ductility, self.penalty, self.contact)

    @property
    def bending(self) -> float:
        return self.young * self.width * self.arm_thickness**3 / 12.0

    @property
    def end(self) -> float:
        """Last opening of the programme.

        Raises
        ------
        ValueError : the programme unloads, or does not open at all
        """
        programme = np.concatenate(([0.0], np.atleast_1d(np.asarray(self.opening, dtype=float))))
        if np.any(np.diff(programme) <= 0.0):
            raise ValueError(f"load.opening: must only increase for the method beam, got {programme[1:].tolist()}; "
                             "a programme that unloads needs one of the solvers")
        return float(programme[-1])


@dataclass(frozen=True)
class Solution:
    """Rows (curve and evidence columns), how the run ended, snapshots as plain dictionaries, steps that were halved."""

    rows: tuple[Mapping[str, float], ...]
    status: str
    snapshots: tuple[Mapping[str, object], ...]
    rejected_steps: int = 0


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


def model(problem: BeamProblem) -> Model:
    """Scale a problem by the arm thickness and the bending stiffness."""
    h, bending, area = problem.arm_thickness, problem.bending, problem.width * problem.arm_thickness
    arm = Arm(bending / (SHEAR_CORRECTION * problem.shear * area * h**2), 1.0 / 12.0, problem.kinematics == "finite")
    return Model(arm, Foundation.of(problem.law, problem.width, h, bending), problem.precrack / h, problem.length / h)


def settle(m: Model, guess: Field, zones: Zones, control: Control) -> State | None:
    """Newton on the states and on the ends of the zones, or None where it does not converge."""
    field = guess
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
        size = np.max(np.abs(delta.node).max(axis=0) / np.abs(field.node).max(axis=0))
        if size < TOLERANCE:
            tangent = change(linear, (MOMENT, 0.0), ((FORCE, 0.0), (MOMENT, 0.0)), (node, V, 1.0), homogeneous=True)
            return State(field, kind, tangent, _front(m, field, kind, control), iteration)
        zones = find(m.arm, m.base, field, kind, m.precrack, control.front)
    return None


def _front(m: Model, field: Field, kind: np.ndarray, control: Control) -> float:
    if control.front is not None:
        return control.front
    zones = find(m.arm, m.base, field, kind, m.precrack, None)
    return float(zones.bound[:-1][zones.kind >= 3][0])


def _advance(m: Model, state: State, guess: Field, control: Control) -> State | None:
    return settle(m, guess, find(m.arm, m.base, guess, state.kind, m.precrack, control.front), control)


def intact(m: Model) -> State:
    """The elastic state in which the end of the precrack is about to be damaged, for linear kinematics.

    The penalty is raised tenfold a time, from the stiffness of the open side, so that the zones of contact are found
    however stiff it is.
    """
    elastic, penalty = m.base.k[3:]
    n = max(0, int(np.ceil(np.log10(penalty / elastic)))) if penalty > elastic else 0
    field = Field(np.array([0.0, m.length]), np.zeros((2, 4)), np.zeros((1, 8, 4)))
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


def solve(problem: BeamProblem, on_step: Callable[[Mapping[str, float]], None] | None = None) -> Solution:
    """Follow the path to the end of the programme.

    Raises
    ------
    ValueError : the programme unloads
    """
    m, end, units = model(problem), problem.end, Units.of(problem)
    first = intact(m)
    rows, snapshots, wanted = [row(units, m, first, None)], [], sorted(problem.snapshot_openings)
    pace = Pace(units.deflection(end), units.reference_load, 2.0 / problem.points)
    path, status, rejected = _follow(m, first, pace), "", 0
    if on_step:
        on_step(rows[0])
    for state in path:
        if isinstance(state, str):
            status = state
            break
        if state is None:
            rejected += 1
            continue
        rows.append(row(units, m, state, rows[-1]))
        if wanted and rows[-1]["opening"] >= wanted[0] * (1.0 - 1e-9):
            snapshots.append(snapshot(units, m, state, rows[-1]))
            wanted = [opening for opening in wanted if opening > rows[-1]["opening"] * (1.0 + 1e-9)]
        if on_step:
            on_step(rows[-1])
    return Solution(tuple(rows), status, tuple(snapshots), rejected)


@dataclass(frozen=True)
class Pace:
    """How far a step goes: ``stride`` along the curve of opening / end over load / LEFM load, and ``turn`` radians
    of it at most, since the work is integrated by cubics; steps shorter than stride / 64 may turn more."""

    end: float  # deflection at the end of the programme
    load: float
    stride: float
    turn: float = 0.15

    def rate(self, tangent: Field) -> tuple[float, float]:
        return tangent.node[0, V] / self.end, -tangent.node[0, FORCE] / self.load

    def turned(self, old: State, new: State) -> float:
        """Angle between the directions of the path at two states, both taken as the damage front advances."""
        a, b = np.array(self.rate(old.tangent)), np.array(self.rate(new.tangent))
        return float(np.abs(np.arctan2(a[0] * b[1] - a[1] * b[0], a @ b)))


def _follow(m: Model, elastic: State, pace: Pace):
    """The converged states in order, None for a step that was halved, and the status at last."""
    for state in _undamaged(m, elastic, pace):
        yield state
        if state.field.node[0, V] >= pace.end * (1.0 - 1e-12):
            yield "complete"
            return
    largest = np.inf
    while m.length - state.front > 1e-3 * (m.length - m.precrack):
        advance = -1.0 / _slope_at_front(m, state)  # of the front, for a unit of the controlled deflection
        stride = pace.stride / np.hypot(*pace.rate(state.tangent)) * advance
        ds = min(stride, largest, 0.2 * (m.length - state.front))
        new = _advance_front(m, state, ds, ds / advance)
        if new is None or (ds > stride / 64.0 and pace.turned(state, new) > pace.turn):
            largest = 0.5 * ds
            if largest < SMALLEST_STEP * m.length:
                yield f"stopped: the damage front did not advance beyond {state.front / m.length:.4g} of the length"
                return
            if new is None:
                yield None
            continue
        largest = ds * np.clip(0.6 * pace.turn / max(pace.turned(state, new), 1e-12), 0.5, 2.0)
        new = _land_on_tip(m, state, new, ds / advance)
        if new.field.node[0, V] >= pace.end:
            last = _advance(m, new, new.field, Control(0.0, pace.end, None))
            yield from (last, "complete") if last else ("stopped: the end of the programme was not met",)
            return
        yield new
        state = new
    yield "stopped: separated, the arms hold together over less than 0.1 % of the bond"


def _land_on_tip(m: Model, old: State, new: State, step: float) -> State:
    """The state in which the end of the precrack just opens fully, a kink of the path, where a step passes over it."""
    before, after = _tip(m, old), _tip(m, new)
    if not before < m.base.v_open * (1.0 - 1e-9) < after:
        return new
    share = (m.base.v_open - before) / (after - before)
    return _advance(m, old, old.ahead(share * step), Control(m.precrack, m.base.v_open, None)) or new


def _undamaged(m: Model, elastic: State, pace: Pace):
    """Elastic states up to the onset of damage, or to the end of the programme."""
    n = int(np.ceil(np.hypot(*pace.rate(elastic.field)) / pace.stride)) + 3
    state = elastic
    for share in np.linspace(0.0, 1.0, n + 1)[1:]:
        scale = share / (share - 1.0 / n) if share > 1.5 / n else share
        guess = Field(state.field.x, scale * state.field.node, scale * state.field.stage)
        state = _advance(m, state, guess, Control(m.precrack, share * m.base.v_peak, m.precrack))
        if state is None:
            raise ArithmeticError("the undamaged arm was not solved")
        if state.field.node[0, V] >= pace.end:
            yield _advance(m, state, state.field, Control(0.0, pace.end, m.precrack))
            return
        yield state


def _slope_at_front(m: Model, state: State) -> float:
    return float(m.arm.rates(state.field.at(np.array([state.front])), np.zeros(1), np.zeros(1))[0][0, V])


def _tip(m: Model, state: State) -> float:
    return float(state.field.at(np.array([m.precrack]))[0, V])


def _advance_front(m: Model, state: State, ds: float, step: float) -> State | None:
    front = state.front + ds
    return _advance(m, state, state.ahead(step), Control(front, m.base.v_peak, front))
