"""A scene by MOOSE: the input of `debond export --format moose`, run as it is, and the curve that it writes."""

import csv
from pathlib import Path
from tempfile import TemporaryDirectory

from verify.export.mesh import scene_mesh
from verify.export.moose import refused, write_moose
from verify.methods import peers
from verify.result import Result, steps_from_rows
from verify.scene.schema import counted_steps

BINARY = "rabbit/bin/rabbit"
#: Numbers of steps that are tried next, over those of the scene.
RETRIES = (0.67, 1.4)


def unsuitable(scene):
    """Why MOOSE is not given a scene, or nothing."""
    if why := refused(scene):
        return why
    return "" if scene.dolfinx.degree in ("auto", 1, 2) else "dolfinx.degree: must be 1 or 2"


def solve(scene, on_step):
    """Load over opening; ``[dolfinx]`` of the scene sets elements, layers and degree.

    Its law jumps where a pressed face opens, and Newton's method then goes round in circles at some openings, however
    short the steps: another number of steps passes them by.
    """
    mesh, why, best, started = scene_mesh(scene), "", [], 0.0
    for steps in (counted_steps(scene), *(round(part * counted_steps(scene)) for part in RETRIES)):
        rows, why, begun = attempt(scene, mesh, steps)
        started += begun
        best = max(best, rows, key=len) if why else rows
        if not why or "has not ended within" in why:
            break
    if len(best) < 2:
        raise RuntimeError(why or "moose wrote no curve")
    size = {"dofs": mesh.X_nI.size, "elements": len(mesh.conn_ea), "jit_seconds": started}
    return Result("moose", steps_from_rows(best), f"stopped: {why}" if why else "complete", **size)


def attempt(scene, mesh, steps):
    """The rows of a run in so many steps, why it has ended early, or nothing, and the seconds of its start."""
    with TemporaryDirectory() as place:
        folder, why, begun = Path(place), "", 0.0
        write_moose(scene, mesh, folder / "scene.i", steps)
        words = [peers.known()["moose"].site / BINARY, "-i", "scene.i", "-pc_type", "lu", "--no-color"]
        try:
            begun = peers.run("moose", words, folder)
        except RuntimeError as error:
            why = str(error)
        return list(read(folder / "scene.csv")), why, begun


solve.unsuitable = unsuitable
#: Elements in the process zone on the coarsest mesh of `debond cost`, by the degree.
solve.degrees = {1: 4.0, 2: 1.0}


def read(path):
    """The rows of MOOSE's table, none where it wrote none."""
    if not path.exists():
        return
    with path.open(errors="replace") as file:
        table = csv.DictReader(file)
        for number, row in enumerate(table, 1):
            for key in ("opening", "load"):
                if key not in row:
                    raise RuntimeError(f"no column {key} in its table")
            try:
                yield {key: float(row[key]) for key in ("opening", "load")}
            except (TypeError, ValueError):
                raise RuntimeError(f"no numbers in row {number} of its table") from None
