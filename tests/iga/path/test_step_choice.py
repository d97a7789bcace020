"""How many steps draw a curve: few points and their slopes against many."""

from dataclasses import replace

import numpy as np
import pytest
from paths import BOTH, CZM1, column, curve, decided, loads, run

from iga.dcb import build
from iga.path.follow import follow
from iga.path.solver import DEFAULT, Solver

#: Basis, strength, unknowns: neighbouring meshes, whose quadrature points break elsewhere along the curve.
MANY_ARCS = [
    ("nurbs", 4.0, 1900),
    ("nurbs", 4.0, 1956),
    ("nurbs", 4.0, 2040),
    ("nurbs", 6.0, 1956),
    ("tspline", 4.0, 1956),
]


@pytest.mark.slow
@pytest.mark.parametrize(("basis", "strength", "dofs"), MANY_ARCS)
def test_steps_chosen_by_accuracy_are_few_and_draw_the_curve(basis, strength, dofs):
    problem = replace(CZM1, basis=basis, strength=strength, dofs=dofs)
    (_, few, end), (_, many, _) = run(problem, None), run(problem, 150)
    opening = np.linspace(0.0, 3.0, 401)[1:]
    reference = np.interp(opening, column(many, "opening"), loads(many))
    error = float(np.linalg.norm(curve(few, opening) - reference) / np.linalg.norm(reference))
    print(f"{len(few) - 1} steps instead of {len(many) - 1}: curve within {error:.2e}")
    assert end.status == "complete" and len(few) - 1 <= 40 and error < 1e-3


@pytest.mark.parametrize(("basis", "kinematics"), BOTH)
def test_steps_chosen_by_accuracy_end_in_balance(basis, kinematics):
    system, points, end = run(replace(CZM1, basis=basis, kinematics=kinematics, dofs=800), None)
    residuals = [decided(system, a, b) for a, b in zip(points[:-1], points[1:], strict=True)]
    print(f"{basis}, {kinematics}: residual with contact by the signs of the gaps {max(residuals):.1e}")
    assert end.status == "complete" and max(residuals) <= DEFAULT.settle


def test_the_further_steps_may_leave_their_tangents_the_fewer_there_are():
    system = build(replace(CZM1, dofs=800, interface_points=4)).system
    taken = []
    for bend in (0.003, 0.03):
        *points, end = follow(Solver(system), (2.0,), None, tolerance=bend)
        away = [
            abs(b.state.load - a.state.load - a.slope * (b.opening - a.opening))
            for a, b in zip(points, points[1:], strict=False)
        ]
        peak = max(loads(points))
        assert end.status == "complete" and np.median(away) < bend * peak
        taken.append(len(points) - 1)
    print(f"{taken} steps")
    assert taken[1] < 0.7 * taken[0]
