"""Random T-meshes, and what is read off a T-mesh by walking it edge by edge: the slow, plain second route."""

import numpy as np
from hypothesis import strategies as st
from tmeshes import Bisected, from_rectangles, initial, made_suitable, transposed

from iga.specimen.tmesh_strip import Strip, strip_tmesh
from iga.tsplines.lines import tensor_grid, with_line
from iga.tsplines.tmesh import TMesh

SPANS = st.lists(st.floats(0.2, 5.0), min_size=1, max_size=4)
FRACTIONS = st.floats(0.0, 1.0, exclude_max=True)


@st.composite
def breaks(draw):
    return draw(st.floats(-3.0, 3.0)) + np.concatenate([[0.0], np.cumsum(draw(SPANS))])


@st.composite
def markings(draw, steps=5):
    """A grid, and for each step of its refinement the places of the elements to mark."""
    marks = st.lists(FRACTIONS, min_size=1, max_size=3)
    return initial(draw(breaks()), draw(breaks())), draw(st.lists(marks, max_size=steps))


def marked(mesh: Bisected, places: list[float]) -> np.ndarray:
    return np.unique([int(place * len(mesh.level_e)) for place in places])


@st.composite
def bisections(draw):
    """Elements after several steps of marking and bisecting."""
    mesh, steps = draw(markings())
    for places in steps:
        mesh = mesh.refined(marked(mesh, places))
    return mesh


@st.composite
def one_way(draw):
    """A grid with inner knots of any multiplicity, and partial lines that all run in one direction."""
    s, t = draw(breaks()), draw(breaks())
    times_s, times_t = ([draw(st.integers(1, 3)) for _ in x[1:-1]] for x in (s, t))
    mesh = tensor_grid(s, t, times_s, times_t)
    for _ in range(draw(st.integers(0, 5))):
        at = s[0] + (s[-1] - s[0]) * draw(st.floats(0.01, 0.99))
        low, high = sorted(draw(st.sets(st.integers(0, len(t) - 1), min_size=2, max_size=2)))
        mesh = with_line(mesh, "vertical", at, (t[low], t[high]), times=draw(st.integers(1, 2)))
    return transposed(mesh) if draw(st.booleans()) else mesh


@st.composite
def strips(draw):
    """Elements along an interface, some of them halved towards it once for every layer."""
    s = draw(breaks())
    halved = [draw(st.booleans()) for _ in s[1:]]
    return Strip(s, np.array(halved), draw(st.integers(1, 3)))


@st.composite
def split_at_will(draw):
    """Rectangles cut in two, again and again, one way or the other: as a rule not analysis-suitable."""
    s, t = draw(breaks()), draw(breaks())
    boxes = [(a, b, c, d) for c, d in zip(t, t[1:], strict=False) for a, b in zip(s, s[1:], strict=False)]
    for place, upright in draw(st.lists(st.tuples(FRACTIONS, st.booleans()), max_size=7)):
        s0, s1, t0, t1 = boxes.pop(int(place * len(boxes)))
        s_m, t_m = (s0 + s1) / 2, (t0 + t1) / 2
        boxes += [(s0, s_m, t0, t1), (s_m, s1, t0, t1)] if upright else [(s0, s1, t0, t_m), (s0, s1, t_m, t1)]
    return from_rectangles(np.array(boxes))


@st.composite
def drawn_at_will(draw):
    """Random edges between random knots, lines that would dangle prolonged: multiple knots, lines that end anywhere."""
    knots = []
    for x in (draw(breaks()), draw(breaks())):
        inner = [draw(st.integers(1, 3)) for _ in x[1:-1]]
        knots.append(np.repeat(x, [4, *inner, 4]))
    m, n = (len(k) for k in knots)
    across, up = draw(edges(m - 1, n)), draw(edges(n - 1, m)).T
    across[:, :4] = across[:, -4:] = up[:4] = up[-4:] = True
    while True:
        count = across.sum() + up.sum()
        for along in (across, up.T):
            along[:2] |= along[2] | along[1]
            along[-2:] |= along[-3] | along[-2]
            along[0], along[-1] = along[1], along[-2]
        right, left, above, below = across[1:, 1:-1], across[:-1, 1:-1], up[1:-1, 1:], up[1:-1, :-1]
        for one, other, ways in ((right, left, above & below), (above, below, right & left)):
            loose = (one ^ other) & ~ways
            one |= loose
            other |= loose
        if count == across.sum() + up.sum():
            return TMesh(knots[0], knots[1], across, up)


@st.composite
def edges(draw, m, n):
    """Booleans (m, n), most of them true."""
    bits = draw(st.binary(min_size=m * n, max_size=m * n))
    return (np.frombuffer(bits, dtype=np.uint8) >= 64).reshape(m, n)


