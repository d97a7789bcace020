"""The laws of opening and sliding: tangent against differences, energies against work, published numbers."""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

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


@pytest.mark.parametrize("name", ["bk and turon", "power"])
def test_a_jump_reaches_one_at_the_onset_and_two_at_failure(name):
    """In opening, from rest: by parts of the way to the onset, and then to failure; the rate is the derivative."""
    law = LAWS[name]
    onset, failure = law.strength / law.stiffness, 2.0 * law.toughness / law.strength
    failure = onset + (failure - onset) / (2.0 * law.shape.area)
    g_q = np.array([0.5 * onset, onset, 0.5 * (onset + failure), failure])
    r_q, rate_qj = law.reach(g_q, np.zeros(4))
    assert r_q == pytest.approx([0.5, 1.0, 1.5, 2.0])
    change_q = law.reach(g_q[::2] + 1e-9, np.zeros(2))[0] - law.reach(g_q[::2] - 1e-9, np.zeros(2))[0]
    assert rate_qj[::2, 0] == pytest.approx(change_q / 2e-9, rel=1e-5)


@pytest.mark.parametrize("mode", [0, 1])
def test_an_exponential_bond_reaches_one_at_its_largest_traction_and_two_at_seven_times_that_jump(mode):
    """In pure opening and pure sliding; the rate is the derivative, in mixed mode as well."""
    law, rest = LAWS["exponential"], np.zeros(3000)
    along = np.linspace(0.0, 0.2, 3000)
    jumps_qj = along[:, None] * np.eye(2)[mode]
    peak = along[np.argmax(law.traction(*jumps_qj.T, rest, rest)[mode])]
    r_q, _ = law.reach(*(np.array([0.5, 1.0, 4.0, 7.0])[:, None] * peak * np.eye(2)[mode]).T)
    assert r_q == pytest.approx([0.5, 1.0, 1.5, 2.0], abs=2e-3)
    g_q, s_q = peak * np.array([[0.3, 0.6, 3.0], [0.4, -0.5, -2.0]])
    for j, (dg, ds) in enumerate(1e-7 * peak * np.eye(2)):
        change_q = law.reach(g_q + dg, s_q + ds)[0] - law.reach(g_q - dg, s_q - ds)[0]
        assert law.reach(g_q, s_q)[1][:, j] == pytest.approx(change_q / (2e-7 * peak), rel=1e-6)
