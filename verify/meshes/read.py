"""A plane mesh with its groups, of `meshio`: from a file of another program or from memory."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from verify.meshes.abaqus import COHESIVE, DECK_NUMBERS, LINE_TYPES, PLANE_TYPES, NotRead, read_deck
from verify.support.refusal import one_of

if TYPE_CHECKING:
    from meshio import Mesh

#: Endings of files by the format's name in `meshio`.
MESH_FORMATS = {"gmsh": (".msh",), "abaqus": (".inp",), "vtu": (".vtu",), "exodus": (".e", ".exo"), "med": (".med",)}
MESH_ENDINGS = {ending: name for name, endings in MESH_FORMATS.items() for ending in endings}

ELEMENT_DEGREES = {3: 1, 4: 1, 6: 2, 8: 2, 9: 2}


@dataclass(frozen=True)
class PlaneMesh:
    """Nodes ``X_nI`` (n, 2) [length] and elements ``conn_kea``: number of nodes -> (n_e, n_a), corners
    counter-clockwise, then the middles of the sides, then the centre.

    ``elements`` are groups of elements by name, as numbers counted through ``conn_kea``; ``nodes`` groups of lines or
    points, as the numbers of their nodes. ``number_n`` and ``number_e`` are the numbers that a deck gives its nodes and
    elements, from 1 in other files.
    """

    X_nI: np.ndarray
    conn_kea: Mapping[int, np.ndarray]
    elements: Mapping[str, np.ndarray]
    nodes: Mapping[str, np.ndarray]
    number_n: np.ndarray
    number_e: np.ndarray


def read_mesh(source: Path | Mesh) -> PlaneMesh:
    """The mesh of a file, whose ending names its format, or of a `meshio.Mesh`.

    Raises
    ------
    ValueError : no mesh of plane elements of one degree at z = 0; the message names line, group or element type.
    OSError : the file cannot be read.
    """
    found = _read(source) if isinstance(source, Path) else source
    _require_plane(found)
    conn_kea: dict[int, np.ndarray] = {}
    number_be: dict[int, np.ndarray] = {}  # numbers of the elements of each block among them all
    for kind, size in PLANE_TYPES.items():
        blocks = {b: np.asarray(part.data) for b, part in enumerate(found.cells) if part.type == kind and len(part)}
        for b, conn in blocks.items():
            number_be[b] = sum(map(len, number_be.values())) + np.arange(len(conn))
        if blocks:
            conn_kea[size] = np.concatenate(list(blocks.values()))
    elements, nodes = {}, _node_groups(found)
    for name, members in _cell_groups(found).items():
        inside = [number_be[b][e] for b, e in enumerate(members) if b in number_be and len(e)]
        parts = [part.data[e].ravel() for part, e in zip(found.cells, members, strict=True) if len(e)]
        if inside:
            elements[name] = np.unique(np.concatenate(inside))
        elif parts:
            nodes[name] = np.unique(np.concatenate(parts))
    own_n, own_be = (found.info or {}).get(DECK_NUMBERS, (1 + np.arange(len(found.points)), None))
    number_e = np.concatenate([1 + of if own_be is None else own_be[b] for b, of in number_be.items()])
    flat_ke = {size: _flat(found, conn) for size, conn in conn_kea.items()}
    if (flat_e := np.concatenate(list(flat_ke.values()))).any():
        nodes[COHESIVE] = np.unique(np.concatenate([conn[flat_ke[size]].ravel() for size, conn in conn_kea.items()]))
        new_e, number_e = np.cumsum(~flat_e) - 1, number_e[~flat_e]
        elements = {name: new_e[e[~flat_e[e]]] for name, e in elements.items() if not flat_e[e].all()}
        conn_kea = {size: conn[~flat_ke[size]] for size, conn in conn_kea.items() if not flat_ke[size].all()}
    return PlaneMesh(np.asarray(found.points, dtype=float)[:, :2], conn_kea, elements, nodes, own_n, number_e)


def _read(path: Path) -> Mesh:
    """The mesh of a file, with all its groups."""
    kind = MESH_ENDINGS.get(path.suffix.lower())
    if kind is None:
        raise ValueError(f"must end with {one_of(MESH_ENDINGS)}, got {path.suffix or 'no ending'!r}")
    if path.exists() and not path.is_file():
        raise ValueError("must be a file, got a folder, a device or a pipe")
    content = path.read_bytes()
    if not content.strip():
        raise ValueError("is empty")
    said = io.StringIO()
    try:
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            if kind == "abaqus":
                return read_deck(content.decode("utf-8-sig", errors="replace"), path.parent)
            found = import_module(f"meshio.{kind}").read(str(path))
            return _with_block_names(found, path) if kind == "exodus" else found
    except (OSError, MemoryError, NotRead):
        raise
    except ImportError as error:
        raise ValueError(f"needs the Python package {error.name}, which reads this format") from None
    except (Exception, SystemExit) as error:  # readers let pass whatever a broken file makes them trip over
        words = " ".join(str(error).split())[:200] or type(error).__name__
        first, lines = content.strip()[:40].decode("latin-1").splitlines()[0], content.count(b"\n")
        got = f"{lines} lines from {first!r} on ({words})"
        raise ValueError(f"must be a whole file of {kind}, of a version that meshio reads, got {got}") from None


def _with_block_names(found: Mesh, path: Path) -> Mesh:
    """The mesh of an Exodus file with its element blocks as groups; `meshio` reads those of nodes alone."""
    from netCDF4 import Dataset, chartostring

    with Dataset(path) as file:
        names = chartostring(file.variables["eb_names"][:].filled(b"")) if "eb_names" in file.variables else ()
    for b, name in enumerate(str(name).strip("\0 ") for name in names):
        if name:
            found.cell_sets[name] = [
                np.arange(len(part) if b == other else 0) for other, part in enumerate(found.cells)
            ]
    return found


def _require_plane(found: Mesh) -> None:
    points = np.asarray(found.points, dtype=float)
    if not len(points) or not np.all(np.isfinite(points)):
        raise ValueError("must have nodes with finite coordinates")
    for part in found.cells:
        if part.type not in PLANE_TYPES and part.type not in LINE_TYPES:
            raise ValueError(f"elements must be {', '.join(PLANE_TYPES)}, got {len(part)} of type {part.type}")
        if len(part) and not 0 <= np.min(part.data) <= np.max(part.data) < len(points):
            raise ValueError(f"elements of type {part.type} must have nodes of the file, of which it has {len(points)}")
    if points.shape[1] > 2 and np.abs(points[:, 2]).max() > 1e-9 * np.ptp(points, axis=0).max():
        worst = int(np.argmax(np.abs(points[:, 2])))
        raise ValueError(f"nodes must lie in the plane z = 0, got z = {points[worst, 2]:g} at node {worst + 1}")
    plane = [part for part in found.cells if part.type in PLANE_TYPES]
    kinds = sorted({part.type for part in plane if not np.all(_flat(found, part.data))})
    if not kinds:
        raise ValueError(f"must have elements of type {', '.join(PLANE_TYPES)}, got none")
    if len({ELEMENT_DEGREES[PLANE_TYPES[kind]] for kind in kinds}) > 1:
        raise ValueError(f"elements must have one degree, got {' and '.join(kinds)}")


def _flat(found: Mesh, conn: np.ndarray) -> np.ndarray:
    """Which elements (n_e,) have no height, as cells of a bond, which the scene describes."""
    return np.ptp(np.asarray(found.points, dtype=float)[conn, 1], axis=1) == 0.0


def _cell_groups(found: Mesh) -> dict[str, list[np.ndarray]]:
    """Groups of elements or lines by name, as the numbers of their members in each block."""
    groups: dict[str, list[np.ndarray]] = {
        name: [np.asarray(() if e is None else e, dtype=int) for e in per_block]
        for name, per_block in found.cell_sets.items()
        if not name.startswith("gmsh:")
    }
    physical = {name: [tag] for name, (tag, _) in found.field_data.items() if name != "med:nom"}
    for key, tags in (("gmsh:physical", physical), ("cell_tags", _families(found, "cell_tags"))):
        if key in found.cell_data:
            per_block = [np.ravel(values) for values in found.cell_data[key]]
            groups |= {name: [np.flatnonzero(np.isin(tag_e, of)) for tag_e in per_block] for name, of in tags.items()}
    flagged = {name: values for name, values in found.cell_data.items() if all(map(_flags, values))}
    return groups | {name: [np.flatnonzero(flag_e) for flag_e in values] for name, values in flagged.items()}


def _node_groups(found: Mesh) -> dict[str, np.ndarray]:
    """Groups of nodes: named ones, families of MED, and arrays of zeros and ones, one a node."""
    groups: dict[str, np.ndarray] = {
        name: np.asarray(nodes, dtype=int).ravel() for name, nodes in found.point_sets.items()
    }
    tag_n = found.point_data.get("point_tags")
    if tag_n is not None:
        groups |= {name: np.flatnonzero(np.isin(tag_n, of)) for name, of in _families(found, "point_tags").items()}
    return groups | {name: np.flatnonzero(np.ravel(at)) for name, at in found.point_data.items() if _flags(at)}


def _families(found: Mesh, key: str) -> dict[str, list[int]]:
    """Families of MED that belong to each group; a family is what belongs to the same groups."""
    families: Mapping[int, Sequence[str]] = getattr(found, key, {})
    names = {name for of in families.values() for name in of}
    return {name: [tag for tag, of in families.items() if name in of] for name in names}


def _flags(values: Any) -> bool:
    return np.ndim(np.squeeze(values)) <= 1 and bool(np.all(np.isin(values, (0, 1))))
