"""Strip and substrate that close again: contact on the bond and beyond it, whatever the penalty and the slave."""

from dataclasses import replace

import numpy as np
import pytest

from iga.mesh.quadrature import gauss
from iga.path.follow import follow
from iga.path.point import Point
from iga.path.solver import Solver
from iga.peel import build, solve
from iga.specimen.bond import between, everywhere
from tests.iga.test_peel import PEEL, column

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
def test_points_that_only_touch_have_no_history():
    specimen, points = points_of(BACK)
    loose_q = ~specimen.system.interface.bonded_q
    X_q = specimen.system.interface.X_qi[:, 0]
    assert np.array_equal(loose_q, X_q > BACK.bond_length) and X_q.max() < BACK.substrate_length
    area = specimen.system.interface.dA_q
    assert area[loose_q].sum() == pytest.approx(60.0) and area[~loose_q].sum() == pytest.approx(60.0)
    for point in points:
        assert np.all(point.state.k_q[loose_q] == 0.0) and np.all(point.response.p_q[loose_q] <= 0.0)
    assert np.any(points[-1].response.p_q[loose_q] < 0.0)


@pytest.mark.slow
@pytest.mark.parametrize(("basis", "dofs"), [("tspline", 2600), ("nurbs", 2600), ("lagrange", 7000)])
def test_slave_and_master_exchanged(basis, dofs):
    """Opening, unloading, indentation on meshes 1 : 1.37; Lagrange elements resolve the zone with more unknowns."""
    loads = []
    for slave in ("upper", "lower"):
        solution = solve(replace(BACK, basis=basis, dofs=dofs, slave=slave, mismatch=1.37))
        assert solution.status == "complete"
        opening, load = column(solution, "opening"), column(solution, "load")
        top = int(np.argmax(opening))
        up, down = opening[: top + 1], opening[top:]
        grid = np.linspace(0.05, 5.0, 100)
        loads.append(
            np.concatenate(
                [np.interp(grid, up, load[: top + 1]), np.interp(grid, down[::-1], load[top:][::-1]), load[-1:]]
            )
        )
    error = np.linalg.norm(loads[0] - loads[1]) / np.linalg.norm(loads[1])
    print(f"{basis}: slave exchanged {error:.2e}, pressed {loads[0][-1]:.5f} {loads[1][-1]:.5f}")
    assert error < 0.005 and abs(loads[0][-1] / loads[1][-1] - 1.0) < 0.02


@pytest.mark.slow
@pytest.mark.parametrize("slave", ["upper", "lower"])
def test_penalties_from_soft_to_hard(slave):
    """The curve settles, what penetrates is the pressure over the penalty, and energy is closed."""
    pressed = {}
    for penalty in (1e3, 1e4, 1e5, 1e6):
        problem = replace(BACK, penalty=penalty, slave=slave)
        specimen, points = points_of(problem)
        end, touch = points[-1], points[-1].response.contact
        assert end.opening == -0.05
        closed = touch.g_q < 0.0
        assert np.allclose(end.response.p_q[closed], penalty * touch.g_q[closed] * touch.share_q[closed], rtol=1e-12)
        assert -touch.g_q.min() < 30.0 / penalty
        work = max(point.external_work for point in points)
        assert abs(end.external_work - end.energies.total) < 2e-3 * work
        pressed[penalty] = end.state.load
    loads = np.array(list(pressed.values()))
    print(f"{slave}: pressed {loads}")
    steps = np.abs(np.diff(loads) / loads[-1])
    assert np.all(loads < 0.0) and np.all(steps[1:] < 0.25 * steps[:-1]) and steps[-1] < 0.001


@pytest.mark.slow
def test_reversal_unloads_to_the_origin_and_meets_the_envelope_again():
    """[4, 0, 5] against [5]: secant unloading, contact at zero, and damage goes on where it was."""
    straight = solve(replace(BACK, opening=(5.0,)))
    back = solve(replace(BACK, opening=(4.0, 0.0, 5.0), steps=90))
    assert straight.status == back.status == "complete"
    turn = next(i for i, row in enumerate(back.rows) if row["opening"] == 0.0 and i > 0)
    assert abs(back.rows[turn]["load"]) < 1e-3 * column(back, "load").max()
    assert back.rows[turn]["dissipated_energy"] == pytest.approx(back.rows[turn - 1]["dissipated_energy"], rel=1e-12)
    assert back.rows[-1]["load"] == pytest.approx(straight.rows[-1]["load"], rel=1e-4)
    assert back.rows[-1]["dissipated_energy"] == pytest.approx(straight.rows[-1]["dissipated_energy"], rel=1e-3)
