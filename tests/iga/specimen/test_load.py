"""The functional of the load: the mean of a face, its corner, or its middle, wherever the specimen lies."""

import numpy as np
import pytest

from iga.dcb import Problem, build
from iga.specimen.bond import control_points
from iga.specimen.specimen import pulled_row

PLACES = {"face": 0.5, "node": 1.0, "hinge": 0.5}


@pytest.mark.parametrize("basis", ["nurbs", "tspline", "lagrange"])
@pytest.mark.parametrize("at", PLACES)
def test_a_row_is_the_displacement_of_its_place(basis, at):
    """Of any linear field, along and across, turned and moved; on both arms."""
    problem = Problem(
        length=6.0, arm_thickness=0.5, precrack=2.0, E1=100.0, E2=100.0, G12=40.0, nu12=0.2, strength=1.0,
        toughness=0.1, penalty=100.0, ductility=5.0, opening=(1.0,), basis=basis, dofs=300, load_at=at,
        angle=30.0, shift=(2.0, 1.0),
    )  # fmt: skip
    specimen = build(problem)
    pose, P_AI = specimen.pose, control_points(specimen.bodies)
    field = np.array([[0.3, -0.2], [0.5, 0.7]])
    for arm, sign in zip(specimen.bodies, (1.0, -1.0), strict=True):
        place = pose.place(np.array([0.0, sign * PLACES[at] * 0.5]))
        for axis in (0, 1):
            row = pulled_row(arm, "left", at, pose, axis, P_AI.size)
            assert row @ (P_AI @ field.T).ravel() == pytest.approx(pose.axes_kI[axis] @ field @ place, abs=1e-12)
    # the lever of the load is that of its place
    turn = np.array([[0.0, -1.0], [1.0, 0.0]])
    about = pose.place(np.zeros(2))
    u_d = ((P_AI - about) @ turn.T).ravel()
    assert specimen.face_row @ u_d == pytest.approx(-PLACES[at] * 0.5, abs=1e-12)
