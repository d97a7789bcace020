"""Splines along the arms: they reproduce what they should, and are as smooth as they should be."""

from __future__ import annotations

import numpy as np
import pytest

from verify.theory.arms.splines import ARM_DEGREE, ELEMENT_GROWTH, Fine, Splines

KINKS = (0.0, 3.0, 4.5, 10.0)
MESH = Splines.graded(KINKS, [Fine(2.0, 4.0, 0.3), Fine(0.0, 10.0, 2.0)])


def values(coefficients: np.ndarray, derivative: int, at: np.ndarray) -> np.ndarray:
    """Of a spline in every element, (E, q)."""
    shapes = MESH.shapes(at, np.ones_like(at))
    where = MESH.first[:, None] + np.arange(ARM_DEGREE + 1)
    return np.einsum("eqa,ea->eq", shapes[derivative], coefficients[where])


def test_elements_are_as_fine_as_asked_and_grow_slowly():
    assert set(KINKS) <= set(MESH.ends) and np.all(np.diff(MESH.ends) > 0.0)
    inside = (MESH.ends[:-1] > 2.0) & (MESH.ends[1:] < 4.0)
    assert MESH.sizes[inside].max() <= 0.3 * (1 + 1e-3) and MESH.sizes.max() <= 2.0 * (1 + 1e-3)
    assert np.all(MESH.sizes[1:] / MESH.sizes[:-1] < 1.0 + 2.0 * ELEMENT_GROWTH)
    assert MESH.count == len(MESH.sizes) + ARM_DEGREE + 2 * (ARM_DEGREE - 2)


def test_polynomials_of_the_degree_are_reproduced_with_their_derivatives():
    at = np.linspace(0.1, 0.9, 6)
    x, where = MESH.x(at), MESH.first[:, None] + np.arange(ARM_DEGREE + 1)
    shapes = MESH.shapes(at, np.ones_like(at))
    assert shapes.N.sum(axis=-1) == pytest.approx(1.0) and np.abs(shapes.dN.sum(axis=-1)).max() < 1e-11
    assert values(MESH.places, 0, at) == pytest.approx(x) and values(MESH.places, 1, at) == pytest.approx(1.0)
    system = np.zeros((x.size, MESH.count))
    np.put_along_axis(system, np.repeat(where, len(at), axis=0), shapes.N.reshape(x.size, -1), axis=1)
    for n in range(ARM_DEGREE + 1):
        c = np.linalg.lstsq(system, x.ravel() ** n, rcond=None)[0]
        found = [values(c, k, at) for k in range(3)]
        assert found[0] == pytest.approx(x**n, rel=1e-9, abs=1e-9)
        assert found[1] == pytest.approx(n * x ** max(n - 1, 0), rel=1e-7, abs=1e-7)
        assert found[2] == pytest.approx(n * (n - 1) * x ** max(n - 2, 0), rel=1e-6, abs=1e-6)


def test_slopes_are_continuous_everywhere_and_curvatures_but_at_kinks():
    c = np.random.default_rng(3).normal(size=MESH.count)
    inner = np.isin(MESH.ends[1:-1], KINKS)
    for derivative in range(3):
        left, right = (values(c, derivative, np.array([end])) for end in (1.0, 0.0))
        step = np.abs(left[:-1, 0] - right[1:, 0])
        smooth = step < 1e-9 * np.abs(left).max()
        assert np.all(smooth) if derivative < 2 else np.array_equal(smooth, ~inner)


def test_gauss_points_integrate_and_a_place_is_found():
    shapes = MESH.gauss(ARM_DEGREE + 1)
    assert shapes.weight.sum() == pytest.approx(10.0)
    for x in (0.0, 3.0, 3.3, 10.0):
        e, one = MESH.at(x)
        assert one.N[0] @ MESH.places[MESH.first[e] + np.arange(ARM_DEGREE + 1)] == pytest.approx(x, abs=1e-12)
        assert MESH.ends[e] <= x <= MESH.ends[e + 1]
