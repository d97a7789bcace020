"""`.iga` files: what is written is read again bit for bit, and what is malformed is refused with its line."""

import time
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from iga_files import REAL, SMALL, assert_same, from_mesh, random_file, real, small

from iga.files.iga_format import mesh, write_iga
from iga.files.iga_reader import IgaError, read_iga
from iga.mesh.bezier import homogeneous, jacobian
from iga.mesh.extraction import SIDES
from iga.mesh.quadrature import gauss, square

LINES = SMALL.splitlines()


def test_what_a_file_says(tmp_path):
    file = read_iga(small(tmp_path))
    assert file.kind == "plane"
    assert file.P_AI.tolist()[5] == [2.0, 0.5, 0.0] and file.w_A.tolist() == [1.0] * 7
    (block,) = file.blocks
    assert block.degrees == (1, 1) and block.conn_ea.tolist() == [[0, 1, 3, 2], [1, 2, 4, 5], [1, 2, 5, 6]]
    assert block.C_eab[1, 0].tolist() == [1.0, 0.0, 0.5, 0.0]
    assert [(s.kind, s.name, s.ids.tolist(), s.sides) for s in file.sets] == [
        ("side", "Right_side", [2, 1], ("RIGHT", "RIGHT")),
        ("node", "ends", [0, 6], ()),
        ("elem", "first", [0], ()),
    ]
    (domain,) = file.domains
    assert domain.functions.tolist() == [0, 1, 2, 3] and domain.places[0].tolist() == [0, 1, 3, 2]


@pytest.mark.parametrize("name", REAL)
def test_real_files_read_write_read(name, tmp_path):
    file = read_iga(real(name))
    write_iga(file, tmp_path / "again.iga")
    again = read_iga(tmp_path / "again.iga")
    assert_same(file, again)
    write_iga(again, tmp_path / "twice.iga")
    assert (tmp_path / "twice.iga").read_bytes() == (tmp_path / "again.iga").read_bytes()
    assert len(file.block_e) == sum(len(block.conn_ea) for block in file.blocks)


@pytest.mark.parametrize("seed", range(5))
def test_random_files_write_read(seed, tmp_path):
    file = random_file(np.random.default_rng(seed))
    file.P_AI[0, 2] = -0.0
    file.P_AI[1] = 5e-324, 0.1, 1e29 / 3.0
    write_iga(file, tmp_path / "random.iga")
    assert_same(file, read_iga(tmp_path / "random.iga"))


def test_elements_keep_their_order(tmp_path):
    """Blocks gather elements of one kind; the file knows where each of its elements went."""
    file = random_file(np.random.default_rng(3))
    write_iga(file, tmp_path / "random.iga")
    heads = [line.split()[1:] for line in (tmp_path / "random.iga").read_text().splitlines() if "belem" in line]
    expected = [file.blocks[b] for b in file.block_e]
    assert heads == [[str(b.conn_ea.shape[1]), *map(str, b.degrees)] for b in expected]
    assert len(set(map(tuple, heads))) == 3


def test_line_ends_comments_and_blank_lines_do_not_matter(tmp_path):
    file = read_iga(small(tmp_path))
    loose = SMALL.replace("\n", "   # note\r\n\r\n# line\r\n \t").replace("node 1 ", "node\t+1.0e0 ")
    (tmp_path / "loose.iga").write_bytes(b"\xef\xbb\xbf" + loose.encode() + "# größer".encode())
    assert_same(file, read_iga(tmp_path / "loose.iga"))


def test_a_mesh_as_a_file(tmp_path):
    """The file of a mesh gives the mesh again, its chains as side sets."""
    body = mesh(read_iga(small(tmp_path)))
    write_iga(from_mesh(body), tmp_path / "mesh.iga")
    again = mesh(read_iga(tmp_path / "mesh.iga"))
    assert np.array_equal(again.P_AI, body.P_AI) and np.array_equal(again.blocks[0].C_eab, body.blocks[0].C_eab)
    (name,) = body.chains
    assert again.chains[name].element_c.tolist() == body.chains[name].element_c.tolist() == [1, 2]


def test_only_a_plane_is_a_mesh(tmp_path):
    file = read_iga(small(tmp_path, SMALL.replace("type plane", "type thickened_surface")))
    with pytest.raises(ValueError, match="type: must be plane for a body in the plane, got thickened_surface"):
        mesh(file)


