"""Right meshes of all kinds are sound; a mesh that is wrong in one place is named."""

from dataclasses import replace

import numpy as np
import pytest
from doctored_meshes import (
    C0,
    SMOOTH,
    arch,
    every,
    function_halved,
    point_unused,
    with_block,
    with_copies,
    with_elements,
)
from hypothesis import given, settings
from iga_files import SMALL, from_mesh, small
from random_tmeshes import suitable_tmeshes
from scipy.sparse import csr_array
from unstructured import polygon_mesh

from iga.bases.bspline import open_knots
from iga.bases.nurbs import nurbs_rectangle
from iga.files.cad_body import body_mesh
from iga.files.iga_format import mesh, write_iga
from iga.files.iga_reader import read_iga
from iga.mesh.extraction import Chain, ElementBlock, Mesh
from iga.mesh.rank import rank
from iga.mesh.soundness import UNITY, dependence, faults, missed_unity, unity_fault
from iga.tsplines.tspline import tspline_rectangle


def quads(*corners) -> Mesh:
    """Bilinear elements from their corners (4, 2): lower left, lower right, upper left, upper right."""
    points = np.concatenate([np.array(one, dtype=float) for one in corners])
    P_AI, number = np.unique(points, axis=0, return_inverse=True)
    conn_ea = number.reshape(-1, 4)
    C_eab = np.broadcast_to(np.eye(4), (len(conn_ea), 4, 4))
    return Mesh(P_AI, np.ones(len(P_AI)), (ElementBlock((1, 1), C_eab, conn_ea),))


def box(x, X, y, Y):
    return [(x, y), (X, y), (x, Y), (X, Y)]


def strip(aspect: float, degree: int = 3) -> Mesh:
    return nurbs_rectangle(open_knots(np.linspace(0.0, 1.0, 6), degree), open_knots(np.array([0.0, aspect]), degree))


def thin_ring(thickness: float) -> Mesh:
    """Three quarters of a circle, one element through the thickness, a quarter each."""
    c, q = np.array([(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1)]), np.sqrt(0.5)
    knots = open_knots(np.array([0.0, 1.0, 1.0, 2.0, 2.0, 3.0]), 2)
    body = nurbs_rectangle(knots, open_knots(np.array([0.0, 1.0]), 1))
    P_AI = np.concatenate([(1.0 + thickness) * c, c * 1.0])
    return replace(body, P_AI=P_AI, w_A=np.tile([1.0, q, 1.0, q, 1.0, q, 1.0], 2))


def closed_ring(spans: int = 5) -> Mesh:
    """A C1 ring of quadratic elements whose functions go around it, one element through its thickness."""
    around = np.array([[0.5, 0.0, 0.0], [0.5, 1.0, 0.5], [0.0, 0.0, 0.5]])
    e = np.arange(spans)
    C_eab = np.broadcast_to(np.kron(np.eye(2), around), (spans, 6, 6))
    turn = (e[:, None] + np.arange(3)) % spans
    conn_ea = np.concatenate([turn, turn + spans], axis=1)
    angle = 2.0 * np.pi * e / spans
    circle = np.stack([np.cos(angle), np.sin(angle)], -1)
    P_AI = np.concatenate([2.0 * circle, circle])
    return Mesh(P_AI, np.ones(2 * spans), (ElementBlock((2, 1), C_eab, conn_ea),))


def mixed() -> Mesh:
    """Functions along the bottom of which all but the first and last live on every element, as in hierarchies."""
    body = arch()
    (block,) = body.blocks
    n = 7
    T_ab = np.eye(n)
    T_ab[1:-1, 1:-1] += 0.3 * np.roll(np.eye(n - 2), 1, axis=0) + 0.2 * np.ones((n - 2, n - 2))
    T_AB = np.kron(np.eye(n), T_ab / T_ab.sum(0))
    N_eAb = np.zeros((body.elements, n * n, block.C_eab.shape[2]))
    for e in range(body.elements):
        N_eAb[e, block.conn_ea[e]] = block.C_eab[e]
    C_eab, conn_ea = T_AB @ N_eAb, np.broadcast_to(np.arange(n * n), (body.elements, n * n))
    return replace(with_block(body, C_eab=C_eab, conn_ea=conn_ea), P_AI=np.linalg.solve(T_AB.T, body.P_AI))


