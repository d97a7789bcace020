"""Controls: value and gradient, and that the path does not depend on which one is prescribed."""

from dataclasses import replace

import numpy as np
import pytest
from bent_specimens import bond, mixed_bending
from specimens import PAPER, E

from iga.dcb import build
from iga.delamination import solution
from iga.path.control import (
    Prescribed,
    arc_length_control,
    dissipation_control,
    gap_control,
    load_control,
    opening_control,
)
from iga.path.follow import follow
from iga.path.newton import equilibrium
from iga.path.point import Point
from iga.path.solver import Solver
from iga.system.system import respond

CZM1 = replace(PAPER, dofs=400)
NAMES = ("opening", "load", "gap", "dissipation", "arc length")


def front(point):
    """The point that has gone furthest of those that still soften."""
    return int(np.argmax(np.where(point.tangent.growing_q, point.response.x_q, -np.inf)))


def control(name, system, start):
    """A control as it would be prescribed of a step from ``start``."""
    return {
        "opening": lambda: opening_control(system),
        "load": lambda: load_control(system),
        "gap": lambda: gap_control(system, front(start)),
        "dissipation": lambda: dissipation_control(system),
        "arc length": lambda: arc_length_control(system, start.response, start.tangent.du_d),
    }[name]()


BRANCHES = {
    "opens, linear": lambda: build(replace(CZM1, kinematics="linear")).system,
    "opens, finite": lambda: build(CZM1).system,
    **{
        f"slides, {kinematics}, friction {friction}": lambda kinematics=kinematics, friction=friction: (
            solution.build(
                mixed_bending(kinematics=kinematics, bond=bond(friction=friction), opening=(5.8,), dofs=600)
            ).system
        )
        for kinematics, friction in (("linear", 0.0), ("finite", 0.0), ("finite", 0.4))
    },
}


@pytest.fixture(scope="module", params=BRANCHES)
def branch(request):
    """System and two successive points on the softening branch, damage growing at several points.

    They are near to one another: the curve falls in waves, and further on it comes by the same load again.
    """
    system = BRANCHES[request.param]()
    slides = system.interface.slides
    points = [
        p for p in follow(Solver(system), (5.8 if slides else 1.0,), 40 if slides else 80) if isinstance(p, Point)
    ]
    if slides:
        pairs = zip(points[-2::-1], points[:0:-1], strict=True)
        return next((system, a, b) for a, b in pairs if np.count_nonzero(b.state.k_q > a.state.k_q) >= 2)
    peak = int(np.argmax([p.state.load for p in points]))
    start, end = next(
        (a, b)
        for a, b in zip(points[peak:-1], points[peak + 1 :], strict=True)
        if a.heading > 0.0 > a.slope
        and np.sum(a.tangent.growing_q) >= 2
        and np.array_equal(a.tangent.growing_q, b.tangent.growing_q)
    )
    return system, start, end


@pytest.mark.parametrize("name", NAMES)
def test_gradients_are_those_of_the_values(branch, name, rng):
    """Central differences along random directions, at a damaged state with points that soften, unload and touch."""
    system, start, end = branch
    trial = replace(end.state, k_q=start.state.k_q, slip_q=start.state.slip_q)
    asked, response = control(name, system, start), respond(system, trial, decide=False)
    _, a_d, a_load = asked(trial, response)
    assert np.sum(response.k_q > start.state.k_q) >= 2, "nothing to be learnt from this state"
    for v_load in (1e6 if system.interface.slides else 1.0) * rng.standard_normal(5):  # as forces are to displacements
        v_d, s = rng.standard_normal(system.n_dof), 1e-9
        ahead, behind = (replace(trial, u_d=trial.u_d + h * v_d, load=trial.load + h * v_load) for h in (s, -s))
        values = [asked(moved, respond(system, moved, decide=False))[0] for moved in (ahead, behind)]
        scale = np.abs(a_d) @ np.abs(v_d) + abs(a_load * v_load)
        rounding = np.spacing(np.max(np.abs(values))) / s  # an opening of 5 is known to 1e-15
        slope, expected = (values[0] - values[1]) / (2.0 * s), a_d @ v_d + a_load * v_load
        assert slope == pytest.approx(expected, abs=1e-6 * scale + rounding), name


