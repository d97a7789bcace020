"""VTU files of Bezier cells: what VTK makes of them, and without VTK what they say."""

from pathlib import Path

import numpy as np
import pytest
from vtu_files import arrays

from iga.bases.bspline import open_knots
from iga.bases.nurbs import nurbs_mesh
from iga.mesh.bernstein import bernstein, tensor
from iga.mesh.extraction import ElementBlock, Mesh
from verify.fields.cells import vtk_order, write_vtu


def quarter_ring() -> Mesh:
    """Quarter of a ring between radii 1 and 2, along s the circle: exact with weights 1, 1/sqrt(2), 1."""
    corner = np.array([(1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    kv_s, kv_t = open_knots(np.array([0.0, 1.0]), 2), open_knots(np.array([0.0, 1.0]), 3)
    radii = 2.0 - np.linspace(0.0, 1.0, 4)  # s counterclockwise and t inwards: positive Jacobians
    P_AI = np.concatenate([radius * corner for radius in radii])
    return nurbs_mesh(kv_s, kv_t, P_AI, np.tile([1.0, np.sqrt(0.5), 1.0], 4))


def test_order_of_vtk():
    """A bicubic and a cell of degrees 2 and 3, by hand from the picture in VTK's file formats."""
    assert vtk_order((3, 3)).tolist() == [0, 3, 15, 12, 1, 2, 7, 11, 13, 14, 4, 8, 5, 6, 9, 10]
    assert vtk_order((2, 3)).tolist() == [0, 2, 11, 9, 1, 5, 8, 10, 3, 6, 4, 7]
    assert vtk_order((1, 1)).tolist() == [0, 1, 3, 2]


def test_what_a_file_says(tmp_path):
    """Declared attributes, and points that give the circle and a field that gives the position again."""
    ring = quarter_ring()
    write_vtu(ring, tmp_path / "ring.vtu", {"displacement": ring.P_AI, "x": ring.P_AI[:, 0]})
    found, root = arrays(tmp_path / "ring.vtu")
    assert root.find(".//PointData").get("RationalWeights") == "RationalWeights"
    assert root.find(".//PointData").get("Vectors") == "displacement"
    assert root.find(".//CellData").get("HigherOrderDegrees") == "HigherOrderDegrees"
    assert found["types"].ravel().tolist() == [77] and found["HigherOrderDegrees"].tolist() == [[2.0, 3.0, 0.0]]
    assert found["offsets"].ravel().tolist() == [12] and found["connectivity"].ravel().tolist() == list(range(12))
    xi = np.linspace(0.0, 1.0, 9)
    B_qb = tensor(bernstein(2, xi), bernstein(3, np.ones(9)))[:, vtk_order((2, 3))] * found["RationalWeights"].ravel()
    X = B_qb @ found["Points"] / B_qb.sum(1, keepdims=True)
    assert np.linalg.norm(X, axis=1) == pytest.approx(1.0, abs=1e-15)
    assert np.array_equal(found["displacement"], found["Points"])
    assert np.array_equal(found["x"][:, 0], found["Points"][:, 0])


def test_names_are_escaped(tmp_path):
    ring = quarter_ring()
    write_vtu(ring, tmp_path / "ring.vtu", {'<"σ" & τ>': ring.w_A})
    assert '<"σ" & τ>' in arrays(tmp_path / "ring.vtu")[0]


def in_vtk(path: Path):
    """The grid that VTK reads."""
    pytest.importorskip("vtkmodules.vtkIOXML", reason="the vtk package is not installed")
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    assert reader.GetErrorCode() == 0
    return reader.GetOutput()


def evaluated(grid, cell: int, s: float, t: float, field: str | None = None) -> np.ndarray:
    """Position, or a field, at parameters of a cell, by VTK's own shape functions."""
    place, sub, weights = [0.0] * 3, [0], [0.0] * grid.GetCell(cell).GetNumberOfPoints()
    element = grid.GetCell(cell)
    element.EvaluateLocation(_reference(sub), [s, t, 0.0], place, weights)
    if field is None:
        return np.array(place)
    data, ids = grid.GetPointData().GetArray(field), element.GetPointIds()
    return sum(w * np.array(data.GetTuple(ids.GetId(i))) for i, w in enumerate(weights))


def _reference(value: list[int]):
    from vtkmodules.vtkCommonCore import reference

    return reference(value[0])


def test_vtk_evaluates_the_same_points(tmp_path):
    """Cells of several degrees with random weights and points, against our own evaluation."""
    rng = np.random.default_rng(7)
    blocks, first = [], 0
    for p, q in ((1, 1), (2, 3), (4, 2), (4, 4)):
        n_b = (p + 1) * (q + 1)
        blocks.append(ElementBlock((p, q), np.eye(n_b)[None], first + np.arange(n_b)[None]))
        first += n_b
    body = Mesh(rng.normal(size=(first, 2)), 0.5 + rng.random(first), tuple(blocks))
    write_vtu(body, tmp_path / "mixed.vtu")
    grid = in_vtk(tmp_path / "mixed.vtu")
    for cell, block in enumerate(blocks):
        (A,) = block.conn_ea
        for s, t in rng.random((5, 2)):
            B_b = tensor(bernstein(block.degrees[0], s), bernstein(block.degrees[1], t)) * body.w_A[A]
            expected = B_b @ body.P_AI[A] / B_b.sum()
            assert evaluated(grid, cell, s, t)[:2] == pytest.approx(expected, abs=1e-12)


def test_order_is_that_of_vtk():
    module = pytest.importorskip("vtkmodules.vtkCommonDataModel", reason="the vtk package is not installed")
    for p, q in ((1, 1), (2, 3), (3, 3), (4, 2)):
        place = [
            module.vtkHigherOrderQuadrilateral.PointIndexFromIJK(i, j, (p, q))
            for j in range(q + 1)
            for i in range(p + 1)
        ]
        assert vtk_order((p, q)).tolist() == np.argsort(place).tolist()
    for p, q, r in ((1, 1, 1), (2, 3, 4), (3, 3, 2)):
        index = module.vtkHigherOrderHexahedron.PointIndexFromIJK
        place = [index(i, j, k, (p, q, r)) for k in range(r + 1) for j in range(q + 1) for i in range(p + 1)]
        assert vtk_order((p, q, r)).tolist() == np.argsort(place).tolist()