def disc() -> Mesh:
    """Six triangles, each an element with a side that is a point."""
    angle = np.pi / 3.0 * np.arange(7)
    rim = np.round(np.stack([np.cos(angle), np.sin(angle)], -1), 12)
    return quads(*([(0, 0), rim[i], (0, 0), rim[i + 1]] for i in range(6)))


def slit(named: bool) -> Mesh:
    """A grid whose middle line is open from one end to the middle, the faces on each other."""
    whole = quads(*(box(i, i + 1, j, j + 1) for j in (0, 1) for i in range(4)))
    (block,) = whole.blocks
    on_line = np.flatnonzero((whole.P_AI[:, 1] == 1) & (whole.P_AI[:, 0] < 2))
    body = with_copies(whole, np.arange(4, 8), on_line)
    faces = {"below": (np.arange(2), "TOP"), "above": (np.arange(4, 6), "BOTTOM")}
    chains = {
        k: Chain(np.zeros(2, dtype=int), e[:: 1 - 2 * (s == "TOP")], np.full(2, s), 1.0) for k, (e, s) in faces.items()
    }
    return replace(body, chains=chains if named else {})


RIGHT = {
    "arch": lambda: arch(),
    "C1 arch": lambda: arch(2),
    "C0 arch": lambda: arch(1),
    "triangle": lambda: polygon_mesh(3, 2),
    "hexagon": lambda: polygon_mesh(6, 3),
    "thin strip": lambda: strip(1e-5),
    "high strip": lambda: strip(1e4),
    "thin ring": lambda: thin_ring(1e-4),
    "ring around": closed_ring,
    "ring of three": lambda: closed_ring(3),
    "disc": disc,
    "many functions on every side": mixed,
    "slit with names": lambda: slit(True),
    "hole in a C0 mesh": lambda: with_elements(arch(1), np.delete(every(arch(1)), 5)),
    "narrow slot": lambda: quads(
        box(0, 1, 0, 1), box(0, 1, 1, 1.02), box(0, 1, 1.02, 2), box(1, 3, 0, 1), box(1, 3, 1.02, 2)
    ),
    "notch": lambda: quads(box(0, 1, -1, 0), box(0, 1, 0, 1), [(1, -1), (3, -1), (1, 0), (3, -0.1)],
                           [(1, 0), (3, 0.1), (1, 1), (3, 1)]),
    "far from the origin": lambda: replace(arch(), P_AI=arch().P_AI + 1e6),
    "small": lambda: replace(arch(), P_AI=arch().P_AI * 1e-12),
}  # fmt: skip


@pytest.mark.parametrize("name", RIGHT)
def test_right_meshes_are_sound(name):
    body = RIGHT[name]()
    if name != "slit with names":
        body = replace(body, chains={})
    assert faults(body) == () and missed_unity(body) < UNITY


def test_hanging_nodes_are_no_tears(tmp_path):
    assert faults(mesh(read_iga(small(tmp_path)))) == ()


@settings(max_examples=60)
@given(mesh=suitable_tmeshes())
def test_tsplines_are_sound(mesh):
    body = tspline_rectangle(mesh)
    assert faults(body) == () and unity_fault(body) == ()


#: With quadratic elements the exchange of rows folds the element, which the reader refuses before.
FOLDED = (2, "rows of one element exchanged")