def test_a_volume_is_read_and_written(tmp_path):
    text = "type volume\nnodeN 2\nelemN 1\nnode 0 0 1 1\nnode 1 0 2 0.5\nbelem 2 1 1 1\n1 0\n" + "0.5 0.5 " * 4 + "\n"
    file = read_iga(small(tmp_path, text + "1 1 1 1 1 1 1 1\n"))
    assert file.blocks[0].degrees == (1, 1, 1) and file.blocks[0].C_eab.shape == (1, 2, 8)
    write_iga(file, tmp_path / "volume.iga")
    assert_same(file, read_iga(tmp_path / "volume.iga"))


def changed(number: int, text: str) -> str:
    """The small file with another line; lines count from 1."""
    return "\n".join([*LINES[: number - 1], text, *LINES[number:]]) + "\n"


MALFORMED = {
    "empty": ("", 1, "expected type or nodeN or elemN, got the end of the file"),
    "only comments": ("# a\n# b", 2, "expected type or nodeN or elemN, got the end of the file"),
    "unknown type": (
        changed(2, "type solid"),
        2,
        "expected type plane, surface, thickened_surface or volume, got 'solid'",
    ),
    "type twice": (changed(3, "type plane"), 3, "expected nodeN or elemN, got 'type'"),
    "no number of elements": (changed(4, ""), 5, "expected elemN, got 'node'"),
    "two numbers of nodes": (changed(3, "nodeN 7 7"), 3, "expected 1 word after nodeN, got 2"),
    "negative count": (changed(3, "nodeN -7"), 3, "expected a number from 1 to 999999999, got '-7'"),
    "count that is none": (changed(4, "elemN three"), 4, "expected a number from 1 to 999999999, got 'three'"),
    "absurd count": (changed(3, "nodeN 99999999999999999999"), 3, "got '99999999999999999999'"),
    "huge count": (changed(3, "nodeN 999999999"), 12, "expected node 8 of 999999999, got 'belem'"),
    "huge count of elements": (changed(4, "elemN 999999999"), 30, "expected belem 4 of 999999999, got 'set'"),
    "too few nodes": (changed(8, "#"), 12, "expected node 7 of 7, got 'belem'"),
    "too many nodes": (changed(8, "node 0 1 0 1\nnode 0 1 0 1"), 12, "expected belem 1 of 3, got 'node'"),
    "node of three numbers": (changed(8, "node 0 1 0"), 8, "expected 4 numbers x y z w of a node, got 3"),
    "node that is no number": (
        changed(8, "node 0 1 0 one"),
        8,
        "expected 4 numbers x y z w of a node, all finite numbers, got 'one'",
    ),
    "NaN": (changed(8, "node nan 1 0 1"), 8, "all finite numbers, got 'nan'"),
    "infinite": (changed(8, "node 0 -inf 0 1"), 8, "all finite numbers, got '-inf'"),
    "overflow": (changed(8, "node 0 1e999 0 1"), 8, "expected numbers up to 1e+30 in magnitude, got inf"),
    "negative weight": (changed(8, "node 0 1 0 -1"), 8, "expected a weight > 0, 1e-30 or more, got -1"),
    "no weight": (changed(8, "node 0 1 0 0"), 8, "expected a weight > 0, 1e-30 or more, got 0"),
    "underscore": (changed(8, "node 0 1_0 0 1"), 8, "all finite numbers, got '1_0'"),
    "decimal comma": (changed(8, "node 0 1,5 0 1"), 8, "all finite numbers, got '1,5'"),
    "other digits": (changed(8, "node 0 ٣ 0 1"), 8, "all finite numbers, got '٣'"),
    "degree zero": (changed(12, "belem 4 0 1"), 12, "expected a degree from 1 to 20, got '0'"),
    "absurd degree": (changed(12, "belem 4 1 1000000"), 12, "expected a degree from 1 to 20, got '1000000'"),
    "a third degree": (changed(12, "belem 4 1 1 1"), 12, "expected a number of functions and 2 degrees, got 4 numbers"),
    "no functions": (changed(12, "belem 0 1 1"), 12, "expected a number of functions from 1 to 7, got '0'"),
    "too many functions": (changed(12, "belem 8 1 1"), 12, "expected a number of functions from 1 to 7, got '8'"),
    "node out of range": (changed(13, "0 1 3 7"), 13, "expected node ids from 0 to 6, got '7'"),
    "negative node": (changed(13, "0 1 3 -1"), 13, "expected node ids from 0 to 6, got '-1'"),
    "fraction of a node": (changed(13, "0 1 3 2.0"), 13, "expected node ids from 0 to 6, got '2.0'"),
    "too few ids": (changed(13, "0 1 3"), 13, "expected 4 node ids, got 3"),
    "function twice": (changed(13, "0 1 1 2"), 13, "expected different node ids, got 1 twice"),
    "short row": (changed(15, "0 1 0"), 15, "expected 4 coefficients of function 2 of 4 on element 0, got 3"),
    "long row": (changed(15, "0 1 0 0 0"), 15, "expected 4 coefficients of function 2 of 4 on element 0, got 5"),
    "short block": (
        changed(17, "#"),
        18,
        "expected 4 coefficients of function 4 of 4 on element 0, all finite numbers",
    ),
    "word in a row": (changed(15, "0 x 0 0"), 15, "all finite numbers, got 'x'"),
    "truncated": ("\n".join(LINES[:20]), 20, "expected 4 coefficients of function 2 of 4 on element 1, got the end"),
    "truncated in a row": ("\n".join(LINES[:20]) + "\n0 0 0", 21, "function 2 of 4 on element 1, got 3"),
    "element without volume": (changed(14, "0 0 0 0"), 12, "element 0 positive Bezier weights, got 0"),
    "hardly any Bezier weight": (changed(14, "1e-13 0 0 0"), 12, "element 0 positive Bezier weights, got 1e-13"),
    "negative Bezier weights": (changed(14, "-1 0 0 0"), 12, "element 0 positive Bezier weights, got -1"),
    "unknown keyword": (
        changed(30, "sett 2 side a 2 RIGHT 1 RIGHT"),
        30,
        "expected set, domain or the end of the file",
    ),
    "set too long": (changed(30, "set 1 side a 2 RIGHT 1 RIGHT"), 30, "an element and a side each, for 1 sides, got 4"),
    "set too short": (changed(31, "set 3 node ends 0 6"), 31, "expected 3 node ids, got 2"),
    "set of nothing": (changed(31, "set 3"), 31, "expected set, a number of entries, node, side or elem, and a name"),
    "set of huge size": (changed(31, "set 999999999 node ends 0 6"), 31, "expected 999999999 node ids, got 2"),
    "set of unknown kind": (changed(31, "set 2 nodes ends 0 6"), 31, "expected node, side or elem, got 'nodes'"),
    "set without a name": (changed(31, "set 2 node 3 0 6"), 31, "expected the name of the set, got '3'"),
    "unknown side": (changed(30, "set 1 side a 2 FRONT"), 30, "expected a side LEFT, RIGHT, BOTTOM, TOP, got 'FRONT'"),
    "side twice": (changed(30, "set 2 side a 2 TOP 2 TOP"), 30, "expected different sides, got (2, 'TOP') twice"),
    "element out of range": (changed(32, "set 1 elem first 3"), 32, "expected elem ids from 0 to 2, got '3'"),
    "same name twice": (
        changed(32, "set 1 node ends 3"),
        32,
        "expected different names of node sets, got 'ends' twice",
    ),
    "domain of nothing": (changed(33, "domain 0 4"), 33, "expected a number of elements from 1 to 3, got '0'"),
    "domain place out of range": (changed(36, "0 1 4 2"), 36, "expected domain ids from 0 to 3, got '4'"),
    "domain cut short": ("\n".join(LINES[:34]), 34, "expected 4 node ids, got the end"),
    "Latin-1": (SMALL.replace("ends", "Händel").encode("latin-1"), 31, "expected UTF-8 text, got the byte 0xe4"),
    "binary": (b"\x89PNG\r\n\x1a\n\x00\x00", 1, "expected UTF-8 text, got the byte 0x89"),
    "zeros": (b"\x00" * 100, 1, "expected type or nodeN or elemN, got"),
}


