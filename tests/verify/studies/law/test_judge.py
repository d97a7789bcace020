"""What a law owes: a right one keeps all of it, and each fault breaks the check that is made for it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache, partial

import numpy as np
import pytest
from made_up_point_laws import BONDS, law_of

from verify.scene.load import load_scene
from verify.studies.law import laws, study
from verify.studies.law.judge import EXACT, NOT_COMPARED, Judgement, Tolerances, inconsistent, judge
from verify.studies.law.laws import Answer, built_in, followed, modelled, of_bond, of_function
from verify.studies.law.paths import JumpPath, paths
from verify.support.refusal import Refusal
from verify.theory.mixed_law import MixedBond

BOND = BONDS["as4-peek"]
VARIANTS = {
    "bilinear": BOND,
    "compdam": replace(BONDS["compdam"], friction=0.3, pressure_strength=0.35),
    "rubbing area": replace(BONDS["compdam"], friction=0.3, rubs="area"),
    "power": replace(BOND, criterion="power"),
    "quadratic": replace(BOND, onset="quadratic"),
    "trapezoidal": replace(BOND, law="trapezoidal", plateau=0.3),
    "trilinear": replace(BOND, law="trilinear", criterion="power", knee=0.3),
    "tabular": replace(BOND, law="tabular", table=((1e-3, 9.0), (2e-3, 8.0), (3e-3, 1.0), (0.02, 0.0)), friction=0.2),
    "exponential-softening": replace(BOND, law="exponential-softening", decay=7.0),
    "exponential": replace(BOND, law="exponential", friction=0.2),
    "viscous": replace(BOND, viscosity=0.01),
    "without contact": replace(BOND, contact=False),
}


@pytest.fixture(autouse=True)
def few_differences(monkeypatch):
    """Tangents are compared at some steps of a path: at fewer of them than a user's."""
    monkeypatch.setattr(laws, "PROBED", 2)


@pytest.fixture
def unexplained(monkeypatch):
    """Which defect explains what is broken takes a second, and is tested in `test_defects.py`."""
    monkeypatch.setattr("verify.studies.law.judge.defects", lambda *_: ())


def judged(bond: MixedBond, law: Callable, tolerances: Tolerances | None = None) -> Judgement:
    ways = paths(bond)
    return judge(bond, ways, {way.name: of_function(law, way) for way in ways}, tolerances)


def broken(found: Judgement) -> set[str]:
    return {check.name for check in found.broken}


@pytest.mark.parametrize("code", [built_in, modelled])
@pytest.mark.parametrize(
    "bond",
    [  # tests/verify/theory/test_three_laws.py holds all of them against each other
        pytest.param(bond, id=name, marks=() if name == "viscous" else pytest.mark.slow)
        for name, bond in VARIANTS.items()
    ],
)
def test_two_solvers_and_the_definition_agree_to_the_last_digits(bond, code):
    found = judged(bond, code(bond), EXACT)
    assert broken(found) == set() and found.passed and found.defects == ()
    assert "tangent" in {check.name for check in found.checks}


def healing(g: float, s: float, state: object, dt: float) -> tuple:
    """Damage without history."""
    return (*law_of(BOND)(g, s, None, dt)[:2], None)


def lopsided(g: float, s: float, state: tuple, dt: float) -> tuple:
    """Slip to one side is damaged as if it were 1 % larger."""
    p, t, state = law_of(BOND)(g, s * (1.01 if s < 0.0 else 1.0), state, dt)
    return p, t, state


def prestressed(g: float, s: float, state: tuple, dt: float) -> tuple:
    p, t, state = law_of(BOND)(g, s, state, dt)
    return p + 0.1, t, state


def sticky(g: float, s: float, state: tuple, dt: float) -> tuple:
    """Faces that are open by 1e-9 have lost a per cent of the shear traction."""
    p, t, state = law_of(BOND)(g, s, state, dt)
    return p, t * (0.99 if g > 0.0 else 1.0), state


def permanent(g: float, s: float, state: tuple | None, dt: float) -> tuple:
    """Unloads with the initial stiffness and leaves a residual opening."""
    inner, largest = state or (None, 0.0)
    p, t, inner = law_of(BOND)(max(g, largest), s, inner, dt)
    if 0.0 <= g < largest:
        p = max(p - BOND.stiffness[0] * (largest - g), 0.0)
    if g < 0.0:
        p = BOND.penalty * g
    return p, t, (inner, max(g, largest))


FAULTS = {
    "dissipation": healing,
    "unloading": permanent,
    "odd-in-slip": lopsided,
    "rest": prestressed,
    "continuity": sticky,
    "toughness": law_of(BOND, "half-area"),
    "strength": law_of(BOND, "onset"),
    "contact": law_of(BOND, "damaged-contact"),
    "compressed-toughness": law_of(BOND, "sqrt2-compressed-shear"),
    "compressed-strength": law_of(BOND, "viscosity", 0.1),
}


