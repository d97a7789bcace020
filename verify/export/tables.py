"""A scene as tables: nodes, elements, pairs of the bond, and sets. Numbers are those of the mesh, from 1 on."""

from __future__ import annotations

import csv
from pathlib import Path

from verify.export.mesh import SceneMesh


def write_tables(mesh: SceneMesh, folder: Path) -> tuple[Path, ...]:
    """Write nodes.csv, elements.csv, pairs.csv and sets.csv into a folder; their paths.

    Corners of an element go counter-clockwise, then the middles of its sides. Pairs are ordered along the bond, and
    ``length`` is the share of each in the interface. ``weight`` is a node's part of the load of a loaded face, or
    of the force of a support.
    """
    names, nodes = [mesh.names[b] for b in mesh.body_e], [f"n{a + 1}" for a in range(mesh.conn_ea.shape[1])]
    elements = zip(mesh.number_e.tolist(), names, mesh.conn_ea + 1, strict=True)
    pairs = zip(mesh.pair_kb + 1, mesh.at(mesh.pair_kb[:, 0]), mesh.length_k, strict=True)
    weights = {face.name: face.weight_n for face in (*mesh.loaded, *mesh.resting)}
    tables = {
        "nodes.csv": (
            ("node", "x", "y"),
            ((n, *X) for n, X in zip(mesh.number_n.tolist(), mesh.X_nI.tolist(), strict=True)),
        ),
        "elements.csv": (("element", "body", *nodes), ((e, b, *conn) for e, b, conn in elements)),
        "pairs.csv": (
            ("pair", "lower", "upper", "x", "y", "length"),
            ((k, *pair, *X.tolist(), float(length)) for k, (pair, X, length) in enumerate(pairs, 1)),
        ),
        "sets.csv": (
            ("set", "node", "weight"),
            (
                (name, node + 1, "" if name not in weights else float(weights[name][i]))
                for name, nodes in mesh.sets.items()
                for i, node in enumerate(nodes)
            ),
        ),
    }
    for name, (columns, rows) in tables.items():
        with (folder / name).open("w", newline="", encoding="utf-8") as stream:
            csv.writer(stream).writerows((columns, *rows))
    return tuple(folder / name for name in tables)
