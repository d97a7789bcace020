"""Tractions along a path: of the definition, of the laws of the solvers, of a function in a module or a Python file."""

from __future__ import annotations

import copy
import sys
import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from importlib import import_module
from pathlib import Path
from runpy import run_path
from typing import Any

import numpy as np

from verify.methods.bonds import iga_law, modelled_law
from verify.studies.law.paths import JumpPath
from verify.support.refusal import Refusal
from verify.theory.bond import Bond
from verify.theory.mixed_law import MixedBond

#: ``law(g, s, state, dt) -> p, t, state`` or ``p, t, state, ((dp_dg, dp_ds), (dt_dg, dt_ds))``
PointLaw = Callable[..., Any]

#: Tangents are compared with differences of these step sizes, relative to the largest opening or slip of the path, at
#: this many of its steps.
DIFFERENCES, PROBED = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7), 16

#: A law is followed to failure in this many steps more, shorter near rest by this exponent; beyond the path each jump
#: is this times the last, up to this many lengths. It has failed where this part of its work is left (`unfinished`).
#: Trapezia are then good for 1e-4 of the work of an exponential law.
FINE, GRADED, GROWTH, FURTHEST, NO_WORK_LEFT = 400, 3.0, 1.02, 1024.0, 1e-5


@dataclass(frozen=True, eq=False)
class Answer:
    """Tractions ``p``, ``t`` (n,) [stress] at the steps of a path.

    ``tangent`` (n, 2, 2) holds the derivatives of (p, t) by (g, s) [stress per length]. ``differences`` are forward and
    backward differences of the law itself with each of the sizes `DIFFERENCES`, (n, n_h, 2, 2, 2), NaN at steps where
    there are none.
    """

    p: np.ndarray
    t: np.ndarray
    tangent: np.ndarray | None = None
    differences: np.ndarray | None = None

    @property
    def tractions(self) -> np.ndarray:
        """Both (2, n)."""
        return np.array([self.p, self.t])

    def work(self, path: JumpPath) -> float:
        """Work along a path, by the trapezoid rule [energy per area]."""
        return float(np.trapezoid(self.p, path.g) + np.trapezoid(self.t, path.s))


#: A path and tractions there.
Far = tuple[JumpPath, Answer]


@dataclass(frozen=True, eq=False)
class Case:
    """One path, with the tractions of the law that is judged, those ``known`` of the definition, those of the law on
    the path with the opposite slip, if there is one, and its longer path of this mode ratio that ends with failure."""

    bond: MixedBond
    way: JumpPath
    given: Answer
    known: Answer
    opposite: Answer | None = None
    far: Far | None = None

    @property
    def whole(self) -> Far:
        """The path to failure of the law that is judged, as far as it is known."""
        return self.far or (self.way, self.given)

    @cached_property
    def scale(self) -> np.ndarray:
        """Of each traction (2, 1): its strength, or its largest value where that is larger, as in contact."""
        return np.maximum(self.bond.strength, np.abs(self.known.tractions).max(axis=1))[:, None]

    def apart(self, one: Answer, other: Answer) -> tuple[float, float]:
        """Mean square and largest distance of tractions, ``sqrt((dp / p_s)^2 + (dt / t_s)^2)`` with those scales."""
        distance = np.hypot(*((one.tractions - other.tractions) / self.scale))
        return float(np.mean(distance**2)), float(distance.max())


def of_bond(bond: MixedBond, path: JumpPath) -> Answer:
    """Tractions of the definition."""
    found = bond.path(path.g, path.s, path.time)
    return Answer(found.p, found.t)


def of_function(law: PointLaw, path: JumpPath, name: str = "law") -> Answer:
    """Tractions of a law that is called step by step; the first state is None, each step gets the state of the last.

    Raises
    ------
    Refusal : naming the path, the step, and the line of the law that failed.
    """
    states, jumps, dt = [None], path.jump.T, float(path.time[1])

    def called(i: int, jump: np.ndarray) -> tuple[np.ndarray, Any, np.ndarray | None]:
        g, s = float(jump[0]), float(jump[1])
        place = f"{name}: path {path.name}, step {i}, g = {g:g}, s = {s:g}"
        return _called(law, (g, s, copy.deepcopy(states[i]), dt), place)

    tractions, given = [], []
    for i, jump in enumerate(jumps):
        found, state, tangent = called(i, jump)
        states.append(state)
        tractions.append(found)
        given += [] if tangent is None else [tangent]
    p, t = np.array(tractions).T
    if not given:
        return Answer(p, t)
    if len(given) < p.size:
        raise Refusal(f"{name}: must return a tangent at every step or at none, got some on path {path.name}")
    differences = np.full((p.size, len(DIFFERENCES), 2, 2, 2), np.nan)
    for i in np.linspace(1, p.size - 1, min(PROBED, p.size - 1)).astype(int):
        for k, size in enumerate(DIFFERENCES):
            for side, step in enumerate(size * np.abs(jumps).max() * np.array([1.0, -1.0])):
                ahead = [called(i, jumps[i] + step * axis)[0] for axis in np.eye(2)]
                differences[i, k, side] = (np.array(ahead) - tractions[i]).T / step
    return Answer(p, t, np.array(given), differences)


def unfinished(far: Far) -> float:
    """What the tractions at the end of a path would do on as long a way again, over the work so far."""
    way, given = far
    left = abs(given.p[-1] * way.g[-1] + given.t[-1] * way.s[-1])
    return float(left / max(abs(given.work(way)), np.finfo(float).tiny))


