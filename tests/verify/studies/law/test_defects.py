"""Planted defects are named first, on three materials; a right law has none; what is no known defect is unknown."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from made_up_point_laws import BONDS, DEFECTS, consistent, law_of

from verify.scene.bond.mixed import mixed_bond
from verify.scene.load import load_scene
from verify.studies.law.defects import Defect, defects
from verify.studies.law.given.answer import Answer, Answers, of_bond, of_function
from verify.studies.law.ways.legs import JumpPath
from verify.studies.law.ways.paths import paths
from verify.theory.mixed_law import MixedBond

TOLERANCE = 1e-4
AMOUNTS = {"viscosity": (0.003, 0.05), "stiffness-unit": (1e3, 1e-3)}
#: Amounts of the defects that are fitted, and of those that hold for one direction of slip.
NUMBERS = {
    "healing": (0.0, 0.9), "slip-sign": (-1.0, 0.0, 0.9), "penalty": (0.1, 1.3), "exponent": (0.7, 1.5),
    "toughness": (0.6, 1.1), "shear-toughness": (0.6, 1.1), "strength": (0.6, 1.1), "shear-strength": (0.6, 1.1),
    "stiffness": (0.5, 1.1), "shear-stiffness": (0.5, 1.1),
}  # fmt: skip
PLANTED = [(name, amount) for name in DEFECTS if name not in NUMBERS for amount in AMOUNTS.get(name, (1.0,))]
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


SCENES = ("mmb50-as4peek", "slb", "krueger-mmb50")


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize(
    ("name", "amount"), [(name, amounts[i % 2]) for i, (name, amounts) in enumerate(NUMBERS.items())]
)
def test_a_planted_number_is_named_first_of_the_bond_of_a_scene(scene: str, name: str, amount: float) -> None:
    bond = mixed_bond(load_scene(scene))
    assert bond is not None and found_in(bond, law_of(bond)) == ()
    first, *_ = found_in(bond, law_of(bond, name, amount))
    assert first.name == name


OTHER_BONDS = {
    "trapezoidal": replace(BONDS["as4-peek"], law="trapezoidal"),
    "exponential": replace(BONDS["as4-peek"], law="exponential"),
    "power": replace(BONDS["compdam"], criterion="power", exponent=1.3),
    "quadratic": replace(BONDS["moose"], onset="quadratic", exponent=1.5),
    "rubbing": replace(BONDS["compdam"], friction=0.3, pressure_strength=0.35),
}
WRONG = {
    "healing": lambda bond: replace(bond, irreversible=False),
    "penalty": lambda bond: replace(bond, penalty=0.5 * bond.penalty),
    "exponent": lambda bond: replace(bond, exponent=1.7 * bond.exponent),
    "criterion": lambda bond: replace(bond, criterion="power", onset=None),
    "strength": lambda bond: replace(bond, strength=(0.9 * bond.strength[0], bond.strength[1])),
    "shear-strength": lambda bond: replace(bond, strength=(bond.strength[0], 0.9 * bond.strength[1])),
    "shear-toughness": lambda bond: replace(bond, toughness=(bond.toughness[0], 1.1 * bond.toughness[1])),
    "friction": lambda bond: replace(bond, friction=2.0 * bond.friction),
    "pressure-strength": lambda bond: replace(bond, pressure_strength=0.5 * bond.pressure_strength),
}


def can_have(bond: MixedBond, name: str) -> bool:
    """Whether a wrong number shows: an exponential law has no criterion, and a power law is one already."""
    if name == "criterion":
        return bond.law != "exponential" and bond.criterion == "bk"
    return WRONG[name](bond) != bond and (name, bond.law) != ("exponent", "exponential")


@pytest.mark.parametrize(
    ("kind", "name"), [(kind, name) for kind, bond in OTHER_BONDS.items() for name in WRONG if can_have(bond, name)]
)
def test_of_other_laws_and_criteria_the_wrong_number_is_named_first(kind: str, name: str) -> None:
    bond = OTHER_BONDS[kind]
    ways, wrong = paths(bond), WRONG[name](bond)
    first, *_ = defects(bond, ways, {way.name: of_bond(wrong, way) for way in ways}, TOLERANCE)
    assert first.name == name


@each
def test_a_traction_that_drives_the_slip_has_the_wrong_sign(bond: MixedBond) -> None:
    def law(g: float, s: float, state: tuple | None, dt: float) -> tuple:
        p, t, state = law_of(bond)(g, s, state, dt)
        return p, -t, state

    (first,) = found_in(bond, law)
    assert first.name == "slip-sign" and "opposite sign" in first.what


def test_friction_that_drives_the_slip_has_the_wrong_sign() -> None:
    bond = OTHER_BONDS["rubbing"]
    ways, plain = paths(bond), replace(bond, friction=0.0)
    given = {}
    for way in ways:
        known, without = of_bond(bond, way), of_bond(plain, way)
        given[way.name] = Answer(known.p, 2.0 * without.t - known.t)
    (first,) = defects(bond, ways, given, TOLERANCE)
    assert first.name == "slip-sign" and "friction" in first.what


@each
def test_damage_that_heals_where_faces_close_is_named(bond: MixedBond) -> None:
    def law(g: float, s: float, state: tuple | None, dt: float) -> tuple:
        return law_of(bond)(g, s, None if g < 0.0 else state, dt)

    (first,) = found_in(bond, law)
    assert first.name == "healing" and "close" in first.what


@pytest.mark.parametrize("law", ["bilinear", "trapezoidal", "exponential"])
@pytest.mark.parametrize("name", ["healing", "penalty", "strength", "toughness"])
def test_a_bond_that_only_opens_has_the_defects_of_opening(law: str, name: str) -> None:
    bond = MixedBond(law, (10.0, 10.0), (0.5, 0.5), (2e3, 2e3), 2e5)
    wrong = {
        "healing": replace(bond, irreversible=False),
        "penalty": replace(bond, penalty=0.5 * bond.penalty),
        "strength": replace(bond, strength=(8.0, 8.0)),
        "toughness": replace(bond, toughness=(0.6, 0.6)),
    }[name]
    ways = paths(bond, shear=False)
    first, *_ = defects(bond, ways, {way.name: of_bond(wrong, way) for way in ways}, TOLERANCE)
    assert first.name == name


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


@given(
    ratios,
    ratios,
    st.floats(1.5, 3.0),
    st.floats(8.0, 60.0),
    st.sampled_from([*PLANTED, *((name, amount) for name, all_of in NUMBERS.items() for amount in all_of)]),
)
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
