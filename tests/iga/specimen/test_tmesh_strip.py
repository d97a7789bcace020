"""T-meshes along an interface: what their functions are there and on the other side, and where their lines end."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from knots import values
from random_tmeshes import strips, walked_values
from tmeshes import faces

from iga.bases.bspline import open_knots
from iga.specimen.tmesh_strip import STOCKY, Strip, functions_of_halves, strip_tmesh
from iga.tsplines.tmesh import DEGREE

some = settings(max_examples=25, deadline=None)

LOW, HIGH = -0.5, 1.0


def fine_breaks(strip: Strip) -> np.ndarray:
    """Element boundaries on the interface: every element as it is, or in 2^layers parts."""
    parts = np.where(strip.halved_c, 2**strip.layers, 1)
    pieces = zip(strip.breaks_c, strip.breaks_c[1:], parts, strict=False)
    return np.concatenate([*(np.linspace(a, b, n + 1)[:-1] for a, b, n in pieces), strip.breaks_c[-1:]])


def on_side(mesh, x: np.ndarray, y: float) -> np.ndarray:
    """Values (n_x, n) on a side of the functions that do not vanish there, by Cox-de Boor; s runs along it."""
    inside = np.nextafter(y, 0.5 * (LOW + HIGH))  # the last span is open above
    values = walked_values(mesh, np.stack([x, np.full(len(x), inside)], -1))
    s, t = mesh.local_knots
    there = np.sum(t == y, axis=1) == DEGREE + 1
    assert np.abs(values[:, ~there]).max(initial=0.0) < 1e-14
    return values[:, np.flatnonzero(there)[np.argsort(s[there].sum(1))]]


@some
@given(strips(), st.booleans(), st.integers(0, 2**32 - 1))
def test_on_either_side_the_functions_are_plain_splines(strip, top, seed):
    """On the interface on all its lines, opposite on the full ones: nothing of a T-junction is felt there."""
    mesh = strip_tmesh(strip, (LOW, HIGH), top)
    x = np.random.default_rng(seed).uniform(strip.breaks_c[0], strip.breaks_c[-1], 30)
    interface, opposite = (HIGH, LOW) if top else (LOW, HIGH)
    for y, breaks in ((interface, fine_breaks(strip)), (opposite, strip.breaks_c)):
        plain = values(open_knots(breaks, DEGREE), x)
        found = on_side(mesh, x, y)
        assert found.shape == plain.shape and np.abs(found - plain).max() < 1e-11


@some
@given(strips())
def test_the_interface_above_is_the_mirror_image_of_the_one_below(strip):
    below, above = strip_tmesh(strip, (0.0, 1.0), False), strip_tmesh(strip, (-1.0, 0.0), True)
    assert np.array_equal(below.across_ij, above.across_ij[:, ::-1]) and np.array_equal(
        below.up_ij, above.up_ij[:, ::-1]
    )
    assert np.array_equal(below.knots_i, above.knots_i)
    assert np.abs(below.knots_j + above.knots_j[::-1]).max() < 1e-15


@some
@given(strips())
def test_layers_are_twice_as_thick_and_their_elements_twice_as_long(strip):
    """Faces, before extensions: the shortest lines end on the interface itself, the next ones one layer up."""
    mesh = strip_tmesh(strip, (LOW, HIGH), False)
    box = faces(mesh)
    (x0, x1), (y0, y1) = mesh.knots_i[box[:, :2]].T, mesh.knots_j[box[:, 2:]].T
    thick = (HIGH - LOW) / (2**strip.layers - 1) * 2.0 ** np.arange(strip.layers)
    layer = np.argmin(np.abs(y0[:, None] - (LOW + np.cumsum(thick) - thick)), axis=1)
    column = np.searchsorted(strip.breaks_c, 0.5 * (x0 + x1)) - 1
    parts = np.where(strip.halved_c[column], 2.0 ** (strip.layers - 1 - layer), 1.0)
    assert np.allclose(y1 - y0, thick[layer], rtol=1e-12)
    assert np.allclose(x1 - x0, np.diff(strip.breaks_c)[column] / parts, rtol=1e-9)


@pytest.mark.parametrize(("layers", "functions"), [(1, 1), (2, 2 * 1 + 3), (3, 4 * 1 + 2 * 3 + 4)])
def test_a_line_has_one_function_on_each_row_that_it_meets(layers, functions):
    """Shortest lines one, on the interface; the next ones three, for two rows are at an end of the knots, and so on."""
    x = np.linspace(0.0, 1.0, 8)
    counts = [len(strip_tmesh(Strip(x, np.arange(7) < n, layers), (0.0, 1.0), False).anchors) for n in (2, 3, 6)]
    assert counts[1] - counts[0] == functions == functions_of_halves(layers)
    assert counts[2] - counts[0] == 4 * functions


@pytest.mark.parametrize("layers", [1, 2, 3])
def test_a_strip_is_stocky_where_its_layer_at_the_interface_is_thick(layers):
    """The shortest of the halved elements counts, and no other."""
    strip = Strip(np.array([0.0, 0.01, 1.01, 3.01]), np.array([False, True, True]), layers)
    just = STOCKY * (2**layers - 1) / 2**layers
    assert strip.stocky(just * (1.0 + 1e-9)) and not strip.stocky(just * (1.0 - 1e-9))
