"""Energy that the ledger of a path must know of: in springs of supports, and in points that slide off the master."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from bent_specimens import MODES

import iga.path.energy
from iga.laws.law import History
from iga.laws.laws import ShapedLaw
from iga.path.energy import Balance, leaks, unstored_work
from iga.peel import solve
from iga.system.state import Energies, State
from tests.iga.test_peel import PEEL, column, isotropic

#: So soft that the bond hardly gives: strip and substrate stretch, slide on each other and tilt.
SOFT = replace(PEEL, strip=isotropic(250.0, 0.2), substrate=isotropic(5.0, 0.2), dofs=900)


def ledger(solution) -> float:
    """Worst energy that is missing, in parts of the work."""
    work = column(solution, "external_work")
    missing = work - column(solution, "stored_energy") - column(solution, "dissipated_energy")
    return float(np.abs(missing).max() / work.max())


def test_springs_that_hold_tilted_tractions_store_energy():
    """Work of a purely elastic path to 1e-9; 1e-4 of it is in the spring along the strip at opening 4."""
    found = solve(replace(SOFT, opening=(4.0,)))
    assert found.status == "complete" and column(found, "dissipated_energy").max() == 0.0
    assert ledger(found) < 1e-9


@pytest.mark.slow
def test_what_slides_off_the_end_of_the_master_is_told():
    """The outermost points fade before any damage: their energy is gone with them, and told to a percent of it."""
    found = solve(replace(SOFT, opening=(22.0,), steps=110))
    assert found.status == "complete"
    gone = column(found, "dissipated_energy")[-1]
    assert gone > 0.0 and column(found, "damage_front").max() == column(found, "damage_front")[0]
    assert ledger(found) * column(found, "external_work").max() < 0.01 * gone


#: Dissipated before and after a step that does a work of 1, what it leaks, the forces times displacements that balance
#: has left over, and whether the leak is too much.
LEAKS = [
    pytest.param(0.5, 0.6, 0.9e-3, 1e-12, False, id="far less than is dissipated"),
    pytest.param(0.5, 0.6, 1.1e-3, 1e-12, True, id="a part of the path left out"),
    pytest.param(0.0, 0.0, 1e-6, 1e-12, True, id="nothing dissipated and energy gone"),
    pytest.param(0.0, 0.0, 1e-6, 2e-6, False, id="nothing dissipated, no more gone than rounding leaves"),
    pytest.param(0.0, 1e-5, 1e-6, 1e-12, False, id="damage has just begun"),
    pytest.param(1e-17, 1e-5, 1e-6, 1e-12, False, id="damage has just begun, and rounding had left energy before"),
    pytest.param(0.0, 1e-17, 1e-6, 1e-12, True, id="no damage, whatever rounding leaves"),
    pytest.param(1e-5, 2e-5, 1e-6, 1e-12, True, id="a twentieth of all that is dissipated"),
    pytest.param(1e-4, 5e-4, 4.9e-7, 1e-12, False, id="less than a thousandth of the little that is dissipated"),
    pytest.param(1e-4, 5e-4, 5.1e-7, 1e-12, True, id="more than a thousandth of the little that is dissipated"),
    pytest.param(1e-5, 1e-5, 0.9e-7, 1e-12, False, id="less than a tenth of a millionth of the work"),
    pytest.param(1e-5, 1e-5, 1.1e-7, 1e-12, True, id="more than a tenth of a millionth of the work"),
    pytest.param(1.1e-3, 1.1e-3, 0.9e-3, 1e-12, False, id="enough is dissipated to be held against all work"),
    pytest.param(0.9e-3, 0.9e-3, 0.9e-3, 1e-12, True, id="not yet enough is"),
]


@pytest.mark.parametrize(("before", "after", "leak", "left_over", "refused"), LEAKS)
def test_what_a_step_may_leak(before, after, leak, left_over, refused):
    """A part of the work, but of what is dissipated as long as that is little; of the work with a reversible law."""
    start, end = (
        SimpleNamespace(
            external_work=work,
            energies=Energies(work - spent, 0.0, 0.0, spent),
            state=SimpleNamespace(u_d=np.array([0.0, 2.0 * work])),
        )
        for work, spent in ((0.0, before), (1.0, after))
    )
    for reversible in (False, True):
        law = SimpleNamespace(irreversible=not reversible, friction=0.0)
        system = SimpleNamespace(interface=SimpleNamespace(law=law, slides=False, viscosity=0.0))
        off = replace(end.energies, bulk=end.energies.bulk - leak)
        after_it = SimpleNamespace(external_work=1.0, energies=off, state=end.state, residual=0.5 * left_over)
        assert leaks(system, start, after_it, 0.0) == (refused if not reversible else leak > 1e-3)


@pytest.mark.parametrize(
    ("ledger", "leak", "refused"), [(0.9e-3, 5e-4, False), (1.1e-3, 5e-4, True), (0.1, 0.9e-4, False)]
)
def test_of_a_bond_that_slides_an_open_ledger_is_not_opened_further(ledger, leak, refused):
    """Of a step that does a tenth of the work, in parts of which it may leak a thousandth then."""
    law = SimpleNamespace(irreversible=True, friction=0.0)
    system = SimpleNamespace(interface=SimpleNamespace(law=law, slides=True, viscosity=0.0))
    start, end = (
        SimpleNamespace(
            external_work=work,
            energies=Energies(work - 0.5 - off, 0.0, 0.0, 0.5),
            state=SimpleNamespace(u_d=np.array([work])),
            residual=0.0,
        )
        for work, off in ((0.9, ledger - leak), (1.0, ledger))
    )
    assert leaks(system, start, end, 0.0) == refused


def profile(behind: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Opening and slip behind the front of a crack, in process zones; the mode turns from sliding to opening."""
    behind = np.maximum(behind, 0.0)
    return 4e-3 * behind**1.5, 9e-3 * behind


