"""The input: what is refused, and the stiffness of the sheet."""

import numpy as np
import pytest

from fem_reference.dcb import Problem
from fem_reference.material import in_plane_stiffness

DCB = dict(
    length=14.0,
    arm_thickness=0.2,
    precrack=4.0,
    E1=120e3,
    E2=120e3,
    G12=50e3,
    nu12=0.2,
    strength=4.0,
    toughness=0.1,
    ductility=12.5,
)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"symmetry": True}, "symmetry"),
        ({"precrack": 15.0}, "precrack: must be < length = 14.0, got 15.0"),
        ({"strength": -4.0}, "strength: must be > 0, got -4.0"),
        ({"ductility": 1.0}, "ductility: must be > 1"),
        ({"degree": 5}, "degree: must be one of 1, 2, 3, 4, got 5"),
        ({"kinematics": "auto"}, "kinematics: must be one of linear, finite"),
        ({"opening": (0.0,)}, "opening"),
        ({"elements": 1}, "elements: must be >= 2"),
        ({"nu12": 1.5}, "negative energy"),
    ],
)
def test_impossible_problems_are_refused_with_key_and_value(change, words):
    with pytest.raises(ValueError, match=words):
        Problem(**(DCB | change))


def test_isotropic_sheet_has_the_textbook_matrices():
    E, nu = 7.0, 0.3
    G = E / (2 * (1 + nu))
    stress = E / (1 - nu**2) * np.array([[1, nu, 0], [nu, 1, 0], [0, 0, (1 - nu) / 2]])
    strain = E / ((1 + nu) * (1 - 2 * nu)) * np.array([[1 - nu, nu, 0], [nu, 1 - nu, 0], [0, 0, (1 - 2 * nu) / 2]])
    assert in_plane_stiffness(E, E, G, nu, "stress") == pytest.approx(stress, rel=1e-13)
    assert in_plane_stiffness(E, E, G, nu, "strain") == pytest.approx(strain, rel=1e-13)


def test_orthotropic_sheet_answers_a_pull_along_its_fibres():
    E1, E2, G12, nu12 = 130.0, 9.0, 5.0, 0.3
    D = in_plane_stiffness(E1, E2, G12, nu12, "stress")
    assert D @ [1 / E1, -nu12 / E1, 0.0] == pytest.approx([1.0, 0.0, 0.0], abs=1e-13)
    assert D @ [0.0, 0.0, 2.0] == pytest.approx([0.0, 0.0, 2 * G12], rel=1e-13)


def test_plane_strain_takes_the_third_direction_for_transverse():
    E1, E2, G12, nu = 130.0, 9.0, 5.0, 0.3
    S = np.array([[1 / E1, -nu / E1, -nu / E1], [-nu / E1, 1 / E2, -nu / E2], [-nu / E1, -nu / E2, 1 / E2]])
    strain = np.array([1e-3, -2e-3, 0.0])
    stress = np.linalg.solve(S, strain)
    D = in_plane_stiffness(E1, E2, G12, nu, "strain")
    assert D[:2, :2] @ strain[:2] == pytest.approx(stress[:2], rel=1e-12)
