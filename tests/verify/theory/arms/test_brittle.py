"""Fracture mechanics of two arms: closed forms of the specimens, and G as the derivative of the compliance."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from tests.verify.theory.arms import specimens as of
from tests.verify.theory.arms.specimens import ARM, ENF, WIDTH, L, mmb, moments
from verify.methods.problems import arms_problem
from verify.scene.effects import simulated
from verify.scene.load import load_scene
from verify.support.refusal import Refusal
from verify.theory.arms.brittle import growth, releases, solve, stability
from verify.theory.arms.interface import extra_lengths
from verify.theory.arms.problem import Arm, ArmsProblem, Load, Support
from verify.theory.mixed_law import MixedBond

E, H = ARM.young, ARM.thickness
D_I, D_II = extra_lengths(ARM)
UNIT = 16.0 * WIDTH**2 * E * H**3


def g_of_mmb(c: float, a: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """ASTM D6671 (Reeder and Crews 1990)."""
    return 12 * ((3 * c - L) * (a + D_I) / L) ** 2 / UNIT, 9 * ((c + L) * (a + D_II) / L) ** 2 / UNIT


CLOSED_FORMS = {
    "enf": (ENF, lambda a: (0 * a, 9 * (a + D_II) ** 2 / UNIT)),
    "slb": (of.SLB, lambda a: (12 * (a + D_I) ** 2 / UNIT, 9 * (a + D_II) ** 2 / UNIT)),
    "4enf": (of.FOUR_POINT, lambda a: (0 * a, 9 * 30.0**2 / UNIT + 0 * a)),
    "els": (of.ELS, lambda a: (0 * a, 36 * (a + D_II) ** 2 / UNIT)),
    "dcb": (of.DCB, lambda a: (192 * (a + D_I) ** 2 / UNIT, 0 * a)),
    "mmb": (mmb(44.4), lambda a: g_of_mmb(44.4, a)),
    "moments I": (moments(1.0, -1.0), lambda a: (192 / UNIT + 0 * a, 0 * a)),
    "moments II": (moments(1.0, 1.0), lambda a: (0 * a, 144 / UNIT + 0 * a)),
    "moments": (moments(1.0, 0.0), lambda a: (48 / UNIT + 0 * a, 36 / UNIT + 0 * a)),
}


@pytest.mark.parametrize(
    "kind",  # of ENF it is the sliding part of SLB, and of four-point bending the plateau below
    [pytest.param(kind, marks=pytest.mark.slow if kind in ("enf", "4enf") else ()) for kind in CLOSED_FORMS],
)
def test_g_is_the_closed_form_away_from_loads(kind):
    """What is left: boundary layers that overlap, and rollers that are no points."""
    problem, closed = CLOSED_FORMS[kind]
    found = releases(replace(problem, points=40))
    a = found.tip
    kept = (a < a[0] + 4.0) & (a < L - 6.0) | (kind in ("els", "dcb") or "moments" in kind) & (a < 2 * L - 12.0)
    G_I, G_II = (np.asarray(part)[kept] for part in closed(a))
    total = (G_I + G_II).max()
    assert kept.sum() > 2
    assert found.G_I[kept] == pytest.approx(G_I, rel=6e-3, abs=1e-4 * total)
    assert found.G_II[kept] == pytest.approx(G_II, rel=6e-3, abs=1e-4 * total)


UNEQUAL = Arm(2.4, 70e3, 70e3, 26e3)


@pytest.mark.parametrize(("problem", "lower"), [(of.SLB, ARM), (of.SLB, UNEQUAL), (ENF, UNEQUAL), (of.DCB, UNEQUAL)])
def test_g_is_the_rate_of_the_compliance(problem, lower):
    """dC/da = 2 b G, of equal and unequal arms, before the crack is below the load."""
    found = releases(replace(problem, bodies=(ARM, lower), points=40))
    rate = CubicSpline(found.tip, found.compliance)(found.tip, 1)
    kept = (found.tip > problem.bonded[0] + 4.0) & (found.tip < L - 6.0)
    assert 2.0 * WIDTH * (found.G_I + found.G_II)[kept] == pytest.approx(rate[kept], rel=1e-3)


def test_moments_of_unequal_arms_release_what_beam_theory_says():
    """J = sum M^2 / (2 E I b) of the arms less that of both together, whatever its parts."""
    found = releases(replace(moments(1.0, 0.5), bodies=(ARM, UNEQUAL), points=60))
    (h1, h2), (E1, E2) = ((arm.thickness for arm in (ARM, UNEQUAL)), (arm.young for arm in (ARM, UNEQUAL)))
    middle = (E1 * h1 * h1 / 2 - E2 * h2 * h2 / 2) / (E1 * h1 + E2 * h2)
    whole = E1 * h1**3 / 12 + E1 * h1 * (h1 / 2 - middle) ** 2 + E2 * h2**3 / 12 + E2 * h2 * (h2 / 2 + middle) ** 2
    J = 12 / (E1 * h1**3) + 12 * 0.25 / (E2 * h2**3) - 1.5**2 / whole
    near = slice(0, len(found.tip) // 2)
    assert (found.G_I + found.G_II)[near] == pytest.approx(J / (2 * WIDTH**2), rel=4e-6)


@pytest.mark.parametrize(("lever", "load"), [(92.9, 126.6), (41.3, 379.0), (27.3, 725.2)])
def test_critical_loads_of_mixed_mode_bending_of_im7_8552(lever, load):
    """Krueger (2012), NASA/CR-2012-217562, by the beam theory of ASTM D6671; his plane model: 128.5, 385, 751 N."""
    arm, half = Arm(2.25, 161e3, 11380.0, 5200.0), 50.4
    law = MixedBond("bilinear", (60.0, 90.0), (0.212, 0.774), (1e5, 1e5), 1e5, "bk", 2.1)
    loads = Load(0, "top", lever / half, (0.0, 0.0)), Load(0, "top", -(lever + half) / half, (half, half))
    supports = Support(1, "bottom", (0.0, 0.0)), Support(1, "bottom", (2 * half, 2 * half))
    problem = ArmsProblem(
        (arm, arm), (2 * half, 2 * half), (25.4, 2 * half), 25.4, loads, supports, law, 1.0, 60.0, points=8
    )
    assert growth(problem, releases(problem)).load[0] == pytest.approx(load, rel=2e-3)


@pytest.mark.parametrize(
    ("problem", "critical"),
    [(ENF, 3 ** (-1 / 3)), (of.SLB, 7 ** (-1 / 3))],
    ids=["enf", "slb"],
)
def test_a_bending_test_is_stable_beyond_a_part_of_half_its_span(problem, critical):
    """ENF from a = 0.693 L on, SLB from 0.523 L, less about the extra crack lengths D_II and D_I."""
    for tip, stable in ((0.3 * L, False), (0.8 * L, True)):
        found = stability(replace(problem, bonded=(tip, 2 * L), points=30))
        assert found.stable is stable
        assert found.changes[0] == pytest.approx(critical * L - 0.5 * D_I, abs=0.8)


def test_four_point_bending_has_a_plateau():
    """P = 4 b / (3 d) sqrt(E h^3 G_IIc), stable and free of the crack length between the loads."""
    problem = replace(of.FOUR_POINT, points=24)
    rows = solve(problem).rows
    plateau = 4 * WIDTH / (3 * 30.0) * np.sqrt(E * H**3 * 1.719)
    grown = [row["load"] for row in rows if 41.0 < row["crack_length"] < 60.0]
    assert len(grown) > 10 and np.array(grown) == pytest.approx(plateau, rel=2e-3)
    assert stability(problem).stable


def test_the_curve_of_a_crack_that_snaps_back():
    """The deflection falls and rises again; the rows end at the last one, and nothing is lost on the way."""
    rows = solve(replace(ENF, bonded=(20.0, 2 * L), opening=5.5, points=40)).rows
    opening, load = (np.array([row[name] for row in rows]) for name in ("opening", "load"))
    onset = int(load.argmax())
    assert opening[onset:].min() < 0.82 * opening[onset] and opening[-1] == pytest.approx(5.5)
    lost = np.array([row["dissipated_energy"] for row in rows])
    work = np.concatenate(([0.0], np.cumsum(0.5 * (load[1:] + load[:-1]) * np.diff(opening))))
    stored = np.array([row["stored_energy"] for row in rows])
    assert np.abs(work - stored - lost).max() < 2e-3 * lost[-1]


def test_loads_that_nothing_takes_are_refused():
    with pytest.raises(Refusal, match="balance"):
        releases(replace(ENF, supports=of.BELOW[:1]))


def test_faces_that_hardly_touch_come_to_rest():
    """Of a glass laminate in mixed mode: faces lie on each other along the crack, nearly without a force."""
    scene = load_scene("plain-8")
    assert len(releases(replace(arms_problem(scene, simulated(scene), 1), points=20)).tip) == 20