@pytest.mark.parametrize("what", MALFORMED)
def test_malformed_files_are_refused_with_their_line(what, tmp_path):
    text, line, reason = MALFORMED[what]
    path = tmp_path / "wrong.iga"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(IgaError) as refusal:
        read_iga(path)
    assert str(refusal.value).startswith(f"{path}: line {line}: expected ")
    assert reason in str(refusal.value)
    assert refusal.value.line == line and len(str(refusal.value)) < 400


def test_the_small_file_itself_is_well_formed(tmp_path):
    """Of the test above: none of its files is refused for something else."""
    assert read_iga(small(tmp_path, changed(1, "# other"))).kind == "plane"
    assert LINES[11] == "belem 4 1 1" and LINES[29].startswith("set 2 side") and LINES[32] == "domain 1 4"


SPICE = ["nan", "inf", "1e400", "-1", "0", "999999999", "belem", "node", "set", "#", "LEFT", "1e-320", "\x00", "é", ""]


@st.composite
def mutated(draw) -> bytes:
    """The small file with some bytes, words or lines changed, doubled, exchanged or lost."""
    data = SMALL.encode()
    for _ in range(draw(st.integers(1, 4))):
        kind = draw(st.sampled_from(["byte", "word", "line", "cut"]))
        if kind == "byte":
            at = draw(st.integers(0, max(len(data) - 1, 0)))
            data = data[:at] + bytes([draw(st.integers(0, 255))]) + data[at + draw(st.integers(0, 1)) :]
        elif kind == "cut":
            data = data[: draw(st.integers(0, len(data)))]
        else:
            gap = b" " if kind == "word" else b"\n"
            parts = data.split(gap)
            i, j = (draw(st.integers(0, len(parts) - 1)) for _ in range(2))
            new = draw(st.sampled_from([parts[j], *(spice.encode() for spice in SPICE)]))
            parts[i : i + draw(st.integers(0, 1))] = [new]
            data = gap.join(parts)
    return data