def to_failure(law: PointLaw, path: JumpPath, name: str = "law") -> Far:
    """A straight path in finer steps, and on beyond its end until the law has failed, or `FURTHEST` times as far."""
    size, length = np.hypot(*path.jump) / np.hypot(*path.jump[:, -1]), 1.0
    part = np.union1d(size, np.linspace(0.0, 1.0, FINE + 1) ** GRADED)
    while True:
        beyond = GROWTH ** np.arange(1, round(np.log(length) / np.log(GROWTH)) + 1)
        g, s = (jump[-1] * np.append(part, beyond) for jump in path.jump)
        way = replace(path, g=g, s=s)
        far = way, of_function(law, way, name)
        if not unfinished(far) > NO_WORK_LEFT or length >= FURTHEST:
            return far
        length *= 2.0


def followed(law: PointLaw, paths: Sequence[JumpPath], name: str = "law") -> tuple[dict[str, Answer], dict[str, Far]]:
    """Tractions of a law on all paths, and on the way to failure at the mode ratios of some."""
    far = {path.name: to_failure(law, path, name) for path in paths if path.ratio is not None}
    return {path.name: of_function(law, path, name) for path in paths}, far


def _called(law: PointLaw, call: tuple, place: str) -> tuple[np.ndarray, Any, np.ndarray | None]:
    """Tractions (2,), state and tangent of one call."""
    try:
        found = law(*call)
    except (Exception, SystemExit) as error:
        raise Refusal(f"{place}: {_told(error)}") from None
    if not isinstance(found, Sequence | np.ndarray) or isinstance(found, str) or len(found) not in (3, 4):
        raise Refusal(f"{place}: must return p, t, state or p, t, state, tangent, got {_short(found)}")
    tractions = [_finite(found[i], (), f"{place}: {key} must be a finite number") for i, key in enumerate("pt")]
    rule = f"{place}: the tangent must be 2 x 2 finite numbers"
    return np.array(tractions), found[2], None if len(found) == 3 else _finite(found[3], (2, 2), rule)


def _finite(value: Any, shape: tuple[int, ...], rule: str) -> np.ndarray:
    try:
        found = np.squeeze(np.asarray(value, dtype=float))
    except (TypeError, ValueError):
        found = np.full(shape, np.nan)
    if found.shape != shape or not np.isfinite(found).all():
        raise Refusal(f"{rule}, got {_short(value)}")
    return found


def _told(error: BaseException) -> str:
    """An error with the last line of the user's code in its traceback, if any."""
    ours = ("importlib", "runpy", __file__)
    frames = traceback.extract_tb(error.__traceback__)
    lines = [line for line in frames if not any(one in line.filename for one in ours)]
    where = f"{lines[-1].filename}:{lines[-1].lineno}, in {lines[-1].name}: " if lines else ""
    return f"{where}{type(error).__name__}: {' '.join(str(error).split())[:200]}"


def _short(value: Any) -> str:
    text = " ".join(repr(value).split())
    return text if len(text) <= 80 else f"{text[:80]}..."


def function(text: str) -> PointLaw | None:
    """The function that ``module:function`` or ``file.py:function`` names, of a module of the present folder or an
    installed one; None for the name of a file of tractions.

    Raises
    ------
    Refusal : no such file, module or function.
    """
    place, _, name = text.rpartition(":")
    if not (place and name.isidentifier()) or Path(text).exists():
        return None
    in_file, before = place.endswith(".py"), list(sys.path)
    if in_file and not Path(place).is_file():
        raise Refusal(f"{text}: must name a function in a file or a module, got no file {place}")
    sys.path.insert(0, str(Path(place).resolve().parent if in_file else Path.cwd()))
    try:
        content = run_path(place, run_name=f"law_{Path(place).stem}") if in_file else vars(import_module(place))
    except (Exception, SystemExit) as error:
        raise Refusal(f"{text}: {place} cannot be imported: {_told(error)}") from None
    finally:
        sys.path[:] = before
    found = content.get(name)
    if not callable(found):
        what = "nothing" if found is None else type(found).__name__
        raise Refusal(f"{text}: {place} must have a function {name}, got {what}")
    return found


def built_in(bond: Bond) -> PointLaw:
    """The law of ``iga`` with the numbers of a bond, with its tangent; where it opens alone sliding costs nothing."""
    found, n = iga_law(bond), 1 + bond.slides

    def law(g: float, s: float, state: Any, dt: float) -> tuple:
        history = found.start(1) if state is None else state
        traction, slope, after = found.respond(np.array([[g, s][:n]]), history, dt, None, None)
        whole, tangent = np.zeros(2), np.zeros((2, 2))
        whole[:n], tangent[:n, :n] = traction[0], slope[0]
        return *whole, after, tangent

    return law


def modelled(bond: MixedBond) -> PointLaw:
    """The law of ``fem_reference`` with the numbers of a bond."""
    from fem_reference.problem.mixed_law import MixedLaw

    found = modelled_law(bond)
    assert isinstance(found, MixedLaw)

    def law(g: float, s: float, state: Any, dt: float) -> tuple:
        d, slip = (np.zeros(1), np.zeros(1)) if state is None else state
        p, t, tangent, d, slip = found.traction(np.array([g]), np.array([s]), d, slip, dt)
        return p[0], t[0], (d, slip), tangent[0]

    return law
