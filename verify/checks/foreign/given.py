"""A load curve of another code: what it goes through of a programme, and how finely it was written down."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from verify.checks.between_codes import CODE_TOLERANCE
from verify.checks.orders import ARMS, BEAM_RUN
from verify.checks.proof import SEARCHING, sampled
from verify.curves.curve import LEAST_LOAD
from verify.curves.leg_checks import OF_A_POINT
from verify.curves.legs import TURN_TOLERANCE, path
from verify.curves.scatter import SIGMAS, Scatter, scatter_of
from verify.methods.names import METHODS
from verify.result import Result
from verify.scene.magnitudes import SMALLEST_NUMBER
from verify.scene.schema import Scene
from verify.support.programme import only_opens, turns
from verify.verdict import Check

#: Methods that a curve is compared with, each with the tolerance that holds between these methods, too.
HELD_AGAINST: Mapping[str, float] = {
    name: CODE_TOLERANCE for name, one in METHODS.items() if one.has_mesh and not one.mesh_error
}

#: Load, over the peak load, below which a curve counts as that of a separated specimen.
BEARS_NO_LOAD = 0.01

#: First opening of a curve, over the first leg, above which its beginning is missing.
LATE = 0.01


@dataclass(frozen=True)
class Given:
    """A curve (n,) of another code along ``goals``, the part of the load ``programme`` that it goes through.

    ``loud``: a noise, over the largest load, that is too large to count as none.
    """

    name: str
    curve: tuple[np.ndarray, np.ndarray]
    programme: tuple[float, ...]
    goals: tuple[float, ...]
    scatter: Scatter
    loud: float = 0.0

    @property
    def first(self) -> float:
        """Its first opening, in the sense of the first leg."""
        return max(float(np.asarray(self.curve[0])[0]) * float(np.sign(self.programme[0])), 0.0)

    @property
    def whole(self) -> bool:
        """Whether it ends where the programme does."""
        return self.goals == self.programme

    @property
    def missing(self) -> float:
        """Part of the way of the programme behind its end."""
        return max(0.0, 1.0 - _way(self.goals) / _way(self.programme))

    @property
    def share(self) -> float:
        """Part of the way of the programme that it goes, in percent."""
        return 100.0 * (_way(self.goals) - self.first) / _way(self.programme)

    @property
    def scattered(self) -> str:
        """What was found of rounding and noise; empty where it is too small to matter."""
        pairs = zip(("loads", "openings"), self.scatter.halves[::-1], strict=True)
        said = [f"{name} rounded to {2.0 * float(half.max()):.3g}" for name, half in pairs if half.max() > 0.0]
        if self.scatter.seen:
            noise = self.scatter.noise / float(np.max(np.abs(self.curve[1])))
            said.append(f"noise of {100.0 * noise:.2g} % of the peak load")
        return " and ".join(said)

    def unless_outside(self, check: Check, at: float, what: str = "it") -> Check:
        """The check, not covered where the curve does not contain an opening of the first or the last leg."""
        if self.first <= at * (1.0 + TURN_TOLERANCE) and at <= max(self.goals) * (1.0 + TURN_TOLERANCE):
            return check
        side = f"begins at {self.first:.4g}" if self.first > at else f"ends at {max(self.goals):.4g}"
        return not_covered(check, f"the curve {side}, {what} is at {at:.4g}")


def given(scene: Scene, name: str, curve: Result, results: Mapping[str, Result]) -> Given:
    """What a curve goes through of the programme, and its scatter.

    Parameters
    ----------
    results : the runs of the scene by name; where the programme only opens they show what no scatter is
    """
    programme = _programme(scene, curve, results.values())
    goals, rows = _gone_through(curve, programme), (curve.opening, curve.load)
    judge = guide(results) if only_opens(programme) else None
    scatter = scatter_of(rows, None if judge is None else sampled(judge))
    noise = scatter.noise / max(float(np.max(np.abs(curve.load))), SMALLEST_NUMBER)
    loud = noise > CODE_TOLERANCE * (1.0 + 3.5 / np.sqrt(curve.load.size))  # three of its own standard deviations
    if SIGMAS * noise <= OF_A_POINT * CODE_TOLERANCE * LEAST_LOAD or (loud and scatter.seen):
        counts = 0.0
    else:
        counts = scatter.noise * CODE_TOLERANCE / noise if loud else scatter.noise
    return Given(name, rows, programme, goals, replace(scatter, noise=counts), noise if loud and scatter.seen else 0.0)


def guide(results: Mapping[str, Result]) -> Result | None:
    """The run that shows the shape of a curve between its rows."""
    names = (SEARCHING, *HELD_AGAINST, ARMS, BEAM_RUN)
    return next((results[name] for name in names if name in results and results[name].load.size > 1), None)


def not_covered(check: Check, why: str) -> Check:
    """The check of what a curve does not contain."""
    return replace(check, unresolved=why, covered=False)


def remark(mine: Given, checks: Sequence[Check]) -> tuple[str, ...]:
    """A sentence on what was judged of a curve, if that is not all, or has scatter."""
    said = []
    if mine.first > LATE * abs(mine.programme[0]) or not mine.whole:
        said.append(
            f"judged from the opening {mine.first:.4g} to {mine.goals[-1]:.4g}, {mine.share:.3g} % of the programme"
        )
        absent = dict.fromkeys(check.name for check in checks if check.state == "not covered")
        said += [f"not covered: {', '.join(absent)}"] if absent else []
    said += [f"{mine.scattered}, which is taken for no error"] if mine.scattered else []
    loud = (
        f"{100.0 * mine.loud:.2g} % of the peak load is more than the {100.0 * CODE_TOLERANCE:g} % that a curve may be"
    )
    said += [f"a noise of {loud} off"] if mine.loud else []
    return (f"{mine.name}: {'; '.join(said)}",) if said else ()


def _way(goals: Sequence[float]) -> float:
    return float(np.sum(np.abs(np.diff((0.0, *goals)))))


def _gone_through(curve: Result, programme: tuple[float, ...]) -> tuple[float, ...]:
    """The programme up to the last opening of a curve that only ends before it; else the whole programme."""
    corners = turns(programme)
    found = path((curve.opening, curve.load), programme)
    last, k, size = found.legs[-1], len(found.legs), max(map(abs, corners))
    end, begin = float(last.opening[-1]), (0.0, *corners)[k - 1]
    rest = curve.opening[np.flatnonzero(curve.opening == end)[-1] :]
    back = max(float(np.max(leg.heading * (leg.begin - leg.opening))) for leg in found.legs)  # beyond its beginning
    short = not found.complete and last.heading * (corners[k - 1] - end) > 0.0
    if not short or max(np.ptp(rest), back) > TURN_TOLERANCE * size:
        return programme
    here = (end,) if last.heading * (end - begin) > TURN_TOLERANCE * size else ()
    return (*corners[: k - 1], *here) or programme


def _programme(scene: Scene, curve: Result, runs: Iterable[Result]) -> tuple[float, ...]:
    """The load programme up to the separation of the specimen in a built-in run.

    A foreign curve whose load has vanished is complete, too: its last opening may be the end of the programme.
    """
    programme = scene.load.opening
    apart = [float(run.opening.max()) for run in runs if run.separated]
    side = curve.opening * curve.opening[-1] >= 0.0  # of zero: pressed faces may bear a hundred times as much
    if apart and abs(curve.load[-1]) <= BEARS_NO_LOAD * np.max(np.abs(curve.load[side])):
        apart.append(float(curve.opening.max()))
    end = min(apart, default=np.inf)
    last = next((i for i, goal in enumerate(programme) if goal > end), None)
    return tuple(programme) if last is None else (*programme[:last], end)
