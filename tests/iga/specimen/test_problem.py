"""The input: defaults, and what is refused before any work."""

from dataclasses import replace

import numpy as np
import pytest
from specimens import NU, PAPER, E

from iga.dcb import Problem
from iga.elements.elasticity import isotropic
from iga.specimen.layout import Moduli

#: As little as must be stated.
LEAST = Problem(length=14.0, arm_thickness=0.2, precrack=4.0, E1=E, nu12=NU, strength=4.0, toughness=0.1, opening=1.0)


def test_contact_is_stiff_beside_the_bond_where_no_penalty_is_given():
    assert LEAST.law.penalty == pytest.approx(100.0 * LEAST.law.stiffness[0], rel=1e-12)
    assert replace(LEAST, strength=8.0).law.penalty == pytest.approx(4.0 * LEAST.law.penalty)
    assert replace(LEAST, penalty=7.0).law.penalty == 7.0


def test_a_programme_is_a_number_or_several():
    assert LEAST.opening == (1.0,) == replace(LEAST, opening=[1]).opening
    assert replace(LEAST, opening=np.array([1.5, 0.2, 3.0])).legs == ((0.0, 1.5), (1.5, 0.2), (0.2, 3.0))


def test_moduli_left_out_are_isotropic():
    for problem in (LEAST, PAPER):
        assert np.array_equal(problem.layout.bodies[0].moduli.stiffness("stress"), isotropic(E, NU, "stress"))
    assert Moduli(E1=E, nu12=NU, E2=E / 10, G12=E / 20).stiffness("stress")[1, 1] < 0.11 * E


def test_a_table_says_strength_toughness_and_ductility():
    """Mesh and penalty are by its numbers, not by those that it replaces."""
    table = ((0.01, 4.0), (0.05, 0.0))
    by_table = replace(LEAST, law_name="tabular", table=table, strength=1.0, toughness=9.0)
    assert (by_table.strength, by_table.toughness, by_table.ductility) == pytest.approx((4.0, 0.1, 5.0))
    assert by_table.law.penalty == pytest.approx(100.0 * 400.0)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"strength": 0.0}, "strength: must be > 0 and finite, got 0.0"),
        ({"toughness": np.nan}, "toughness: must be > 0 and finite, got nan"),
        ({"penalty": -1.0}, "penalty: must be > 0 and finite, got -1.0"),
        ({"E1": "1e5"}, "E1: must be a number, got '1e5'"),
        ({"degree": "3"}, "degree: must be a number, got '3'"),
        ({"E1": np.inf}, "E1: must be > 0 and finite, got inf"),
        ({"ductility": 1.0}, "ductility: must be > 1 and finite, got 1.0"),
        ({"nu12": 0.5}, "nu12: must be > -1 and < 0.5 without E2 and G12, got 0.5"),
        ({"nu12": -1.0}, "nu12: must be > -1 and < 0.5 without E2 and G12, got -1.0"),
        ({"nu12": np.nan}, "nu12: must be .*, got nan"),
        ({"E2": E, "G12": 1.0, "nu12": 1.0}, r"nu12: must be > -1 and < 1 = sqrt\(E1/E2\), got 1.0"),
        ({"E2": 1e4}, "G12: must be given where E2 is, got None"),
        ({"G12": 1e4}, "E2: must be given where G12 is, got None"),
        ({"precrack": 14.0}, "precrack: must be < length = 14, got 14.0"),
        ({"opening": ()}, "opening: must be finite, and different from the opening before it .*, got \\(\\)"),
        ({"opening": (1.0, 1.0)}, "opening: must be .*, got \\(1.0, 1.0\\)"),
        ({"opening": np.nan}, "opening: must be .*, got \\(nan,\\)"),
        ({"basis": "fourier"}, "basis: must be one of tspline, nurbs, lagrange, got 'fourier'"),
        ({"kinematics": "large"}, "kinematics: must be one of finite, linear, got 'large'"),
        ({"interface_rule": "simpson"}, "interface_rule: must be one of gauss, lobatto, lumped, got 'simpson'"),
        ({"slave": "top"}, "slave: must be one of upper, lower, got 'top'"),
        ({"irreversible": "no"}, "irreversible: must be True or False, got 'no'"),
        (
            {"snapshot_openings": (0.5, 5.0)},
            r"snapshot_openings: must be >= 0 and <= 1, the largest .*, got \(0.5, 5.0\)",
        ),
        ({"snapshot_openings": (-0.5,)}, "snapshot_openings: must be >= 0 and <= 1, the largest opening, got"),
        ({"law_name": "tabular"}, "table must be two or more pairs"),
        ({"degree": 0}, "degree: must be >= 1, got 0"),
        ({"steps": 0}, "steps: must be >= 1, or None, got 0"),
    ],
    ids=lambda one: next(iter(one)) if isinstance(one, dict) else "",
)
def test_what_cannot_be_solved_is_refused_with_key_rule_and_value(changes, words):
    with pytest.raises(ValueError, match=words):
        replace(LEAST, **changes)