@pytest.mark.usefixtures("unexplained")
@pytest.mark.parametrize("name", FAULTS)
def test_each_fault_breaks_the_check_that_is_made_for_it(name):
    assert {name, "reference"} <= broken(judged(BOND, FAULTS[name]))


def test_a_law_of_a_user_is_right_without_a_tangent_and_every_check_has_its_fault():
    """`reference` is broken by all of them."""
    found = judged(BOND, law_of(BOND))
    assert found.passed and found.remarks == ("no tangent is given: none is judged",)
    assert {check.name for check in found.checks} == {*FAULTS, "reference"}


@pytest.mark.parametrize("i", [0, 1])
@pytest.mark.parametrize("j", [0, 1])
def test_a_wrong_entry_of_the_tangent_is_found(i, j):
    right = built_in(BOND)

    def law(g: float, s: float, state: object, dt: float) -> tuple:
        p, t, state, tangent = right(g, s, state, dt)
        tangent = np.array(tangent)
        tangent[i, j] += 0.01 * BOND.stiffness[0]
        return p, t, state, tangent

    assert broken(judged(BOND, law)) == {"tangent"}


def test_a_wrong_tangent_is_found_in_a_file_too():
    """Tangents without a function are held against differences along the path."""
    ways = paths(BOND)
    given = {way.name: replace(of_function(built_in(BOND), way), differences=None) for way in ways}
    assert judge(BOND, ways, given).passed
    right = given["mixed-50"]
    found = judge(BOND, ways, given | {"mixed-50": replace(right, tangent=1.5 * np.array(right.tangent))})
    assert [(check.name, check.subject) for check in found.broken] == [("tangent", "mixed-50")]


def endless(g: float, s: float, state: float | None, dt: float, part: float = 1.0) -> tuple:
    """Softening of ``BOND`` by an exponential that never ends, of a ``part`` of its toughness."""
    (K, Ks), B = BOND.stiffness, float(BOND.mode_ratio(g, s))
    size = max(float(BOND.energy_norm(g, s)), state or 0.0)
    onset, G = float(BOND.onset_norm(B)), part * float(BOND.critical(B))
    left = np.exp((onset - size) * onset / (G - 0.5 * onset**2)) * onset / size if size > onset else 1.0
    return (BOND.penalty if g < 0.0 else left * K) * g, left * Ks * s, size


@pytest.mark.usefixtures("unexplained")
@pytest.mark.parametrize("part", [1.0, 1.002])
def test_a_law_is_followed_until_it_has_failed(part):
    """Its tail counts: the toughness is right to 2e-4, and 0.2 % more are found. A file of the paths ends before."""
    ways, law = paths(BOND), partial(endless, part=part)
    given, far = followed(law, ways)
    found = judge(BOND, ways, given, None, far)
    off = [check.value for check in found.checks if check.name == "toughness"]
    assert off == pytest.approx([part - 1.0] * 5, abs=2e-4) and not any("ended before" in one for one in found.remarks)
    if part == 1.0:  # a decay of 30 hardly ends either
        like = replace(BOND, law="exponential-softening", decay=30.0)
        assert judge(like, paths(like), followed(endless, paths(like))[0]).passed
    short = judge(BOND, ways, {way.name: of_function(law, way) for way in ways})
    assert sum("ended before failure" in one for one in short.remarks) == 5
    assert "toughness" not in {check.name for check in short.checks} and not short.toughness


def test_without_a_definition_the_exact_checks_judge_and_the_toughness_is_listed():
    def bare(law: Callable) -> Judgement:
        ways = paths(BOND)
        given, far = followed(law, ways)
        return judge(BOND, ways, given, None, far, compared=False)

    found = bare(endless)
    assert found.passed and found.defects == () and {check.kind for check in found.checks} == {"exact"}
    assert [*found.toughness] == [0.0, 0.2, 0.5, 0.8, 1.0] and found.remarks[0] == NOT_COMPARED
    assert [*found.toughness.values()] == pytest.approx(BOND.critical(np.array([*found.toughness])), rel=2e-4)
    for name in ("dissipation", "unloading", "odd-in-slip", "rest", "continuity"):
        assert name in broken(bare(FAULTS[name])), name