#: How far apart two solutions may lie: in finite kinematics the last step is quadratic and leaves nothing; in linear
#: kinematics the predictor is a solution as it is, and what the tolerance on the residual allows remains.
SAME = {"linear": 1e-8, "finite": 1e-9}


@pytest.mark.parametrize("name", NAMES)
def test_every_control_leads_to_the_same_next_point(branch, name):
    system, start, end = branch
    if system.interface.slides:
        return
    asked, path, same = control(name, system, start), start.tangent, SAME["linear" if system.linear else "finite"]
    before, a_d, a_load = asked(start.state, respond(system, start.state, decide=False))
    there = replace(end.state, k_q=start.state.k_q)
    target = asked(there, respond(system, there, decide=False))[0]
    away = (target - before) / (a_d @ path.du_d + a_load * path.d_load)
    trial = replace(start.state, u_d=start.state.u_d + away * path.du_d, load=start.state.load + away * path.d_load)
    found = equilibrium(Solver(system), trial, Prescribed(asked, target, target - before))
    assert found is not None
    size = np.linalg.norm(end.state.u_d)
    assert np.linalg.norm(end.state.u_d - start.state.u_d) > 0.01 * size, "no step at all"
    difference = np.linalg.norm(found.state.u_d - end.state.u_d) / size
    print(f"{name}: {difference:.1e}, load {found.state.load / end.state.load - 1.0:.1e}")
    assert difference < same and found.state.load == pytest.approx(end.state.load, rel=same)
    assert np.allclose(found.response.k_q, end.state.k_q, rtol=0.0, atol=10.0 * same * end.state.k_q.max())


@pytest.mark.parametrize("name", ["dissipation", "arc length"])
def test_points_that_are_broken_count_for_nothing(branch, name):
    """Points up to the middle of those that soften taken for broken: the gradient is blind to them and no others."""
    system, start, end = branch
    growing = np.flatnonzero((end.state.k_q > start.state.k_q) & (end.state.k_q > system.interface.law.begun))
    broken_q = np.arange(system.interface.points) < growing[growing.size // 2]
    past = replace(start.state, k_q=np.where(broken_q, system.interface.law.failed, start.state.k_q))
    half = replace(start, state=past, response=respond(system, past, decide=False))
    state = replace(end.state, k_q=past.k_q)
    _, a_d, _ = control(name, system, half)(state, respond(system, state, decide=False))
    alone_d = end.response.x_rows.gradients(np.flatnonzero(broken_q), system.n_dof).any(axis=1)
    alone_d &= ~end.response.x_rows.gradients(np.flatnonzero(~broken_q), system.n_dof).any(axis=1)
    assert alone_d.any() and not a_d[alone_d].any() and a_d.any()


def curve(problem):
    points = [p for p in follow(Solver(build(problem).system), problem.opening, 60) if isinstance(p, Point)]
    return np.array([(p.opening, p.state.load, p.slope, p.external_work) for p in points])


def test_the_path_is_the_same_in_other_units():
    """Snap-backs and all, point by point: millimetres become metres, newtons kilonewtons."""
    m, kN = 1e-3, 1e-3
    problem = replace(CZM1, strength=6.0, dofs=280, opening=(0.9,), basis="lagrange")
    other = replace(
        problem,
        length=14 * m,
        arm_thickness=0.2 * m,
        precrack=4 * m,
        width=m,
        E1=E * kN / m**2,
        E2=E * kN / m**2,
        G12=problem.G12 * kN / m**2,
        strength=6.0 * kN / m**2,
        toughness=0.1 * kN / m,
        penalty=1e5 * kN / m**3,
        opening=(0.9 * m,),
    )
    first, second = curve(problem), curve(other) / np.array([m, kN, kN / m, kN * m])
    assert np.any(np.diff(first[:, 0]) < 0.0) and len(first) == len(second)
    size = np.abs(first).max(0)
    print(f"units: largest change {np.max(np.abs(second - first) / size, axis=0)}")
    assert np.all(np.abs(second - first)[:, [0, 1, 3]] < 1e-9 * size[[0, 1, 3]])
    assert np.allclose(second[:, 2], first[:, 2], rtol=1e-6)
