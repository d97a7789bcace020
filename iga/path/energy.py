"""The work of the load along a step, to fourth order, and whether the energies of the step say the same."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from iga.interface.interface import Interface
from iga.interface.mixed_law import History, MixedLaw
from iga.interface.traction_law import TractionLaw
from iga.mesh.quadrature import gauss
from iga.path.point import Point
from iga.system.state import INSTANT, Response, State
from iga.system.system import System


@dataclass(frozen=True)
class Balance:
    """How far a step may leave the balance of energy open: one that leaps over a part of the path does by more.

    ``leak`` is in parts of the largest work so far. As long as less than that is dissipated it is no measure; then
    ``of_dissipated`` is a part of what is, or, where that is next to nothing, ``of_elastic`` one of the work.
    Less than ``rounding`` of the work is not dissipated: rounding alone leaves points without damage some.
    Of a bond that slides the ledger of the whole path may be open by the part ``ledger`` of the largest work; from
    there on a step may add that part of its own.
    What slides off the master is added up over so many parts of a step (``sliding``).
    """

    leak: float = 1e-3
    of_dissipated: float = 1e-3
    of_elastic: float = 1e-7
    rounding: float = 1e-13
    ledger: float = 1e-3
    sliding: int = 16


BALANCE = Balance()


def _cubics(s: np.ndarray) -> tuple[np.ndarray, ...]:
    """Of cubic Hermite curves the functions (2, n_s) of both ends' values and slopes, and their derivatives."""
    return (
        np.stack([(1 + 2 * s) * (1 - s) ** 2, s * s * (3 - 2 * s)]),
        np.stack([s * (1 - s) ** 2, s * s * (s - 1)]),
        np.stack([6 * s * (s - 1), 6 * s * (1 - s)]),
        np.stack([(1 - s) * (1 - 3 * s), s * (3 * s - 2)]),
    )


_PLACES, _WEIGHTS = gauss(3)
_VALUES, _SLOPES, _D_VALUES, _D_SLOPES = _cubics(_PLACES)


def step_work(system: System, start: Point, end: Point, away: float, back: float) -> float:
    """Integral of the load over the opening along one step, both cubic Hermite curves over the controlled quantity.

    ``away`` and ``back`` are the lengths of the tangents at both ends that change that quantity by the step. Unlike a
    rule over the opening it holds where the path turns back. Its error is of fourth order; three Gauss points
    integrate it exactly.
    """
    loads = np.array([away * start.tangent.d_load, back * end.tangent.d_load])
    openings = np.array([away * (system.load_d @ start.tangent.du_d), back * (system.load_d @ end.tangent.du_d)])
    load = np.array([start.state.load, end.state.load]) @ _VALUES + loads @ _SLOPES
    d_opening = np.array([start.opening, end.opening]) @ _D_VALUES + openings @ _D_SLOPES
    return float(_WEIGHTS @ (load * d_opening))


def straight_work(start: Point, end: Point, several: bool) -> float:
    """The same over the opening itself, for a step that does not turn round.

    With the slopes behind its start and before its end; over ``several`` arcs of the load with their mean slopes.
    """
    move = end.opening - start.opening
    first, last = (start.slope, end.slope) if several else (start.tangent.departure, end.tangent.arrival)
    return 0.5 * move * (start.state.load + end.state.load) + move**2 / 12.0 * (first - last)


def by_chords(system: System) -> bool:
    """Whether slopes say nothing of a step: points stick and slip one after the other, or damage follows in time."""
    law = system.interface.law
    return isinstance(law, MixedLaw) and (law.friction > 0.0 or system.interface.viscosity > 0.0)


def spending(interface: Interface, start: Point, state: State, response: Response) -> State:
    """A converged state with what the bond has spent on a step, beyond what it stores: the work of its tractions along
    straight ways of the jumps, by the trapezoidal rule on ``sliding`` parts of each (`Balance`).

    Points whose history has not changed store all of it.
    """
    law, before, touches = interface.law, start.state.past, (start.response.contact, response.contact)
    now, (g0, g1), shares = state.past, (touch.g_q for touch in touches), [touch.share_q for touch in touches]
    assert isinstance(law, MixedLaw)
    changed_q = (now.k_q != before.k_q) | (shares[1] < 1.0) | (shares[0] < 1.0)
    if now.slip_q is not None and before.slip_q is not None:
        changed_q |= now.slip_q != before.slip_q
    q = np.flatnonzero(changed_q)
    if q.size == 0:
        return state
    s0, s1 = (touch.slip.s_q for touch in touches if touch.slip is not None)
    jumps, share = ((g0[q], s0[q]), (g1[q], s1[q])), (shares[0][q], shares[1][q])
    ends = [History(one.k_q[q], None if one.slip_q is None else one.slip_q[q]) for one in (before, now)]
    parts = 1 if interface.viscosity else BALANCE.sliding  # a part of a viscous step does not end where the step does
    work_q, rubbed_q = _work_of_jumps(law, jumps, share, ends[0], (parts, state.dt or INSTANT))
    kept, left = (law.stored(g, s, past) for (g, s), past in zip(jumps, ends, strict=True))
    work_q -= share[1] * sum(left) - share[0] * sum(kept)
    dA_q = interface.dA_q[q]
    return replace(state, spent=state.spent + float(dA_q @ work_q), rubbed=state.rubbed + float(dA_q @ rubbed_q))


