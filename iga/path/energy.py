"""The work of the load along a step, to fourth order, and whether it equals the change of energy of the step."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from iga.interface.interface import Interface
from iga.laws.law import INSTANT, History, Law
from iga.path.kinks import run_to
from iga.path.point import Point
from iga.path.polyline import cubics
from iga.system.state import State
from iga.system.system import System


@dataclass(frozen=True)
class Balance:
    """Largest error of the energy balance of a step; a step that leaps over a part of the path has a larger one.

    ``leak``: error relative to the largest work so far. While less than this part of the work is dissipated, the error
    is limited to ``of_dissipated`` of the dissipation, or to ``of_elastic`` of the work if that is more.
    ``rounding``: dissipation below this part of the work is rounding and counts as none.
    ``ledger``: where a bond slides the balance of the whole path may be open by this part of the largest work; once it
    is, each step may add an error of this part of its own work.
    ``sliding``: number of parts of a step over which the work of tractions is summed; ``halvings`` in the search for
    the kinks between. ``ran``: part of a change of jumps that may be left where a crack has run on.
    """

    leak: float = 1e-3
    of_dissipated: float = 1e-3
    of_elastic: float = 1e-7
    rounding: float = 1e-13
    ledger: float = 1e-3
    sliding: int = 16
    halvings: int = 14
    ran: float = 0.5


BALANCE = Balance()


def step_work(system: System, start: Point, end: Point, away: float, back: float) -> float:
    """Integral of the load over the opening along one step, both cubic Hermite curves over the controlled quantity.

    ``away`` and ``back`` are the lengths along the tangents at both ends over which that quantity changes as much as in
    the step. Unlike quadrature over the opening this holds where the path turns back. The error of the curves is of
    fourth order; their integral is exact.
    """
    first, last = away * start.tangent.d_load, back * end.tangent.d_load
    opens, closes = (n * float(system.load_d @ one.tangent.du_d) for n, one in ((away, start), (back, end)))
    move, rise = end.opening - start.opening, end.state.load - start.state.load
    straight = 0.5 * (start.state.load + end.state.load) * move
    return straight + 0.1 * (rise * (closes - opens) - move * (last - first)) + (last * opens - first * closes) / 60.0


def straight_work(start: Point, end: Point, several: bool) -> float:
    """Work of the load as an integral over the opening itself, for a step on which the opening does not turn round.

    It uses the slopes just after the start and just before the end; over ``several`` arcs of the load the mean slopes.
    """
    move = end.opening - start.opening
    first, last = (start.slope, end.slope) if several else (start.tangent.departure, end.tangent.arrival)
    return 0.5 * move * (start.state.load + end.state.load) + move**2 / 12.0 * (first - last)


def by_chords(system: System) -> bool:
    """Whether slopes at the ends do not describe a step: with friction (points stick and slip) or with viscosity."""
    return system.interface.law.friction > 0.0 or system.interface.viscosity > 0.0


def dissipating(system: System, start: Point, end: Point, lengths: tuple[float, float]) -> State:
    """The state at the end of a step with the energies that the step has dissipated, as far as these do not follow from
    the history alone; ``lengths`` are ``away`` and ``back`` of `step_work`."""
    state, interface = end.state, system.interface
    work, rubbed = unstored_work(interface, start, end, None if by_chords(system) else lengths)
    heals = interface.slides and not interface.law.irreversible
    lost, kept = (rubbed, work - rubbed) if heals else (work, 0.0)
    return replace(state, lost=state.lost + lost, rubbed=state.rubbed + rubbed, kept=state.kept + kept, dt=0.0)


#: Jumps (n, n_c) of points, or what is left (n, 1) of their way off the master, each at its own part (n,) of a step.
Way = Callable[[np.ndarray], np.ndarray]


def unstored_work(
    interface: Interface, start: Point, end: Point, lengths: tuple[float, float] | None = None
) -> tuple[float, float]:
    """The work of the tractions on a step less what the bond stores, or dissipates as its history says, and what
    friction dissipates; ``lengths`` along the tangents at both ends, None where these do not describe the step.

    Points whose history has not changed store all of the work, and so do all points of a bond that opens alone, but
    those that slide off the master. A point that stores ``share psi`` loses ``-psi d(share)`` there: no force draws
    back what slides off. Damage is booked for the whole point, but only its share dissipates.
    """
    law, before, now = interface.law, start.state.past, end.state.past
    shares = [point.response.contact.share_q for point in (start, end)]
    changed_q = (shares[1] < 1.0) | (shares[0] < 1.0)
    if law.slides:
        changed_q |= now.d != before.d
    if now.slip is not None and before.slip is not None:
        changed_q |= now.slip != before.slip
    q = np.flatnonzero(changed_q)
    if q.size == 0:
        return 0.0, 0.0
    way, share, held_q = _way(interface, start, end, q), (shares[0][q], shares[1][q]), interface.bonded_q[q]
    way, left = _sliding_off(way, (start, end), share, q, lengths)
    ends = [History(one.d[q], None if one.slip is None else one.slip[q]) for one in (before, now)]
    parts = 1 if interface.viscosity else BALANCE.sliding  # a part of a viscous step does not end where the step does
    work_q, rubbed_q = _work_of_jumps(law, way, left, ends[0], (parts, end.state.dt or INSTANT), held_q)
    for sign, at, past, share_q in zip((1.0, -1.0), (0.0, 1.0), ends, share, strict=True):
        cohesion, contact, friction, known = law.stored(*way(np.full(q.size, at)).T, past)
        work_q += sign * (share_q * (held_q * cohesion + contact + friction) + held_q * known)
    dA_q = interface.dA_q[q]
    return float(dA_q @ work_q), float(dA_q @ rubbed_q)


def _way(interface: Interface, start: Point, end: Point, q: np.ndarray) -> Way:
    """The jumps of the points q (n,) on a step: they change evenly, but where a crack has run on they travel with it.

    A crack has run on where most of the change of the jumps is that of their profile having travelled (`Balance.ran`);
    what is left of the change is even.
    """
    front = start.front
    before_qc, after_qc = (point.response.contact.jump_qc for point in (start, end))
    run = run_to(interface, start.response.x_q, front, float(end.response.x_q[front]))
    change_nc = after_qc[q] - before_qc[q]
    if run is not None:
        left_nc = after_qc[q] - np.stack([run.travelled(v_q, q=q) for v_q in before_qc.T], axis=1)
        if np.linalg.norm(left_nc) > BALANCE.ran * np.linalg.norm(change_nc):
            run = None

    def way(part: np.ndarray) -> np.ndarray:
        if run is None:
            return np.asarray(before_qc[q] + part[:, None] * change_nc)
        return np.stack([run.travelled(v_q, part, q) for v_q in before_qc.T], axis=1) + part[:, None] * left_nc

    return way


def _sliding_off(
    way: Way,
    ends: tuple[Point, Point],
    shares: tuple[np.ndarray, np.ndarray],
    q: np.ndarray,
    lengths: tuple[float, float] | None,
) -> tuple[Way, Way]:
    """The way of the jumps, and what is left (n, 1) of the way on which a point slides off the master.

    Both are cubic Hermite curves for points that slide off, limited to the values at both ends. On straight ways the
    balance of a peel test to the end of its bond may be open by 2 %.
    """
    at_ends = [(0.5 - np.sin(np.arcsin(1.0 - 2.0 * share) / 3.0))[:, None] for share in shares]
    if lengths is None:
        return way, lambda part: at_ends[0] + part[:, None] * (at_ends[1] - at_ends[0])
    jumps, jump_rates, left_rates = [], [], []
    for point, left, length in zip(ends, at_ends, lengths, strict=True):
        touch, du_d, slope = point.response.contact, length * point.tangent.du_d, 6.0 * left * (1.0 - left)
        jumps.append(touch.jump_qc[q])
        jump_rates.append(np.stack([rows.rates(du_d, q) for rows in touch.jump_rows], axis=1))
        fades = touch.share_rates(du_d, q)[:, None]
        left_rates.append(np.divide(fades, slope, out=np.zeros_like(left), where=slope > 0.0))
    curved, off = _hermite(jumps, jump_rates), (np.minimum(*shares) < 1.0)[:, None]
    return lambda part: np.where(off, curved(part), way(part)), _hermite(at_ends, left_rates)


def _hermite(ends: list[np.ndarray], rates: list[np.ndarray]) -> Way:
    """Cubics between values (n, n_c) at both ends of a step, within them."""
    low, high = np.minimum(*ends), np.maximum(*ends)

    def way(part: np.ndarray) -> np.ndarray:
        values, slopes = cubics(part[:, None])
        return np.clip(sum(values * np.stack(ends)) + sum(slopes * np.stack(rates)), low, high)

    return way


def _work_of_jumps(
    law: Law,
    way: Way,
    left: Way,
    past: History,
    timed: tuple[int, float],
    bonded: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Work per area (n,) of the tractions on the way of the jumps, by the trapezoidal rule, and the part of it that
    friction dissipates. ``left``: what is left of the way off the master; ``timed``: number of parts, and the time of
    each; ``bonded`` (n,): points with cohesion."""
    parts, dt = timed
    work, rubbed = np.zeros(past.d.size), np.zeros(past.d.size)
    ends = _ends(law, way, past, parts)
    jump, history = way(ends[0]), past
    f, _, _ = law.respond(jump, past, INSTANT, None, bonded)
    for before, after in itertools.pairwise(ends):
        last, f_last, jump, kept = jump, f, way(after), history
        f, _, history = law.respond(jump, kept, dt, None, bonded)
        there = left(0.5 * (before + after))[:, 0]
        share = there**2 * (3.0 - 2.0 * there)  # as `iga.interface.master_point` has it
        work += 0.5 * share * np.sum((f_last + f) * (jump - last), axis=1)
        if history.slip is not None and kept.slip is not None:
            held = f[:, 1] - law.kept(history.d)[0] * law.stiffness[1] * jump[:, 1]
            rubbed += share * held * (history.slip - kept.slip)
    return work, rubbed


