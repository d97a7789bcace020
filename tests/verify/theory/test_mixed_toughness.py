"""The toughness of a law between its modes by integration: that of closed forms, and said where no criterion has it."""

from dataclasses import replace

import numpy as np
import pytest
from made_up_point_laws import BONDS
from scipy.integrate import quad

from verify.methods.bonds import iga_law
from verify.theory.mixed_law import MixedBond
from verify.theory.mixed_toughness import off_criterion, toughness

ALIKE = MixedBond("exponential", (10.0, 10.0), (0.5, 0.5), (1e3, 1e3), 1e5)
CRITERIA = ({}, {"criterion": "power", "exponent": 1.0}, {"criterion": "power"}, {"onset": "quadratic"})
each = pytest.mark.parametrize("bond", BONDS.values(), ids=BONDS)


@each
@pytest.mark.parametrize("law", ["bilinear", "trapezoidal", "exponential"])
@pytest.mark.parametrize("more", CRITERIA, ids=str)
def test_it_is_the_closed_form_within_its_error(bond, law, more):
    K, Ks = bond.stiffness
    one = replace(bond, law=law, stiffness=(1e4 * K, 1e4 * Ks), viscosity=0.1, friction=0.3, **more)
    found = toughness(one)
    assert np.all(np.abs(found.law - one.critical(found.B)) <= np.max(found.error))
    assert np.max(found.error / found.law) < 1e-4


@each
@pytest.mark.parametrize("law", ["bilinear", "trapezoidal"])
@pytest.mark.parametrize("more", CRITERIA, ids=str)
def test_a_law_that_keeps_its_criterion_is_not_remarked(bond, law, more):
    assert off_criterion(replace(bond, law=law, **more)) == ()


def test_the_exponential_law_of_equal_toughnesses_has_a_third_less_between_the_modes():
    (told,) = off_criterion(ALIKE)
    assert "the toughness of the exponential law is 0.34 at G_II/G = 0.62" in told
    assert "bk of exponent 2, has 0.5: -32 %, the largest difference" in told
    work, _ = quad(lambda z: z * np.exp(-z * (0.38 / 0.5) ** 0.5 - z**2 * 0.62 / 2.0 / 0.5), 0.0, np.inf)
    assert work == pytest.approx(0.34, abs=0.001)


@each
def test_the_remark_has_the_numbers_of_the_law_of_the_solvers(bond):
    one = replace(bond, law="exponential")
    found, law = toughness(one), iga_law(one)
    at = int(np.argmax(np.abs(found.law / found.criterion - 1.0)))
    size, B = np.linspace(0.0, 30.0, 20_001) * found.law[at] ** 0.5, found.B[at]
    g, s = size * ((1.0 - B) / one.slopes[0]) ** 0.5, size * (B / one.slopes[1]) ** 0.5
    p, t = law.respond(np.stack([g, s], axis=1), law.start(g.size), 1.0)[0].T
    work = np.trapezoid(p, g) + np.trapezoid(t, s)
    assert work == pytest.approx(found.law[at], rel=1e-5)
    assert np.trapezoid(t, s) / work == pytest.approx(B, rel=1e-5)
    (told,) = off_criterion(one)
    assert f"{work:.3g} at G_II/G = {B:.2g}" in told and f"has {one.by_criterion(B):.3g}" in told


def test_a_law_that_departs_by_less_than_a_per_mille_is_remarked():
    class Tougher(MixedBond):
        def driving(self, g, s):  # type: ignore[no-untyped-def]
            d = super().driving(g, s)
            return d - 1e-3 * d * (1.0 - d)

    bond = BONDS["as4-peek"]
    (told,) = off_criterion(Tougher(**{name: getattr(bond, name) for name in bond.__dataclass_fields__}))
    assert "+0.0" in told and told.count(" %") == 1
