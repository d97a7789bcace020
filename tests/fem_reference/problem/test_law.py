"""The traction law: slopes against differences, energies against work, what contact and damage do."""

from dataclasses import replace

import numpy as np
import pytest

from fem_reference.problem.law import MODELLED_LAWS

G_IC = 0.1


NUMBERS = {"strength": 4.0, "toughness": G_IC, "ductility": 12.5, "penalty": 1e5}
#: Fibres that bridge a crack: a peak, then a long tail.
FIBRES = ((0.004, 4.0), (0.01, 1.0), (0.03, 0.8), (0.2, 0.0))


def after(law, k_q):
    """The history (n, 3) of points whose largest gap is k_q (n,)."""
    all_q = np.ones(k_q.size, dtype=bool)
    return law.committed(k_q[:, None], law.intact(all_q), all_q, 0.0)


def responded(law, g_q, k_q):
    """Traction and slope (n,) at gaps g_q (n,) after a largest gap k_q (n,)."""
    p_qi, slope_qij = law.respond(g_q[:, None], after(law, k_q), np.ones(g_q.size, dtype=bool), 0.0)
    return p_qi[:, 0], slope_qij[:, 0, 0]


SHAPES = {name: law(**NUMBERS, **{"table": FIBRES} if name == "tabular" else {}) for name, law in MODELLED_LAWS.items()}


@pytest.mark.parametrize("contact", [True, False])
@pytest.mark.parametrize("irreversible", [True, False])
@pytest.mark.parametrize("name", SHAPES)
def test_slope_of_every_law_is_the_derivative_of_its_traction(name, irreversible, contact):
    law = replace(SHAPES[name], irreversible=irreversible, contact=contact)
    rng = np.random.default_rng(0)
    g_q = law.failed * rng.uniform(-0.05, 1.1, 2000) ** 3
    k_q = np.where(rng.random(2000) < 0.5, 0.0, law.failed * rng.uniform(0.0, 1.0, 2000) ** 3)
    h = 1e-7 * law.failed
    (_, slope_q), (ahead_q, s_q), (behind_q, r_q) = (responded(law, g_q + x, k_q) for x in (0.0, h, -h))
    smooth_q = np.abs(s_q - r_q) < 1e-3 * law.K0
    assert np.mean(smooth_q) > 0.99
    np.testing.assert_allclose(slope_q[smooth_q], ((ahead_q - behind_q) / (2 * h))[smooth_q], atol=1e-6 * 1e5)


@pytest.mark.parametrize("irreversible", [True, False])
@pytest.mark.parametrize("name", SHAPES)
def test_work_of_every_law_is_stored_or_dissipated(name, irreversible):
    law = replace(SHAPES[name], irreversible=irreversible)
    corners = np.array([0.0, 0.02, 0.1, -0.001, 0.3, 0.1, 1.01, 0.0]) * law.failed
    g_t = np.concatenate([np.linspace(a, b, 20001) for a, b in zip(corners, corners[1:], strict=False)])
    k_t = np.maximum.accumulate(np.maximum(g_t, 0.0))
    p_t, _ = responded(law, g_t, k_t)
    work_t = np.cumsum(0.5 * (p_t[1:] + p_t[:-1]) * np.diff(g_t))
    energies_t = law.balance(g_t[:, None], after(law, k_t if irreversible else g_t))
    np.testing.assert_allclose(work_t, sum(energies_t)[1:], atol=1e-5 * law.toughness)
    assert energies_t[2][-1] == pytest.approx(law.toughness * irreversible, rel=1e-12)


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