def any_tmeshes():
    return st.one_of(split_at_will(), drawn_at_will())


def suitable_tmeshes():
    """Analysis-suitable T-meshes of every origin there is."""
    return st.one_of(
        bisections().map(lambda mesh: mesh.tmesh),
        one_way(),
        st.builds(strip_tmesh, strips(), st.just((-0.5, 1.0)), st.booleans()),
        split_at_will().map(made_suitable),
        drawn_at_will().map(made_suitable),
    )


def ray(mesh: TMesh, i: int, j: int, step: tuple[int, int], hits: int) -> list[tuple[int, int]]:
    """Points where a walk from (i, j) meets the next lines that run across it."""
    found = []
    while len(found) < hits:
        i, j = i + step[0], j + step[1]
        arms = (mesh.up_ij[i, j], mesh.up_ij[i, j - 1]) if step[0] else (mesh.across_ij[i, j], mesh.across_ij[i - 1, j])
        if any(arms):
            found.append((i, j))
    return found


def arms(mesh: TMesh, i: int, j: int) -> dict[tuple[int, int], bool]:
    """For each direction whether an edge leaves the point."""
    return {
        (1, 0): mesh.across_ij[i, j],
        (-1, 0): mesh.across_ij[i - 1, j],
        (0, 1): mesh.up_ij[i, j],
        (0, -1): mesh.up_ij[i, j - 1],
    }


def inner_points(mesh: TMesh) -> list[tuple[int, int]]:
    """Index points of the domain, i runs fastest."""
    m, n = len(mesh.knots_i), len(mesh.knots_j)
    return [(i, j) for j in range(2, n - 2) for i in range(2, m - 2)]


def walked_anchors(mesh: TMesh) -> list[tuple[int, int]]:
    """Points of the domain that lie on a line of each direction."""
    found = []
    for i, j in inner_points(mesh):
        leaves = arms(mesh, i, j)
        if (leaves[1, 0] or leaves[-1, 0]) and (leaves[0, 1] or leaves[0, -1]):
            found.append((i, j))
    return found


def walked_knots(mesh: TMesh) -> list[tuple[list[float], list[float]]]:
    """Local knot vectors of all anchors: two lines met on either side."""
    found = []
    for i, j in walked_anchors(mesh):
        left, right = ray(mesh, i, j, (-1, 0), 2), ray(mesh, i, j, (1, 0), 2)
        below, above = ray(mesh, i, j, (0, -1), 2), ray(mesh, i, j, (0, 1), 2)
        found.append(
            (
                [mesh.knots_i[a] for a, _ in left[::-1] + [(i, j)] + right],
                [mesh.knots_j[b] for _, b in below[::-1] + [(i, j)] + above],
            )
        )
    return found


def walked_extensions(mesh: TMesh) -> tuple[set, set]:
    """Points covered by horizontal and by vertical extensions: two lines on, one back."""
    covered = set(), set()
    for i, j in inner_points(mesh):
        missing = [step for step, drawn in arms(mesh, i, j).items() if not drawn]
        if len(missing) != 1:
            continue
        (a, b) = step = missing[0]
        end, start = ray(mesh, i, j, step, 2)[-1], ray(mesh, i, j, (-a, -b), 1)[0]
        (i0, i1), (j0, j1) = sorted([start[0], end[0]]), sorted([start[1], end[1]])
        points = [(x, y) for x in range(i0, i1 + 1) for y in range(j0, j1 + 1)]
        covered[0 if a else 1].update(points)
    return covered


def cubic(knots: list[float], x: np.ndarray) -> np.ndarray:
    """One cubic B-spline by the recursion of Cox and de Boor, written out (Piegl and Tiller 1997, eq. 2.5)."""
    N = [((a <= x) & (x < b)).astype(float) for a, b in zip(knots, knots[1:], strict=False)]
    for r in range(1, 4):
        finer = []
        for k in range(4 - r):
            rise, fall = knots[k + r] - knots[k], knots[k + r + 1] - knots[k + 1]
            up = (x - knots[k]) / rise * N[k] if rise > 0 else 0.0 * x
            down = (knots[k + r + 1] - x) / fall * N[k + 1] if fall > 0 else 0.0 * x
            finer.append(up + down)
        N = finer
    return N[0]


def walked_values(mesh: TMesh, x_qi: np.ndarray) -> np.ndarray:
    """Values (n_q, n_A) of all functions, from their walked knot vectors alone."""
    return np.stack([cubic(s, x_qi[:, 0]) * cubic(t, x_qi[:, 1]) for s, t in walked_knots(mesh)], axis=-1)