@pytest.mark.parametrize(("degree", "kind"), [(p, kind) for p in (2, 3) for kind in SMOOTH if (p, kind) != FOLDED])
def test_what_is_wrong_in_a_smooth_mesh_is_named(degree, kind):
    doctor, words = SMOOTH[kind]
    body = doctor(arch(degree))
    found = (*faults(body), *unity_fault(body))
    assert any(words.removesuffix(" 4.4") in sentence for sentence in found), found


@pytest.mark.parametrize("kind", C0)
def test_what_is_wrong_in_a_c0_mesh_is_named(kind):
    doctor, words = C0[kind]
    found = faults(doctor(arch(1)))
    assert any(words in sentence for sentence in found), found


def test_a_slit_without_names_is_a_tear():
    (sentence,) = faults(slit(False))
    assert sentence == (
        "the mesh is torn: 4 sides of the boundary on each other, the first near (0.5, 1); "
        "the faces of a slit have to be side sets"
    )


def test_an_element_missing_beside_a_hanging_node(tmp_path):
    body = mesh(read_iga(small(tmp_path)))
    for gone in (1, 2):
        (sentence,) = faults(with_elements(body, np.delete(every(body), gone)))
        assert sentence == "the mesh is torn: 1 side shared in part, the first near (1, 0.5)"


def test_sides_that_agree_in_the_middle_only():
    """Two functions that differ along a side by a cubic with a zero in its middle."""
    body = arch()
    C_eab = body.blocks[0].C_eab.copy()
    C_eab[5, 5, [1, 2]] += [1e-3, -1e-3]
    C_eab[5, 6, [1, 2]] -= [1e-3, -1e-3]
    (sentence,) = faults(with_block(body, C_eab=C_eab))
    assert sentence.startswith("the mesh is torn: 1 side shared in part")


def bilinear(P_AI, *elements) -> Mesh:
    """Elements (control points, coefficients at the corners)."""
    conn_ea, C_eab = (np.array(part) for part in zip(*elements, strict=True))
    return Mesh(np.array(P_AI, dtype=float), np.ones(len(P_AI)), (ElementBlock((1, 1), C_eab.astype(float), conn_ea),))


def test_an_element_over_a_half_of_another():
    """With the functions of that one."""
    half = [[1, 0, 0.5, 0], [0, 1, 0, 0.5], [0, 0, 0.5, 0], [0, 0, 0, 0.5]]
    body = bilinear(box(0, 1, 0, 1), ([0, 1, 2, 3], np.eye(4)), ([0, 1, 2, 3], half))
    assert faults(body)[0].startswith("elements lie on each other: ")


def test_two_neighbours_over_each_other_on_one_side():
    """One beside the lower 0.6 of a side, the other beside its upper 0.6."""
    P_AI = [*box(0, 1, 0, 1), (2, 0), (2, 0.6), (2, 0.4), (2, 1)]
    lower = [[1, 0, 0.4, 0], [0, 0, 0.6, 0], [0, 1, 0, 0], [0, 0, 0, 1]]
    upper = [[0.6, 0, 0, 0], [0.4, 0, 1, 0], [0, 1, 0, 0], [0, 0, 0, 1]]
    body = bilinear(P_AI, ([0, 1, 2, 3], np.eye(4)), ([1, 3, 4, 5], lower), ([1, 3, 6, 7], upper))
    assert faults(body) == (
        "elements lie on each other: 2 sides with more than one neighbour, the first near (1, 0.3)",
    )


def test_a_ring_that_goes_around_twice():
    """Eight elements, a quarter each, the last one beside the first: the boundary lies on itself all along."""
    angle = 0.5 * np.pi * np.arange(8)
    circle = np.stack([np.cos(angle), np.sin(angle)], -1)
    e = np.arange(8)
    corners = np.stack([e + 8, (e + 1) % 8 + 8, e, (e + 1) % 8], -1)
    body = bilinear(np.concatenate([circle, 2.0 * circle]), *((one, np.eye(4)) for one in corners))
    (sentence,) = faults(body)
    assert sentence.startswith("elements overlap: 16 sides of the boundary inside the body")


