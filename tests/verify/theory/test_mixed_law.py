"""The laws of opening and sliding of the checks against closed forms and published numbers."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from verify.support.refusal import Refusal
from verify.theory.mixed_law import KNOWN_MIXED_LAWS, ONSETS_OF, MixedBond, Path

#: Equal stiffness: p_max = t_max = 1, G = 1 and 2, exponent 2, K = 100 (idaholab/moose, bilinear_mixed_energy.i).
MOOSE = MixedBond("bilinear", (1.0, 1.0), (1.0, 2.0), (100.0, 100.0), 1e4)
#: IM7/8552 of nasa/CompDam_DGD, test_COH2D4, with stiffness in the ratio of Turon et al. (2010).
TURON = 0.277 / 0.788 * (92.3 / 62.3) ** 2
COMPDAM = MixedBond("bilinear", (62.3, 92.3), (0.277, 0.788), (1e6, 1e6 * TURON), 1e6, exponent=1.634)


def path_along(bond: MixedBond, *corners: tuple[float, float], n: int = 30000) -> Path:
    """The bond along straight lines of n steps each between jumps (g, s)."""
    return bond.path(*jumps_along(*corners, n=n))


def jumps_along(*corners: tuple[float, float], n: int) -> np.ndarray:
    """Jumps (2, n_points) on straight lines of n steps each."""
    way = [np.linspace(a, b, n, endpoint=False) for a, b in zip(corners[:-1], corners[1:], strict=True)]
    return np.concatenate([*way, [corners[-1]]]).T


@st.composite
def bonds(draw):
    """Bonds of all laws, criteria and onsets, stiff enough for any mode."""
    share = st.floats(0.5, 2.0)
    (p, t), G = ((draw(share), draw(share)) for _ in range(2))
    K = tuple(30.0 * draw(st.floats(1.0, 10.0)) * x**2 / y for x, y in zip((p, t), G, strict=True))
    law, criterion = draw(st.sampled_from(KNOWN_MIXED_LAWS)), draw(st.sampled_from(sorted(ONSETS_OF)))
    onset = draw(st.sampled_from(ONSETS_OF[criterion]))
    exponent, plateau = draw(st.floats(1.0, 4.0)), draw(st.floats(0.0, 0.9))
    table = ((0.1, 4.0), (0.2, 4.0), (0.3, 1.0), (0.9, 0.0))
    return MixedBond(law, (p, t), G, K, 1e4, criterion, exponent, onset, plateau=plateau, table=table)


@given(bonds(), st.floats(0.0, 1.0))
def test_a_path_of_constant_mode_takes_up_the_toughness_of_its_mode(bond, B):
    failed = 12.0 * max(bond.toughness) / min(bond.strength)  # the area of a shape is 0.19 at least
    norm = np.linspace(0.0, 60.0 if bond.law == "exponential" else failed * np.sqrt(max(bond.slopes)), 250001)
    K, Ks = bond.slopes
    done = bond.path(norm * np.sqrt((1.0 - B) / K), norm * np.sqrt(B / Ks))
    assert done.released[-1] == pytest.approx(bond.critical(B), rel=1e-5)
    assert done.d[-1] == pytest.approx(1.0, abs=1e-9) and np.all(np.diff(done.d) >= 0.0)


@pytest.mark.parametrize(
    ("corners", "energy"),
    [
        ([(0, 0), (3, 0)], 1.0),
        ([(0, 0), (0, 5)], 2.0),
        ([(0, 0), (3, 3)], 1.25),
        ([(0, 0), (1, 0), (1, 6)], 1.49936),
        ([(0, 0), (0, 2), (6, 2)], 1.66124),
        ([(0, 0), (1, 0), (0, 0), (0, 6)], 1.83528),
        ([(0, 0), (0, 2), (0, 0), (6, 0)], 1.33194),
        ([(0, 0), (-1e-8, 5)], 2.0),  # compressed shear, where MOOSE had a toughness of 2 sqrt(2) until 2026
    ],
)
def test_energies_of_paths_at_equal_stiffness(corners, energy):
    """Regression values of one update rule, by an own scalar program 60,000 steps a line; of constant mode exact."""
    done = path_along(MOOSE, *corners)
    assert done.d[-1] == 1.0 and done.released[-1] == pytest.approx(energy, abs=6e-6)


@pytest.mark.parametrize(("Ks", "energy"), [(1e6 * TURON, 0.437269), (1e6, 0.484883)])
def test_energies_of_opening_and_then_sliding(Ks, energy):
    """As above: half of G_I lost in opening, held there, then slid to the end, for two stiffnesses."""
    half = 0.277 / 62.3
    done = path_along(replace(COMPDAM, stiffness=(1e6, Ks)), (0, 0), (half, 0), (half, 0.06), n=60000)
    assert done.d[-1] == 1.0 and done.released[-1] == pytest.approx(energy, abs=2e-6)


@pytest.mark.parametrize(
    ("g", "s", "p", "t"),
    [
        (0.005, 0.005, 5.0, 5.0),
        (0.01, 0.01, 8.2220308033, 8.22203080328),
        (0.025, 0.025, 7.3425519759, 7.34255197586),
        (0.1, 0.1, 2.9451578391, 2.94515783908),
        (0.175, 0.175, 0.0, 0.0),
        (0.0, 0.010050251256, 0.0, 10.050251256),
        (0.0, 0.040201005025, 0.0, 13.497953343),
        (0.0, 0.4, 0.0, 0.0),
    ],
)
def test_tractions_of_neml2_bilinear(g, s, p, t):
    """Golds of applied-material-modeling/neml2, bilinear, BK, quadratic onset; s is the length of its two slips."""
    done = MixedBond("bilinear", (10.0, 15.0), (1.0, 2.0), (1e3, 1e3), 1e5, onset="quadratic").path([0.0, g], [0.0, s])
    assert (done.p[-1], done.t[-1]) == pytest.approx((p, t), rel=1e-9, abs=1e-12)


@pytest.mark.parametrize(
    ("g", "s", "p", "t"),
    [
        (0.075, 0.0375, 0.18900717712, 0.057319323916),
        (0.375, 0.1875, 0.68838474291, 0.20876322613),
        (1.5, 0.75, 0.68675004266, 0.20826747822),
        (3.0, 1.5, 0.13181080087, 0.039973646005),
    ],
)
def test_tractions_of_neml2_exponential(g, s, p, t):
    """Golds of the same, Salehani and Irani's law with g0 = 1, s0 = sqrt(2), strengths 1."""
    done = MixedBond("exponential", (1.0, 1.0), (np.e, np.exp(0.5)), (1.0, 1.0), 1e5).path([0.0, g], [0.0, s])
    assert (done.p[-1], done.t[-1]) == pytest.approx((p, t), rel=1e-10)


