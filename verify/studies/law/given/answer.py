"""Tractions along a path, from a function, the built-in law or the definition."""

from __future__ import annotations

import copy
import traceback
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from verify.studies.law.ways.legs import JumpPath
from verify.support.refusal import Refusal
from verify.theory.mixed_law import MixedBond

#: ``law(g, s, state, dt) -> p, t, state`` or ``p, t, state, ((dp_dg, dp_ds), (dt_dg, dt_ds))``
PointLaw = Callable[..., Any]


@dataclass(frozen=True, eq=False)
class Answer:
    """Tractions ``p``, ``t`` (n,) [stress] at the steps of a path.

    ``tangent`` (n, 2, 2) holds the derivatives of (p, t) by (g, s) [stress per length]. ``differences`` are forward,
    central and backward differences of the law itself, (n_h, n_i, 3, 2, 2), at the steps ``probed`` (n_i,), with each
    of the step sizes `DIFFERENCES.sizes`.
    """

    p: np.ndarray
    t: np.ndarray
    tangent: np.ndarray | None = None
    probed: np.ndarray | None = None
    differences: np.ndarray | None = None


Answers = Mapping[str, Answer]


@dataclass(frozen=True)
class Differences:
    """Where tangents are compared with differences: at up to ``most`` steps of a path, with step ``sizes`` relative to
    the largest opening and slip of the path."""

    sizes: tuple[float, ...] = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7)
    most: int = 16


DIFFERENCES = Differences()


class LawError(Refusal):
    """A law that raises, or returns something else than finite tractions."""


def of_bond(bond: MixedBond, path: JumpPath) -> Answer:
    """Tractions of the definition."""
    found = bond.path(path.g, path.s, path.time)
    return Answer(found.p, found.t)


def of_function(law: PointLaw, path: JumpPath, name: str = "law") -> Answer:
    """Tractions of a law that is called step by step; the first state is None, each step gets the state of the last.

    Raises
    ------
    LawError : naming the path, the step, and the line of the law that failed.
    """
    state: Any = None
    found: list[list[float]] = []
    given: list[np.ndarray | None] = []
    states: list[Any] = []
    for i, (g, s) in enumerate(zip(path.g.tolist(), path.s.tolist(), strict=True)):
        place = f"{name}: path {path.name}, step {i}, g = {g:g}, s = {s:g}"
        states.append(copy.deepcopy(state))
        *tractions, state, tangent = _called(law, (g, s, state, path.dt), place)
        found.append(tractions)
        given.append(tangent)
    p, t = np.array(found).T
    if any(one is None for one in given):
        if any(one is not None for one in given):
            raise LawError(f"{name}: must return a tangent at every step or at none, got some on path {path.name}")
        return Answer(p, t)
    probed = np.unique(np.linspace(1, path.g.size - 1, min(DIFFERENCES.most, path.g.size - 1)).astype(int))
    differences = np.stack([_differences(law, path, i, states[i], name) for i in probed], axis=1)
    return Answer(p, t, np.array(given), probed, differences)


def _differences(law: PointLaw, path: JumpPath, i: int, state: Any, name: str) -> np.ndarray:
    """Forward, central and backward differences (n_h, 3, 2, 2) of a law at a step, from the state before it."""
    place = f"{name}: path {path.name}, beside step {i}"
    at = np.array([path.g[i], path.s[i]])

    def tractions(jump: np.ndarray) -> np.ndarray:
        call = (float(jump[0]), float(jump[1]), copy.deepcopy(state), path.dt)
        return np.array(_called(law, call, place)[:2])

    here, largest = tractions(at), max(np.abs(path.g).max(), np.abs(path.s).max())
    out = np.empty((len(DIFFERENCES.sizes), 3, 2, 2))
    for k, size in enumerate(DIFFERENCES.sizes):
        for j in (0, 1):
            h = size * largest * np.eye(2)[j]
            ahead, behind = tractions(at + h), tractions(at - h)
            step = size * largest
            out[k, :, :, j] = (ahead - here) / step, (ahead - behind) / (2.0 * step), (here - behind) / step
    return out


def _called(law: PointLaw, call: tuple, place: str) -> tuple[float, float, Any, np.ndarray | None]:
    try:
        found = law(*call)
    except (Exception, SystemExit) as error:
        raise LawError(f"{place}: {_where(error)}{type(error).__name__}: {_one_line(error)}") from None
    if not isinstance(found, Sequence | np.ndarray) or isinstance(found, str) or len(found) not in (3, 4):
        raise LawError(f"{place}: must return p, t, state or p, t, state, tangent, got {_short(found)}")
    p, t = (_number(value, f"{place}: {key}") for key, value in zip("pt", found[:2], strict=True))
    return p, t, found[2], _tangent(found[3], place) if len(found) == 4 else None


def _number(value: Any, place: str) -> float:
    try:
        array = np.asarray(value, dtype=float)
        number = float(array.reshape(())) if array.size == 1 else np.nan
    except (TypeError, ValueError):
        number = np.nan
    if not np.isfinite(number):
        raise LawError(f"{place} must be a finite number, got {_short(value)}")
    return number


def _tangent(value: Any, place: str) -> np.ndarray:
    try:
        found = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        found = np.empty(0)
    if found.shape != (2, 2) or not np.isfinite(found).all():
        raise LawError(f"{place}: the tangent must be 2 x 2 finite numbers, got {_short(value)}")
    return found


def _where(error: BaseException) -> str:
    """The last line of the user's code in a traceback; empty where the call itself failed."""
    lines = [line for line in traceback.extract_tb(error.__traceback__) if line.filename != __file__]
    return f"{lines[-1].filename}:{lines[-1].lineno}, in {lines[-1].name}: " if lines else ""


def _one_line(error: BaseException) -> str:
    return " ".join(str(error).split())[:200]


def _short(value: Any) -> str:
    text = " ".join(repr(value).split())
    return text if len(text) <= 80 else f"{text[:80]}..."