def spent_on(steps: int) -> float:
    """Energy that a bond spends while a crack runs on by a process zone, in so many steps."""
    law = ShapedLaw(MODES, penalty=1e6)
    x = np.linspace(0.0, 4.0, 801)
    X_qi = np.stack([x, np.zeros_like(x)], axis=1)
    interface = SimpleNamespace(
        law=law, X_qi=X_qi, dA_q=np.full(801, x[1]), bonded_q=np.full(801, True), viscosity=0.0, all_bonded=True
    )

    def at(front: float, d_q: np.ndarray) -> tuple[SimpleNamespace, np.ndarray]:
        g_q, s_q = profile(front - x)
        now = law.respond(np.stack([g_q, s_q], axis=1), History(d_q))[2].d
        touch = SimpleNamespace(
            g_q=g_q, share_q=np.ones(801), jump_qc=np.stack([g_q, s_q], axis=1), slip=SimpleNamespace(s_q=s_q)
        )
        return SimpleNamespace(contact=touch, x_q=law.scaled(g_q, s_q, now).x), now

    response, d_q = at(2.0, np.zeros(801))
    state, spent = State(np.zeros(2), 0.0, d_q, np.zeros(801, dtype=bool), None), 0.0
    for front in 2.0 + np.linspace(0.0, 1.0, steps + 1)[1:]:
        point = SimpleNamespace(state=state, response=response, front=int(np.searchsorted(x, 1.9)))
        response, d_q = at(front, state.k_q)
        state = replace(state, k_q=d_q)
        spent += unstored_work(interface, point, SimpleNamespace(state=state, response=response))[0]
    return spent


def test_a_bond_spends_the_same_energy_however_far_a_crack_leaps_at_once(monkeypatch):
    """Straight from jump to jump a leap of a process zone is percents off, as the mode turns through the zone."""
    fine = spent_on(100)
    assert spent_on(1) == pytest.approx(fine, rel=1e-3) and spent_on(4) == pytest.approx(fine, rel=1e-3)
    monkeypatch.setattr(iga.path.energy, "BALANCE", Balance(ran=0.0))
    assert spent_on(100) == pytest.approx(fine, rel=1e-3) and abs(spent_on(1) / fine - 1.0) > 0.01
