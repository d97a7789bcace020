"""The path of the cohesive beam: elastic steps, then steps of the damage front, which only advances."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from verify.theory.beam.arm import FORCE, V
from verify.theory.beam.collocation import Field
from verify.theory.beam.equilibrium import Control, Model, State, controlled, resettle, settle
from verify.theory.beam.zones import OPEN, SOFTENING, find


@dataclass(frozen=True)
class BeamPathSettings:
    """When the path of the beam ends.

    smallest_step : step of the damage front, as a part of the length, below which the path stops.
    separated : part of the bond that holds, or of the largest load while the load falls, below which the specimen has
        separated. The second condition ends a strip that rotates about its last bonded part over a long opening.
    """

    smallest_step: float = 1e-7
    separated: float = 1e-3


BEAM_PATH = BeamPathSettings()

#: Reason why the undamaged arm has no solution that can be found.
UNEQUAL = "the bond is far stiffer or softer than the arm (interface.strength, ductility, penalty)"

#: Last item of a path whose specimen has separated.
HAS_SEPARATED = "separated"


@dataclass(frozen=True)
class Pace:
    """Length of a step: ``stride`` along the curve of opening / end and load / LEFM load.

    The curve turns by at most ``turn`` [rad] in a step, since the work is integrated by cubics; steps shorter than
    stride / 64 may turn more.
    """

    end: float  # deflection at the end of the programme
    load: float
    stride: float
    turn: float = 0.15

    def rate(self, tangent: Field) -> tuple[float, float]:
        """Rates of opening / end and load / LEFM load along a tangent."""
        return tangent.node[0, V] / self.end, -tangent.node[0, FORCE] / self.load

    def turned(self, old: State, new: State) -> float:
        """Angle [rad] between the directions of the path at two states, in the sense of an advancing damage front."""
        a, b = np.array(self.rate(old.tangent)), np.array(self.rate(new.tangent))
        return float(np.abs(np.arctan2(a[0] * b[1] - a[1] * b[0], a @ b)))

    def fading(self, state: State) -> bool:
        """Whether the load falls as the opening grows."""
        opening, load = self.rate(state.tangent)
        return opening * load < 0.0


def follow(m: Model, elastic: State, pace: Pace) -> Iterator[State | str | None]:
    """The converged states in order, None for every step that was halved, and last a sentence on the end."""
    state = elastic
    for found in _undamaged(m, elastic, pace):
        yield found
        if isinstance(found, str):
            return
        state = found
    largest, peak = np.inf, 0.0
    while not _reached(state, pace):
        load, bond = -state.field.node[0, FORCE], m.ends.length - m.ends.precrack
        peak = max(peak, load)
        if m.ends.length - state.front < BEAM_PATH.separated * bond or (
            load <= BEAM_PATH.separated * peak and pace.fading(state)
        ):
            yield HAS_SEPARATED
            return
        stride = pace.stride / np.hypot(*pace.rate(state.tangent)) / _per_front(m, state)
        ds = min(stride, largest, 0.2 * (m.ends.length - state.front))
        new = _step(m, state, ds)
        if new is None or (ds > stride / 64.0 and pace.turned(state, new) > pace.turn):
            largest = 0.5 * ds
            if largest < BEAM_PATH.smallest_step * m.ends.length:
                place = state.front / m.ends.length
                yield f"stopped: the damage front did not advance beyond {place:.4g} of the length"
                return
            if new is None:
                yield None
            continue
        largest = ds * np.clip(0.6 * pace.turn / max(pace.turned(state, new), 1e-12), 0.5, 2.0)
        new = _land(m, state, new, m.ends.precrack, m.base.v_open)
        state = _land(m, state, new, 0.0, pace.end)
        yield state
    yield "complete"


def _reached(state: State, pace: Pace) -> bool:
    return bool(state.field.node[0, V] >= pace.end * (1.0 - 1e-12))


def _undamaged(m: Model, elastic: State, pace: Pace) -> Iterator[State | str]:
    """Elastic states up to the onset of damage or the end of the programme; a sentence if one is not found."""
    n = int(np.ceil(np.hypot(*pace.rate(elastic.field)) / pace.stride)) + 3
    state = elastic
    for share in np.linspace(0.0, 1.0, n + 1)[1:]:
        scale = share / (share - 1.0 / n) if share > 1.5 / n else share
        guess = Field(state.field.x, scale * state.field.node, scale * state.field.stage)
        found = resettle(m, state, guess, Control(m.ends.precrack, share * m.base.v_peak, m.ends.precrack))
        if found is not None and found.field.node[0, V] > pace.end:
            found = resettle(m, found, found.field, Control(0.0, pace.end, m.ends.precrack))
        if found is None:
            yield f"stopped: the undamaged arm was not solved; {UNEQUAL}"
            return
        state = found
        yield state
        if _reached(state, pace):
            return


def _per_front(m: Model, state: State) -> float:
    """Factor of the tangent for a unit advance of the front: -(slope of the gap) / (its change by the tangent)."""
    y = state.field.at(np.array(state.front))
    by = m.arm.gap(y)[1]
    return float(-by @ m.arm.rates(y, np.zeros(3))[0] / (by @ state.tangent.at(np.array(state.front))))


def _step(m: Model, state: State, ds: float) -> State | None:
    """The state with the damage front advanced by ``ds``; None if not found.

    The first guess of a step that is short compared with the process zone follows the tangent; that of a longer step
    moves the whole field with the front, as a fully developed zone moves.
    """
    front = state.front + ds
    control = Control(front, m.base.v_peak, front)
    zone = np.diff(state.field.x)[state.kind == SOFTENING].sum()
    along = state.ahead(ds * _per_front(m, state)), state.kind
    guesses = [along, _moved(m, state, ds)]
    if np.any(state.kind == OPEN) and ds > 0.25 * zone:
        guesses.reverse()
    for guess, kind in guesses:
        new = settle(m, guess, find(m.arm, m.base, guess, kind, m.ends, front), control)
        if new is not None:
            return new
    return None


def _moved(m: Model, state: State, ds: float) -> tuple[Field, np.ndarray]:
    """The field moved by ``ds``, the arm before it extended straight, and the kind of its elements."""
    inside = state.field.x + ds < m.ends.length
    x = np.concatenate(([0.0], state.field.x[inside] + ds, [m.ends.length]))
    kind = np.concatenate((state.kind[:1], state.kind[inside[:-1]]))
    blank = Field.zero(x, m.arm.states)
    slope = m.arm.rates(state.field.node[0], np.zeros(3))[0][V]

    def there(at: np.ndarray) -> np.ndarray:
        y = state.field.at(np.maximum(at - ds, 0.0))
        y[..., V] += slope * np.minimum(at - ds, 0.0)
        return y

    return Field(x, there(x), there(blank.stage_x)), kind


def _land(m: Model, old: State, new: State, at: float, target: float) -> State:
    """The state between two at which the quantity controlled at ``at`` equals ``target``; ``new`` if it never does."""
    low, high = 0.0, new.front - old.front
    before, after = (controlled(m, state.field.at(np.array(at)), at)[0] for state in (old, new))
    if not before < target * (1.0 - 1e-9) < after:
        return new
    for _ in range(40):
        ds = low + np.clip((target - before) / (after - before), 0.02, 0.98) * (high - low)
        trial = _step(m, old, ds)
        if trial is None:
            return new
        value, by = controlled(m, trial.field.at(np.array(at)), at)
        rate = float(by @ trial.tangent.at(np.array(at)))
        landed = resettle(m, trial, trial.ahead((target - value) / rate), Control(at, target, None))
        if landed is not None and old.front <= landed.front <= new.front:
            return landed
        low, high, before, after = (low, ds, before, value) if value > target else (ds, high, value, after)
    return new
