"""The laws of opening and sliding: tangent against differences, energies against work, published numbers."""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from fem_reference.problem.mixed_law import MixedLaw
from fem_reference.problem.mixed_laws import MODELLED_MIXED_LAWS, MixedExponential

MixedBilinear, MixedTrapezoidal, MixedDecaying, MixedTrilinear = (
    MODELLED_MIXED_LAWS[name] for name in ("bilinear", "trapezoidal", "exponential-softening", "trilinear")
)
BOND = {"strength": 3.0, "shear_strength": 4.0, "toughness": 0.2, "shear_toughness": 0.5, "penalty": 900.0}
STIFF = {**BOND, "stiffness": 400.0, "shear_stiffness": 500.0}
#: Laws by what they exercise.
LAWS = {
    "bk and turon": MixedBilinear(**STIFF, exponent=2.3),
    "bk and quadratic": MixedTrapezoidal(**STIFF, onset="quadratic", exponent=1.0),
    "power": MixedTrapezoidal(**STIFF, criterion="power", exponent=1.6, plateau=0.2),
    "decay": MixedDecaying(**STIFF, exponent=2.3, decay=3.0),
    "two lines": MixedTrilinear(**STIFF, criterion="power", exponent=1.6, friction=0.3),
    "exponential": MixedExponential(**BOND),
    "friction": MixedBilinear(**STIFF, friction=0.4),
    "friction by area": MixedTrapezoidal(**STIFF, friction=0.4, rubs="area"),
    "viscosity": MixedExponential(**BOND, viscosity=0.3, friction=0.2),
    "pressure": MixedTrapezoidal(**STIFF, pressure_strength=0.5, friction=0.2),
    "reversible": MixedBilinear(**STIFF, irreversible=False),
    "no contact": MixedBilinear(**STIFF, contact=False),
}


def along(law: MixedLaw, g_t: np.ndarray, s_t: np.ndarray) -> tuple[np.ndarray, ...]:
    """Tractions, energies and histories (n_t,) along a path of one point, with the energies lost by its steps."""
    d_q, slip_q, before, rows = np.zeros(1), np.zeros(1), np.zeros(4), []
    for g_q, s_q in zip(g_t[:, None], s_t[:, None], strict=True):
        p_q, t_q, _, d_new_q, slip_new_q = law.traction(g_q, s_q, d_q, slip_q, 1.0 / g_t.size)
        now = np.array([law.release(g_q, s_q, d_new_q, slip_new_q), law.rubbing(g_q, d_new_q), d_new_q, slip_new_q])[
            :, 0
        ]
        mean = 0.5 * (now[:2] + before[:2])
        lost = mean @ [now[2] - before[2], abs(now[3] - before[3])]
        rows.append((p_q[0], t_q[0], *(e[0] for e in law.energies(g_q, s_q, d_new_q, slip_new_q)), lost))
        d_q, slip_q, before = d_new_q, slip_new_q, now
    return tuple(np.array(rows).T)


@pytest.mark.parametrize("name", LAWS)
def test_tangent_is_the_derivative_of_the_tractions(name):
    law, rng = LAWS[name], np.random.default_rng(4)
    g_q, s_q = rng.normal(0.0, 0.05, (2, 3000))
    g_q[::3] *= 0.1
    d_q, slip_q = rng.random(3000) * rng.integers(0, 2, 3000), rng.normal(0.0, 0.02, 3000)
    _, _, tangent_qij, d_new_q, _ = law.traction(g_q, s_q, d_q, slip_q, 0.2)
    h = 1e-7
    smooth_q = np.ones(3000, dtype=bool)
    differences_jiq = []
    for step_j in np.eye(2) * h:
        *ahead, ahead_qij, _, _ = law.traction(g_q + step_j[0], s_q + step_j[1], d_q, slip_q, 0.2)
        *behind, behind_qij, _, _ = law.traction(g_q - step_j[0], s_q - step_j[1], d_q, slip_q, 0.2)
        differences_jiq.append((np.array(ahead) - behind) / (2 * h))
        smooth_q &= np.max(np.abs(ahead_qij - behind_qij), (1, 2)) < 1.0  # else a kink is between them
    assert np.mean(smooth_q) > 0.99 and np.mean(d_new_q > d_q) > 0.1
    difference_qij = np.einsum("jiq->qij", differences_jiq)
    np.testing.assert_allclose(tangent_qij[smooth_q], difference_qij[smooth_q], atol=1e-6 * 900.0)


