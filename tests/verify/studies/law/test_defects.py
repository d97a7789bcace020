"""Planted defects are named first, of many bonds; a right law has none; what is no known defect is unknown."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from made_up_point_laws import BONDS, DEFECTS, consistent, law_of

from verify.studies.law.defects import Defect, defects
from verify.studies.law.laws import Answer, Case, of_bond, of_function
from verify.studies.law.paths import JumpPath, paths
from verify.theory.mixed_law import MixedBond

#: Amounts of defects (`law_of`).
AMOUNTS = {
    "viscosity": (0.003, 0.05), "stiffness-unit": (1e3, 1e-3), "healing": (0.0, 0.9), "slip-sign": (-1.0, 0.9),
    "penalty": (0.02, 1.3), "exponent": (0.7, 1.5), "stiffness": (0.5, 1.1), "shear-stiffness": (0.5, 1.1),
    "toughness": (0.6, 1.1), "shear-toughness": (0.6, 1.1), "strength": (0.6, 1.1), "shear-strength": (0.6, 1.1),
}  # fmt: skip
PLANTED = [(name, amount) for name in DEFECTS for amount in AMOUNTS.get(name, (1.0, 1.0))]


def found_in(bond: MixedBond, answers: Mapping[str, Answer], ways: tuple[JumpPath, ...]) -> tuple[Defect, ...]:
    return defects(
        [Case(bond, way, answers[way.name], of_bond(bond, way)) for way in ways if way.name in answers], 1e-4
    )


def found_of(bond: MixedBond, law: Callable | MixedBond, shear: bool = True) -> tuple[Defect, ...]:
    ways, answer = paths(bond, shear), of_bond if isinstance(law, MixedBond) else of_function
    return found_in(bond, {way.name: answer(law, way) for way in ways}, ways)


@pytest.mark.parametrize(
    ("i", "name", "amount"),
    [pytest.param(i, *planted, marks=pytest.mark.slow if i % 2 else ()) for i, planted in enumerate(PLANTED)],
)
def test_a_planted_defect_is_named_first(i, name, amount):
    bond = [*BONDS.values()][i % 3]
    first, *_ = found_of(bond, law_of(bond, name, amount))
    assert first.name == name
    assert first.error_with < 1e-3 * first.error_without


OTHER_BONDS = {
    "trapezoidal": replace(BONDS["as4-peek"], law="trapezoidal"),
    "trilinear": replace(BONDS["as4-peek"], law="trilinear"),
    "tabular": replace(BONDS["as4-peek"], law="tabular", table=((1e-3, 9.0), (2e-3, 8.0), (3e-3, 1.0), (0.02, 0.0))),
    "exponential-softening": replace(BONDS["as4-peek"], law="exponential-softening"),
    "exponential": replace(BONDS["as4-peek"], law="exponential"),
    "power": replace(BONDS["compdam"], criterion="power", exponent=1.3),
    "quadratic": replace(BONDS["moose"], onset="quadratic", exponent=1.5),
    "rubbing": replace(BONDS["compdam"], friction=0.3, pressure_strength=0.35),
    "soft": MixedBond("bilinear", (3.16, 4.85), (4.31, 11.6), (2.0, 1.75), 147.0, exponent=3.0),
}
#: Changes of numbers; those of a mode by its factor.
WRONG: dict[str, dict] = {
    "healing": {"irreversible": False}, "criterion": {"criterion": "power", "onset": None}, "penalty": {"penalty": 0.5},
    "exponent": {"exponent": 1.7}, "friction": {"friction": 2.0}, "pressure-strength": {"pressure_strength": 0.5},
    "strength": {"strength": (0.9, 1.0)}, "shear-strength": {"strength": (1.0, 0.9)},
    "shear-toughness": {"toughness": (1.0, 1.1)}, "half-area": {"toughness": (0.5, 0.5)},
}  # fmt: skip
OF_A_SHAPE = (
    "healing",
    "criterion",
    "exponent",
    "strength",
    "shear-strength",
    "shear-toughness",
    "half-area",
    "penalty",
)
SHOWN = {
    **dict.fromkeys(("trilinear", "tabular", "exponential-softening"), OF_A_SHAPE),
    "trapezoidal": ("healing", "criterion", "exponent", "strength", "half-area"),
    "exponential": ("healing", "penalty", "strength", "shear-strength", "shear-toughness", "half-area"),
    "power": ("exponent", "shear-strength"),
    "quadratic": ("criterion", "exponent", "shear-toughness"),
    "rubbing": ("friction", "pressure-strength", "penalty", "shear-strength"),
}


def wrong(bond: MixedBond, name: str) -> MixedBond:
    values = {}
    for key, change in WRONG[name].items():
        known = getattr(bond, key)
        values[key] = change if isinstance(known, str | bool | None) else (np.array(known) * change).tolist()
    return replace(bond, **values)


@pytest.mark.parametrize(
    ("kind", "name"),
    [
        pytest.param(kind, name, marks=() if name == names[i % len(names)] else pytest.mark.slow)
        for i, (kind, names) in enumerate(SHOWN.items())
        for name in names
    ],
)
def test_of_other_laws_and_criteria_the_wrong_number_is_named_first(kind, name):
    assert found_of(OTHER_BONDS[kind], wrong(OTHER_BONDS[kind], name))[0].name == name


@pytest.mark.parametrize(
    ("law", "name"),
    [("bilinear", "healing"), ("exponential", "penalty"), ("trapezoidal", "strength"), ("bilinear", "half-area")],
)
def test_a_bond_that_only_opens_has_the_defects_of_opening(law, name):
    bond = MixedBond(law, (10.0, 10.0), (0.5, 0.5), (2e3, 2e3), 2e5)
    assert found_of(bond, wrong(bond, name), shear=False)[0].name == name


def opposite(bond: MixedBond, g: float, s: float, state: tuple | None, dt: float) -> tuple:
    p, t, state = law_of(bond)(g, s, state, dt)
    return p, -t, state


def forgetful(bond: MixedBond, g: float, s: float, state: tuple | None, dt: float) -> tuple:
    return law_of(bond)(g, s, None if g < 0.0 else state, dt)


def with_own_time_step(bond: MixedBond, g: float, s: float, state: tuple | None, dt: float) -> tuple:
    return law_of(bond, "viscosity", 0.7)(g, s, state, 1.0)


def viscous(bond: MixedBond, g: float, s: float, state: tuple | None, dt: float) -> tuple:
    return law_of(bond, "viscosity", 0.02)(g, s, state, dt)


def elastic(bond: MixedBond, g: float, s: float, state: None, dt: float) -> tuple:
    return (bond.penalty if g < 0.0 else bond.stiffness[0]) * g, bond.stiffness[1] * s, None


HAND_MADE = {
    opposite: "slip-sign: the shear traction has the opposite sign",
    forgetful: "healing: damage heals where faces close",
    with_own_time_step: "viscosity of 0.7 steps",
    viscous: "viscosity of 0.02 of the programme's duration",
    elastic: "unknown: the tractions differ",
}


@pytest.mark.parametrize(
    ("law", "bond"),
    [
        pytest.param(law, bond, marks=[pytest.mark.slow] * ((i + j) % 3 > 0))
        for i, law in enumerate(HAND_MADE)
        for j, bond in enumerate(BONDS.values())
    ],
)
def test_a_wrong_law_is_named_with_its_amount(bond, law):
    first, *_ = found_of(bond, partial(law, bond))
    assert HAND_MADE[law] in first.sentence


def test_friction_that_drives_the_slip_has_the_wrong_sign():
    bond, answers = OTHER_BONDS["rubbing"], {}
    ways, plain = paths(bond), replace(bond, friction=0.0)
    for way in ways:
        right, smooth = (of_bond(one, way) for one in (bond, plain))
        answers[way.name] = Answer(right.p, 2.0 * smooth.t - right.t)
    (first,) = found_in(bond, answers, ways)
    assert first.name == "slip-sign" and "friction" in first.what


@pytest.mark.parametrize("bond", BONDS)
@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.slow)])
def test_a_smooth_perturbation_differs_without_a_false_name(bond, seed):
    """The definition times 1 + 0.005 times a smooth function of the jump, for each traction another one."""
    bond = BONDS[bond]
    (k, m, n), ways = np.random.default_rng(seed).normal(size=(3, 2)), paths(bond)
    scale, answers = 2.0 * bond.toughness[0] / bond.strength[0], {}
    for way in ways:
        waves = 1.0 + 0.005 * np.sin((np.outer(k, way.g) + np.outer(m, way.s)) / scale + n[:, None])
        answers[way.name] = Answer(*(of_bond(bond, way).tractions * waves))
    (found,) = found_in(bond, answers, ways)
    assert found.name == "unknown" and found.error_with == found.error_without > 1e-4


@pytest.mark.parametrize(
    ("elsewhere", "names"),
    [
        ({"contact": "damaged-contact"}, {"sqrt2-compressed-shear", "damaged-contact"}),
        ({"mixed-50": 1.02}, {"sqrt2-compressed-shear", "unknown"}),
    ],
)
def test_defects_on_paths_of_their_own_are_named_side_by_side(elsewhere, names):
    """One is planted on all paths but one, which has another one, or a traction that is larger by a factor."""
    bond = BONDS["as4-peek"]
    ways = tuple(way for way in paths(bond) if way.name in ("contact", "mode-II", "mixed-50", "mode-II-negative"))
    answers = {}
    for way in ways:
        other = elsewhere.get(way.name, "sqrt2-compressed-shear")
        found = of_function(law_of(bond, other if isinstance(other, str) else ""), way)
        answers[way.name] = found if isinstance(other, str) else replace(found, p=other * found.p)
    assert {one.name for one in found_in(bond, answers, ways)} == names


@pytest.mark.parametrize("bond", BONDS.values(), ids=BONDS)
@pytest.mark.parametrize("names", [("lagged-mode-ratio", "sqrt2-compressed-shear"), ("sqrt2-compressed-shear",)])
def test_faces_that_just_touch_are_open_or_closed_as_rounding_has_it(bond, names):
    """The defects of MOOSE, whose openings of nothing are 1e-19 of either sign, from step to step another one."""
    signs, law = np.random.default_rng(3), law_of(bond, " and ".join(names))

    def noisy(g: float, s: float, state: tuple | None, dt: float) -> tuple:
        return law(signs.choice([-1e-19, 1e-19]) if abs(g) < 1e-18 else g, s, state, dt)

    found = found_of(bond, noisy)
    assert tuple(one.name for one in found) == names
    assert all(one.error_with < 1e-3 * one.error_without for one in found)


def test_a_law_without_contact_is_not_one_whose_contact_fades():
    """Where the bond has failed before it closes the two are one, and no defect explains all paths together."""
    bond = BONDS["as4-peek"]
    ways = paths(bond)
    answers = {way.name: of_function(law_of(bond, "no-contact"), way) for way in ways}
    answers["mode-I"] = replace(answers["mode-I"], p=1.02 * answers["mode-I"].p)
    assert [one.name for one in found_in(bond, answers, ways)] == ["no-contact", "unknown"]


ratios = st.floats(0.4, 2.5)


@given(ratios, ratios, st.floats(1.5, 3.0), st.floats(8.0, 60.0), st.sampled_from(PLANTED))
@settings(max_examples=4)
def test_of_any_bond_the_planted_defect_is_named_if_it_shows(tougher, stronger, exponent, ductility, planted):
    """Where K / Ks is such that two modes have one onset or one toughness, a defect may not show at all."""
    strength, toughness, K = (1.0, stronger), (1.0, 1.3 * tougher), 0.5 * ductility
    bond = MixedBond("bilinear", strength, toughness, consistent(K, toughness, strength), 10.0 * K, exponent=exponent)
    found = found_of(bond, law_of(bond, *planted))
    assert found[0].name == planted[0] if found else planted[0] in ("displacement-mode-ratio", "onset")
