"""What the numbers of a mesh, a rule or a material cannot be is refused at once, in a sentence."""

import numpy as np
import pytest

from iga.bases.bspline import KnotVector, open_knots
from iga.bases.nurbs import nurbs_mesh
from iga.elements.elasticity import orthotropic
from iga.mesh.quadrature import gauss, lobatto

LINE = open_knots(np.linspace(0.0, 1.0, 3), 2)


@pytest.mark.parametrize(
    ("degree", "knots", "words"),
    [
        (0, [0.0, 0.0, 1.0, 1.0], "a knot vector of degree 0 needs at least 2 finite"),
        (2, [0.0, 0.0, 0.0, 1.0, 1.0], "degree 2 needs at least 6 finite"),
        (1, [0.0, 0.0, 2.0, 1.0, 3.0, 3.0], "non-decreasing knots"),
        (1, [0.0, 0.0, np.nan, 1.0, 1.0], "finite, non-decreasing knots"),
        (2, [0.0, 0.0, 0.5, 1.0, 1.0, 1.0], "the end knots must have multiplicity 3, got 2 and 3"),
        (2, [0.0, 0.0, 0.0, 0.5, 1.0, 1.0], "the end knots must have multiplicity 3, got 3 and 2"),
        (1, [0.0, 0.0, 0.0, 0.0], "the end knots must have multiplicity 2"),
        (2, [0.0, 0.0, 0.0, 0.5, 0.5, 0.5, 1.0, 1.0, 1.0], "inner knots may have multiplicity 2 at most, got 3"),
    ],
)
def test_knot_vectors(degree, knots, words):
    with pytest.raises(ValueError, match=words):
        KnotVector(degree, np.array(knots))


def test_knots_may_be_given_as_a_list_of_integers():
    kv = KnotVector(2, [0, 0, 0, 1, 3, 3, 3])
    assert kv.knots.dtype == float and kv.functions == 4 and kv.greville == pytest.approx([0.0, 0.5, 2.0, 3.0])
    assert kv.spans.tolist() == [2, 3]


def test_control_nets():
    n = LINE.functions**2
    P_AI = np.stack(np.meshgrid(*[np.linspace(0.0, 1.0, LINE.functions)] * 2), axis=-1).reshape(-1, 2)
    assert nurbs_mesh(LINE, LINE, P_AI).elements == 4
    for points, weights in ((P_AI[1:], np.ones(n - 1)), (P_AI, np.ones(n - 1)), (P_AI[:, :1], np.ones(n))):
        with pytest.raises(ValueError, match=f"the knot vectors ask for {n} control points and weights"):
            nurbs_mesh(LINE, LINE, points, weights)
    for least in (0.0, -1.0, np.nan):
        with pytest.raises(ValueError, match="weights must be > 0"):
            nurbs_mesh(LINE, LINE, P_AI, np.append(np.ones(n - 1), least))


def test_rules_and_planes():
    with pytest.raises(ValueError, match="a Lobatto rule has at least 2 points, got 1"):
        lobatto(1)
    assert np.array_equal(lobatto(2), [[0.0, 1.0], [0.5, 0.5]])
    with pytest.raises(ValueError, match='plane must be "stress" or "strain", got \'flat\''):
        orthotropic(1.0, 1.0, 0.5, 0.0, "flat")


@pytest.mark.parametrize("n", [2, 3, 5, 12])
def test_lobatto_rules_have_both_ends_and_are_exact_for_two_degrees_less_than_gauss(n):
    (x, w), (x_gauss, w_gauss) = lobatto(n), gauss(n)
    assert (x[0], x[-1]) == (0.0, 1.0) and np.all(w > 0) and len(x) == len(x_gauss) == n
    for degree in range(2 * n):
        assert w_gauss @ x_gauss**degree == pytest.approx(1.0 / (degree + 1), rel=1e-12)
        if degree <= 2 * n - 3:
            assert w @ x**degree == pytest.approx(1.0 / (degree + 1), rel=1e-12)
    if n <= 5:  # what is missed becomes small
        assert abs(w @ x ** (2 * n - 2) * (2 * n - 1) - 1.0) > 1e-6
