"""The laws of opening and sliding of `iga`, of `fem_reference` and of the checks, each written from the definition."""

import itertools

import numpy as np
import pytest

from fem_reference.problem.law import MODELLED_LAWS
from fem_reference.problem.mixed_laws import MODELLED_MIXED_LAWS
from iga.laws.law import History
from iga.laws.laws import LAWS
from iga.laws.mode_ratio import ModeRatio
from verify.theory.law import KNOWN_LAWS
from verify.theory.mixed_law import KNOWN_MIXED_LAWS, ONSETS_OF, MixedBond

#: Paths of each case, and steps of each path.
PATHS, STEPS = 60, 40
KEYS = ("plateau", "knee", "knee_traction", "decay", "table")
MODES = [(criterion, onset) for criterion, onsets in ONSETS_OF.items() for onset in onsets]
EXTRAS = [
    {},
    {"contact": False},
    {"irreversible": False},
    {"friction": 0.4},
    {"viscosity": 0.05},
    {"pressure_strength": 0.6},
    {"friction": 0.3, "rubs": "area"},
    {"friction": 0.3, "viscosity": 0.02, "pressure_strength": 0.3},
]
CASES = [
    (law, *mode, extra)
    for law, mode, extra in itertools.product(KNOWN_MIXED_LAWS, MODES, EXTRAS)
    if law != "exponential" or (mode == MODES[0] and not {"pressure_strength", "rubs"} & extra.keys())
]


def random_keys(rng: np.random.Generator) -> dict:
    """Keys of every shape, of which a law uses its own; tables fall from corner to corner."""
    knee, knee_traction = rng.uniform(0.05, 0.95, 2)
    opening, traction = np.cumsum(rng.uniform(0.1, 1.0, 5)), np.sort(rng.uniform(0.05, 1.0, 4))[::-1]
    table = tuple(zip(opening, [*traction, 0.0], strict=True))
    return {
        "plateau": rng.uniform(0.0, 0.9), "knee": knee, "knee_traction": knee_traction,
        "decay": rng.uniform(0.2, 9.0), "table": table,
    }  # fmt: skip


def bond_of(law: str, criterion: str, onset: str, extra: dict, rng: np.random.Generator) -> MixedBond:
    """A bond with random numbers in any ratio of the modes; it begins to fail at 1.5 to 30 % of its toughness."""
    strength, toughness = (tuple(10.0 ** rng.uniform(-1.0, 1.0, 2)) for _ in range(2))
    share = rng.uniform(0.015, 0.3, 2)
    stiffness = tuple(p**2 / (2.0 * G * part) for p, G, part in zip(strength, toughness, share, strict=True))
    exponent, keys = rng.uniform(1.0, 4.0), random_keys(rng)
    penalty = stiffness[0] * rng.uniform(0.5, 20.0)
    return MixedBond(law, strength, toughness, stiffness, penalty, criterion, exponent, onset, **keys, **extra)


