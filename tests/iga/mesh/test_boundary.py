"""Boundaries found from extraction alone, hanging nodes and slits included, and the four sides of a body."""

from dataclasses import replace

import numpy as np
import pytest
from boundary import boundary_chains
from iga_files import SMALL, from_mesh, real, small

from iga.bases.bspline import open_knots
from iga.bases.nurbs import nurbs_rectangle
from iga.elements.shape_functions import chain_basis
from iga.files.cad_body import RECTANGLE, body_mesh
from iga.files.iga_format import mesh, write_iga
from iga.files.iga_reader import read_iga
from iga.interface.surface import normal, surface
from iga.mesh.bernstein import bernstein
from iga.mesh.edges import element_sides
from iga.mesh.extraction import ElementBlock, Mesh
from iga.mesh.quadrature import gauss


def strip():
    return nurbs_rectangle(open_knots(np.linspace(0.0, 14.0, 8), 3), open_knots(np.array([0.0, 0.1, 0.2]), 3))


def length(body, chain):
    return sum(basis.dV_eq.sum() for basis in chain_basis(body, chain, *gauss(10)))


def walk(body, chain):
    """Start and end (n_c, 2) of the sides of a chain as they are walked."""
    curve = surface(body, chain, 0)
    X_cbI = curve.bezier_points(body.P_AI) / curve.w_cb[..., None]
    return X_cbI[:, 0], X_cbI[:, -1]


def test_the_boundary_of_a_strip_is_one_loop_around_it():
    body = strip()
    (chain,) = boundary_chains(body)
    start, end = walk(body, chain)
    assert len(chain.element_c) == 2 * (7 + 2) and chain.outward == 1.0
    assert np.allclose(end, np.roll(start, -1, axis=0), atol=1e-13)
    assert length(body, chain) == pytest.approx(28.4, rel=1e-14)


def test_normals_point_out_of_the_body():
    """Of the divergence theorem: the boundary integral of X . n is twice the area."""
    body = strip()
    (chain,) = boundary_chains(body)
    points, weights = gauss(4)
    c, xi = np.repeat(np.arange(len(chain.element_c)), 4), np.tile(points, len(chain.element_c))
    curve = surface(body, chain, 0)
    H_cbI = curve.bezier_points(body.P_AI)
    r, dr = curve.coefficients(c, xi, 1)
    X, X_t = (np.einsum("qb,qbI->qI", v, H_cbI[c]) for v in (r, dr))
    flux = np.sum(X * normal(X_t, chain.outward), 1) * np.linalg.norm(X_t, axis=1) * np.tile(weights, len(H_cbI))
    assert flux.sum() == pytest.approx(2 * 14.0 * 0.2, rel=1e-13)


def test_a_side_with_a_hanging_node_is_inside(tmp_path):
    body = mesh(read_iga(small(tmp_path)))
    sides = element_sides(body)
    (chain,) = boundary_chains(body)
    assert length(body, chain) == pytest.approx(6.0, rel=1e-14)
    assert len(chain.element_c) == 7
    vertex, side = sides.hanging.T
    assert len(vertex) == 1 and (sides.element_k[side[0]], sides.side_k[side[0]]) == (0, "RIGHT")


@pytest.mark.parametrize("at", [0.3, 0.05, 2.0 / 3.0])
def test_a_hanging_node_anywhere(tmp_path, at):
    """The node on the long side at any part of it, the functions of the long side its interpolation."""
    text = SMALL.replace("node 2 0.5", f"node 2 {at!r}")
    text = text.replace("1 0 0.5 0\n0 0 0.5 0", f"1 0 {1 - at!r} 0\n0 0 {at!r} 0")
    text = text.replace("0.5 0 0 0\n0.5 0 1 0", f"{1 - at!r} 0 0 0\n{at!r} 0 1 0")
    body = mesh(read_iga(small(tmp_path, text)))
    sides = element_sides(body)
    ((vertex, side),) = sides.hanging
    k = np.flatnonzero(sides.vertex_kv[:, 0] == vertex)[:1]
    assert sides.points(k, np.zeros(1))[0, :2] == pytest.approx([1.0, at], abs=1e-15)
    assert len(boundary_chains(body)[0].element_c) == 7


