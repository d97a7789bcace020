"""Elements as VTK's cells of higher order: ParaView shows geometry and displacement themselves, not a sampling."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from iga.mesh.bezier import homogeneous
from iga.mesh.extraction import Mesh
from verify.fields.vtk_xml import Grid, write_grid

#: Lagrange and Bezier cells of vtkCellType.h by the number of directions: quadrilaterals and hexahedra.
LAGRANGE_CELLS, BEZIER_CELLS = {2: 70, 3: 72}, {2: 77, 3: 79}

#: Weights that differ from one by less than this are rounding.
UNIT_WEIGHT_TOLERANCE = 1e-12


@dataclass(frozen=True)
class Cells:
    """Quadrilaterals of the same degrees (p, q), or hexahedra (p, q, r), each with n_b points of its own.

    Points are numbered j (p + 1) + i, i along the first direction, those of hexahedra (k (q + 1) + j) (p + 1) + i.
    They are Bezier points with weights ``w_eb`` (n_e, n_b), or, without weights, the evenly spaced nodes of Lagrange
    elements. ``fields`` (n_e, n_b, k) go with the points, ``of_cells`` (n_e,) with the cells.
    """

    degrees: tuple[int, ...]
    X_ebI: np.ndarray
    w_eb: np.ndarray | None
    fields: Mapping[str, np.ndarray] = field(default_factory=dict)
    of_cells: Mapping[str, np.ndarray] = field(default_factory=dict)

    @property
    def type(self) -> int:
        return (LAGRANGE_CELLS if self.w_eb is None else BEZIER_CELLS)[len(self.degrees)]


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
    write_grid(path, grid(bezier_cells(mesh, fields or {})))


def bezier_cells(mesh: Mesh, fields: Mapping[str, np.ndarray]) -> list[Cells]:
    """Elements of a mesh with fields in its own functions, told by their control values (n_A,) or (n_A, k)."""
    columns = {name: np.asarray(v, dtype=float).reshape(len(mesh.P_AI), -1) for name, v in fields.items()}
    values_Af = np.concatenate([mesh.P_AI, *columns.values()], axis=1)
    ends = np.cumsum([2, *(v.shape[1] for v in columns.values())])[:-1]
    cells = []
    for block in mesh.blocks:
        H_ebf = homogeneous(values_Af, mesh.w_A, block)
        X_ebI, *parts = np.split(H_ebf[..., :-1] / H_ebf[..., -1:], ends, axis=2)
        cells.append(Cells(block.degrees, X_ebI, H_ebf[..., -1], dict(zip(columns, parts, strict=True))))
    return cells


def grid(cells: Sequence[Cells], whole: Mapping[str, float] | None = None) -> Grid:
    """All cells with their fields, which are the same ones everywhere; RationalWeights where a weight is not one."""
    rational = any(part.w_eb is not None and np.abs(part.w_eb - 1.0).max() > UNIT_WEIGHT_TOLERANCE for part in cells)
    orders = [vtk_order(part.degrees) for part in cells]

    def points(values: Sequence[np.ndarray]) -> np.ndarray:
        ordered = (v.reshape(*v.shape[:2], -1)[:, order] for v, order in zip(values, orders, strict=True))
        return three_columns(np.concatenate([v.reshape(-1, v.shape[2]) for v in ordered]))

    point_data = {"RationalWeights": points([part.w_eb for part in cells if part.w_eb is not None])} if rational else {}
    point_data |= {name: points([part.fields[name] for part in cells]) for name in cells[0].fields}
    sizes = [part.X_ebI.shape[:2] for part in cells]
    degrees = [
        np.tile(np.resize([*part.degrees, 0.0], 3), (n_e, 1)) for part, (n_e, _) in zip(cells, sizes, strict=True)
    ]
    cell_data = {name: np.concatenate([part.of_cells[name] for part in cells]) for name in cells[0].of_cells}
    return Grid(
        points=points([part.X_ebI for part in cells]),
        connectivity=np.arange(sum(n_e * n_b for n_e, n_b in sizes)),
        offsets=np.cumsum(np.concatenate([np.full(n_e, n_b) for n_e, n_b in sizes])),
        types=np.concatenate([np.full(n_e, part.type) for part, (n_e, _) in zip(cells, sizes, strict=True)]),
        point_data=point_data,
        cell_data={"HigherOrderDegrees": np.concatenate(degrees)} | cell_data,
        whole=whole or {},
    )


def vtk_order(degrees: tuple[int, ...]) -> np.ndarray:
    """Point numbers of `Cells` in VTK's order (vtkHigherOrderQuadrilateral, vtkHigherOrderHexahedron).

    Corners counterclockwise; inner points of the edges j = 0, i = p, j = q, i = 0, each with i or j rising; the inside,
    i fastest. Of a hexahedron the corners of k = 0 and k = r, then the edges; the edges along k; the insides of the
    faces i = 0, i = p, j = 0, j = q, k = 0, k = r, and of the cell.
    """
    number = np.arange(np.prod(np.add(degrees, 1))).reshape(np.add(degrees, 1)[::-1])
    ends, inside = ([0, 0, -1, -1], [0, -1, -1, 0]), slice(1, -1)

    def edges(of: np.ndarray) -> tuple[np.ndarray, ...]:
        return of[0, inside], of[inside, -1], of[-1, inside], of[inside, 0]

    if number.ndim == 2:
        parts = number[ends], *edges(number), number[inside, inside]
    else:
        low, high = number[0], number[-1]
        faces = (np.moveaxis(number, axis, 0)[side, inside, inside] for axis in (2, 1, 0) for side in (0, -1))
        upright = (number[inside, j, i] for j, i in zip(*ends, strict=True))
        parts = low[ends], high[ends], *edges(low), *edges(high), *upright, *faces, number[inside, inside, inside]
    return np.concatenate([part.ravel() for part in parts])


def three_columns(values: np.ndarray) -> np.ndarray:
    """Values (n, k) with k as it is, or 3 in place of 2."""
    return np.column_stack([values, np.zeros(len(values))]) if values.shape[1] == 2 else values