def random_paths(bond: MixedBond, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Jumps (STEPS + 1, PATHS) from rest, of the size of those at failure; closed ones are smaller, some are zero."""
    sizes = [2.0 * G / p for G, p in zip(bond.toughness, bond.strength, strict=True)]
    g, s = (size * rng.normal(0.0, 0.4, (STEPS + 1, PATHS)) * rng.random(PATHS) for size in sizes)
    g = np.where(g < 0.0, 0.05 * g, g) * rng.choice([0.0, 1.0], (STEPS + 1, PATHS), p=[0.1, 0.9])
    s = s * rng.choice([0.0, 1.0], (STEPS + 1, PATHS), p=[0.1, 0.9])
    return np.concatenate([np.zeros((1, PATHS)), g[1:]]), np.concatenate([np.zeros((1, PATHS)), s[1:]])


def by_theory(bond: MixedBond, g: np.ndarray, s: np.ndarray) -> dict[str, np.ndarray]:
    """Tractions, histories and energies (STEPS, PATHS), whole paths at once."""
    paths = [bond.path(*jumps) for jumps in zip(g.T, s.T, strict=True)]
    names = ("p", "t", "d", "slip", "stored", "contact", "friction_stored")
    return {name: np.stack([getattr(path, name)[1:] for path in paths], -1) for name in names}


def by_fem(bond: MixedBond, g: np.ndarray, s: np.ndarray) -> dict[str, np.ndarray]:
    """The same, all points of a step at once, what a unit of damage releases, and the tangent (STEPS, PATHS, 2, 2)."""
    names = ("contact", "irreversible", "friction", "viscosity", "pressure_strength", "rubs")
    own = {key: getattr(bond, key) for key in KEYS} if bond.law != "exponential" else {}
    law = MODELLED_MIXED_LAWS[bond.law](
        **{key: getattr(bond, key)[0] for key in ("strength", "toughness", "stiffness")},
        **{f"shear_{key}": getattr(bond, key)[1] for key in ("strength", "toughness", "stiffness")},
        **{key: getattr(bond, key) for key in ("penalty", "criterion", "exponent", "onset", *names)},
        **own,
    )
    d, slip, rows = np.zeros(PATHS), np.zeros(PATHS), []
    for g_q, s_q in zip(g[1:], s[1:], strict=True):
        p, t, tangent, d, slip = law.traction(g_q, s_q, d, slip, 1.0 / STEPS)
        stored, contact, rubbing = law.energies(g_q, s_q, d, slip)
        rows.append({"p": p, "t": t, "d": d, "slip": slip, "stored": stored, "contact": contact})
        rows[-1] |= {"friction_stored": rubbing, "tangent": tangent, "released": law.release(g_q, s_q, d, slip)}
    return {name: np.stack([row[name] for row in rows]) for name in rows[0]}


def by_iga(bond: MixedBond, g: np.ndarray, s: np.ndarray) -> dict[str, np.ndarray]:
    """As `by_fem`."""
    modes = ModeRatio(bond.toughness, bond.strength, bond.slopes, bond.criterion, bond.exponent, bond.onset)
    names = ("contact", "irreversible", "friction", "viscosity", "pressure_strength", "rubs")
    own = {key: getattr(bond, key) for key in KEYS} if bond.law != "exponential" else {}
    law = LAWS[bond.law](modes, bond.penalty, **{key: getattr(bond, key) for key in names}, **own)
    history, rows = law.start(PATHS), []
    for g_q, s_q in zip(g[1:], s[1:], strict=True):
        f_qc, tangent, history = law.respond(np.stack([g_q, s_q], axis=1), history, 1.0 / STEPS)
        slip = np.zeros(PATHS) if history.slip is None else history.slip
        stored = law.stored(g_q, s_q, history)
        rows.append({"p": f_qc[:, 0], "t": f_qc[:, 1], "d": history.d, "slip": slip, "tangent": tangent})
        rows[-1] |= {"stored": stored.cohesion, "contact": stored.contact, "friction_stored": stored.friction}
        (K, Ks), closed = law.stiffness, (g_q < 0.0) & law.contact
        elastic = np.where(closed, 0.0, 0.5 * K * g_q**2) + 0.5 * Ks * s_q**2
        rubs = 0.5 * Ks * law.rubbing(history.d)[1] * (s_q - slip) ** 2 if law.friction else 0.0
        rows[-1]["released"] = elastic - rubs
    return {name: np.stack([row[name] for row in rows]) for name in rows[0]}


@pytest.mark.parametrize("case", CASES, ids=lambda case: "-".join([*case[:3], *case[3]]))
@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.slow) for seed in (1, 2))])
def test_three_codes_have_one_law(case, seed):
    """To 1e-12 of strengths, sizes and toughnesses; tractions and energies of contact to 1e-12 of themselves."""
    rng = np.random.default_rng([seed, CASES.index(case)])
    bond = bond_of(*case, rng)
    g, s = random_paths(bond, rng)
    theory, fem, iga = (code(bond, g, s) for code in (by_theory, by_fem, by_iga))
    assert 0.05 < np.mean(theory["d"] > 0.0) and np.any(theory["d"] < 1.0)
    scale = dict.fromkeys(("stored", "contact", "friction_stored"), sum(bond.toughness))
    scale |= {"d": 1.0, "p": bond.strength[0], "t": bond.strength[1], "slip": bond.toughness[1] / bond.strength[1]}
    for other in (fem, iga):
        for name, unit in scale.items():
            np.testing.assert_allclose(other[name], theory[name], rtol=1e-12, atol=1e-12 * unit, err_msg=name)
    unit = sum(bond.toughness)
    np.testing.assert_allclose(iga["released"], fem["released"], rtol=1e-12, atol=1e-12 * unit, err_msg="released")
    K = np.sqrt(np.outer(bond.slopes, bond.slopes))
    np.testing.assert_allclose(iga["tangent"] / K, fem["tangent"] / K, rtol=1e-9, atol=1e-9, err_msg="tangent")


@pytest.mark.parametrize("irreversible", [True, False])
@pytest.mark.parametrize("contact", [True, False])
@pytest.mark.parametrize("name", KNOWN_LAWS)
def test_three_codes_have_one_law_in_opening(name, contact, irreversible):
    """Tractions, slopes, energies and damage to 1e-12 of strength and toughness, with histories and without; of a bond
    that heals the solvers alone have it."""
    own = {"tabular": {"table": ((0.004, 3.6), (0.01, 4.0), (0.03, 0.8), (0.2, 0.0))}, "trapezoidal": {"plateau": 0.3}}
    theory = KNOWN_LAWS[name](4.0, 0.1, 12.5, 3e3, contact, **own.get(name, {}))
    both = (MODELLED_LAWS[name], LAWS[name].opening)
    fem, iga = (law(4.0, 0.1, 12.5, 3e3, contact, irreversible, **own.get(name, {})) for law in both)
    rng = np.random.default_rng(5)
    g, k = theory.g_open * rng.uniform(-0.4, 1.1, 4000) ** 3, theory.g_open * rng.uniform(0.0, 1.1, 4000) ** 3
    k *= rng.random(4000) < 0.5
    latest = np.maximum(g, k) if irreversible else np.maximum(g, 0.0)
    (p,), ((slope,),) = (one.T for one in iga.respond(g[:, None], History(k))[:2])
    bonded = np.ones(g.size, dtype=bool)
    past, now = (fem.committed(one[:, None], fem.intact(bonded), bonded, 0.0) for one in (k, latest))
    fem_p, fem_slope = (one.ravel() for one in fem.respond(g[:, None], past, bonded, 0.0))
    energies = fem.balance(g[:, None], now)
    known = theory.traction(g, k if irreversible else latest)
    for one, other in ((p, known), (p, fem_p), (iga.damage(k), theory.damage(k))):
        np.testing.assert_allclose(one, other, rtol=1e-12, atol=4e-12)
    np.testing.assert_allclose(slope, fem_slope, rtol=1e-10, atol=1e-12 * theory.stiffness)
    np.testing.assert_allclose(fem.damaged(past, bonded), theory.damage(k), rtol=1e-12, atol=1e-12)
    found = iga.stored(g, History(latest))
    np.testing.assert_allclose(energies, [found.cohesion, found.contact, found.dissipated], rtol=1e-12, atol=1e-13)
    np.testing.assert_allclose(energies[2], irreversible * theory.dissipated(latest), rtol=1e-12, atol=1e-13)
    numbers = (theory.strength, theory.toughness)
    assert iga.pure_modes == (pytest.approx(numbers, rel=1e-13),)
    assert (fem.strength, fem.toughness) == pytest.approx(numbers, rel=1e-13)
    assert fem.ductility == pytest.approx(theory.ductility, rel=1e-13)
    assert name == "exponential" or 2.0 * numbers[1] / numbers[0] / iga.g_max == pytest.approx(theory.ductility)
