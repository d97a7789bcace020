"""Two arms as `meshio` writes them: graded, of any element, and with faults planted."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import meshio
import numpy as np

LENGTH, THICKNESS, PRECRACK = 14.0, 0.2, 4.0
TAGS = {"upper": (1, 2), "lower": (2, 2), "bond": (3, 1), "load": (4, 1)}


def breaks(fine: int = 120, coarse: int = 24) -> np.ndarray:
    """Element boundaries, short at the bond."""
    before = PRECRACK * (1.0 - np.linspace(1.0, 0.0, coarse + 1) ** 1.5)
    return np.concatenate([before[:-1], np.linspace(PRECRACK, LENGTH, fine + 1)])


def arms(kind: str = "quad8", x: np.ndarray | None = None, layers: int = 2) -> meshio.Mesh:
    """Points, elements, and lines of the bonded and loaded faces, in groups of gmsh's kind."""
    x = breaks() if x is None else x
    points, solids, lines = [], [], {"bond": [], "load": []}
    for sign in (1.0, -1.0):
        at = sum(map(len, points))
        grid = _grid(kind, x, np.sort(sign * np.linspace(0.0, THICKNESS, layers + 1)))
        points.append(grid[0])
        solids.append(grid[1] + at)
        X, ends = grid[0], _edges(grid[1], kind)
        on = {
            "bond": np.all(X[ends, 1] == 0.0, 1) & (X[ends, 0].min(1) >= PRECRACK),
            "load": np.all(X[ends, 0] == 0, 1),
        }
        for name, here in on.items():
            lines[name].append(ends[here] + at)
    line = "line3" if kind in ("quad8", "quad9", "triangle6") else "line"
    cells = [(kind, solids[0]), (kind, solids[1]), *((line, np.concatenate(of)) for of in lines.values())]
    tags = [np.full(len(conn), tag) for (_, conn), (tag, _) in zip(cells, TAGS.values(), strict=True)]
    flat = np.concatenate(points)
    return meshio.Mesh(
        np.column_stack([flat, np.zeros(len(flat))]),
        cells,
        cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
        field_data={name: np.array(value) for name, value in TAGS.items()},
    )


def _grid(kind: str, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    p = 2 if kind in ("quad8", "quad9", "triangle6") else 1
    xs, ys = (np.interp(np.arange((len(b) - 1) * p + 1) / p, np.arange(len(b)), b) for b in (x, y))
    number = np.arange(len(xs) * len(ys)).reshape(len(ys), len(xs))
    X = np.column_stack([np.tile(xs, len(ys)), np.repeat(ys, len(xs))])

    def at(i: int, j: int) -> np.ndarray:
        return number[j : j + len(ys) - p : p, i : i + len(xs) - p : p].ravel()

    corners = [at(0, 0), at(p, 0), at(p, p), at(0, p)]
    middles = [at(1, 0), at(2, 1), at(1, 2), at(0, 1)] if p == 2 else []
    centre = [at(1, 1)] if p == 2 else []
    c, m = corners, middles
    if kind.startswith("triangle"):
        one = np.stack([c[0], c[1], c[2], *([m[0], m[1], centre[0]] if p == 2 else [])], -1)
        two = np.stack([c[0], c[2], c[3], *([centre[0], m[2], m[3]] if p == 2 else [])], -1)
        conn = np.concatenate([one, two])
    else:
        conn = np.stack([*c, *m, *(centre if kind == "quad9" else [])], -1)
    used, inverse = np.unique(conn, return_inverse=True)
    return X[used], np.ravel(inverse).reshape(conn.shape)


def _edges(conn: np.ndarray, kind: str) -> np.ndarray:
    n = 3 if kind.startswith("triangle") else 4
    parts = [conn[:, :n], np.roll(conn[:, :n], -1, axis=1), *([conn[:, n : 2 * n]] if conn.shape[1] > 4 else [])]
    return np.stack(parts, -1).reshape(-1, len(parts))


def write(mesh: meshio.Mesh, file: Path) -> str:
    """Write a mesh with its groups as the format has them."""
    if file.suffix == ".msh":
        meshio.gmsh.write(file, mesh, "2.2", binary=False)
    elif file.suffix == ".inp":
        _abaqus(mesh, file)
    else:
        flags = {name: _flags(mesh, tag) for name, (tag, dim) in TAGS.items() if dim == 1}
        solids = [(block.type, block.data) for block in mesh.cells[:2]]
        meshio.Mesh(mesh.points, solids, point_data=flags).write(file)
    return str(file)


def _flags(mesh: meshio.Mesh, tag: int) -> np.ndarray:
    tagged = zip(mesh.cells, mesh.cell_data["gmsh:physical"], strict=True)
    nodes = np.concatenate([block.data.ravel() for block, tags in tagged if tags[0] == tag])
    return np.isin(np.arange(len(mesh.points)), nodes).astype(int)


def _abaqus(mesh: meshio.Mesh, file: Path) -> None:
    names = {"quad": "CPE4I", "quad8": "CPS8R", "triangle": "CPS3", "triangle6": "CPE6"}
    lines = ["*NODE", *(f"{n}, {x:.17g}, {y:.17g}" for n, (x, y, _) in enumerate(mesh.points.tolist(), 1))]
    number = 1
    for name, block in zip(("upper", "lower"), mesh.cells, strict=False):
        lines.append(f"*ELEMENT, TYPE={names[block.type]}, ELSET={name}")
        lines += [f"{e}, {', '.join(map(str, row))}" for e, row in enumerate((block.data + 1).tolist(), number)]
        number += len(block.data)
    for name in ("bond", "load"):
        nodes = np.flatnonzero(_flags(mesh, TAGS[name][0])) + 1
        lines += [f"*NSET, NSET={name}", *(f"{n}," for n in nodes)]
    file.write_text("\n".join(lines) + "\n")


def changed(mesh: meshio.Mesh, **parts: Any) -> meshio.Mesh:
    """A mesh with some of points, cells, cell_data and field_data replaced."""
    whole: Mapping[str, Any] = {
        "points": mesh.points,
        "cells": mesh.cells,
        "cell_data": mesh.cell_data,
        "field_data": mesh.field_data,
    } | parts
    return meshio.Mesh(**whole)
