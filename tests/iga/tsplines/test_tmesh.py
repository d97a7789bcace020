"""T-meshes: what rays and extensions meet, which are analysis-suitable, how lines make them, what is refused."""

import re

import numpy as np
import pytest
from hypothesis import find, given, settings
from hypothesis import strategies as st
from random_tmeshes import (
    any_tmeshes,
    breaks,
    drawn_at_will,
    split_at_will,
    strips,
    suitable_tmeshes,
    walked_anchors,
    walked_extensions,
    walked_knots,
)
from tmeshes import faces, from_rectangles

from iga.specimen.tmesh_strip import strip_tmesh
from iga.tsplines.lines import tensor_grid, with_line
from iga.tsplines.tmesh import NotSuitable, TMesh, require_suitable
from iga.tsplines.tspline import bezier_elements

some = settings(max_examples=60, deadline=None)
UNIT = np.array([0.0, 1.0])
FOUR = np.linspace(0.0, 1.0, 5)


def test_the_edges_of_a_grid_are_its_lines_from_knot_to_knot():
    """Those of no length, at the repeated knots of the ends, are left out."""
    s, t = np.array([0.0, 1.0, 3.0]), np.array([0.0, 0.5, 1.0, 2.0])
    level = {((a, y), (b, y)) for a, b in zip(s, s[1:], strict=False) for y in t}
    upright = {((x, a), (x, b)) for a, b in zip(t, t[1:], strict=False) for x in s}
    found = [tuple(map(tuple, edge)) for edge in tensor_grid(s, t).edges().tolist()]
    assert set(found) == level | upright and len(found) == len(set(found))
    ended = {tuple(map(tuple, e)) for e in with_line(tensor_grid(s, t), "vertical", 2.0, (0.5, 2.0)).edges().tolist()}
    halves = {((a, y), (b, y)) for y in t for a, b in ((1.0, 2.0), (2.0, 3.0))}
    line = {((2.0, 0.5), (2.0, 1.0)), ((2.0, 1.0), (2.0, 2.0))}
    assert ended == {edge for edge in level if edge[0][0] != 1.0} | upright | halves | line


@some
@given(any_tmeshes())
def test_anchors_and_local_knots_are_those_of_a_walk(mesh):
    assert mesh.anchors.tolist() == [list(anchor) for anchor in walked_anchors(mesh)]
    s, t = zip(*walked_knots(mesh), strict=True)
    assert np.array_equal(mesh.local_knots[0], s) and np.array_equal(mesh.local_knots[1], t)


@some
@given(any_tmeshes())
def test_extensions_and_their_crossings_are_those_of_a_walk(mesh):
    level, upright = walked_extensions(mesh)
    found_level, found_upright = mesh.extensions
    assert {(i, j) for i0, i1, j in found_level for i in range(i0, i1 + 1)} == level
    assert {(i, j) for j0, j1, i in found_upright for j in range(j0, j1 + 1)} == upright
    assert {tuple(x) for x in mesh.crossings()} == {(mesh.knots_i[i], mesh.knots_j[j]) for i, j in level & upright}


@some
@given(any_tmeshes())
def test_meshes_with_crossings_are_refused_by_the_coordinates_of_one(mesh):
    level, upright = walked_extensions(mesh)
    crossings = [(mesh.knots_i[i], mesh.knots_j[j]) for i, j in level & upright]
    assert mesh.suitable == (not crossings)
    if mesh.suitable:
        require_suitable(mesh)
        return
    with pytest.raises(NotSuitable, match="analysis-suitable") as refusal:
        require_suitable(mesh)
    named = re.search(r"meet at \((.*), (.*)\)", str(refusal.value).split(" and ")[0].split(";")[0])
    near = np.min(np.max(np.abs(np.array(crossings) - [float(named[1]), float(named[2])]), axis=1))
    assert near < 1e-5 * max(1.0, np.max(np.abs(crossings)))


@pytest.mark.parametrize("kind", [split_at_will, drawn_at_will])
@pytest.mark.parametrize("suitable", [True, False])
def test_random_meshes_are_of_both_kinds_and_have_junctions(kind, suitable):
    """The tests over random T-meshes see T-junctions, analysis-suitable and not."""
    without_shrinking = settings(max_examples=500, deadline=None, derandomize=True, phases=["generate"])
    find(kind(), lambda mesh: mesh.suitable == suitable and len(mesh.junctions) > 0, settings=without_shrinking)


@some
@given(strips(), st.booleans())
def test_strips_are_suitable_and_have_the_functions_that_they_say(strip, top):
    mesh = strip_tmesh(strip, (0.0, 2.0), top)
    assert mesh.suitable and len(mesh.anchors) == strip.functions
    at_interface = mesh.knots_i[mesh.anchors[mesh.anchors[:, 1] == (len(mesh.knots_j) - 3 if top else 2), 0]]
    shortest = np.min(np.diff(strip.breaks_c)[strip.halved_c], initial=np.inf) / 2**strip.layers
    assert np.min(np.diff(np.unique(at_interface))) == pytest.approx(min(shortest, np.diff(strip.breaks_c).min()))


