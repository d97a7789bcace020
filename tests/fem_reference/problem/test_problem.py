"""The input: what is refused, and the stiffness of the sheet."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from opening_specimens import Dcb, Peel

from fem_reference.problem.delamination import layers_below
from fem_reference.problem.material import Moduli

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
        ({"degree": 5}, "degree: must be one of 1, 2, 3, 4, got 5"),
        ({"kinematics": "auto"}, "kinematics: must be one of linear, finite"),
        ({"opening": (0.0,)}, "opening"),
        ({"elements": 1}, "elements: must be >= 2"),
        ({"nu12": 1.5}, "negative energy"),
    ],
)
def test_impossible_problems_are_refused_with_key_and_value(change, words):
    with pytest.raises(ValueError, match=words):
        Dcb(**(DCB | change))


def test_isotropic_sheet_has_the_textbook_matrices():
    E, nu = 7.0, 0.3
    G = E / (2 * (1 + nu))
    stress = E / (1 - nu**2) * np.array([[1, nu, 0], [nu, 1, 0], [0, 0, (1 - nu) / 2]])
    strain = E / ((1 + nu) * (1 - 2 * nu)) * np.array([[1 - nu, nu, 0], [nu, 1 - nu, 0], [0, 0, (1 - 2 * nu) / 2]])
    assert Moduli(E, E, G, nu).stiffness_IJ("stress") == pytest.approx(stress, rel=1e-13)
    assert Moduli(E, E, G, nu).stiffness_IJ("strain") == pytest.approx(strain, rel=1e-13)


def test_orthotropic_sheet_answers_a_pull_along_its_fibres():
    E1, E2, G12, nu12 = 130.0, 9.0, 5.0, 0.3
    D = Moduli(E1, E2, G12, nu12).stiffness_IJ("stress")
    assert D @ [1 / E1, -nu12 / E1, 0.0] == pytest.approx([1.0, 0.0, 0.0], abs=1e-13)
    assert D @ [0.0, 0.0, 2.0] == pytest.approx([0.0, 0.0, 2 * G12], rel=1e-13)


@pytest.mark.parametrize("nu23", [None, 0.45])
def test_plane_strain_takes_the_third_direction_for_transverse(nu23):
    E1, E2, G12, nu, across = 130.0, 9.0, 5.0, 0.3, nu23 or 0.3
    S = np.array([[1 / E1, -nu / E1, -nu / E1], [-nu / E1, 1 / E2, -across / E2], [-nu / E1, -across / E2, 1 / E2]])
    strain = np.array([1e-3, -2e-3, 0.0])
    stress = np.linalg.solve(S, strain)
    D = Moduli(E1, E2, G12, nu, nu23).stiffness_IJ("strain")
    assert D[:2, :2] @ strain[:2] == pytest.approx(stress[:2], rel=1e-12)


def test_a_solid_has_the_compliance_of_its_nine_constants():
    """Pulled and sheared along each axis; what is left out is that of a second transverse direction."""
    full = Moduli(130.0, 9.0, 5.0, 0.3, nu23=0.4, E3=11.0, nu13=0.25, G13=4.0, G23=3.0)
    S = np.linalg.inv(full.stiffness_IJ("solid"))
    assert 1.0 / np.diag(S) == pytest.approx([130.0, 9.0, 11.0, 3.0, 4.0, 5.0], rel=1e-13)
    assert -S[[0, 0, 1], [1, 2, 2]] * [130.0, 130.0, 9.0] == pytest.approx([0.3, 0.25, 0.4], rel=1e-13)
    assert pytest.approx(S, rel=1e-13) == S.T and not np.any(S[:3, 3:])
    left_out = Moduli(130.0, 9.0, 5.0, 0.3, 0.4, E3=9.0, nu13=0.3, G13=5.0, G23=9.0 / 2.8).stiffness_IJ("solid")
    assert Moduli(130.0, 9.0, 5.0, 0.3, 0.4).stiffness_IJ("solid") == pytest.approx(left_out, rel=1e-14)
    E, nu = 7.0, 0.3
    turned = [2, 0, 1, 5, 3, 4]
    D = Moduli(E, E, E / (2 * (1 + nu)), nu).stiffness_IJ("solid")
    assert D == pytest.approx(D[np.ix_(turned, turned)], rel=1e-13)


PEEL = dict(
    strip_length=15.0,
    strip_thickness=0.2,
    substrate_length=12.0,
    substrate_thickness=1.0,
    bond_length=6.0,
    strip=Moduli(250e3, 250e3, 100e3, 0.2),
    substrate=Moduli(5e3, 5e3, 2e3, 0.2),
    strength=6.0,
    toughness=0.1,
    ductility=10.0,
)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"elements": 2}, "elements: must be >= 3, one on each part of the specimen, got 2"),
        ({"elements": 1, "bond_length": 12.0}, "elements: must be >= 2"),
        ({"substrate": Moduli(1.0, 1.0, 1.0, 1.5)}, "negative energy"),
    ],
)
def test_impossible_peels_are_refused_with_key_and_value(change, words):
    with pytest.raises(ValueError, match=words):
        Peel(**(PEEL | change))


@pytest.mark.parametrize("elements", [3, 4, 17, 150, 451])
@pytest.mark.parametrize(("bond", "lower"), [(6.0, 12.0), (12.0, 12.0), (0.01, 12.0), (11.99, 12.0), (6.0, 40.0)])
def test_lines_along_a_peel_end_where_its_parts_end(bond, lower, elements):
    made = Peel(**(PEEL | {"bond_length": bond, "substrate_length": lower, "elements": elements})).specimen()
    assert made.X.size == elements + 1
    assert np.all(np.diff(made.X) > 0)
    assert {0.0, bond, lower, 15.0} <= set(made.X)
    assert np.sum(made.bond_elements) == pytest.approx(bond, rel=1e-12)
    longest, mean = np.max(np.diff(made.X)), made.X[-1] / elements
    assert longest < (1.2 if elements >= 150 else 3) * mean


@given(thickness=st.floats(1e-3, 1e3), first=st.floats(1e-4, 1e4))
def test_layers_are_the_fewest_that_begin_thin_enough(thickness, first):
    tops = layers_below(thickness, first)
    heights = np.diff(tops)
    assert tops[0] == 0.0 and tops[-1] == pytest.approx(thickness, rel=1e-14)
    assert heights[0] <= first * (1 + 1e-6)
    assert heights[1:] == pytest.approx(2 * heights[:-1], rel=1e-9)
    assert heights.size == 1 or thickness > first * (2 ** (heights.size - 1) - 1)
