"""Exact plane fields: displacements and stresses belong together and are in equilibrium."""

from dataclasses import replace

import numpy as np
import pytest
from plane_fields import kirsch, smooth, uniform

from iga.elements.elasticity import isotropic

SOLID = {"young": 70.0, "poisson": 0.3}
FIELDS = {
    "uniform": lambda plane: uniform(1.0, -0.4, 0.3, **SOLID, plane=plane),
    "smooth": lambda plane: smooth(0.4 - 0.1j, 3.0, 2.0, **SOLID, plane=plane),
    "kirsch": lambda plane: kirsch(0.7, 2.0, **SOLID, plane=plane),
}


def gradient(field, X, h=1e-5):
    """Central differences (..., component, direction)."""
    return np.stack([(field(X + step) - field(X - step)) / (2 * h) for step in h * np.eye(2)], -1)


@pytest.mark.parametrize("plane", ["stress", "strain"])
@pytest.mark.parametrize("name", FIELDS)
def test_stress_is_that_of_the_displacement_and_in_equilibrium(name, plane):
    rng = np.random.default_rng(7)
    field, angle = FIELDS[name](plane), rng.uniform(0, 2 * np.pi, 40)
    X = rng.uniform(0.8, 2.0, 40)[:, None] * np.stack([np.cos(angle), np.sin(angle)], -1)
    H, stress = gradient(field.displacement, X), field.stress(X)
    strain = np.stack([H[:, 0, 0], H[:, 1, 1], H[:, 0, 1] + H[:, 1, 0]], -1)
    expected = strain @ isotropic(**SOLID, plane=plane)
    found = np.stack([stress[:, 0, 0], stress[:, 1, 1], stress[:, 0, 1]], -1)
    assert np.max(np.abs(found - expected)) < 1e-7 * np.max(np.abs(found))
    divergence = np.einsum("nijj->ni", gradient(field.stress, X))
    assert np.max(np.abs(divergence)) < 1e-7 * np.max(np.abs(found))
    other = replace(field, plane="strain" if plane == "stress" else "stress")
    assert np.max(np.abs(gradient(other.displacement, X) - H)) > 1e-3 * np.max(np.abs(H)), "the plane matters"


def test_the_hole_is_free_and_concentrates_the_stress_three_times():
    field = kirsch(0.7, 2.0, **SOLID, plane="stress")
    angle = np.linspace(0, 2 * np.pi, 25)
    normal = -np.stack([np.cos(angle), np.sin(angle)], -1)
    assert np.max(np.abs(field.traction(-0.7 * normal, normal))) < 1e-14
    assert field.stress(np.array([0.0, 0.7]))[0, 0] == pytest.approx(6.0, rel=1e-14)
    assert field.stress(np.array([0.7, 0.0]))[1, 1] == pytest.approx(-2.0, rel=1e-14)
    assert field.stress(np.array([1e5, 3e4])) == pytest.approx(np.diag([2.0, 0.0]), abs=1e-9)


def test_a_uniform_field_is_what_it_says():
    assert uniform(1.0, -0.4, 0.3, **SOLID, plane="strain").stress(np.ones(2)) == pytest.approx(
        np.array([[1.0, 0.3], [0.3, -0.4]]), rel=1e-15
    )
