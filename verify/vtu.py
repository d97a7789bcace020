"""Meshes as VTU files of rational Bezier quadrilaterals: ParaView shows the geometry itself, not a sampling of it."""

from __future__ import annotations

import base64
from collections.abc import Mapping
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np

from iga.bezier import homogeneous
from iga.extraction import ElementBlock, Mesh

#: VTK_BEZIER_QUADRILATERAL of vtkCellType.h.
BEZIER_QUADRILATERAL = 77

_TYPES = {"float64": "Float64", "int64": "Int64", "uint8": "UInt8"}


def write_vtu(mesh: Mesh, path: Path | str, fields: Mapping[str, np.ndarray] | None = None) -> None:
    """Write every element as one cell with Bezier points of its own, exact to rounding.

    Parameters
    ----------
    fields : control values (n_A,) or (n_A, k) of fields in the mesh's own functions, such as a displacement; pairs
        get a zero third component, so that they are vectors there.

    Raises
    ------
    OSError : the path cannot be written to.
    """
    fields = {name: _three_columns(values) for name, values in (fields or {}).items()}
    parts = [_block_points(mesh, block, fields) for block in mesh.blocks]
    names = ("points", "RationalWeights", *fields)
    points = {name: np.concatenate([part[name] for part in parts]) for name in names}
    counts = [np.full(len(b.conn_ea), b.C_eab.shape[2]) for b in mesh.blocks]
    degrees = [np.tile([*b.degrees, 0], (len(b.conn_ea), 1)).astype(float) for b in mesh.blocks]
    n_n, n_e = len(points["points"]), mesh.elements
    cells = {
        "connectivity": np.arange(n_n),
        "offsets": np.cumsum(np.concatenate(counts)),
        "types": np.full(n_e, BEZIER_QUADRILATERAL, dtype=np.uint8),
    }
    vectors = [name for name, values in fields.items() if values.shape[1] == 3]
    vectors = f" Vectors={quoteattr(vectors[0])}" if vectors else ""
    coordinates = points.pop("points")
    lines = [
        '<?xml version="1.0"?>',
        '<VTKFile type="UnstructuredGrid" version="2.2" byte_order="LittleEndian" header_type="UInt64">',
        f'<UnstructuredGrid><Piece NumberOfPoints="{n_n}" NumberOfCells="{n_e}">',
        f'<PointData RationalWeights="RationalWeights"{vectors}>',
        *(_array(name, values) for name, values in points.items()),
        '</PointData><CellData HigherOrderDegrees="HigherOrderDegrees">',
        _array("HigherOrderDegrees", np.concatenate(degrees)),
        f"</CellData><Points>{_array('Points', coordinates)}</Points>",
        f"<Cells>{''.join(_array(name, values) for name, values in cells.items())}</Cells>",
        "</Piece></UnstructuredGrid></VTKFile>",
    ]
    Path(path).write_text("\n".join(lines) + "\n", encoding="utf-8", newline="\n")


def vtk_order(degrees: tuple[int, int]) -> np.ndarray:
    """Bernstein indices j (p + 1) + i of a quadrilateral in VTK's order (vtkHigherOrderQuadrilateral).

    Corners counterclockwise; inner points of the edges j = 0, i = p, j = q, i = 0, each with i or j rising; the inside,
    i fastest.
    """
    p, q = degrees
    number = np.arange((p + 1) * (q + 1)).reshape(q + 1, p + 1)
    corners = number[[0, 0, -1, -1], [0, -1, -1, 0]]
    edges = (number[0, 1:-1], number[1:-1, -1], number[-1, 1:-1], number[1:-1, 0])
    return np.concatenate([corners, *edges, number[1:-1, 1:-1].ravel()])


def _block_points(mesh: Mesh, block: ElementBlock, fields: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Bezier points, weights and field values of a block, element by element in VTK's order."""
    order_b = vtk_order(block.degrees)
    values_Af = np.concatenate([_three_columns(mesh.P_AI), *fields.values()], axis=1)
    H_ebf = homogeneous(values_Af, mesh.w_A, block)[:, order_b].reshape(-1, values_Af.shape[1] + 1)
    parts = np.split(H_ebf[:, :-1] / H_ebf[:, -1:], np.cumsum([3, *(v.shape[1] for v in fields.values())]), axis=1)
    return dict(zip(("points", *fields), parts, strict=False)) | {"RationalWeights": H_ebf[:, -1:]}


def _three_columns(values: np.ndarray) -> np.ndarray:
    """Values (n, k) with k as it is, or 3 in place of 2."""
    values = np.asarray(values, dtype=float).reshape(len(values), -1)
    return np.column_stack([values, np.zeros(len(values))]) if values.shape[1] == 2 else values


def _array(name: str, values: np.ndarray) -> str:
    """One DataArray: a base64 string of its length in bytes and its values."""
    data = np.ascontiguousarray(values, dtype=values.dtype.newbyteorder("<")).tobytes()
    text = base64.b64encode(np.array(len(data), dtype="<u8").tobytes() + data).decode()
    components = values.shape[1] if values.ndim == 2 else 1
    head = f'type="{_TYPES[values.dtype.name]}" Name={quoteattr(name)} NumberOfComponents="{components}"'
    return f'<DataArray {head} format="binary">{text}</DataArray>'
