"""The path behind the front of damage: what a step prescribes, how long it is, and where it ends.

A step raises the progress of the bond at a point of the front, which only grows, so that snap-backs of load and opening
need no special treatment. The last one prescribes the opening.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from verify.theory.arms.equilibrium import Control, Model, State, solve

#: What a path ends with: the bond has nothing left to break.
ALL_BROKEN = "the bond is broken from end to end"


@dataclass(frozen=True)
class Pace:
    """Lengths of steps.

    ``scale`` (2,) : opening and load by which a step is measured
    ``stride`` : goal of a step in these; one of three times that is halved
    ``least``, ``most`` : changes of the progress of the bond at the front; the path stops at a smaller one
    ``room`` : progress at which a point is left for one behind it, as a part of the way to failure
    ``iterations`` : more of them than this shorten the next step
    """

    end: float
    scale: np.ndarray
    stride: float
    least: float = 1e-4
    most: float = 0.3
    room: float = 1.95
    iterations: int = 9

    def length(self, model: Model, before: State, after: State) -> float:
        opening, load = model.structure.load @ (after.x - before.x), after.load - before.load
        return float(np.hypot(*np.array([opening, load]) / self.scale))


def first_state(model: Model, end: float) -> State | None:
    """A state without damage at an opening up to ``end`` / 100.

    It prescribes the opening, since the progress of the bond does not know its sign.
    """
    opening, rest = 0.01 * end, model.intact()
    while opening > 1e-12 * end:
        found = solve(model, rest, rest, Control(opening))
        if found is None or not np.any(found.history.d[model.interface.bonded] > 0.0):
            return found
        opening *= 0.1
    return None


def follow(model: Model, state: State, pace: Pace) -> Iterator[State | None | str]:
    """States of the path from the first one to the opening ``pace.end``; None for a step that was halved; at last what
    ended it."""
    yield state
    dr = _front(model, state, 0.0)[1]
    while True:
        at, now = _front(model, state, dr)
        if at is None:
            yield ALL_BROKEN
            return
        found = solve(model, _guess(model, state, dr, at), state, Control(now + dr, at))
        length = np.inf if found is None else pace.length(model, state, found)
        if length > 3.0 * pace.stride and dr > pace.least:
            dr = max(0.5 * dr, pace.least)
            yield None
            continue
        if found is None:
            yield f"stopped: no equilibrium found beyond opening {model.structure.load @ state.x:.6g}"
            return
        if model.structure.load @ found.x >= pace.end:
            last = solve(model, found, state, Control(pace.end))
            if last is None and dr > pace.least:
                dr = max(0.5 * dr, pace.least)
                yield None
                continue
            yield last or found
            yield "complete"
            return
        most = 2.0 if found.iterations <= pace.iterations else 0.7
        dr = float(np.clip(dr * min(pace.stride / max(length, 1e-12), most), pace.least, _most(model, found, pace)))
        state = found
        yield found


def _most(model: Model, state: State, pace: Pace) -> float:
    """Without damage the path is straight but for contact."""
    return pace.most if np.any(state.history.d[model.interface.bonded] > 0.0) else np.inf


def _front(model: Model, state: State, dr: float) -> tuple[tuple[int, int] | None, float]:
    """The point of the bond that is furthest on its way among those that a step will not break, and its progress."""
    face = model.interface
    r = np.where(face.bonded, face.progress(state.jump[..., 0], state.jump[..., 1]), -1.0)
    r = np.where((r + min(dr, Pace.most) <= Pace.room) & (state.history.d < 1.0), r, -1.0)
    r[:, [0, -1]] = -1.0  # the ends of an element have no weight
    e, q = np.unravel_index(int(np.argmax(r)), r.shape)
    return ((int(e), int(q)), float(r[e, q])) if r[e, q] >= 0.0 else (None, 0.0)


def _guess(model: Model, state: State, dr: float, at: tuple[int, int]) -> State:
    """The state moved along its direction until the progress at a point is raised by ``dr``; itself where the direction
    does not raise it."""
    way = state.direction
    if way is None:
        return state
    here, along = state.jump[at], way.jump[at]
    face, size = model.interface, 1e-6 * np.abs(model.interface.scale / np.maximum(np.abs(along), 1e-300)).min()
    rate = float(face.progress(*(here + size * along)) - face.progress(*here)) / size
    step = dr / rate if rate > 0.0 else 0.0
    if step * np.abs(way.jump).max() > 10.0 * max(np.abs(state.jump).max(), face.scale.max()):
        step = 0.0
    return replace(
        state, x=state.x + step * way.x, load=state.load + step * way.load, jump=state.jump + step * way.jump
    )
