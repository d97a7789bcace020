"""A plane mesh with its groups from a file of another program, by `meshlane`."""

from __future__ import annotations

import contextlib
import io
import re
import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

#: Endings of files by the format's name in `meshlane`.
MESH_FORMATS = {"gmsh": (".msh",), "abaqus": (".inp",), "vtu": (".vtu",), "exodus": (".e", ".exo"), "med": (".med",)}
MESH_ENDINGS = {ending: name for name, endings in MESH_FORMATS.items() for ending in endings}

#: Elements of a plane body: name in `meshlane` -> number of nodes; and what groups of nodes may consist of.
PLANE_TYPES = {"triangle": 3, "quad": 4, "triangle6": 6, "quad8": 8, "quad9": 9}
ELEMENT_DEGREES = {3: 1, 4: 1, 6: 2, 8: 2, 9: 2}
LINE_TYPES = ("vertex", "line", "line3")

#: Elements of Abaqus for plane stress and plane strain, by an element of the same nodes that `meshlane` knows.
ABAQUS_ALIASES = {"3": "CPS3", "4": "CPS4", "6": "STRI65", "8": "S8R"}
_NODES = re.compile(r"^\*node\s*(,|$)", re.IGNORECASE)
_ELEMENT = re.compile(r"^(\*element\b.*?\btype\s*=\s*)([^,\s]+)", re.IGNORECASE)
_SOLID = re.compile(r"CP[ES](3|4|6|8)(R|I|H|M|RH|IH|MH)?$", re.IGNORECASE)
_NO_BODY = re.compile(r"((T2D|T3D|B2|B3)[123]H?|MASS|ROTARYI|(SPRING|DASHPOT|CONN)\w*)$", re.IGNORECASE)

#: Cohesive elements of Abaqus, which are a group of that name. `meshlane` does not know them and reads them as
#: tetrahedra, which have four nodes as well; files with tetrahedra of their own are refused before.
COHESIVE = "COH2D4"
_COHESIVE_ALIAS = ("C3D4", "tetra")


@dataclass(frozen=True)
class PlaneMesh:
    """Nodes ``X_nI`` (n, 2) [length] and elements ``conn_kea``: number of nodes -> (n_e, n_a), corners
    counter-clockwise, then the middles of the sides, then the centre.

    ``elements`` are groups of elements by name, as numbers counted through ``conn_kea``; ``nodes`` groups of lines or
    points, as the numbers of their nodes.
    """

    X_nI: np.ndarray
    conn_kea: Mapping[int, np.ndarray]
    elements: Mapping[str, np.ndarray]
    nodes: Mapping[str, np.ndarray]


def read_mesh(path: Path) -> PlaneMesh:
    """The mesh of a file, whose ending names its format.

    Raises
    ------
    ValueError : no mesh of plane elements of one degree at z = 0; the message names line, group or element type.
    OSError : the file cannot be read.
    """
    kind = MESH_ENDINGS[path.suffix.lower()]
    if not path.read_bytes().strip():
        raise ValueError("is empty")
    found = _read(path, kind)
    _require_plane(found)
    groups = dict(_groups(found))
    conn_kea, first = _elements(found)
    inside = {name: [first[b][e] for b, e in parts if b in first] for name, parts in groups.items()}
    sets = {name: _joined(parts) for name, parts in inside.items() if parts}
    lines = {
        name: np.unique(np.concatenate([found.cells[b].data[e].ravel() for b, e in parts]))
        for name, parts in groups.items()
        if parts and name not in sets
    }
    return PlaneMesh(np.asarray(found.points, dtype=float)[:, :2], conn_kea, sets, {**_points(found), **lines})


def _read(path: Path, kind: str) -> Any:
    reader = import_module(f"meshlane.{kind}")
    said = io.StringIO()
    try:
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            if kind == "exodus":
                return _with_block_names(reader.read(str(path)), path)
            if kind != "abaqus":
                return reader.read(str(path))
            with tempfile.TemporaryDirectory() as folder:
                known = Path(folder) / path.name
                known.write_text("\n".join(_known_lines(path.read_text(errors="replace"))) + "\n")
                return _with_cohesive_lines(reader.read(str(known)))
    except (OSError, MemoryError):
        raise
    except ImportError as error:
        raise ValueError(f"needs the Python package {error.name}, which reads this format") from None
    except (Exception, SystemExit) as error:  # readers let pass whatever a broken file makes them trip over
        lines = path.read_bytes().count(b"\n")
        words = " ".join(str(error).split())[:200] or type(error).__name__
        raise ValueError(f"is broken or cut off within its {lines} lines, as {kind} ({words})") from None


def _with_block_names(found: Any, path: Path) -> Any:
    """The mesh of an Exodus file with its element blocks as groups; `meshlane` reads those of nodes alone."""
    from netCDF4 import Dataset, chartostring

    with Dataset(path) as file:
        if "eb_names" not in file.variables:
            return found
        names = [str(name).strip("\0 ") for name in chartostring(file.variables["eb_names"][:].filled(b""))]
    for b, name in enumerate(names):
        if name:
            members = [np.arange(len(block.data) if b == other else 0) for other, block in enumerate(found.cells)]
            found.cell_sets[name] = members
    return found


def _with_cohesive_lines(found: Any) -> Any:
    """The mesh of an Abaqus file with its cohesive elements as lines on the lower face, a group named `COHESIVE`."""
    from meshlane import CellBlock

    cohesive = [block.type == _COHESIVE_ALIAS[1] for block in found.cells]
    if any(cohesive):
        found.cells = [
            CellBlock("line", block.data[:, :2]) if here else block
            for here, block in zip(cohesive, found.cells, strict=True)
        ]
        members = zip(cohesive, found.cells, strict=True)
        found.cell_sets[COHESIVE] = [np.arange(len(block.data) if here else 0) for here, block in members]
    return found


