"""Unstructured grids and collections of them in VTK's XML formats, whole or absent."""

from __future__ import annotations

import base64
import os
import zlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from html import escape
from pathlib import Path

import numpy as np

#: Arrays that VTK is told of as what they are, besides showing them: name -> attribute of the same name.
_MEANT = ("RationalWeights", "HigherOrderDegrees")
_TYPES = {"float64": "Float64", "int64": "Int64", "uint8": "UInt8"}
#: Versions of the format: since which there are cells of higher order as they are now, and what everybody reads.
_HIGHER, _PLAIN = "2.2", "1.0"
_BYTE_LAYOUT = 'byte_order="LittleEndian" header_type="UInt64"'


@dataclass(frozen=True)
class Grid:
    """Points (n, 3), cells of any types, and values on them.

    ``connectivity`` lists the points of all cells, ``offsets`` (n_e,) where each of these ends in it, ``types`` (n_e,)
    are the numbers of vtkCellType.h. ``whole`` are numbers that belong to the grid as such, like its time.
    """

    points: np.ndarray
    connectivity: np.ndarray
    offsets: np.ndarray
    types: np.ndarray
    point_data: Mapping[str, np.ndarray] = field(default_factory=dict)
    cell_data: Mapping[str, np.ndarray] = field(default_factory=dict)
    whole: Mapping[str, float] = field(default_factory=dict)


def write_grid(path: Path | str, grid: Grid) -> None:
    """Write a `.vtu` file; the first vectors among the point data are those that VTK takes where it is not told.

    Raises
    ------
    OSError : the path cannot be written to.
    """
    vectors = [name for name, values in grid.point_data.items() if values.ndim == 2 and values.shape[1] == 3]
    first = {"Vectors": vectors[0]} if vectors else {}
    cells = {"connectivity": grid.connectivity, "offsets": grid.offsets, "types": grid.types.astype(np.uint8)}
    whole = [_array(name, np.array([value], dtype=float), "NumberOfTuples") for name, value in grid.whole.items()]
    version = _HIGHER if "HigherOrderDegrees" in grid.cell_data else _PLAIN
    lines = [
        '<?xml version="1.0"?>',
        f'<VTKFile type="UnstructuredGrid" version="{version}" {_BYTE_LAYOUT} compressor="vtkZLibDataCompressor">',
        f"<UnstructuredGrid><FieldData>{''.join(whole)}</FieldData>",
        f'<Piece NumberOfPoints="{len(grid.points)}" NumberOfCells="{len(grid.types)}">',
        *_data("PointData", grid.point_data, first),
        *_data("CellData", grid.cell_data, {}),
        f"<Points>{_array('Points', grid.points)}</Points>",
        f"<Cells>{''.join(_array(name, values) for name, values in cells.items())}</Cells>",
        "</Piece></UnstructuredGrid></VTKFile>",
    ]
    _write(Path(path), lines)


def write_collection(path: Path | str, files: Iterable[tuple[float, str]]) -> None:
    """Write a `.pvd` file: grids, each with its time and its path from there.

    Raises
    ------
    OSError : the path cannot be written to.
    """
    sets = [f'<DataSet timestep="{time:.17g}" part="0" file="{escape(file)}"/>' for time, file in files]
    head = '<VTKFile type="Collection" version="0.1" byte_order="LittleEndian"><Collection>'
    _write(Path(path), ['<?xml version="1.0"?>', head, *sets, "</Collection></VTKFile>"])


def _write(path: Path, lines: list[str]) -> None:
    """Beside and renamed: a file is whole, whoever looks at it and whenever the run ends."""
    beside = path.with_name(f".{path.name}.{os.getpid()}")
    beside.write_text("\n".join(lines) + "\n", encoding="utf-8", newline="\n")
    beside.replace(path)


def _data(kind: str, arrays: Mapping[str, np.ndarray], meant: Mapping[str, str]) -> list[str]:
    meant = dict(meant) | {name: name for name in arrays if name in _MEANT}
    words = "".join(f' {attribute}="{escape(name)}"' for attribute, name in meant.items())
    return [f"<{kind}{words}>", *(_array(name, values) for name, values in arrays.items()), f"</{kind}>"]


def _array(name: str, values: np.ndarray, *counted: str) -> str:
    """One DataArray of a single compressed block: its header and its bytes, each in base64.

    The header counts the blocks, the bytes of a whole one, those of a last one that is not whole, and the compressed.
    """
    data = np.ascontiguousarray(values, dtype=values.dtype.newbyteorder("<")).tobytes()
    packed = zlib.compress(data, 1)
    header = np.array([1, len(data), 0, len(packed)], dtype="<u8").tobytes()
    text = (base64.b64encode(header) + base64.b64encode(packed)).decode()
    components = values.shape[1] if values.ndim == 2 else 1
    about = "".join(f' {attribute}="{len(values)}"' for attribute in counted)
    head = f'type="{_TYPES[values.dtype.name]}" Name="{escape(name)}" NumberOfComponents="{components}"{about}'
    return f'<DataArray {head} format="binary">{text}</DataArray>'