@pytest.mark.parametrize("name", ["bk and turon", "bk and quadratic", "power"])
@pytest.mark.parametrize("B", [0.0, 0.3, 1.0])
def test_energy_of_a_constant_mode_is_its_toughness(name, B):
    law = LAWS[name]
    norm_t = np.linspace(0.0, 6.0, 1501)
    p_t, t_t, *_, lost_t = along(law, norm_t * np.sqrt((1.0 - B) / 400.0), norm_t * np.sqrt(B / 500.0))
    share = ((1 - B) / 0.2) ** 1.6 + (B / 0.5) ** 1.6
    expected = share ** (-1 / 1.6) if name == "power" else 0.2 + 0.3 * B**law.exponent
    assert np.sum(lost_t) == pytest.approx(expected, rel=2e-4)
    assert (p_t[-1], t_t[-1]) == (0.0, 0.0)


@pytest.mark.parametrize(
    ("g", "s", "p", "t"),
    [
        (0.01, 0.01, 8.2220308033, 8.22203080328),
        (0.1, 0.1, 2.9451578391, 2.94515783908),
        (0.175, 0.175, 0.0, 0.0),
        (0.0, 0.040201005025, 0.0, 13.497953343),
    ],
)
def test_tractions_of_neml2_bilinear(g, s, p, t):
    """Golds of applied-material-modeling/neml2, bilinear, BK, quadratic onset; s is the length of its two slips."""
    law = MixedBilinear(
        strength=10.0, shear_strength=15.0, toughness=1.0, shear_toughness=2.0, stiffness=1e3, shear_stiffness=1e3,
        penalty=1e5, onset="quadratic",
    )  # fmt: skip
    p_q, t_q, *_ = law.traction(np.array([g]), np.array([s]), np.zeros(1), np.zeros(1))
    assert (p_q[0], t_q[0]) == pytest.approx((p, t), rel=1e-9, abs=1e-12)


@pytest.mark.parametrize(
    ("g", "s", "p", "t"),
    [(0.075, 0.0375, 0.18900717712, 0.057319323916), (3.0, 1.5, 0.13181080087, 0.039973646005)],
)
def test_tractions_of_neml2_exponential(g, s, p, t):
    """Golds of the same, Salehani and Irani's law with g0 = 1, s0 = sqrt(2), strengths 1."""
    law = MixedExponential(strength=1.0, shear_strength=1.0, toughness=np.e, shear_toughness=np.exp(0.5), penalty=1e5)
    p_q, t_q, *_ = law.traction(np.array([g]), np.array([s]), np.zeros(1), np.zeros(1))
    assert (p_q[0], t_q[0]) == pytest.approx((p, t), rel=1e-10)


def test_pressure_raises_the_strength_in_shear():
    """nasa/CompDam_DGD test_COH2D4_shear_compression under 10 MPa: strength, open slip; friction of 0.3 remains."""
    law = MixedBilinear(
        strength=62.3, shear_strength=92.3, toughness=0.277, shear_toughness=0.788, stiffness=1e6, shear_stiffness=1e6,
        penalty=1e6, exponent=1.634, pressure_strength=0.3514922612859746,
    )  # fmt: skip
    s_q = np.array([1 - 1e-9, 1 + 1e-9]) * 95.81492261285975e-6
    g_q, zero_q = np.full(2, -1e-5), np.zeros(2)
    assert np.flatnonzero(law.traction(g_q, s_q, zero_q, zero_q)[3]) == [1]
    s_q = np.array([1 - 1e-9, 1 + 1e-9]) * 0.016448377319760815
    assert np.flatnonzero(law.traction(g_q, s_q, zero_q, zero_q)[3] == 1.0) == [1]
    assert replace(law, friction=0.3).traction(g_q, s_q, zero_q, zero_q)[1][1] == pytest.approx(3.0)


@pytest.mark.parametrize("name", LAWS)
def test_tractions_are_odd_in_slip(name):
    g_q, s_q, slip_q = np.random.default_rng(1).normal(0.0, 0.05, (3, 500))
    d_q = np.linspace(0.0, 1.0, 500)
    p_q, t_q, tangent_qij, d_new_q, slip_new_q = LAWS[name].traction(g_q, s_q, d_q, slip_q, 0.1)
    mirrored = LAWS[name].traction(g_q, -s_q, d_q, -slip_q, 0.1)
    for one, other in zip((p_q, -t_q, d_new_q, -slip_new_q), (*mirrored[:2], *mirrored[3:]), strict=True):
        np.testing.assert_array_equal(one, other)
    np.testing.assert_array_equal(tangent_qij, mirrored[2] * [[1, -1], [-1, 1]])


@pytest.mark.parametrize("name", LAWS)
def test_work_is_stored_or_lost_along_any_path(name):
    """Opening, sliding to and fro under pressure, opening; the energies lost are sums over the steps."""
    corners = np.array([(0, 0), (0.02, 0.02), (-0.002, 0.1), (-0.002, -0.2), (-0.001, 0.3), (0.1, 0.3), (0.3, 0.9)])
    share = np.linspace(0.0, 1.0, 300, endpoint=False)[:, None]
    g_t, s_t = np.concatenate([a + share * (b - a) for a, b in zip(corners, corners[1:], strict=False)]).T
    p_t, t_t, cohesive_t, contact_t, friction_t, lost_t = along(LAWS[name], g_t, s_t)
    work = sum(np.sum(0.5 * (f[1:] + f[:-1]) * np.diff(x)) for f, x in ((p_t, g_t), (t_t, s_t)))
    assert work == pytest.approx(cohesive_t[-1] + contact_t[-1] + friction_t[-1] + np.sum(lost_t), rel=2e-3)