@pytest.mark.parametrize("beta", [0.7, 0.8])
def test_a_law_of_one_effective_opening_has_a_definition(beta):
    """Ortiz and Pandolfi (1999), with 0.5 in every mode; another beta is another shear strength, 20 times beta."""
    scene = load_scene("dcb-as4peek", [
        'interface={law="exponential", strength=20.0, toughness=0.5, shear_strength=14.0, shear_toughness=0.5}',
        "published=[]",
    ])  # fmt: skip
    of = study.subject(scene, "ortiz-pandolfi")

    def law(g: float, s: float, largest: float | None, dt: float) -> tuple:
        scale, size = 0.5 / (np.e * 20.0), max(np.hypot(max(g, 0.0), beta * s), largest or 0.0)
        k = 0.5 / scale**2 * np.exp(-size / scale)
        return (of.bond.penalty if g < 0.0 else k) * g, k * beta**2 * s, size

    given, far = followed(law, of.ways)
    found = judge(of.bond, of.ways, given, None, far)
    assert found.passed == (beta == 0.7) and [*found.toughness.values()] == pytest.approx([0.5] * 5, rel=1e-4)
    assert beta == 0.7 or "the shear strength is 16, not 14" in found.defects[0].sentence
    own = study.subject(scene)
    first = judge(own.bond, own.ways, followed(law, own.ways)[0]).defects[0]
    assert ("judge by --definition ortiz-pandolfi" in first.sentence) == (beta == 0.7)
    with pytest.raises(Refusal, match='--definition: must be "bilinear", .* "xu-needleman", "ppr" or "none", got .x.'):
        study.subject(scene, "x")


P_T, G_G = (20.0, 14.0), (0.5, 0.4)


@cache
def of_potential(name: str, toughness: tuple[float, float] = G_G) -> study.Subject:
    """A definition that is a potential, with the numbers of a scene."""
    law = '"exponential"' if name == "xu-needleman" else '"bilinear", stiffness=8e3, shear_stiffness=4e3'
    numbers = f"strength={P_T[0]}, toughness={toughness[0]}, shear_strength={P_T[1]}, shear_toughness={toughness[1]}"
    return study.subject(load_scene("dcb-as4peek", [f"interface={{law={law}, {numbers}}}", "published=[]"]), name)


@pytest.mark.parametrize(("name", "toughness"), [("xu-needleman", G_G), ("ppr", G_G), ("ppr", (0.4, 0.5))])
def test_a_definition_by_a_potential_is_one(name, toughness):
    """Work to failure, peaks, and the coupling: the slope of p by s is that of t by g; and the defect that is known."""
    with pytest.raises(Refusal, match="interface.shear_toughness: must be <= interface.toughness for xu-needleman"):
        of_potential("xu-needleman", (0.4, 0.5))
    bond, far, none = of_potential(name, toughness).bond, np.geomspace(1e-5, 10.0, 20_001), np.zeros(20_001)
    opened, slid = bond.path(far, none), bond.path(none, far)
    assert (np.trapezoid(opened.p, far), np.trapezoid(slid.t, far)) == pytest.approx(toughness, rel=1e-4)
    assert (opened.p.max(), slid.t.max()) == pytest.approx(P_T, rel=1e-6)
    assert bond.critical(np.array([0.0, 1.0])) == pytest.approx(toughness, rel=1e-5)
    g, s, h = bond.scale[0] * 1.2, bond.scale[1] * 1.3, 1e-6
    at = [bond.path(np.array([one]), np.array([two])) for one, two in ((g, s - h), (g, s + h), (g - h, s), (g + h, s))]
    assert at[1].p - at[0].p == pytest.approx(at[3].t - at[2].t, rel=1e-5) and at[1].p < at[0].p
    behind = bond.path(np.append(0.0, far), np.full(20_002, 10.0))  # slid apart, then opened
    left = toughness[0] - toughness[1] if name == "xu-needleman" else 0.0
    assert np.trapezoid(behind.p[1:], far) == pytest.approx(left, rel=1e-4)


def xu_needleman(g: float, s: float, fault: str) -> tuple[float, float, float, float]:
    """Stiffness of both tractions and what is left of it; a fault leaves the sliding out of the opening traction."""
    dn, dt, q = G_G[0] / (np.e * P_T[0]), np.sqrt(2.0 / np.e) * G_G[1] / P_T[1], G_G[1] / G_G[0]
    x, slid = g / dn, np.exp(-((s / dt) ** 2))
    now = np.exp(-x) * (1.0 if fault else 1.0 - q + q * slid), np.exp(-x) * (1.0 + x) * slid
    return G_G[0] / dn**2, 2.0 * G_G[1] / dt**2, *now


