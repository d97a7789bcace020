"""Laws for opening and sliding: properties of all of them on random paths, closed forms, published numbers.

Tangents, energies and what damage releases are those of two other codes: `tests/verify/theory/test_three_laws.py`.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from made_up_laws import answer, both

from iga.laws.law import POINTS_IN_CACHE, History, Law
from iga.laws.laws import LAWS
from iga.laws.mode_ratio import ModeRatio
from iga.laws.shapes import SHAPES

#: Materials of published tests: MOOSE's, CompDam's, AS4/PEEK (Camanho et al. 2003), in their units.
MOOSE = {"toughness": (1.0, 2.0), "strength": (1.0, 1.0), "stiffness": (100.0, 100.0)}
COMPDAM = {"toughness": (0.277, 0.788), "strength": (62.3, 92.3), "stiffness": (1e6, 1e6)}
PEEK = {"toughness": (0.969, 1.719), "strength": (80.0, 100.0), "stiffness": (1e5, 1e5)}
#: A soft one, whose tractions bend little within a difference.
SOFT = {"toughness": (1.0, 2.0), "strength": (1.0, 1.3), "stiffness": (8.0, 6.0)}
CRITERIA = [("bk", "turon"), ("bk", "quadratic"), ("power", "quadratic")]


def law_of(name="bilinear", material=MOOSE, criterion="bk", onset="turon", exponent=2.0, **more) -> Law:
    if name == "exponential":
        criterion, onset, exponent = "bk", "quadratic", 1.0
    modes = ModeRatio(**material, criterion=criterion, exponent=exponent, onset=onset)
    more |= {"table": ((0.1, 4.0), (0.3, 3.0), (0.4, 1.0), (1.3, 0.0))} if name == "tabular" else {}
    return LAWS[name](modes, more.pop("penalty", 100.0 * modes.stiffness[0]), **more)


def every():
    """Each law with criteria, friction, viscosity and strength under pressure."""
    for name in LAWS:
        for criterion, onset in CRITERIA[: 1 if name == "exponential" else None]:
            for more in (
                {},
                {"friction": 0.3},
                {"viscosity": 0.2},
                {"friction": 0.2, "pressure_strength": 0.4, "rubs": "area"},
                {"viscosity": 0.2, "pressure_strength": 0.4},
            ):
                if name == "exponential" and "pressure_strength" in more:
                    continue
                yield pytest.param((name, criterion, onset, more), id=f"{name}-{criterion}-{onset}-{'-'.join(more)}")


EVERY = pytest.mark.parametrize("case", list(every()))


def made(case, material=MOOSE, exponent=1.7) -> Law:
    name, criterion, onset, more = case
    return law_of(name, material, criterion, onset, exponent, **more)


def scales(law: Law) -> tuple[float, float]:
    """Openings and slips of the order of those at failure."""
    return tuple(2.0 * G / p for G, p in zip(law.modes.toughness, law.modes.strength, strict=True))


def random_paths(law: Law, seed: int, n: int, steps: int = 12) -> tuple[np.ndarray, np.ndarray]:
    """Openings and slips (steps, n): corners of random paths, some closed, some beyond failure."""
    rng, (g_f, s_f) = np.random.default_rng(seed), scales(law)
    size = rng.uniform(0.0, 1.3, (steps, n)) ** 2
    angle = rng.uniform(0.0, 2.0 * np.pi, (steps, n))
    g = g_f * size * np.cos(angle)
    return np.where(g < 0.0, 0.01 * g, g), s_f * size * np.sin(angle)


@EVERY
@settings(max_examples=4, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_on_any_path_damage_grows_and_slip_has_no_preferred_sign(case, seed):
    law, n = made(case), 300
    g_sn, s_sn = random_paths(law, seed, n)
    one = other = law.start(n)
    for g, s in zip(g_sn, s_sn, strict=True):
        found, mirrored = both(law, g, s, one, 0.1), both(law, g, -s, other, 0.1)
        assert np.all(found.history.d >= one.d) and np.all((found.history.d >= 0.0) & (found.history.d <= 1.0))
        assert np.array_equal(found.p, mirrored.p) and np.array_equal(found.t, -mirrored.t)
        assert np.array_equal(found.dp_ds, -mirrored.dp_ds) and np.array_equal(found.dt_ds, mirrored.dt_ds)
        one, other = found.history, mirrored.history


#: Shear stiffness over that in opening.
RATIOS = (1e-3, 1.0, 1e3)


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("ratio", RATIOS)
def test_the_scaled_jump_grows_with_the_damage_that_the_jump_drives_to(name, ratio):
    """Whatever the mode ratio does: with unequal stiffnesses a jump that slides on may drive to less damage."""
    law = law_of(name, PEEK | {"stiffness": (1.2e5 / ratio**0.5, 1.2e5 * ratio**0.5)}, exponent=2.284)
    rng, n, (K, Ks) = np.random.default_rng(5), 20_000, law.stiffness
    angle = rng.uniform(0.0, 0.5 * np.pi, n)
    (m, _), (G, _) = law.modes.at(np.sin(angle) ** 2)
    size = m**0.5 * (2.0 * G / m) ** rng.uniform(-0.3, 1.1, n)  # from below the onset to beyond failure
    g, s = size * np.cos(angle) / K**0.5, size * np.sin(angle) / Ks**0.5
    d = law.driven(g, s)
    found, soft, order = law.scaled(g, s, d), (d > 0.0) & (d < 1.0), np.argsort(d)
    first, last = law.kinks
    assert np.all(found.x[d == 0.0] <= first) and np.all(found.x[d == 1.0] >= last)
    assert np.all(np.diff(found.x[order][soft[order]]) > 0.0)
    assert found.x[soft] == pytest.approx(found.back[soft], rel=1e-12)
    for by, v, w in ((found.by_g, g, 0.0), (found.by_s, 0.0, s)):
        h = 1e-7
        change = law.scaled(g + h * v, s + h * w, d).x - law.scaled(g - h * v, s - h * w, d).x
        away = np.abs(change / (2.0 * h) - by * (v + w)) / found.x
        assert np.mean(away > 1e-6) < 1e-3 and away[soft].max() < 0.5  # but where a kink is between both


@EVERY
def test_tractions_are_continuous_where_the_faces_meet(case):
    law = made(case)
    s = np.linspace(-1.2, 1.2, 101) * scales(law)[1]
    before = History(np.linspace(0.0, 1.0, 101) ** 2, np.zeros(101) if law.friction else None)
    tiny = np.nextafter(0.0, 1.0)
    at = both(law, np.zeros(101), s, before, 0.1)
    for g in (tiny, -tiny, 1e-12, -1e-12):
        beside = both(law, np.full(101, g * scales(law)[0]), s, before, 0.1)
        near = {"rtol": 1e-12, "atol": 2.0 * law.penalty * abs(g) * scales(law)[0]}
        assert np.allclose(beside.t, at.t, **near) and np.allclose(beside.p, at.p, **near)
        assert np.allclose(beside.history.d, at.history.d, rtol=0.0, atol=1e-8)


def test_pressure_that_uses_up_the_toughness_leaves_a_brittle_bond():
    """Its energy at onset is the toughness: it breaks at once, and no later under more pressure."""
    law = law_of(material=SOFT, pressure_strength=1.0, penalty=10.0)
    s = np.linspace(0.0, 2.0, 2001)
    for g in (-1.0, -10.0):
        found = both(law, np.full(s.size, g), s, law.start(s.size))
        assert set(found.history.d) == {0.0, 1.0} and np.all(np.isfinite(found.dt_ds))
        assert np.trapezoid(found.t, s) == pytest.approx(SOFT["toughness"][1], rel=5e-3)


def test_viscosity_costs_what_moose_measures():
    """`traction_curve_modeI_viscous.i`: 0.01 s at an opening rate of 0.3 / s, steps of 0.01 s; peak 50.98 for 50."""
    mortar = {"toughness": (5.0, 5.0), "strength": (50.0, 50.0), "stiffness": (1e3, 1e3)}
    law = law_of(material=mortar, viscosity=0.01)
    gold = {0.050999160276728: 50.333053425576, 0.053999149476745: 50.98040476998, 0.056999153490447: 50.739823357519}
    history = law.start(1)
    for g, p in gold.items():
        found = both(law, np.array([g]), np.zeros(1), history, 0.01)
        history = found.history
        assert found.p == pytest.approx(p, rel=1e-6)
    with pytest.raises(ValueError, match="dt > 0, got 0"):
        both(law, np.zeros(1), np.zeros(1), history)


@pytest.mark.parametrize("name", ["bilinear", "trapezoidal"])
def test_without_slip_it_is_the_law_of_mode_one(name):
    mixed = law_of(name, COMPDAM)
    (G, _), (p, _), (K, _) = mixed.modes.toughness, mixed.modes.strength, mixed.stiffness
    plain = LAWS[name].opening(p, G, 2.0 * G * K / p**2, mixed.penalty)
    g = np.linspace(-0.1, 1.2, 1001) * plain.g_u
    expected, slope, _ = answer(plain, g, np.zeros(g.size))
    found = both(mixed, g, np.zeros(g.size), mixed.start(g.size))
    assert np.allclose(found.p, expected, rtol=1e-12, atol=1e-12 * p) and not found.t.any()
    away = np.min(np.abs(g[:, None] - np.array(plain.kinks)), axis=1) > 1e-9 * plain.g_u
    assert np.allclose(found.dp_dg[away], slope[away], rtol=1e-9)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"criterion": "linear"}, "criterion must be in"),
        ({"criterion": "power"}, 'take onset "quadratic"'),
        ({"exponent": 0.9}, "exponent must be >= 1, got 0.9"),
        ({"stiffness": (100.0, 0.2)}, "at mode ratio 1.00"),
    ],
)
def test_a_bond_that_cannot_be_is_refused(change, words):
    with pytest.raises(ValueError, match=words):
        ModeRatio(**{**MOOSE, **change})


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_more_points_than_are_answered_at_once_are_answered_alike(friction):
    law, n = law_of(friction=friction), POINTS_IN_CACHE + 1
    (g, further), (s, slid) = random_paths(law, 5, n, steps=2)
    before = both(law, g, s, law.start(n)).history
    whole, last = both(law, further, slid, before), slice(n - 9, n)
    few = History(before.d[last], None if before.slip is None else before.slip[last])
    alone = both(law, further[last], slid[last], few)
    for name in ("p", "t", "dp_dg", "dp_ds", "dt_dg", "dt_ds"):
        assert np.array_equal(getattr(whole, name)[last], getattr(alone, name))
    assert np.array_equal(whole.history.d[last], alone.history.d)