def _ends(law: Law, way: Way, past: History, parts: int) -> np.ndarray:
    """Where the parts of the way end (n_s, n): even ``parts``, and the kinks where damage begins to grow and where the
    point fails."""
    even = np.linspace(0.0, 1.0, parts + 1)[:, None] + np.zeros(past.d.size)
    if parts == 1:
        return even
    kinks = []
    for level in (past.d, np.full(past.d.size, np.nextafter(law.failed, 0.0))):
        low, high = even[0], even[-1]
        for _ in range(BALANCE.halvings):
            middle = 0.5 * (low + high)
            above = law.driven(*way(middle).T) > level
            low, high = np.where(above, low, middle), np.where(above, middle, high)
        kinks.append(high)
    return np.sort([*even, *kinks], axis=0)


def leaks(system: System, start: Point, end: Point, most: float) -> bool:
    """Whether the work of a step differs from the change of its energies: the step then did not follow the path.

    ``most`` is the largest work so far. The work of the residual forces is no leak; rounding may leave them above the
    tolerance. The limit relative to the dissipation is not used on the step on which damage begins, where the
    dissipation is not known yet, nor for a reversible law, which dissipates nothing.
    """
    most = max(most, abs(end.external_work))
    least_known = BALANCE.leak if by_chords(system) else BALANCE.of_elastic
    leak = abs(end.external_work - start.external_work - (end.energies.total - start.energies.total))
    moved_d = end.state.u_d - start.state.u_d
    leak -= end.residual * float(moved_d @ moved_d) ** 0.5
    if system.interface.slides and abs(end.external_work - end.energies.total) > BALANCE.ledger * most:
        if leak > BALANCE.ledger * abs(end.external_work - start.external_work):
            return True  # many small leaks of one sign open the ledger as one large one does
    before, after = start.energies.dissipated, end.energies.dissipated
    begun = before <= BALANCE.rounding * most < after
    if after >= BALANCE.leak * most or begun or not system.interface.law.irreversible:
        return leak > BALANCE.leak * most
    return leak > max(BALANCE.of_dissipated * after, least_known * most)