@given(data=mutated())
def test_any_file_is_refused_with_its_line_or_is_a_mesh(data, tmp_path_factory):
    path = tmp_path_factory.getbasetemp() / "mutated.iga"
    path.write_bytes(data)
    lines = len(data.splitlines()) + 1
    try:
        file = read_iga(path)
    except IgaError as refusal:
        assert 1 <= refusal.line <= lines and f"line {refusal.line}: expected " in str(refusal)
        return
    n_A, n_e = len(file.P_AI), len(file.block_e)
    assert file.P_AI.shape == (n_A, 3) and np.all(np.isfinite(file.P_AI)) and np.all(file.w_A > 0)
    for block in file.blocks:
        assert np.all(np.isfinite(block.C_eab)) and 0 <= block.conn_ea.min() and block.conn_ea.max() < n_A
    for part in file.sets:
        assert np.all((part.ids >= 0) & (part.ids < (n_A if part.kind == "node" else n_e)))
        assert set(part.sides) <= set(SIDES)
    write_iga(file, path)
    assert_same(file, read_iga(path))
    if file.kind == "plane":
        body = mesh(file)
        for block in body.blocks:
            points, _ = square(gauss(3), gauss(3))
            assert np.all(np.isfinite(jacobian(homogeneous(body.P_AI, body.w_A, block), block.degrees, points)))


def test_reading_is_fast():
    path = real("plate_with_hole")
    seconds = []
    for _ in range(3):
        start = time.process_time()
        read_iga(path)
        seconds.append(time.process_time() - start)
    assert min(seconds) < 0.3


@pytest.mark.parametrize("name", REAL)
def test_functions_of_real_files_add_up_to_one(name):
    """Column sums of the extraction operators: the plug-in writes 16 or 17 digits.

    One Bernstein coefficient of each biquartic element of the unstructured square, the one in the middle, misses it by
    3.2e-3 (valence 5) or 5.2e-3 (valence 3); value and gradient of that Bernstein polynomial vanish on all sides.
    """
    for block in read_iga(real(name)).blocks:
        p, q = block.degrees
        missed_eji = np.abs(block.C_eab.sum(1) - 1.0).reshape(-1, q + 1, p + 1)
        if block.degrees == (4, 4):
            expected = {18: 3.2189e-3, 14: 5.2083e-3}[block.conn_ea.shape[1]]
            assert missed_eji[:, 2, 2] == pytest.approx(expected, rel=1e-4)
            missed_eji[:, 2, 2] = 0.0
        assert missed_eji.max() < 2e-14


def test_volumes_and_weights_are_not_lost(tmp_path):
    """z and weights of nodes, which a plane does not need, are there after a round trip."""
    file = read_iga(small(tmp_path))
    moved = replace(file, P_AI=file.P_AI + 0.1, w_A=file.w_A * 0.3)
    write_iga(moved, tmp_path / "moved.iga")
    assert_same(moved, read_iga(tmp_path / "moved.iga"))