def test_a_slit_is_boundary():
    """The middle line of a strip with functions of its own on either face, up to a tip inside."""
    kv_s, kv_t = open_knots(np.linspace(0.0, 4.0, 5), 1), open_knots(np.array([-1.0, 0.0, 1.0]), 1)
    body = nurbs_rectangle(kv_s, kv_t)
    (block,), n_s = body.blocks, 5
    conn_ea, slit = block.conn_ea.copy(), np.arange(n_s, 2 * n_s - 2)
    upper = np.arange(len(conn_ea)) >= 4
    conn_ea[upper] = np.where(np.isin(conn_ea[upper], slit), conn_ea[upper] - n_s + len(body.P_AI), conn_ea[upper])
    P_AI = np.concatenate([body.P_AI, body.P_AI[slit]])
    opened = Mesh(P_AI, np.ones(len(P_AI)), (ElementBlock((1, 1), block.C_eab, conn_ea),))
    (chain,) = boundary_chains(opened)
    assert length(opened, chain) == pytest.approx(12.0 + 2 * 3.0, rel=1e-14)
    (whole,) = boundary_chains(body)
    assert length(body, whole) == pytest.approx(12.0, rel=1e-14)


def test_two_loops_around_a_ring():
    """A ring of four elements whose last sides meet the first: an inner and an outer loop."""
    corner = np.array([(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)])
    P_AI = np.concatenate([corner, 2.0 * corner])
    e = np.arange(4)
    conn_ea = np.stack([e + 4, (e + 1) % 4 + 4, e, (e + 1) % 4], -1)
    ring = Mesh(P_AI, np.ones(8), (ElementBlock((1, 1), np.broadcast_to(np.eye(4), (4, 4, 4)), conn_ea),))
    lengths = sorted(length(ring, chain) for chain in boundary_chains(ring))
    assert lengths == pytest.approx([4 * np.sqrt(2.0), 8 * np.sqrt(2.0)], rel=1e-14)


def test_degrees_are_raised_without_changing_the_curve(rng):
    """Sides of a quadratic beside those of a quartic: the same points."""
    body = nurbs_rectangle(open_knots(np.array([0.0, 1.0]), 2), open_knots(np.array([0.0, 1.0]), 4))
    body = replace(body, P_AI=body.P_AI + 0.05 * rng.normal(size=body.P_AI.shape), w_A=0.5 + rng.random(len(body.w_A)))
    sides, t = element_sides(body), rng.random(7)
    k = int(sides.find(np.array([0]), np.array([0]), np.array(["BOTTOM"]))[0])
    w, B = body.w_A[:3], bernstein(2, t)  # one element: the first three control points are its bottom
    expected = (B * w) @ body.P_AI[:3] / (B @ w)[:, None]
    assert np.allclose(sides.points(np.full(7, k), t)[:, :2], expected, rtol=0, atol=1e-14)


@pytest.mark.parametrize("spelling", ["{}", "{}_side", "edges_{}", "{} ".strip(), "{}Side"])
def test_body_of_a_file_by_names(tmp_path, spelling):
    body = strip()
    named = {spelling.format(name.capitalize()): chain for name, chain in body.chains.items()}
    write_iga(from_mesh(replace(body, chains=named)), tmp_path / "strip.iga")
    found = body_mesh(tmp_path / "strip.iga")
    for name, chain in body.chains.items():
        assert found.chains[name].element_c.tolist() == chain.element_c.tolist()
        assert set(found.chains[name].side_c) == set(chain.side_c)
        assert found.chains[name].outward == chain.outward


def test_body_of_a_file_without_sets(tmp_path):
    body = strip()
    write_iga(from_mesh(replace(body, chains={})), tmp_path / "strip.iga")
    found = body_mesh(tmp_path / "strip.iga")
    assert set(found.chains) == set(RECTANGLE)
    for name, chain in body.chains.items():
        assert found.chains[name].element_c.tolist() == chain.element_c.tolist()
        assert found.chains[name].outward == chain.outward


@pytest.mark.parametrize("inner", [(14.2, 13.0), (1.0, -0.2)])
def test_the_ends_of_a_body_are_where_its_corners_are(tmp_path, inner):
    """Control points reach beyond them where lengths are uneven, the body does not."""
    body = nurbs_rectangle(*(open_knots(np.array([0.0, end]), 3) for end in (14.0, 0.2)))
    P_AI = body.P_AI.copy()
    for number, x in enumerate(inner, 1):
        P_AI[number::4, 0] = x
    for turn in (np.eye(2), -np.eye(2), np.array([[0.0, 1.0], [-1.0, 0.0]])):
        write_iga(from_mesh(replace(body, P_AI=P_AI @ turn, chains={})), tmp_path / "uneven.iga")
        found = body_mesh(tmp_path / "uneven.iga")
        lengths = {name: length(found, chain) for name, chain in found.chains.items()}
        long, short = ("bottom", "top"), ("left", "right")
        if turn[0, 0] == 0.0:
            long, short = short, long
        assert [lengths[name] for name in short] == pytest.approx([0.2] * 2)
        assert min(lengths[name] for name in long) > 13.99