@some
@given(suitable_tmeshes())
def test_elements_tile_the_domain(mesh):
    for box_ek in (faces(mesh), bezier_elements(mesh)):
        s0, s1, t0, t1 = mesh.knots_i[box_ek[:, 0]], mesh.knots_i[box_ek[:, 1]], *mesh.knots_j[box_ek[:, 2:]].T
        again = from_rectangles(np.stack([s0, s1, t0, t1], -1))
        assert len(faces(again)) == len(box_ek)
        area = np.ptp(mesh.knots_i) * np.ptp(mesh.knots_j)
        assert np.sum((s1 - s0) * (t1 - t0)) == pytest.approx(area, rel=1e-12), "neither gaps nor overlaps"


@some
@given(breaks(), breaks(), st.randoms())
def test_a_grid_comes_of_its_lines_in_any_order(s, t, random):
    lines = [("vertical", at) for at in s[1:-1]] + [("horizontal", at) for at in t[1:-1]]
    random.shuffle(lines)
    mesh = tensor_grid(s[[0, -1]], t[[0, -1]])
    for direction, at in lines:
        mesh = with_line(mesh, direction, at)
    grid = tensor_grid(s, t)
    assert same(mesh, grid) and same(from_rectangles(rectangles(grid)), grid)


def test_a_line_is_there_as_often_as_asked_for_and_twice_makes_no_difference():
    mesh = tensor_grid(FOUR, FOUR)
    line = ("vertical", 0.5, (0.25, 1.0), 3)
    thrice = with_line(mesh, *line)
    assert np.count_nonzero(thrice.knots_i == 0.5) == 3 and thrice.suitable
    assert np.count_nonzero(thrice.up_ij[thrice.knots_i == 0.5][:, 3]) == 1, "below 0.25 the line is single"
    assert same(with_line(thrice, *line), thrice)
    assert len(thrice.anchors) == len(mesh.anchors) + 2 * 5, "two more lines, each over 0.25, 0.5, 0.75, 1, 1"


def test_a_line_between_ends_on_the_lines_it_is_given():
    mesh = with_line(tensor_grid(FOUR, FOUR), "vertical", 0.125, (0.25, 0.75))
    assert mesh.knots_i[mesh.junctions[:, 0]].tolist() == [0.125, 0.125]
    assert mesh.knots_j[mesh.junctions[:, 1]].tolist() == [0.25, 0.75]
    assert mesh.junctions[:, 2].tolist() == [3, 2], "the edges down and up are missing"
    assert not mesh.up_ij[4, :4].any() and not mesh.up_ij[4, -4:].any(), "nothing of it in the frame"


