"""Energy that goes with points sliding off the master, along steps of which the integral is known."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from made_up_laws import energies
from numpy.polynomial import Polynomial
from scipy.integrate import quad

from iga.interface.contact import Contact, Rows
from iga.interface.master_point import _share
from iga.laws.law import History
from iga.laws.laws import ShapedLaw
from iga.path.energy import step_work, straight_work, unstored_work

LAW = ShapedLaw.opening(strength=2.0, toughness=0.5, ductility=5.0, penalty=100.0)
AREA = np.array([0.5, 0.25])
NO_ROWS = Rows(np.zeros((2, 0), dtype=int), np.zeros((2, 0)))


def slid_off(g: tuple, k: tuple, share: tuple, bonded: tuple = (True, True)) -> float:
    """What is lost on a step of two points that do the same, besides what their history says."""
    interface = SimpleNamespace(law=LAW, dA_q=AREA, bonded_q=np.array(bonded), viscosity=0.0, X_qi=np.eye(2))
    ends = []
    for i in (0, 1):
        touch = Contact(None, np.full(2, g[i]), np.zeros((2, 2)), np.full(2, share[i]), NO_ROWS)
        point = SimpleNamespace(
            response=SimpleNamespace(contact=touch, x_q=touch.g_q),
            state=SimpleNamespace(past=History(np.where(bonded, k[i], LAW.unbonded)), dt=0.0),
            front=0,
        )
        ends.append(point)
    return unstored_work(interface, *ends)[0]


def stored(g: float, k: float) -> float:
    cohesive, touching, _ = energies(LAW, np.array([g]), np.array([k]))
    return float((cohesive + touching)[0])


def spent(k: float) -> float:
    return float(energies(LAW, np.array([k]), np.array([k]))[2][0])


@pytest.mark.parametrize("share", [0.5, 0.125])
def test_damage_is_booked_whole_and_paid_by_what_is_on_the_master(share):
    """A point that is held by a share of it is torn by as much less than the ledger has."""
    found = slid_off((0.2, 0.4), (0.2, 0.4), (share, share))
    assert found == pytest.approx(-(1.0 - share) * (spent(0.4) - spent(0.2)) * AREA.sum(), rel=1e-9)


def test_a_point_that_is_not_bonded_takes_no_cohesion_and_no_damage():
    free = (False, False)
    assert slid_off((0.2, 0.4), (0.2, 0.4), (1.0, 0.0), bonded=free) == 0.0
    pressed = slid_off((-0.02, -0.02), (0.2, 0.2), (1.0, 0.0), bonded=free)
    assert pressed == pytest.approx(0.5 * LAW.penalty * 0.02**2 * AREA.sum())
    half = slid_off((0.3, 0.3), (0.3, 0.3), (1.0, 0.0), bonded=(True, False))
    assert half == pytest.approx(stored(0.3, 0.3) * AREA[0])


def test_a_point_that_opens_as_it_slides_takes_the_integral():
    """-psi d(share) along the step, on which gap and place on the master change evenly; in 16 pieces to half a per
    cent."""
    g0, g1 = 0.02, 0.09  # elastic: nothing is damaged below g_max = 0.1

    def smooth(s: float) -> float:
        return s * s * (3.0 - 2.0 * s)

    def share(s: float) -> float:
        return 1.0 - smooth(s)

    def taken(s: float) -> float:
        g, h = g0 + (g1 - g0) * s, 1e-6
        return -stored(g, 0.1) * (share(s + h) - share(s - h)) / (2 * h)

    wanted = quad(taken, 1e-6, 1.0 - 1e-6)[0] * AREA.sum()
    assert slid_off((g0, g1), (0.1, 0.1), (1.0, 0.0)) == pytest.approx(wanted, rel=5e-3)


def test_a_point_that_slides_off_unevenly_takes_the_integral_along_the_cubics_of_its_rates():
    """Gap g(s) and way off the master left(s), cubic over the step; on straight ways a fifth would be missing."""
    g, left = Polynomial([0.02, 0.0, 0.21, -0.14]), Polynomial([1.0, 0.0, -1.8, 0.9])
    ends = []
    for s in (0.0, 1.0):
        left_s, rows = left(s), Rows(np.zeros((1, 1), dtype=int), np.full((1, 1), g.deriv()(s)))
        share, fade = left_s**2 * (3.0 - 2.0 * left_s), 6.0 * left_s * (1.0 - left_s) * left.deriv()(s)
        touch = SimpleNamespace(
            share_q=np.array([share]),
            jump_qc=np.array([[g(s)]]),
            jump_rows=(rows,),
            share_rates=lambda du_d, q, fade=fade: fade * du_d[q],
        )
        response = SimpleNamespace(contact=touch, x_q=np.array([g(s)]))
        state = SimpleNamespace(past=History(np.full(1, 0.1)), dt=0.0)
        tangent = SimpleNamespace(du_d=np.array([0.5]))
        ends.append(SimpleNamespace(response=response, state=state, tangent=tangent, front=0))
    interface = SimpleNamespace(law=LAW, dA_q=AREA[:1], bonded_q=np.array([True]), viscosity=0.0, X_qi=np.eye(2)[:1])

    def taken(s: float) -> float:
        fades = 6.0 * left(s) * (1.0 - left(s)) * left.deriv()(s)
        return -stored(g(s), 0.1) * fades

    wanted = quad(taken, 0.0, 1.0)[0] * AREA[0]
    assert unstored_work(interface, *ends, (2.0, 2.0))[0] == pytest.approx(wanted, rel=5e-3)
    assert unstored_work(interface, *ends)[0] < 0.8 * wanted


# --- work


def point(opening: float, load: float, d_opening: float, d_load: float) -> SimpleNamespace:
    tangent = SimpleNamespace(du_d=np.array([d_opening]), d_load=d_load, growing_q=np.array([True]))
    tangent.arrival = tangent.departure = slope = d_load / d_opening if d_opening else np.inf
    return SimpleNamespace(opening=opening, state=SimpleNamespace(load=load), tangent=tangent, slope=slope)


def test_work_along_cubics_is_exact_though_the_path_turns_back():
    """Opening s - s^2 + s^3 / 2 and load 1 + 2 s - 3 s^3 of what is controlled, from 0 to 2."""
    d, P = np.polynomial.Polynomial([0, 1, -1, 0.5]), np.polynomial.Polynomial([1, 2, 0, -3])
    a, b = (point(d(s), P(s), d.deriv()(s), P.deriv()(s)) for s in (0.0, 2.0))
    exact = (P * d.deriv()).integ()
    found = step_work(SimpleNamespace(load_d=np.array([1.0])), a, b, 2.0, 2.0)
    assert found == pytest.approx(exact(2.0) - exact(0.0), rel=1e-12)


def test_work_over_the_opening_is_exact_for_cubics():
    P = np.polynomial.Polynomial([1.0, 2.0, -0.5, 0.3])
    a, b = (point(d, P(d), 1.0, P.deriv()(d)) for d in (0.5, 1.7))
    for several in (False, True):
        assert straight_work(a, b, several) == pytest.approx(P.integ()(1.7) - P.integ()(0.5), rel=1e-12)
        assert straight_work(b, a, several) == pytest.approx(-straight_work(a, b, several))


def test_a_point_lets_go_between_a_tenth_and_three_tenths_of_a_side_beyond_the_end():
    """Held whole before, not at all after, half in the middle; its rate is that of the logarithm of its share."""
    over = np.array([-1.0, 0.0, 0.1, 0.15, 0.2, 0.25, 0.3, 2.0])
    share, rate = _share(over)
    assert (
        share[:3].tolist() == [1.0, 1.0, 1.0]
        and share[-2:] == pytest.approx([0.0, 0.0])
        and share[4] == pytest.approx(0.5)
    )
    assert share[3] + share[5] == pytest.approx(1.0) and np.all(np.diff(share[2:7]) < 0.0)
    inside, h = np.linspace(0.11, 0.29, 19), 1e-6
    quotient = (np.log(_share(inside + h)[0]) - np.log(_share(inside - h)[0])) / (2.0 * h)
    assert _share(inside)[1] == pytest.approx(quotient, rel=1e-6)
    assert np.abs(rate[[0, 1, 2, 6, 7]]).max() < 1e-12
