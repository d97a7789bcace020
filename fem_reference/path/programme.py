"""The load programme as increments of the opening."""

from __future__ import annotations

import numpy as np

from fem_reference.path.stride import COUNTED_STEPS
from fem_reference.problem.problem import Debonding

#: A step that ends within this part of an increment of its goal is extended to the goal.
NEAR_THE_GOAL = 0.01


def branches(problem: Debonding, whole: bool = False) -> list[np.ndarray]:
    """Ends of equal increments of the opening, about ``steps`` over the whole programme, one array per branch.

    With ``whole``, for paths that choose their steps, each branch is one increment. A branch also ends where the
    programme passes through zero, as all gaps of an unloaded bond open or close there.
    """
    goals = np.concatenate([[0.0], problem.opening])
    crossed = np.flatnonzero(goals[1:] * goals[:-1] < 0.0)
    corners = np.insert(goals, crossed + 1, 0.0)
    ways = np.abs(np.diff(corners))
    steps = 0 if whole else problem.steps or COUNTED_STEPS.instead
    counts = np.maximum(1, np.rint(steps * ways / ways.sum()).astype(int))
    parts = zip(corners[:-1], corners[1:], counts, ways, strict=True)
    return [np.linspace(start, end, n + 1) for start, end, n, way in parts if way > 0]


def next_line(opening: float, lines: np.ndarray, reach: float) -> float:
    """Opening at the end of the next increment, or nearer, as far as a step may reach."""
    way = (lines - opening) / (lines[1] - lines[0])
    line = float(lines[np.argmax(way > NEAR_THE_GOAL)]) if way[-1] > NEAR_THE_GOAL else float(lines[-1])
    left = line - opening
    return line if abs(left) <= reach * (1 + NEAR_THE_GOAL) else opening + float(np.copysign(reach, left))