def test_numbers_of_moose_mortar():
    """Idaholab/moose, contact: K 1000, strengths 50; toughness 5 and 2 at 45 degrees; unloaded from 0.12 at 5."""
    bond = MixedBond("bilinear", (50.0, 50.0), (5.0, 2.0), (1e3, 1e3), 1e5)
    power = replace(bond, criterion="power")
    for law, energy, jump in ((bond, 4.25, 0.12020815280171306), (power, 3.7139067635410368, 0.10504514628777803)):
        assert law.critical(0.5) == pytest.approx(energy, rel=1e-13)
        assert 2 * law.critical(0.5) / law.onset_norm(0.5) / np.sqrt(2e3) == pytest.approx(jump, rel=1e-13)
    done = bond.path([0.0, 0.12, 0.08], np.zeros(3))
    assert done.d[-1] == pytest.approx(0.2 * 0.07 / (0.12 * 0.15), rel=1e-13)
    assert done.p[-1] == pytest.approx(17.7778, abs=1e-4)


@pytest.mark.parametrize("Ks", [1e6 * TURON, 1e6])
def test_pressure_raises_the_strength_and_not_the_toughness(Ks):
    """nasa/CompDam_DGD test_COH2D4_shear_compression: 10 MPa raise the strength by 0.3514922612859746 of them."""
    bond = replace(COMPDAM, stiffness=(1e6, Ks), pressure_strength=0.3514922612859746)
    done = path_along(bond, (-1e-5, 0.0), (-1e-5, 0.02), n=200000)
    assert done.t.max() == pytest.approx(95.81492261285975, rel=1e-5)
    assert done.released[-1] == pytest.approx(0.788, rel=1e-6)
    slips = np.linspace(0.0, 0.02, 200001)
    assert slips[np.argmax(done.d >= 1.0)] == pytest.approx(0.016448377319760815, abs=1.1e-7)
    assert path_along(replace(bond, friction=0.3), (-1e-5, 0.0), (-1e-5, 0.02)).t[-1] == pytest.approx(3.0, rel=1e-12)


def test_friction_on_the_area_that_has_failed():
    """nasa/CompDam_DGD test_COH2D4_shear_friction: friction adds nothing to the peak, and stays when all is broken."""
    bond = replace(COMPDAM, stiffness=(1e6, 1e6), pressure_strength=0.3514922612859746, friction=0.3, rubs="area")
    done = path_along(bond, (-1e-5, 0.0), (-1e-5, 0.02), n=200000)
    assert (done.t.max(), done.t[-1]) == pytest.approx((95.81492261285975, 3.0), rel=1e-5)
    s = np.linspace(0.0, 0.02, 1001)
    plain = replace(bond, pressure_strength=0.0)
    way = (s - 92.3e-6) / (2 * 0.788 / 92.3 - 92.3e-6)
    np.testing.assert_allclose(plain.rubbing_part(plain.driving(0.0, s)), np.clip(way, 0.0, 1.0), atol=1e-12)