@pytest.mark.parametrize("name", ["friction", "friction by area", "no contact"])
def test_damage_releases_what_is_stored(name):
    law, h = LAWS[name], 1e-6
    g_q, s_q, slip_q = np.random.default_rng(3).normal(0.0, 0.05, (3, 200))
    more, less = (sum(law.energies(g_q, s_q, np.full(200, 0.5 + change), slip_q)) for change in (h, -h))
    np.testing.assert_allclose(
        law.release(g_q, s_q, np.full(200, 0.5), slip_q), (less - more) / (2 * h), rtol=1e-6, atol=1e-8
    )


def test_contact_is_not_damaged_and_shear_goes_on_across_it():
    law, tiny = LAWS["friction"], np.nextafter(0.0, 1.0)
    g_q, s_q, d_q = np.array([-tiny, 0.0, tiny]), np.full(3, 0.01), np.full(3, 0.7)
    p_q, t_q, _, d_new_q, _ = law.traction(g_q, s_q, d_q, s_q)
    assert np.all(np.abs(p_q) < 1e-300) and np.ptp(t_q) == np.ptp(d_new_q) == 0.0
    p_q, _, _, d_new_q, _ = law.traction(np.array([-0.1]), np.zeros(1), np.ones(1), np.zeros(1))
    assert p_q[0] == pytest.approx(-90.0) and d_new_q[0] == 1.0
    p_q, _, _, d_new_q, _ = LAWS["no contact"].traction(np.array([-0.1]), np.zeros(1), np.array([0.5]), np.zeros(1))
    assert p_q[0] == pytest.approx(-20.0) and d_new_q[0] == 0.5


def test_friction_sticks_and_slips():
    law = replace(LAWS["friction"], friction=0.3)
    g_q, s_q, broken_q = np.full(3, -1e-3), np.array([5e-4, 0.5, -0.5]), np.ones(3)
    _, t_q, _, _, slip_q = law.traction(g_q, s_q, broken_q, np.zeros(3))
    np.testing.assert_allclose(t_q, [0.25, 0.27, -0.27], rtol=1e-12)
    np.testing.assert_allclose(slip_q, [0.0, 0.5 - 5.4e-4, -0.5 + 5.4e-4], rtol=1e-12)
    assert law.rubbing(g_q, broken_q) == pytest.approx(np.full(3, 0.27))


def test_a_plateau_of_nothing_is_the_bilinear_law():
    flat = MixedTrapezoidal(**STIFF, plateau=0.0)
    g_q, s_q = np.random.default_rng(2).normal(0.0, 0.08, (2, 400))
    for one, other in zip(flat.driving(g_q, s_q), MixedBilinear(**STIFF).driving(g_q, s_q), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-9, atol=1e-10)


def test_under_a_pressure_beyond_all_strength_the_bond_is_brittle():
    law = replace(LAWS["pressure"], pressure_strength=50.0)
    s_q = np.sqrt(2 * 0.5 / 500.0) * np.array([0.999, 1.001])
    D_q, dD_qj = law.driving(np.full(2, -1.0), s_q)
    assert list(D_q) == [0.0, 1.0] and not dD_qj.any()


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"criterion": "vcct"}, "criterion: must be one of bk, power, got vcct"),
        ({"onset": "ye"}, "onset: must be turon or quadratic with the criterion bk, got ye"),
        ({"criterion": "power", "onset": "turon"}, "onset: must be quadratic with the criterion power, got turon"),
        ({"exponent": 0.5}, "exponent: must be >= 1, got 0.5"),
        ({"rubs": "all"}, "rubs: must be damage or area, got all"),
        ({"friction": -0.5}, "friction: must be >= 0, got -0.5"),
        ({"plateau": 1.0}, "plateau: must be in [0, 1), got 1.0"),
        ({"shear_stiffness": 10.0}, "stiffness: must be so large "),
    ],
)
def test_refusals(change, sentence):
    with pytest.raises(ValueError) as refused:
        replace(LAWS["power"], **{"criterion": "bk", **change})
    assert str(refused.value).startswith(sentence)
    with pytest.raises(ValueError, match="pressure_strength: must be 0 with the exponential law, got 1.0"):
        MixedExponential(**BOND, pressure_strength=1.0)


def test_laws_load_without_dolfinx():
    """No version of it can change them."""
    code = "import sys, fem_reference.problem.mixed_laws; sys.exit(not {'dolfinx', 'ufl'}.isdisjoint(sys.modules))"
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0
