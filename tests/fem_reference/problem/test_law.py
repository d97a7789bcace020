"""The traction law: slopes against differences, energies against work, what contact and damage do."""

from dataclasses import replace

import numpy as np
import pytest

from fem_reference.problem.law import MODELLED_LAWS, Law

G_IC = 0.1
LAW = Law(strength=4.0, toughness=G_IC, ductility=12.5, penalty=1e5)


def test_envelope_passes_through_its_three_points():
    k_q = np.array([0.0, LAW.g_peak, 0.5 * (LAW.g_peak + LAW.g_open), LAW.g_open, 2 * LAW.g_open])
    assert LAW.traction(k_q, k_q)[0] == pytest.approx([0.0, 4.0, 2.0, 0.0, 0.0], abs=1e-12)
    assert LAW.area(k_q)[-1] == pytest.approx(G_IC, rel=1e-14)


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


NUMBERS = {"strength": 4.0, "toughness": G_IC, "ductility": 12.5, "penalty": 1e5}
#: Fibres that bridge a crack: a peak, then a long tail.
FIBRES = ((0.004, 4.0), (0.01, 1.0), (0.03, 0.8), (0.2, 0.0))
SHAPES = {name: law(**NUMBERS, **{"table": FIBRES} if name == "tabular" else {}) for name, law in MODELLED_LAWS.items()}


@pytest.mark.parametrize("contact", [True, False])
@pytest.mark.parametrize("irreversible", [True, False])
@pytest.mark.parametrize("name", SHAPES)
def test_slope_of_every_law_is_the_derivative_of_its_traction(name, irreversible, contact):
    law = replace(SHAPES[name], irreversible=irreversible, contact=contact)
    rng = np.random.default_rng(0)
    g_q = law.g_open * rng.uniform(-0.05, 1.1, 2000) ** 3
    k_q = np.where(rng.random(2000) < 0.5, 0.0, law.g_open * rng.uniform(0.0, 1.0, 2000) ** 3)
    h = 1e-7 * law.g_open
    (_, slope_q), (ahead_q, s_q), (behind_q, r_q) = (law.traction(g_q + x, k_q) for x in (0.0, h, -h))
    smooth_q = np.abs(s_q - r_q) < 1e-3 * law.K0
    assert np.mean(smooth_q) > 0.99
    np.testing.assert_allclose(slope_q[smooth_q], ((ahead_q - behind_q) / (2 * h))[smooth_q], atol=1e-6 * 1e5)


@pytest.mark.parametrize("irreversible", [True, False])
@pytest.mark.parametrize("name", SHAPES)
def test_work_of_every_law_is_stored_or_dissipated(name, irreversible):
    law = replace(SHAPES[name], irreversible=irreversible)
    corners = np.array([0.0, 0.02, 0.1, -0.001, 0.3, 0.1, 1.01, 0.0]) * law.g_open
    g_t = np.concatenate([np.linspace(a, b, 20001) for a, b in zip(corners, corners[1:], strict=False)])
    k_t = np.maximum.accumulate(np.maximum(g_t, 0.0))
    p_t, _ = law.traction(g_t, k_t)
    work_t = np.cumsum(0.5 * (p_t[1:] + p_t[:-1]) * np.diff(g_t))
    energies_t = sum(law.energies(g_t, law.history(g_t, k_t)))
    np.testing.assert_allclose(work_t, energies_t[1:], atol=1e-5 * law.toughness)
    assert law.energies(g_t, law.history(g_t, k_t))[2][-1] == pytest.approx(law.toughness * irreversible, rel=1e-12)


def test_reference_values_of_other_shapes():
    flat, table, soft = (SHAPES[name] for name in ("trapezoidal", "tabular", "exponential"))
    g_q = np.array([0.002, 0.01, 0.004 + 0.023 / 1.5 + 0.9 * 0.023 / 1.5, 0.04])
    assert flat.traction(g_q, 0 * g_q)[0] == pytest.approx([2.0, 4.0, 0.4, 0.0])
    assert (table.strength, table.toughness, table.g_peak, table.g_open) == pytest.approx((4.0, 0.109, 0.004, 0.2))
    assert table.traction(np.array([0.002, 0.007, 0.02, 0.115]), np.zeros(4))[0] == pytest.approx([2.0, 2.5, 0.9, 0.4])
    assert soft.traction(soft.g_0 * np.array([1.0, 3.0]), np.zeros(2))[0] == pytest.approx([4.0, 12.0 / np.e**2])
    level = MODELLED_LAWS["trapezoidal"](**NUMBERS, plateau=0.0)
    g_q = np.linspace(0.0, 0.06, 50)
    np.testing.assert_allclose(level.traction(g_q, 0 * g_q), LAW.traction(g_q, 0 * g_q), rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(level.area(g_q), LAW.area(g_q), rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize(
    ("table", "sentence"),
    [
        ((), "two or more pairs"),
        (((0.0, 0.0), (1.0, 1.0), (2.0, 0.0)), "openings that rise from above 0"),
        (((1.0, 1.0), (2.0, 0.5)), "a last one of 0"),
        (((1.0, 1.0), (2.0, 2.5), (3.0, 0.0)), "a falling traction / opening"),
    ],
)
def test_refusals_of_shapes(table, sentence):
    with pytest.raises(ValueError, match=f"table: must .*{sentence}.*, got"):
        MODELLED_LAWS["tabular"](**NUMBERS, table=table)
    with pytest.raises(ValueError, match="plateau: must be in .0, 1., got -0.1"):
        MODELLED_LAWS["trapezoidal"](**NUMBERS, plateau=-0.1)
