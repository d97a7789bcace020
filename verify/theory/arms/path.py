"""The path through the legs of a programme: what a step prescribes, how long it is, and where it ends.

A step prescribes the progress of the bond, which only grows, also where opening and load fall, unless the bond heals;
or the opening, where hardly any damage grows.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from verify.theory.arms.equilibrium import Control, Model, State, solve
from verify.theory.arms.front import followed

#: What a path ends with: the bond, or the load, has nothing left.
HAS_SEPARATED = "separated"

#: Rate of the progress along the path, of opening and progress over their scales, from which on a step prescribes it;
#: and that of a step which failures have made short: the opening may have a maximum here.
GROWS, GROWS_AT_ALL = 0.05, 1e-6


@dataclass(frozen=True)
class Pace:
    """Lengths of steps.

    ``opening``, ``progress`` : by which a step is measured
    ``loads`` : and loads on the sides of negative and of positive openings: pressed faces bear far more
    ``size`` : half of the goal of a step along the curve of opening and load, in these; at most six times that
    ``most``, ``least`` : the longest step in opening and progress, and one below which the path stops
    ``iterations`` : more of them than this shorten the next step
    ``separated`` : part of the bond that is whole, or of the largest load, below which the specimen has separated
    """

    opening: float
    progress: float
    loads: tuple[float, float]
    size: float
    most: float
    least: float = 1e-9
    iterations: int = 7
    separated: float = 1e-3

    @property
    def stride(self) -> float:
        return 2.0 * self.size

    @property
    def height(self) -> float:
        """Of the triangle of two steps at most, see `_height`: 6e-4 for 150 rows."""
        return 13.5 * self.size**2

    @property
    def enough(self) -> float:
        """A step in opening and progress that may be longer along the curve."""
        return 0.03 * self.size


def follow(
    model: Model, first: State, programme: tuple[float, ...], pace: Pace
) -> Iterator[State | tuple[Model, State] | str | None]:
    """Converged states in order, a model with the last state on it where the mesh changes, None for every step that was
    made shorter, and last a sentence on the end.

    ``first`` is a state of small opening, without damage.
    """
    state, whole = first, model.progress(np.where(model.interface.bonded, 1.0, 0.0))
    peaks, furthest, start, way = [0.0, 0.0], [0.0, 0.0], 0.0, 0.0  # of both sides: pressed faces bear far more
    for target in programme:
        turning, way, size = (target - start) * way < 0.0, float(np.sign(target - start)), 0.25 * pace.most
        chord: np.ndarray | None = None
        start, done = target, False
        while not done:
            opening = model.opening(state.x)
            side = int(opening > 0.0)
            peaks[side] = max(peaks[side], abs(state.load))
            faded = state.grown and abs(opening) > furthest[side] and abs(state.load) < pace.separated * peaks[side]
            if faded or whole - state.grown <= pace.separated * whole:
                yield HAS_SEPARATED
                return
            furthest[side] = max(furthest[side], abs(opening))
            found, done = _step(model, state, (target, way), size, pace, turning)
            last, chord = chord, _chord(model, state, found, pace)
            length, height = float(np.hypot(*chord)), _height(last, chord)
            coarse = (length > 3.0 * pace.stride or height > pace.height) and size > pace.enough and not turning
            if found is None or coarse:
                size, chord, done = 0.5 * size, last, False
                yield None
                if size < pace.least:
                    why = "where the traction falls steeply a larger beam.in_a_zone may help"
                    yield f"stopped: no equilibrium found beyond opening {opening:.6g}; {why}"
                    return
                continue
            most = 2.0 if found.iterations <= pace.iterations else 0.7
            factor = min(pace.stride / max(length, 1e-12), (0.5 * pace.height / max(height, 1e-12)) ** 0.5, most)
            size = min(size * max(factor, 0.5), pace.most)
            state, turning = found, False
            yield state
            if (on_next := followed(model, state)) is not None:
                model, state = on_next
                yield on_next
    yield "complete"


def _rates(model: Model, state: State, pace: Pace, way: float) -> tuple[np.ndarray, float]:
    """Changes of opening and progress over their scales along the path, of length 1 together, and the factor of
    ``state.along`` that makes them. Forward is where the progress grows; on a leg towards rest where the opening goes,
    or where the progress falls of a bond that heals."""
    along = state.along
    assert along is not None
    rates = np.array([model.opening(along.x) / pace.opening, state.growing / pace.progress])
    grows = 0.0 if _unloads(model, state, way) else rates[1]
    progress = -grows if model.opening(state.x) * way < 0.0 else grows
    forward = progress if abs(progress) > 1e-9 * abs(rates[0]) else rates[0] * way
    factor = np.copysign(1.0, forward) / max(float(np.hypot(*rates)), 1e-300)
    return rates * factor, factor


def _unloads(model: Model, state: State, way: float) -> bool:
    """Whether a leg leads towards rest, on which no damage grows or heals but by friction."""
    return bool(model.opening(state.x) * way < 0.0 and model.interface.bond.irreversible)


def _step(
    model: Model, state: State, to: tuple[float, float], size: float, pace: Pace, turning: bool
) -> tuple[State | None, bool]:
    """The next state, None where none is found, and whether it ends the leg ``to`` an opening in a direction."""
    target, way = to
    here = model.opening(state.x)
    at_rest = abs(here) <= 1e-12 * pace.opening
    if turning or at_rest:  # on the other side of rest other faces touch, and its tangent is that of neither
        step = min(size * pace.opening, abs(target - here), np.inf if at_rest or here * way > 0.0 else abs(here))
        control = Control(1.0, 0.0, here + way * step)
        found = solve(model, state, state, control, turning=True, from_rest=at_rest)
        return found, found is not None and step >= abs(target - here)
    rates, factor = _rates(model, state, pace, way)
    by_growth = not _unloads(model, state, way) and abs(rates[1]) > (GROWS if size > pace.enough else GROWS_AT_ALL)
    weights = np.array([0.0, 1.0]) if by_growth else np.array([way, 0.0])
    opening, growth = weights / (pace.opening, pace.progress)
    now = opening * model.opening(state.x) + growth * state.grown
    ahead = float(weights @ rates) * size
    if not growth and now * (now + ahead) < 0.0:
        ahead = -now
    along, far = state.along, factor * size
    assert along is not None
    load, reactions = state.load + far * along.load, state.reactions + far * along.reactions
    guess = replace(state, x=state.x + far * along.x, load=load, reactions=reactions)
    found = solve(model, guess, state, Control(opening, growth, now + ahead))
    if found is not None and (model.opening(found.x) - target) * way >= 0.0:
        part = (target - model.opening(state.x)) / (model.opening(found.x) - model.opening(state.x))
        found = solve(model, state.between(found, part), state, Control(1.0, 0.0, target))
        return found, found is not None
    return found, False


def _chord(model: Model, state: State, found: State | None, pace: Pace) -> np.ndarray:
    """The step along the curve of opening and load, in scales; infinite where there is none."""
    if found is None:
        return np.full(2, np.inf)
    before, after = model.opening(state.x), model.opening(found.x)
    return np.array([(after - before) / pace.opening, (found.load - state.load) / pace.loads[before + after > 0.0]])


def _height(before: np.ndarray | None, chord: np.ndarray) -> float:
    """Height of the triangle of two steps along the curve: four times what their middles are off a smooth curve."""
    if before is None or not np.all(np.isfinite(chord)):
        return 0.0
    return float(abs(before[0] * chord[1] - before[1] * chord[0]) / max(np.hypot(*(before + chord)), 1e-300))
