"""The traction law: slopes against differences, energies against work, what contact and damage do."""

import numpy as np
import pytest

from fem_reference.problem.law import Law

G_IC = 0.1
LAW = Law(strength=4.0, toughness=G_IC, ductility=12.5, penalty=1e5)
#: gap and history, as shares of g_u: closed intact and damaged, elastic, softening, unloading, reloading, open
#: on first loading and again
STATES = np.array(
    [(-0.01, 0.0), (-0.01, 0.5), (0.05, 0.0), (0.4, 0.1), (0.2, 0.5), (0.49, 0.5), (1.2, 0.3), (0.5, 1.1)]
)


@pytest.mark.parametrize("contact", [True, False])
@pytest.mark.parametrize("irreversible", [True, False])
def test_slope_is_the_derivative_of_the_traction(contact, irreversible):
    law = Law(4.0, G_IC, 12.5, 1e5, contact, irreversible)
    g_q, k_q = STATES.T * law.g_open
    h = 1e-6 * law.g_open
    _, slope_q = law.traction(g_q, k_q)
    difference_q = (law.traction(g_q + h, k_q)[0] - law.traction(g_q - h, k_q)[0]) / (2 * h)
    assert slope_q == pytest.approx(difference_q, rel=1e-6, abs=1e-6 * law.K0)


def test_envelope_passes_through_its_three_points():
    k_q = np.array([0.0, LAW.g_peak, 0.5 * (LAW.g_peak + LAW.g_open), LAW.g_open, 2 * LAW.g_open])
    assert LAW.traction(k_q, k_q)[0] == pytest.approx([0.0, 4.0, 2.0, 0.0, 0.0], abs=1e-12)
    assert LAW.area(k_q)[-1] == pytest.approx(G_IC, rel=1e-14)


@pytest.mark.parametrize("irreversible", [True, False])
def test_work_is_stored_or_dissipated_along_any_history(irreversible):
    law = Law(4.0, G_IC, 12.5, 1e5, irreversible=irreversible)
    corners = np.array([0.0, 0.5, -0.001, 0.8, 0.1, 1.3, 0.0]) * law.g_open
    g_t = np.concatenate([np.linspace(a, b, 20001) for a, b in zip(corners, corners[1:], strict=False)])
    k_t = np.maximum.accumulate(np.maximum(g_t, 0.0))
    p_t, _ = law.traction(g_t, k_t)
    work = np.sum(0.5 * (p_t[1:] + p_t[:-1]) * np.diff(g_t))
    cohesive, contact, lost = (e[-1] for e in law.energies(g_t, law.history(g_t, k_t)))
    assert work == pytest.approx(cohesive + contact + lost, abs=1e-6 * G_IC)
    assert lost == pytest.approx(G_IC if irreversible else 0.0, rel=1e-12)


def test_unloading_goes_to_the_origin_along_the_secant():
    k = np.full(5, 0.6 * LAW.g_open)
    g_q = np.linspace(0.0, k[0], 5)
    p_q, _ = LAW.traction(g_q, k)
    assert p_q == pytest.approx(p_q[-1] * g_q / k[0], rel=1e-13)
    assert p_q[-1] == pytest.approx(LAW.traction(k, 0 * k)[0][-1], rel=1e-13)


def test_without_contact_the_secant_goes_on_into_closing():
    without = Law(4.0, G_IC, 12.5, 1e5, contact=False)
    g, k = np.array([-1e-4]), np.array([0.5 * LAW.g_open])
    assert without.traction(g, k)[0] == pytest.approx(-without.traction(-g, k)[0], rel=1e-14)
    assert LAW.traction(g, k)[0] == pytest.approx(-10.0, rel=1e-14)