@pytest.mark.parametrize("contact", [True, False])
@pytest.mark.parametrize("law", ["bilinear", "trapezoidal", "exponential", "bilinear by area"])
def test_work_is_stored_released_or_rubbed(law, contact):
    """Along a path that opens, closes, and slides to and fro under pressure; the error is of second order."""
    bond = replace(MOOSE, law=law.split()[0], contact=contact, friction=0.3)
    bond = replace(bond, rubs="area") if "area" in law else bond
    corners = (0, 0), (0.3, 0.2), (-1e-4, 0.5), (-1e-4, -0.8), (-5e-5, 1.5), (0.4, 1.5), (-1e-4, 1.0), (-1e-4, 4.0)
    errors = []
    for n in (4000, 8000):
        done = path_along(bond, *corners, n=n)
        g, s = jumps_along(*corners, n=n)
        work = sum(np.sum(0.5 * (f[1:] + f[:-1]) * np.diff(x)) for f, x in ((done.p, g), (done.t, s)))
        sinks = done.stored + done.contact + done.friction_stored + done.released + done.rubbed
        errors.append(abs(work - sinks[-1]))
        assert (done.rubbed[-1] > 0.1) == contact
    assert errors[1] < 0.35 * errors[0] and errors[1] < 1e-5


def test_friction_sticks_slips_and_returns():
    """A broken bond pressed by q = 1 with mu = 0.3: a block on a spring."""
    bond = replace(MOOSE, friction=0.3)
    g = np.r_[0.0, 3.0, 0.0, np.full(4, -1e-4)]
    s = np.array([0.0, 0.0, 0.0, 0.002, 0.5, 0.499, -0.5])
    done = bond.path(g, s)
    np.testing.assert_allclose(done.t[3:], [0.2, 0.3, 0.2, -0.3], rtol=1e-10)
    np.testing.assert_allclose(done.slip[3:], [0.0, 0.497, 0.497, -0.497], atol=1e-12)
    np.testing.assert_allclose(
        done.rubbed[3:], [0.0, 0.3 * 0.497, 0.3 * 0.497, 0.3 * 3 * 0.497], rtol=1e-10, atol=1e-14
    )


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (
            {"law": "cubic"},
            "law: must be one of bilinear, trapezoidal, trilinear, tabular, exponential-softening, "
            "exponential, got cubic",
        ),
        ({"law": "tabular"}, "table: must be two or more pairs of opening and traction, got []"),
        ({"law": "exponential-softening", "decay": 0.0}, "decay: must be in [0.1, 100], got 0"),
        ({"criterion": "vcct"}, "criterion: must be one of bk, power, got vcct"),
        ({"onset": "ye"}, "onset: must be one of turon, quadratic with the criterion bk, got ye"),
        ({"criterion": "power", "onset": "turon"}, "onset: must be quadratic with the criterion power, got turon"),
        ({"rubs": "all"}, "rubs: must be one of damage, area, got all"),
        ({"law": "exponential", "rubs": "area"}, "rubs: must be damage with the exponential law, got area"),
        ({"exponent": 0.9}, "exponent: must be >= 1, got 0.9"),
        ({"strength": (1.0, 0.0)}, "shear_strength: must be > 0, got 0"),
        ({"toughness": (-1.0, 1.0)}, "toughness: must be > 0, got -1"),
        ({"stiffness": (1.0, float("nan"))}, "shear_stiffness: must be > 0, got nan"),
        ({"penalty": float("inf")}, "penalty: must be > 0, got inf"),
        ({"friction": -0.1}, "friction: must be >= 0, got -0.1"),
        ({"viscosity": -1.0}, "viscosity: must be >= 0, got -1"),
        ({"pressure_strength": -1.0}, "pressure_strength: must be >= 0, got -1"),
        (
            {"law": "exponential", "pressure_strength": 1.0},
            "pressure_strength: must be 0 with the exponential law, got 1",
        ),
        ({"law": "trapezoidal", "plateau": 1.0}, "plateau: must be in [0, 1), got 1"),
        (
            {"stiffness": (100.0, 0.2)},
            "stiffness: must store less at the onset of damage than the toughness, got 2.5 of 2 ",
        ),
    ],
)
def test_refusals(change, sentence):
    with pytest.raises(Refusal) as refused:
        replace(MOOSE, **change)
    assert str(refused.value).startswith(sentence)


def test_refusals_of_paths():
    for g, s, time in (([0, 1], [0], None), ([0, np.nan], [0, 1], None), ([[0]], [[0]], None), ([0, 1], [0, 1], [0])):
        with pytest.raises(Refusal):
            MOOSE.path(g, s, time)
    with pytest.raises(Refusal, match="time: must not decrease along the path, got a step of -0.5"):
        MOOSE.path([0, 1], [0, 1], [1.0, 0.5])
