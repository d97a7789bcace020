"""Strip and substrate that close again: contact on the bond and beyond it, whatever the penalty and the slave."""

from dataclasses import replace

import numpy as np
import pytest

from iga.mesh.quadrature import gauss
from iga.path.follow import follow
from iga.path.point import Point
from iga.path.solver import Solver
from iga.peel import build
from iga.specimen.bond import between, everywhere
from tests.iga.test_peel import PEEL

#: The crack runs some 20 mm, and then the strip's end is pressed down on what it has left.
BACK = replace(PEEL, bond_length=60.0, opening=(5.0, -0.05), dofs=1000, steps=50)


def points_of(problem):
    specimen = build(problem)
    return specimen, [
        item for item in follow(Solver(specimen.system), problem.opening, problem.steps) if isinstance(item, Point)
    ]


def gaps_everywhere(specimen, point) -> tuple[np.ndarray, np.ndarray]:
    """Gaps at ten points on every side of the strip over the substrate, and where they are."""
    strip, substrate = (body.surface(side) for body, side in zip(specimen.bodies, ("bottom", "top"), strict=True))
    P_AI, law = specimen.system.interface.P_AI, specimen.system.interface.law
    interface = between(strip, substrate, P_AI, law, everywhere(np.arange(strip.sides), gauss(10)))
    over = interface.X_qi[:, 0] < PEEL.substrate_length
    return interface.X_qi[over, 0], interface.contact(point.state.u_d, interface.pairing).g_q[over]


@pytest.mark.parametrize("kinematics", ["finite", "linear"])
def test_the_overhang_stays_on_top_of_the_substrate(kinematics):
    """Pressed down beyond its end, the strip lies on the substrate's corner; without contact it goes through it."""
    found = {}
    for touches in (True, False):
        problem = replace(BACK, opening=(0.5, -0.05), dofs=600, steps=20, kinematics=kinematics, contact=touches)
        specimen, points = points_of(problem)
        x, g = gaps_everywhere(specimen, points[-1])
        assert points[-1].opening == -0.05
        found[touches] = g[x > 105.0].min()
    assert 0.05 * found[False] < found[True] < 0.0, found


def test_where_nothing_closes_nothing_touches_beyond_the_bond():
    """Not a point more than on the bond is looked at, and none where the bond ends with the substrate."""
    counts = {
        opening: build(replace(BACK, opening=opening)).system.interface.points
        for opening in ((5.0,), (5.0, 1.0), (5.0, 0.0), (5.0, -0.05))
    }
    assert counts[5.0,] == counts[5.0, 1.0] == counts[5.0, 0.0] < counts[5.0, -0.05]
    for keys in ({"opening": (5.0,)}, {"bond_length": 120.0}, {"contact": False}):
        assert build(replace(BACK, **keys)).system.interface.all_bonded


@pytest.mark.slow
def test_points_that_only_touch_are_broken_from_the_start():
    """Whatever they go through they carry pressure alone, and their history stays that of a failed point."""
    specimen, points = points_of(BACK)
    law = specimen.system.interface.law
    loose_q = ~specimen.system.interface.bonded_q
    X_q = specimen.system.interface.X_qi[:, 0]
    assert np.array_equal(loose_q, X_q > BACK.bond_length) and X_q.max() < BACK.substrate_length
    area = specimen.system.interface.dA_q
    assert area[loose_q].sum() == pytest.approx(60.0) and area[~loose_q].sum() == pytest.approx(60.0)
    for point in points:
        assert np.all(point.state.k_q[loose_q] == law.unbonded) and np.all(point.response.p_q[loose_q] <= 0.0)
    assert np.any(points[-1].response.p_q[loose_q] < 0.0)
