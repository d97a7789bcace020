"""`.iga` files for tests: real ones where they are at hand, and a small one with a hanging node."""

from pathlib import Path

import numpy as np
import pytest

from iga.files.iga_format import IgaFile, NamedSet
from iga.mesh.extraction import ElementBlock, Mesh

REAL = ("arch_nurbs", "arch_tsplines", "plate_with_hole", "square_structured", "square_unstructured")

#: Two elements beside one: its right side has a hanging node in the middle. Bilinear, exact in binary.
SMALL = """# three elements
type plane
nodeN 7
elemN 3
node 0 0 0 1
node 1 0 0 1
node 1 1 0 1
node 0 1 0 1
node 2 0 0 1
node 2 0.5 0 1
node 2 1 0 1
belem 4 1 1
0 1 3 2
1 0 0 0
0 1 0 0
0 0 1 0
0 0 0 1
belem 4 1 1
1 2 4 5
1 0 0.5 0
0 0 0.5 0
0 1 0 0
0 0 0 1
belem 4 1 1
1 2 5 6
0.5 0 0 0
0.5 0 1 0
0 1 0 0
0 0 0 1
set 2 side Right_side 2 RIGHT 1 RIGHT
set 2 node ends 0 6
set 1 elem first 0
domain 1 4
0
0 1 2 3
0 1 3 2
"""


def real(name: str) -> Path:
    """A file written by the plug-in."""
    path = Path(__file__).parents[3] / "shared" / "iga" / f"{name}.iga"
    if not path.exists():
        pytest.skip(f"the plug-in's file {path.name} is not at hand")
    return path


def small(folder: Path, text: str = SMALL) -> Path:
    path = folder / "small.iga"
    path.write_text(text)
    return path


def from_mesh(body: Mesh) -> IgaFile:
    """The file of a body in the plane: elements block by block, every chain a side set."""
    first = body.first_b
    block_e = np.repeat(np.arange(len(body.blocks)), np.diff(first))
    sets = tuple(
        NamedSet("side", "_".join(name.split()), first[chain.block_c] + chain.element_c, tuple(map(str, chain.side_c)))
        for name, chain in body.chains.items()
    )
    P_AI = np.column_stack([body.P_AI, np.zeros(len(body.P_AI))])
    return IgaFile("plane", P_AI, body.w_A, body.blocks, block_e, np.arange(first[-1]) - first[block_e], sets)


def random_file(rng: np.random.Generator) -> IgaFile:
    """Elements of several degrees and numbers of functions in mixed order; numbers of all magnitudes."""
    n_A, shapes = 40, [((3, 3), 16, 3), ((4, 2), 18, 2), ((1, 3), 8, 4)]
    magnitudes = 10.0 ** rng.integers(-12, 12, (n_A, 1))
    blocks = tuple(
        ElementBlock(
            degrees,
            rng.random((n_e, n_a, (degrees[0] + 1) * (degrees[1] + 1))) ** 9,
            np.stack([rng.choice(n_A, n_a, replace=False) for _ in range(n_e)]),
        )
        for degrees, n_a, n_e in shapes
    )
    order = rng.permutation(9)
    block_e = np.repeat([0, 1, 2], [3, 2, 4])[order]
    _, first = np.unique(block_e, return_index=True)
    rank = np.argsort(np.argsort(first))
    blocks = tuple(blocks[b] for b in np.argsort(first))
    block_e = rank[block_e]
    place_e = np.array([np.count_nonzero(block_e[:e] == b) for e, b in enumerate(block_e)])
    sets = (
        NamedSet("elem", "some", np.array([3, 1, 8])),
        NamedSet("side", "wet", np.array([5, 5, 0]), ("TOP", "LEFT", "BOTTOM")),
        NamedSet("node", "none", np.array([], dtype=int)),
    )
    return IgaFile(
        "plane", rng.normal(size=(n_A, 3)) * magnitudes, 0.1 + rng.random(n_A), blocks, block_e, place_e, sets
    )


def assert_same(a: IgaFile, b: IgaFile) -> None:
    """Equal to the last bit, signs of zeros included."""
    assert a.kind == b.kind
    for x, y in ((a.P_AI, b.P_AI), (a.w_A, b.w_A)):
        assert x.tobytes() == y.tobytes() and x.shape == y.shape
    assert [block.degrees for block in a.blocks] == [block.degrees for block in b.blocks]
    for one, other in zip(a.blocks, b.blocks, strict=True):
        assert np.array_equal(one.conn_ea, other.conn_ea)
        assert one.C_eab.tobytes() == other.C_eab.tobytes()
    assert np.array_equal(a.block_e, b.block_e) and np.array_equal(a.place_e, b.place_e)
    assert [(s.kind, s.name, s.ids.tolist(), s.sides) for s in a.sets] == [
        (s.kind, s.name, s.ids.tolist(), s.sides) for s in b.sets
    ]
    assert [_plain(domain) for domain in a.domains] == [_plain(domain) for domain in b.domains]


def _plain(domain) -> tuple:
    return domain.elements.tolist(), domain.functions.tolist(), [place.tolist() for place in domain.places]
