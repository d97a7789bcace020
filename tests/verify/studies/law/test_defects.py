"""Planted defects are named first, on three materials; a right law has none; what is no known defect is unknown."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from made_up_point_laws import BONDS, DEFECTS, consistent, law_of

from verify.studies.law.defects import Defect, defects
from verify.studies.law.given.answer import Answer, Answers, of_bond, of_function
from verify.studies.law.ways.legs import JumpPath
from verify.studies.law.ways.paths import paths
from verify.theory.mixed_law import MixedBond

TOLERANCE = 1e-4
AMOUNTS = {"viscosity": (0.003, 0.05), "stiffness-unit": (1e3, 1e-3)}
PLANTED = [(name, amount) for name in DEFECTS for amount in AMOUNTS.get(name, (1.0,))]
each = pytest.mark.parametrize("bond", BONDS.values(), ids=BONDS)


def found_in(bond: MixedBond, law, ways: tuple[JumpPath, ...] | None = None) -> tuple[Defect, ...]:
    ways = ways or paths(bond)
    return defects(bond, ways, {way.name: of_function(law, way) for way in ways}, TOLERANCE)


@each
@pytest.mark.parametrize(("name", "amount"), PLANTED)
def test_a_planted_defect_is_named_first(bond: MixedBond, name: str, amount: float) -> None:
    first, *_ = found_in(bond, law_of(bond, name, amount))
    assert first.name == name
    assert first.error_with < 1e-3 * first.error_without and first.error_without > 1e-3


@each
def test_a_right_law_has_no_defect(bond: MixedBond) -> None:
    assert found_in(bond, law_of(bond)) == ()


@each
def test_the_viscosity_is_fitted(bond: MixedBond) -> None:
    first, *_ = found_in(bond, law_of(bond, "viscosity", 0.02))
    assert first.candidate is not None and first.candidate.bond.viscosity == pytest.approx(0.02, rel=1e-4)


@each
def test_the_viscosity_of_a_code_with_a_time_step_of_its_own_is_fitted_in_steps(bond: MixedBond) -> None:
    law = law_of(bond, "viscosity", 0.7)
    first, *_ = found_in(bond, lambda g, s, state, dt: law(g, s, state, 1.0))
    assert first.name == "viscosity" and "0.7 steps" in first.what


def perturbed(bond: MixedBond, ways: tuple[JumpPath, ...], seed: int, size: float) -> Answers:
    """The definition times 1 + size times a smooth function of the jump, for each traction another one."""
    a = np.random.default_rng(seed).normal(size=(2, 3))
    scale = 2.0 * bond.toughness[0] / bond.strength[0]
    answers = {}
    for way in ways:
        known = of_bond(bond, way)
        waves = [1.0 + size * np.sin((k * way.g + m * way.s) / scale + n) for k, m, n in a]
        answers[way.name] = Answer(known.p * waves[0], known.t * waves[1])
    return answers


@each
@pytest.mark.parametrize("seed", range(8))
def test_a_smooth_perturbation_differs_without_a_false_name(bond: MixedBond, seed: int) -> None:
    ways = paths(bond)
    (found,) = defects(bond, ways, perturbed(bond, ways, seed, 0.005), TOLERANCE)
    assert found.name == "unknown" and found.error_with == found.error_without > 1e-4


@each
def test_a_law_without_damage_gets_no_false_name(bond: MixedBond) -> None:
    K, Ks = bond.stiffness
    (found,) = found_in(bond, lambda g, s, state, dt: ((bond.penalty if g < 0.0 else K) * g, Ks * s, None))
    assert found.name == "unknown"


def test_defects_on_paths_of_their_own_are_named_side_by_side() -> None:
    bond = BONDS["as4-peek"]
    ways = tuple(way for way in paths(bond) if way.name in ("contact", "mode-II", "mixed-50", "mode-II-negative"))
    given = {way.name: of_function(law_of(bond, "sqrt2-compressed-shear"), way) for way in ways}
    contact = next(way for way in ways if way.name == "contact")
    given["contact"] = of_function(law_of(bond, "damaged-contact"), contact)
    found = defects(bond, ways, given, TOLERANCE)
    assert {one.name for one in found} == {"sqrt2-compressed-shear", "damaged-contact"}


def test_a_defect_beside_an_unknown_one_is_named_with_it() -> None:
    bond = BONDS["compdam"]
    ways = tuple(way for way in paths(bond) if way.name in ("mode-II", "mode-II-negative", "mixed-50", "mixed-20"))
    given = {way.name: of_function(law_of(bond, "sqrt2-compressed-shear"), way) for way in ways}
    known = given["mixed-50"]
    given["mixed-50"] = replace(known, p=1.02 * known.p)
    assert [one.name for one in defects(bond, ways, given, TOLERANCE)] == ["sqrt2-compressed-shear", "unknown"]


@each
def test_a_law_without_contact_is_not_one_whose_contact_fades(bond: MixedBond) -> None:
    """Where the bond has failed before it closes the two are one, and no defect explains all paths together."""
    ways = paths(bond)
    given = {way.name: of_function(law_of(bond, "no-contact"), way) for way in ways}
    given["mode-I"] = replace(given["mode-I"], p=1.02 * given["mode-I"].p)
    assert [one.name for one in defects(bond, ways, given, TOLERANCE)] == ["no-contact", "unknown"]


@pytest.mark.parametrize("law", ["trapezoidal", "exponential"])
def test_other_laws_have_the_defects_that_they_can_have(law: str) -> None:
    bond = replace(BONDS["as4-peek"], law=law)
    ways = paths(bond)
    assert defects(bond, ways, {way.name: of_bond(bond, way) for way in ways}, 1e-12) == ()
    half = replace(bond, toughness=(0.5 * bond.toughness[0], 0.5 * bond.toughness[1]))
    first, *_ = defects(bond, ways, {way.name: of_bond(half, way) for way in ways}, TOLERANCE)
    assert first.name == "half-area"


def test_where_modes_cannot_tell_there_is_no_such_defect() -> None:
    """With equal stiffness the mode ratio by displacement is that by energy."""
    bond = replace(BONDS["moose"], stiffness=(100.0, 100.0))
    assert found_in(bond, law_of(bond, "displacement-mode-ratio")) == ()


ratios = st.floats(0.4, 2.5)


@given(ratios, ratios, st.floats(1.5, 3.0), st.floats(8.0, 60.0), st.sampled_from(PLANTED))
@settings(max_examples=12)
def test_of_any_bond_the_planted_defect_is_named_if_it_shows(
    tougher: float, stronger: float, exponent: float, ductility: float, planted: tuple[str, float]
) -> None:
    """Where K / Ks is such that two modes have one onset or one toughness, a defect may not show at all."""
    strength, toughness = (1.0, stronger), (1.0, 1.3 * tougher)
    K = 0.5 * ductility
    bond = MixedBond("bilinear", strength, toughness, consistent(K, toughness, strength), 10.0 * K, exponent=exponent)
    found = found_in(bond, law_of(bond, *planted))
    assert found == () or found[0].name == planted[0]
    assert found != () or planted[0] in ("displacement-mode-ratio", "onset")


def test_half_a_toughness_below_what_the_onset_stores_is_named_too() -> None:
    bond = MixedBond("bilinear", (3.16, 4.85), (4.31, 11.6), (2.0, 1.75), 147.0, exponent=3.0)
    first, *_ = found_in(bond, law_of(bond, "half-area"))
    assert first.name == "half-area"
