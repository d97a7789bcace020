"""Gap and slip of the bonded faces: derivatives, and motions that open and slide nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.verify.theory.arms.quotients import derivative
from tests.verify.theory.arms.specimens import DCB, ENF, of_scene
from verify.theory.arms.faces import Faces, Raised, Rigid, Turned, faces_of
from verify.theory.arms.sections import sections

FACES: dict[str, Faces] = {
    "turned": Turned(np.eye(4), np.zeros((4, 4))),
    "rigid": Rigid(np.eye(6), np.zeros((6, 6)), (1.4, 0.9)),
    "raised": Raised(np.eye(2), np.zeros((2, 2)), 1.4),
    "small": Faces(np.eye(2), np.zeros((2, 2))),
}


@pytest.mark.parametrize("name", FACES)
def test_derivatives_are_those_of_difference_quotients(name):
    one = FACES[name]
    y = 0.5 * np.random.default_rng(2).normal(size=(20, len(one.values)))
    found = one.jump(y)
    assert found.first == pytest.approx(derivative(lambda at: one.jump(at).value, y), rel=1e-7, abs=1e-7)
    second = derivative(lambda at: one.jump(at).first, y)
    assert np.abs(second - (0.0 if found.second is None else found.second)).max() < 1e-7


@pytest.mark.parametrize("angle", [0.4, -1.1, 2.0])
def test_gap_and_slip_turn_with_the_faces(angle):
    """Arms that turn as one and are apart by (g, s) in their own axes, at whatever angle."""
    g, s, h = 0.3, -0.2, (1.4, 0.9)
    c, sin = np.cos(angle), np.sin(angle)
    J = np.array([s * c - g * sin, s * sin + g * c])
    turned = FACES["turned"].jump(np.array([*J, 1.7 * c - 1.0, 1.7 * sin]))
    middle = np.array([0.5 * sum(h) * -sin, 0.5 * sum(h) * (c - 1.0)])  # of two middles that are h1/2 + h2/2 apart
    rigid = FACES["rigid"].jump(np.array([*(J + middle), angle, 0.0, 0.0, angle]))
    assert turned.value == pytest.approx([g, s]) and rigid.value == pytest.approx([g, s])
    raised = FACES["raised"].jump(np.array([g, angle])).value
    assert raised == pytest.approx([g + 0.7 * (1.0 - c)])


@pytest.mark.parametrize(
    ("problem", "kind"),
    [
        (ENF, Faces),
        (replace(ENF, order=3), Faces),
        (replace(ENF, kinematics="finite"), Rigid),
        (replace(ENF, order=3, kinematics="finite"), Turned),
        (of_scene("dcb-czm1", "effects.kinematics='finite'"), Faces),
        (of_scene("peel-60", order=1), Raised),
        (of_scene("peel-60", order=3), Faces),
    ],
)
def test_faces_of_a_problem(problem, kind):
    found = faces_of(problem, sections(problem))  # type: ignore[arg-type]
    assert type(found) is kind and found.turns == (kind is Turned)


@pytest.mark.parametrize("order", [1, 3])
def test_arms_that_move_as_one_keep_their_faces_together(order):
    problem = replace(DCB, order=order)
    parts = sections(problem)
    faces = faces_of(problem, parts)
    for motion in range(3):
        columns = [part.rigid[:, motion] - (part.middle * part.rigid[:, 0] if motion == 2 else 0.0) for part in parts]
        assert np.abs(faces.values @ np.concatenate(columns)).max() < 1e-12