def ppr(g: float, s: float, fault: str) -> tuple[float, float, float, float]:
    """As in the paper, with Gamma_n, Gamma_t of G_I > G_II; a fault forgets that the shear traction ends before."""
    (m, n), (dn, dt), _ = of_potential("ppr").bond.modes
    x, y, (G1, G2) = min(g / dn, 1.0), min(abs(s) / dt, 1.0), G_G
    gamma_n, gamma_t = -G1 * (3.0 / m) ** m, (3.0 / n) ** n
    opens = gamma_n / dn * (m * (1 - x) ** 3 * (m / 3 + x) ** (m - 1) - 3 * (1 - x) ** 2 * (m / 3 + x) ** m)
    slides = gamma_t / dt * (n * (1 - y) ** 3 * (n / 3 + y) ** (n - 1) - 3 * (1 - y) ** 2 * (n / 3 + y) ** n)
    p = opens * gamma_t * (1 - y) ** 3 * (n / 3 + y) ** n
    held = gamma_n * (1 - x) ** 3 * (m / 3 + x) ** m + G1 - G2
    t = slides * (held if fault else min(held, 0.0))
    return 8e3, 4e3, p / (8e3 * g) if g > 0.0 else p_at_rest(y, n), t / (4e3 * abs(s)) if s else t_at_rest(x, m)


def p_at_rest(y: float, n: float) -> float:
    return (1 - y) ** 3 * (1 + 3 * y / n) ** n


def t_at_rest(x: float, m: float) -> float:
    return max(1.0 - G_G[0] / G_G[1] * (1.0 - (1 - x) ** 3 * (1 + 3 * x / m) ** m), 0.0)


@pytest.mark.usefixtures("unexplained")
@pytest.mark.parametrize(
    ("law", "fault"),
    [(xu_needleman, ""), (xu_needleman, "wrong"), (ppr, ""), (ppr, "wrong")],
)
def test_a_law_of_a_potential_is_judged(law, fault):
    of = of_potential(law.__name__.replace("_", "-"))

    def stepped(g: float, s: float, least: tuple | None, dt: float) -> tuple:
        K, Ks, *now = law(max(g, 0.0), s, fault)
        least = tuple(map(min, now, least or now))
        return (K * least[0] if g >= 0.0 else of.bond.penalty) * g, Ks * least[1] * s, least

    given, far = followed(stepped, of.ways)
    found = judge(of.bond, of.ways, given, None, far)
    assert found.passed == (not fault), [check for check in found.broken][:3]


def test_what_is_not_judged_is_said():
    found = judged(replace(BOND, viscosity=0.01, friction=0.1), built_in(replace(BOND, viscosity=0.01, friction=0.1)))
    assert len(found.remarks) == 2 and "viscosity" in found.remarks[0] and "friction" in found.remarks[1]
    assert "unloading" not in {check.name for check in found.checks}


@pytest.mark.usefixtures("unexplained")
def test_tractions_that_are_no_numbers_break_everything():
    ways = paths(BOND)
    given = {way.name: of_bond(BOND, way) for way in ways}
    given["mode-I"] = Answer(np.full_like(given["mode-I"].p, np.nan), given["mode-I"].t)
    assert {"reference", "toughness", "strength"} <= broken(judge(BOND, ways, given))


def test_another_stiffness_than_the_consistent_one_is_said_with_what_it_costs():
    """CompDam's bond with K = Ks: the two energies are those of an own arithmetic, 0.484883 and 0.437269."""
    bond = BONDS["compdam"]
    (text,) = inconsistent(replace(bond, stiffness=(1e6, 1e6)))
    assert "takes up 0.48488" in text and "the consistent one 0.437" in text and "(+10.9%)" in text
    assert not list(inconsistent(bond))


def test_the_bilinear_law_of_neml2_is_right():
    """Every fourth row of `neml2_bilinear_monotonic.csv` (MIT); the same with 1 % less is not, and no known defect."""
    x = np.array([0.0, 0.005, 0.025, 0.045, 0.065, 0.085])
    t = np.array([0.0, 5.0, 7.3425519759, 6.1699135394, 4.9972751029, 3.8246366664])
    bond = MixedBond("bilinear", (10.0, 15.0), (1.0, 2.0), (1e3, 1e3), 1e5, onset="quadratic")
    way = JumpPath("neml2", "Opening and sliding alike.", x, x)
    found = judge(bond, [way], {"neml2": Answer(t, t)}, Tolerances(1e-9, 1e-6))
    assert found.passed and not found.defects
    less = judge(bond, [way], {"neml2": Answer(0.99 * t, 0.99 * t)})
    assert not less.passed and less.defects[0].name == "unknown"


@pytest.mark.usefixtures("unexplained")
def test_a_fault_of_the_other_code_is_found(monkeypatch):
    """One per mille more toughness in the law of fem_reference breaks this check and no other."""

    def tougher(bond: MixedBond) -> Callable:
        return modelled(replace(bond, toughness=(1.001 * bond.toughness[0], bond.toughness[1])))

    subject = study.subject(load_scene("dcb-as4peek"))
    assert study.judge_built_in(subject).passed
    monkeypatch.setattr(study, "modelled", tougher)
    assert broken(study.judge_built_in(subject)) == {"other-code"}