def test_names_come_before_places(tmp_path):
    """A body that lies on its side keeps the names of its sets."""
    body = strip()
    turned = replace(body, P_AI=body.P_AI @ np.array([[0.0, 1.0], [-1.0, 0.0]]))
    write_iga(from_mesh(turned), tmp_path / "strip.iga")
    found = body_mesh(tmp_path / "strip.iga")
    assert length(found, found.chains["bottom"]) == pytest.approx(14.0, rel=1e-14)


def test_elements_seen_from_behind(tmp_path):
    """Some elements with s reversed, as left-handed exports have them: the same body, the same sides."""
    body = strip()
    (block,) = body.blocks
    back = np.arange(16).reshape(4, 4)[:, ::-1].ravel()
    C_eab = block.C_eab.copy()
    C_eab[1::2] = C_eab[1::2][:, :, back]
    file = from_mesh(replace(body, blocks=(replace(block, C_eab=C_eab),), chains={}))
    write_iga(file, tmp_path / "strip.iga")
    found = body_mesh(tmp_path / "strip.iga")
    assert np.array_equal(found.blocks[0].C_eab, block.C_eab)
    for name, chain in body.chains.items():
        assert found.chains[name].element_c.tolist() == chain.element_c.tolist()
        assert found.chains[name].side_c.tolist() == chain.side_c.tolist()


def test_side_sets_of_elements_seen_from_behind():
    body = strip()
    (block,) = body.blocks
    back = np.arange(16).reshape(4, 4)[:, ::-1].ravel()
    file = from_mesh(body)
    swapped = {"LEFT": "RIGHT", "RIGHT": "LEFT"}
    sets = tuple(replace(part, sides=tuple(swapped.get(side, side) for side in part.sides)) for part in file.sets)
    found = mesh(replace(file, blocks=(replace(block, C_eab=block.C_eab[:, :, back]),), sets=sets))
    assert set(found.chains["left"].side_c) == {"LEFT"} and set(found.chains["right"].side_c) == {"RIGHT"}
    assert length(found, found.chains["top"]) == pytest.approx(14.0, rel=1e-14)


def test_a_set_in_pieces_becomes_several_chains(tmp_path):
    text = SMALL.replace("set 2 side Right_side 2 RIGHT 1 RIGHT", "set 3 side ends 2 RIGHT 0 LEFT 1 RIGHT")
    chains = mesh(read_iga(small(tmp_path, text))).chains
    assert {name: len(chain.element_c) for name, chain in chains.items()} == {"ends-1": 2, "ends-2": 1}


def test_a_set_inside_the_body_is_no_chain(tmp_path):
    text = SMALL.replace("set 2 side Right_side 2 RIGHT 1 RIGHT", "set 2 side middle 1 TOP 2 BOTTOM")
    assert mesh(read_iga(small(tmp_path, text))).chains == {}


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (("Right_side 2 RIGHT 1 RIGHT", "left 2 RIGHT 0 LEFT"), "side set left: must be one connected chain"),
        (("Right_side 2 RIGHT 1 RIGHT", "Top 2 BOTTOM 1 TOP"), "side set Top: must be one connected chain"),
        (
            ("set 2 node ends", "set 2 side LEFT_edge 0 LEFT 0 BOTTOM\nset 1 side left 0 LEFT\nset 2 node ends"),
            "got LEFT",
        ),
        (("node 2 0.5 0 1", "node 2.5 0.5 0 1\n#"), "no side set is named right, and no side"),
        (("node 0 1 0 1", "node 0.9 0.1 0 1"), "Jacobians must be > 0"),
        (("type plane", "type surface"), "type: must be plane"),
    ],
)
def test_a_side_that_cannot_be_found_is_refused(tmp_path, change, reason):
    text = SMALL.replace(*change)
    if "no side" in reason:
        text = text.replace("Right_side", "wet")
    with pytest.raises(ValueError, match=reason) as refusal:
        body_mesh(small(tmp_path, text))
    assert str(refusal.value).startswith(str(tmp_path / "small.iga"))


def test_real_bodies():
    """Every side of the files whose sides are named, by its length; the hole's loop is one with the outline."""
    lengths = {"left": 3.0, "right": 4.0, "bottom": 3.0, "top": 4.0, "edges_hole": np.pi / 2}
    body = body_mesh(real("plate_with_hole"))
    assert "edges_diagonal" not in body.chains
    for name, expected in lengths.items():
        assert length(body, body.chains[name]) == pytest.approx(expected, rel=1e-14)
    for name in ("square_structured", "square_unstructured"):
        body = body_mesh(real(name))
        assert [length(body, body.chains[side]) for side in RECTANGLE] == pytest.approx([1.0] * 4, rel=1e-14)
        (loop,) = boundary_chains(body)
        start, end = walk(body, loop)
        assert np.allclose(end, np.roll(start, -1, axis=0), rtol=0, atol=1e-14)