def test_a_body_that_is_bent_over_itself():
    """A bar of three elements that comes back over its first one; all Jacobians are positive."""
    bar = quads(box(0, 2, 0, 1), [(2, 0), (4, 0), (2, 1), (3, 1)], [(4, 0), (4, 3), (3, 1), (3, 2)],
                [(4, 3), (1.9, 3.2), (3, 2), (1.9, 2)], [(1.9, 3.2), (0.2, 3), (1.9, 2), (1.0, 0.5)])  # fmt: skip
    (sentence,) = faults(bar)
    assert sentence.startswith("elements overlap: ") and "inside the body" in sentence


def test_two_squares_with_one_corner():
    assert faults(quads(box(0, 1, 0, 1), box(1, 2, 1, 2))) == (
        "the mesh falls into 2 pieces that share no side, the smallest near (0, 0.5)",
    )
    around = quads(*(box(i, i + 1, j, j + 1) for i in range(4) for j in range(4) if (i, j) not in ((1, 1), (2, 2))))
    assert faults(around) == ("the boundary touches itself in a vertex near (2, 2)",)


def test_the_sum_may_be_that_with_weights(rng):
    body = arch()
    w_A = 0.5 + rng.random(len(body.w_A))
    (block,) = body.blocks
    semi = replace(with_block(body, C_eab=block.C_eab / w_A[block.conn_ea][..., None]), w_A=w_A)
    assert missed_unity(semi) < 1e-14
    assert missed_unity(replace(semi, w_A=np.ones_like(w_A))) > 0.1


@pytest.mark.parametrize(("factor", "found"), [(1.0 + 0.9 * UNITY, False), (1.0 + 1.1 * UNITY, True)])
def test_what_a_sum_may_miss_one_by(factor, found):
    body = quads(box(0, 1, 0, 1))
    C_eab = np.array(body.blocks[0].C_eab)
    C_eab[0, 0] *= factor
    assert bool(unity_fault(with_block(body, C_eab=C_eab))) == found


@pytest.mark.parametrize(("z", "refused"), [(6e-17, False), (1e-6, True), (-0.3, True)])
def test_a_plane_has_no_third_coordinate(z, refused, tmp_path):
    file = read_iga(small(tmp_path, SMALL.replace("node 2 0.5 0", f"node 2 0.5 {z!r}")))
    if refused:
        with pytest.raises(ValueError, match=r"node 5: z must be 0 in a plane, got "):
            mesh(file)
    else:
        assert mesh(file).elements == 3


@pytest.mark.parametrize("kind", ["an element twice", "a row scaled", "a function scaled", "two halves"])
def test_a_body_that_is_not_sound_is_refused(kind, tmp_path):
    doctor, words = SMOOTH[kind]
    flat = nurbs_rectangle(*[open_knots(np.linspace(0.0, 1.0, 5), 3)] * 2)
    write_iga(from_mesh(replace(flat, chains={})), tmp_path / "body.iga")
    assert body_mesh(tmp_path / "body.iga").elements == 16
    write_iga(from_mesh(replace(doctor(flat), chains={})), tmp_path / "body.iga")
    with pytest.raises(ValueError, match=f"body.iga: .*{words}"):
        body_mesh(tmp_path / "body.iga")


@pytest.mark.parametrize("doctor", [function_halved, point_unused])
def test_functions_that_depend_on_others_are_named(doctor):
    """And nothing else: they tear no mesh."""
    body = doctor(arch(spans=8))
    count = len(body.P_AI)
    assert faults(body) == () and unity_fault(body) == () and dependence(arch()) == ()
    assert dependence(body) == (f"the functions are dependent: rank {count - 1} of {count}",)


def test_of_few_functions_the_rank_is_counted_and_no_bound():
    assert rank(csr_array(np.ones((4, 3)))) == 1