def _work_of_jumps(
    law: MixedLaw,
    jumps: Sequence[tuple[np.ndarray, np.ndarray]],
    shares: tuple[np.ndarray, np.ndarray],
    past: History,
    timed: tuple[int, float],
) -> tuple[np.ndarray, np.ndarray]:
    """Work per area (n,) of the tractions along straight ways of gap and slip, and what friction takes of it; in a
    number of parts that take a time each."""
    (g0, s0), (g1, s1), (parts, dt) = *jumps, timed
    work, rubbed, step_g, step_s = np.zeros(g0.size), np.zeros(g0.size), (g1 - g0) / parts, (s1 - s0) / parts
    found = law.traction(g0, s0, past, INSTANT)
    for part in range(1, parts + 1):
        earlier = found.history if part > 1 else past
        last, share = found, shares[0] + (shares[1] - shares[0]) * (part - 0.5) / parts
        s = s0 + part * step_s
        found = law.traction(g0 + part * step_g, s, earlier, dt)
        work += 0.5 * share * ((last.p + found.p) * step_g + (last.t + found.t) * step_s)
        if earlier.slip is not None and found.history.slip is not None:
            held = found.t - (1.0 - found.history.d) * law.stiffness[1] * s
            rubbed += share * held * (found.history.slip - earlier.slip)
    return work, rubbed


def slid_off(system: System, start: Point, end: Point, away: float, back: float) -> float:
    """Energy that goes with points sliding off the master along one step; ``away`` and ``back`` as for `step_work`.

    Of ``share psi`` at a point it is ``-psi d(share)``: no force draws what slides off back. Of the damage, which is
    booked for the whole point, only the share takes anything. The gap and the place beyond the end of the master are
    cubic Hermite curves, within their ends.
    """
    interface, law = system.interface, system.interface.law
    assert isinstance(law, TractionLaw)
    touches = start.response.contact, end.response.contact
    q = np.flatnonzero((touches[0].share_q < 1.0) | (touches[1].share_q < 1.0))
    if q.size == 0:
        return 0.0
    ends, lengths = (start, end), (away, back)
    g = _hermite([touch.g_q[q] for touch in touches], [point.tangent.rate_q[q] for point in ends], lengths)
    at_ends = [0.5 - np.sin(np.arcsin(1.0 - 2.0 * touch.share_q[q]) / 3.0) for touch in touches]
    left = _hermite(at_ends, [_left_rate(point, q, v) for point, v in zip(ends, at_ends, strict=True)], lengths)
    share = left**2 * (3.0 - 2.0 * left)  # as `iga.interface.interface` has it
    k = np.maximum(g, start.state.k_q[q])
    cohesive, touching, dissipated = law.energies(g, k)
    booked = law.energies(g, np.minimum(k, end.state.k_q[q]))[2]  # a point that has gone keeps its history
    held_q = interface.bonded_q[q]
    stored = held_q * cohesive + touching
    gone = held_q * (0.5 * (share[1:] + share[:-1]) * np.diff(dissipated, axis=0) - np.diff(booked, axis=0))
    gone -= 0.5 * (stored[1:] + stored[:-1]) * np.diff(share, axis=0)
    return float(np.sum(gone @ interface.dA_q[q]))


def _left_rate(point: Point, q: np.ndarray, left_q: np.ndarray) -> np.ndarray:
    """Rate along the tangent of what is ``left`` of a point's way off the master, from that of its share."""
    d_share = point.response.contact.share_rates(point.tangent.du_d, q)
    slope = 6.0 * left_q * (1.0 - left_q)
    return np.where(slope > 0.0, d_share / np.where(slope > 0.0, slope, 1.0), 0.0)


def _hermite(ends: Sequence[np.ndarray], rates: Sequence[np.ndarray], lengths: Sequence[float]) -> np.ndarray:
    """Cubics (n_s, n_q) between both ends, within them."""
    values, slopes, _, _ = _cubics(np.linspace(0.0, 1.0, BALANCE.sliding + 1))
    v0, v1 = ends
    rates = [length * rate for rate, length in zip(rates, lengths, strict=True)]
    v = values.T @ np.stack(ends) + slopes.T @ np.stack(rates)
    return np.clip(v, np.minimum(v0, v1), np.maximum(v0, v1))


def leaks(system: System, start: Point, end: Point, most: float) -> bool:
    """Whether the work of a step differs from the change of its energies: it did not go along the path.

    ``most`` is the largest work so far. What the forces that balance leaves over have done, where rounding leaves more
    than the tolerance, is no leak. On the step on which damage begins it is not known yet how much is going to
    be dissipated, and a reversible law dissipates nothing.
    """
    most = max(most, abs(end.external_work))
    least_known = BALANCE.leak if by_chords(system) else BALANCE.of_elastic
    leak = abs(end.external_work - start.external_work - (end.energies.total - start.energies.total))
    left_over = end.residuals[-1] * end.response.scale if end.residuals else 0.0
    moved_d = end.state.u_d - start.state.u_d
    leak -= left_over * float(moved_d @ moved_d) ** 0.5
    if system.interface.slides and abs(end.external_work - end.energies.total) > BALANCE.ledger * most:
        if leak > BALANCE.ledger * abs(end.external_work - start.external_work):
            return True  # many small leaks of one sign open the ledger as one large one does
    before, after = start.energies.dissipated, end.energies.dissipated
    begun = before <= BALANCE.rounding * most < after
    if after >= BALANCE.leak * most or begun or not system.interface.law.irreversible:
        return leak > BALANCE.leak * most
    return leak > max(BALANCE.of_dissipated * after, least_known * most)