def _known_lines(text: str) -> Iterator[str]:
    """The lines of an Abaqus file with elements renamed, and a third coordinate for nodes in the plane.

    Raises ValueError for elements of another kind of body.
    """
    in_nodes = False
    for number, line in enumerate(text.splitlines(), 1):
        if line.startswith("*") and not line.startswith("**"):
            in_nodes = bool(_NODES.match(line))
        elif in_nodes and line.rstrip(", ").count(",") == 2:
            line = f"{line.rstrip(', ')}, 0"
        if match := _ELEMENT.match(line):
            solid, cohesive = _SOLID.match(match[2]), match[2].upper() == COHESIVE
            if solid or cohesive:
                alias = ABAQUS_ALIASES[solid[1]] if solid else _COHESIVE_ALIAS[0]
                line = f"{match[1]}{alias}{line[match.end() :]}"
            elif not _NO_BODY.match(match[2]):
                known = "CPS or CPE with 3, 4, 6 or 8 nodes, or COH2D4"
                raise ValueError(f"line {number}: elements must be {known}, got {match[2]}")
        yield line


def _require_plane(found: Any) -> None:
    for block in found.cells:
        if block.type not in PLANE_TYPES and block.type not in LINE_TYPES:
            raise ValueError(f"elements must be {', '.join(PLANE_TYPES)}, got {len(block.data)} of type {block.type}")
    points = np.asarray(found.points, dtype=float)
    if not len(points) or not np.all(np.isfinite(points)):
        raise ValueError("must have nodes with finite coordinates")
    for block in found.cells:
        if len(block.data) and not 0 <= np.min(block.data) <= np.max(block.data) < len(points):
            raise ValueError(
                f"elements of type {block.type} must have nodes of the file, of which it has {len(points)}"
            )
    if points.shape[1] > 2 and np.abs(points[:, 2]).max() > 1e-9 * np.ptp(points, axis=0).max():
        worst = int(np.argmax(np.abs(points[:, 2])))
        raise ValueError(f"nodes must lie in the plane z = 0, got z = {points[worst, 2]:g} at node {worst + 1}")
    _require_thickness(found, points)
    kinds = sorted({block.type for block in found.cells if block.type in PLANE_TYPES})
    if not kinds:
        raise ValueError(f"must have elements of type {', '.join(PLANE_TYPES)}, got none")
    if len({ELEMENT_DEGREES[PLANE_TYPES[kind]] for kind in kinds}) > 1:
        raise ValueError(f"elements must have one degree, got {' and '.join(kinds)}")


def _require_thickness(found: Any, points: np.ndarray) -> None:
    """Raise ValueError for quadrilaterals with two pairs of nodes at one place, as the cells of a bond have them."""
    X_eaI = points[np.concatenate([np.empty((0, 4), int), *(b.data for b in found.cells if b.type == "quad")])]
    flat = np.all(X_eaI[:, [0, 1]] == X_eaI[:, [3, 2]], axis=(1, 2))
    if flat.any():
        x, y = X_eaI[flat][0].mean(0)[:2]
        raise ValueError(
            f"elements must have a thickness, got {flat.sum()} without one, the first at ({x:.4g}, {y:.4g}): cells of "
            "a bond, which the scene describes; leave them out (debond export --format gmsh writes none)"
        )


def _elements(found: Any) -> tuple[dict[int, np.ndarray], dict[int, np.ndarray]]:
    """Elements by number of nodes, and for each block of the file the numbers of its elements among them all."""
    conn_kea: dict[int, np.ndarray] = {}
    numbers, count = {}, 0
    for name, size in PLANE_TYPES.items():
        for b, block in enumerate(found.cells):
            if block.type == name and len(block.data):
                numbers[b] = count + np.arange(len(block.data))
                count += len(block.data)
                before = conn_kea.get(size, np.empty((0, size), dtype=int))
                conn_kea[size] = np.concatenate([before, np.asarray(block.data, dtype=int)])
    return conn_kea, numbers


def _groups(found: Any) -> Iterator[tuple[str, list[tuple[int, np.ndarray]]]]:
    """Name of each group of elements or lines, and the numbers of its members in each block of the file."""
    for name, per_block in found.cell_sets.items():
        if not name.startswith("gmsh:"):
            parts = [(b, np.asarray(e, dtype=int)) for b, e in enumerate(per_block) if e is not None and len(e)]
            yield name, parts
    physical = found.cell_data.get("gmsh:physical", ())
    for name, (tag, _) in found.field_data.items():
        yield name, [(b, e) for b, tags in enumerate(physical) if len(e := np.flatnonzero(np.ravel(tags) == tag))]
    for name, per_block in found.cell_data.items():
        if all(_flags(values) for values in per_block):
            yield name, [(b, e) for b, values in enumerate(per_block) if len(e := np.flatnonzero(np.ravel(values)))]


def _points(found: Any) -> dict[str, np.ndarray]:
    """Groups of nodes: named ones, and arrays of zeros and ones, one a node."""
    named = {name: np.asarray(nodes, dtype=int).ravel() for name, nodes in found.point_sets.items()}
    flagged = {name: np.flatnonzero(np.ravel(at)) for name, at in found.point_data.items() if _flags(at)}
    return {**named, **flagged}


def _flags(values: Any) -> bool:
    return np.ndim(np.squeeze(values)) <= 1 and bool(np.all(np.isin(values, (0, 1))))


def _joined(parts: list[np.ndarray]) -> np.ndarray:
    return np.unique(np.concatenate(parts))