def test_a_line_ends_on_the_copies_of_a_line_that_are_there():
    """The line at 0.5 is double from 0.5 on: left of that lines end on the one, right of it on the second."""
    mesh = with_line(tensor_grid(FOUR, FOUR), "horizontal", 0.5, (0.5, 1.0), times=2)
    mirrored = TMesh(mesh.knots_i, 1.0 - mesh.knots_j[::-1], mesh.across_ij[:, ::-1], mesh.up_ij[:, ::-1])
    for at, extra in ((0.125, 0), (0.625, 1)):
        below = with_line(mesh, "vertical", at, (0.0, 0.5))
        above = with_line(mirrored, "vertical", at, (0.5, 1.0))
        for made in (below, above):
            assert len(made.anchors) == len(mesh.anchors) + 4 + extra


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda mesh: with_line(mesh, "vertical", 0.3, (0.1, 0.5)), r"\(0\.3, 0\.1\)"),
        (lambda mesh: with_line(mesh, "horizontal", 0.3, (0.25, 0.6)), r"\(0\.6, 0\.3\)"),
        (lambda mesh: with_line(mesh, "vertical", 1.0), r"inside \(0, 1\), got 1"),
        (lambda mesh: with_line(mesh, "vertical", np.nan), "got nan"),
        (lambda mesh: with_line(mesh, "vertical", 0.3, (0.5, 0.25)), r"0\.3.*\(0\.5, 0\.25\)"),
        (lambda mesh: with_line(mesh, "horizontal", 0.3, (-1.0, 0.25)), r"0\.3.*\(-1, 0\.25\)"),
        (lambda mesh: with_line(mesh, "across", 0.3), "vertical or horizontal, got 'across'"),
        (lambda mesh: with_line(mesh, "vertical", 0.3, times=4), "1 to 3 times, got 4"),
        (lambda mesh: tensor_grid([0.0, 1.0, 0.5], UNIT), "breaks in s must be two numbers or more that rise"),
        (lambda mesh: tensor_grid(UNIT, [0.0]), "breaks in t"),
        (lambda mesh: tensor_grid(FOUR, FOUR, 1, 4), "multiplicities in t must be 1 to 3, got 4"),
    ],
)
def test_impossible_lines_are_refused_by_their_coordinates(make, message):
    with pytest.raises(ValueError, match=message):
        make(tensor_grid(FOUR, FOUR))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda a: a.update(knots_i=np.array([0.0, 0, 0, 0, 0.5, 0.25, 0.75, 1, 1, 1, 1])), "knots in s .* not fall"),
        (
            lambda a: a.update(knots_j=np.array([0.0, 0, 0, 0.1, 0.2, 0.5, 0.75, 1, 1, 1, 1])),
            "there 4 times, got 3 and 4",
        ),
        (lambda a: a.update(knots_j=np.array([0.0, 0, 0, 0, np.nan, 0.5, 0.75, 1, 1, 1, 1])), "finite"),
        (lambda a: a.update(knots_i=np.repeat([0.0, 1.0], [4, 4])), "ask for 7 unit edges, got 10"),
        (lambda a: a["up"].__setitem__((3, 5), False), "vertical lines of the end knots must be drawn in full"),
        (lambda a: a["across"].__setitem__((6, 0), False), "horizontal lines of the end knots"),
        (lambda a: a["up"].__setitem__((5, 0), False), "vertical line that reaches the frame must go through"),
        (lambda a: a["up"].__setitem__((5, slice(2)), False), "vertical line that reaches the frame must go through"),
        (lambda a: a["across"].__setitem__((slice(-2, None), 5), False), "horizontal line that reaches the frame"),
        (lambda a: a.update(across=a["across"][:, :-1]), "not of one mesh"),
    ],
)
def test_arrays_that_are_no_tmesh_are_refused(change, message):
    knots = np.repeat(FOUR, [4, 1, 1, 1, 4])
    full = np.ones((10, 11), dtype=bool)
    arrays = {"knots_i": knots, "knots_j": knots, "across": full.copy(), "up": full.T.copy()}
    TMesh(*arrays.values())
    change(arrays)
    with pytest.raises(ValueError, match=message):
        TMesh(*arrays.values())


@pytest.mark.parametrize(
    ("gone", "message"),
    [
        ("right up", r"line of the T-mesh ends at \(0\.5, 0\.5\)"),
        ("left right up", r"a vertical line of the T-mesh ends at \(0\.5, 0\.5\)"),
        ("left right down", r"a vertical line of the T-mesh ends at \(0\.5, 0\.5\)"),
        ("up down left", r"a horizontal line of the T-mesh ends at \(0\.5, 0\.5\)"),
        ("up down right", r"a horizontal line of the T-mesh ends at \(0\.5, 0\.5\)"),
        ("right down", r"line of the T-mesh ends at \(0\.5, 0\.5\)"),
    ],
)
def test_corners_and_dangling_ends_are_refused_where_they_are(gone, message):
    mesh = tensor_grid(FOUR, FOUR)
    up, across = mesh.up_ij.copy(), mesh.across_ij.copy()
    edge = {"up": (up, (5, 5)), "down": (up, (5, 4)), "right": (across, (5, 5)), "left": (across, (4, 5))}
    for name in gone.split():
        array, place = edge[name]
        array[place] = False
    with pytest.raises(ValueError, match=message):
        TMesh(mesh.knots_i, mesh.knots_j, across, up)


def test_whole_numbers_are_knots_like_others():
    whole = TMesh(np.repeat([0, 1, 3], [4, 1, 4]), np.repeat([0, 2], 4), np.ones((8, 8), bool), np.ones((9, 7), bool))
    assert same(whole, tensor_grid([0.0, 1.0, 3.0], [0.0, 2.0])) and whole.knots_i.dtype == float


def test_knots_above_the_degree_are_refused():
    knots = np.repeat([0.0, 0.5, 1.0], [4, 4, 4])
    edges = np.ones((11, 12), dtype=bool)
    with pytest.raises(ValueError, match="inner knots in s may be there 3 times at most, got 4"):
        TMesh(knots, knots, edges, edges.T)


def rectangles(mesh: TMesh) -> np.ndarray:
    """Faces (n, 4) as s0, s1, t0, t1."""
    box = faces(mesh)
    return np.concatenate([mesh.knots_i[box[:, :2]], mesh.knots_j[box[:, 2:]]], axis=1)


def same(one: TMesh, other: TMesh) -> bool:
    pairs = ((one.knots_i, other.knots_i), (one.knots_j, other.knots_j))
    edges = ((one.across_ij, other.across_ij), (one.up_ij, other.up_ij))
    return all(np.array_equal(a, b) for a, b in pairs + edges)
