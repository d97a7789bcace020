"""Steps that end at a kink of the law: where they end, and which slope they tell there."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from specimens import PAPER

from iga.dcb import build
from iga.path.control import Prescribed, gap_control
from iga.path.follow import follow
from iga.path.kinks import SEVERAL, broken_between, run_to, slope_over_arcs
from iga.path.newton import equilibrium
from iga.path.point import End
from iga.path.solver import Solver

CZM1 = replace(PAPER, opening=(1.2,), dofs=1956, steps=None)


#: Half the change of the gap, in parts of the kink, over which one-sided slopes are taken.
NEAR = 1e-5


@pytest.fixture(scope="module")
def path():
    """System, steps (start, end) of a path that chooses them itself, and how it ended."""
    system = build(CZM1).system
    *points, end = follow(Solver(system), CZM1.opening, None)
    return system, list(zip(points[:-1], points[1:], strict=True)), end


def kink_of(law, start, end):
    """The point of the interface at which a step has ended on a kink, and the gap there; None where it has not."""
    g_q = end.response.contact.g_q
    for kink in (law.g_u, law.g_max):
        at_q = (np.abs(g_q / kink - 1.0) < 1e-8) & (start.state.k_q < kink)
        if np.any(at_q):
            return int(np.flatnonzero(at_q)[0]), kink
    return None


def one_sided(system, start, end, q, kink):
    """Slope and rate of the opening, before and after the kink: difference quotients of second order (2, 2)."""
    trial = replace(end.state, k_q=start.state.k_q)
    g, found = float(end.response.contact.g_q[q]), {}
    for part in (-2, -1, 0, 1, 2):
        target = kink * (1.0 + part * NEAR)
        near = equilibrium(Solver(system), trial, Prescribed(gap_control(system, q), target, target - g))
        found[part] = np.array([system.load_d @ near.state.u_d, near.state.load])
    sides = []
    for side in (-1, 1):
        near, far = found[side] - found[0], found[2 * side] - found[0]
        d_opening, d_load = side * (2.0 * near - 0.5 * far)  # for the change NEAR of the gap
        sides.append((d_load / d_opening, d_opening))
    return np.array(sides)


@pytest.fixture(scope="module")
def kinks(path):
    """Start and end of every step with a kink, and the exact slopes and directions of the opening before and after."""
    system, steps, _ = path
    law = system.interface.law
    found = [(start, end, kink_of(law, start, end)) for start, end in steps]
    return [(start, end, one_sided(system, start, end, *kink)) for start, end, kink in found if kink is not None]


def over_arcs(system, start, end):
    """Whether several points break on a step that follows on one on which any did."""
    return start.before is not None and broken_between(system, start.state, end.state) >= SEVERAL


def test_a_step_in_which_a_point_breaks_ends_where_one_does_or_at_the_mean_of_the_next_arc(path):
    """To 1e-8 of its gap; only the last step ends on its goal. No step was taken back, so that none was careful.

    That part of an arc, 0.21, is measured where Newton first arrives: between a tenth and a third of it.
    """
    system, steps, end = path
    law = system.interface.law
    assert end == End("complete", 0)
    breaking = [(a, b) for a, b in steps[:-1] if np.any((b.state.k_q >= law.g_u) & (a.state.k_q < law.g_u))]
    assert len(breaking) > 5
    for start, there in breaking:
        if over_arcs(system, start, there):
            g_q = np.sort(there.response.contact.g_q)
            last = int(np.searchsorted(g_q, law.g_u))
            assert 0.1 < (g_q[last] - law.g_u) / (g_q[last + 1] - g_q[last]) < 0.35
            continue
        q, kink = kink_of(law, start, there)
        assert kink == law.g_u and start.state.k_q[q] < law.g_u <= there.state.k_q[q]


def test_the_slope_at_a_kink_is_the_mean_of_those_before_and_after(path, kinks):
    """Of a step that goes along one arc; those over several ones see `test_over_several_arcs_...`."""
    alone = [(end.slope, sides[:, 0]) for start, end, sides in kinks if not over_arcs(path[0], start, end)]
    same = [(slope, *sides) for slope, sides in alone if np.prod(sides) > 0.0]
    jumps = [abs(after - before) / max(abs(before), abs(after)) for _, before, after in same]
    errors = [abs(slope - 0.5 * (a + b)) / max(abs(a), abs(b)) for slope, a, b in same]
    print(f"{len(same)} kinks, slopes jump by up to {max(jumps):.2f}, mean met within {max(errors):.1e}")
    assert len(same) > 5 and max(jumps) > 0.3, "no kink worth the name"
    assert max(errors) < 1e-5


def test_the_slope_over_arcs_is_exact_on_a_parabola(rng):
    """Over unequal steps, and third order in the opening where the curve is none: the error falls by four, not two."""
    for x in np.sort(rng.uniform(size=(5, 3)), axis=1):
        places = [(float(v), float(2.0 - 3.0 * v + 0.7 * v * v)) for v in x]
        assert slope_over_arcs(*places) == pytest.approx(-3.0 + 1.4 * x[2], rel=1e-9)
    errors = [slope_over_arcs(*((v, v**-0.5) for v in (1.0 - 2.0 * h, 1.0 - h, 1.0))) + 0.5 for h in (0.1, 0.05, 0.025)]
    assert errors[0] / errors[1] > 3.5 and errors[1] / errors[2] > 3.7
    assert errors[2] == pytest.approx(0.025**2 / 3.0 * 15.0 / 8.0, rel=0.1)


@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize("turn", [0.0, 2.1])
def test_gaps_travel_with_the_crack(way, turn, rng):
    """The profile of a crack that has run on is the same one elsewhere, in whatever order and place the points are."""
    s_q = np.sort(rng.uniform(0.0, 3.0, 200))[:: int(way)]
    X_qi = np.stack([np.cos(turn) * s_q, np.sin(turn) * s_q], -1)
    touching = SimpleNamespace(X_qi=X_qi)

    def profile(s):
        return 2.0 - s if way > 0 else s - 1.0

    q, target = 90, profile(s_q[90]) + 0.4
    moved_q = run_to(touching, profile(s_q), q, target).travelled(profile(s_q))
    inside = (moved_q < profile(s_q).max()) & (moved_q > profile(s_q).min() + 0.4)
    assert np.count_nonzero(inside) > 100
    assert moved_q[inside] == pytest.approx(profile(s_q[inside]) + 0.4, abs=1e-12)
    assert moved_q[q] == pytest.approx(target, abs=1e-12)
    assert run_to(touching, profile(s_q), q, profile(s_q).max() + 1.0) is None, "nowhere as open as that"
    assert run_to(touching, profile(s_q), q, profile(s_q)[q] - 0.1) is None, "it closes"
