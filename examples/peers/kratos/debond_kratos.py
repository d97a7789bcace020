"""A double cantilever beam by Kratos: writes mesh and numbers, and reads the rows of `debond_kratos_run`."""

import json
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from verify.export.mesh import scene_mesh
from verify.export.numbers import effects, law
from verify.methods import peers
from verify.result import Result, steps_from_rows
from verify.scene.schema import counted_steps


def unsuitable(scene):
    """Why the solver is not made for a scene, or nothing."""
    asked = effects(scene)
    if asked["kinematics"] != "linear" or not asked["irreversible"]:
        return 'effects: kinematics must be "linear", and irreversible true'
    if len(scene.load.opening) > 1:
        return "only for arms that are pulled apart once"
    return peers.unless_plain_dcb(scene)


def solve(scene, on_step):
    """Load over opening; ``[dolfinx]`` of the scene sets elements, layers and degree."""
    mesh, rows, ends, started = scene_mesh(scene), [], [], 0.0

    def read(line):
        kind, _, text = line.partition(" ")
        if kind == "row":
            rows.append(json.loads(text))
            on_step(rows[-1])
        elif kind == "end":
            ends.append(json.loads(text))

    with TemporaryDirectory() as folder:
        write(scene, mesh, Path(folder))
        program = Path(__file__).with_name("debond_kratos_run.py")
        try:
            started = peers.run("kratos", [peers.known()["kratos"].interpreter, program, folder], Path(folder), read)
        except RuntimeError as error:
            ends.append(str(error))
    why = "kratos has ended early" if not ends else ends[-1]
    if not rows:
        raise RuntimeError(why or "kratos has ended without a row")
    size = {"dofs": mesh.X_nI.size, "elements": len(mesh.conn_ea), "jit_seconds": started}
    return Result("kratos", steps_from_rows(rows), f"stopped: {why}" if why else "complete", **size)


solve.unsuitable = unsuitable
#: Elements in the process zone on the coarsest mesh of `debond cost`, by the degree.
solve.degrees = {1: 4.0, 2: 1.0}


def write(scene, mesh, folder):
    """What the program reads: arrays of the mesh, and numbers under the names of Kratos.

    Its FRACTURE_ENERGY is the area beyond the onset, and its PENALTY_STIFFNESS the stiffness of a closed gap over that
    of the bond.
    """
    bond, material = law(scene), scene.materials[0]
    told = {
        "arms": {"YOUNG_MODULUS": material.young, "POISSON_RATIO": material.poisson, "THICKNESS": 1.0, "DENSITY": 0.0},
        "bond": {
            "NORMAL_STIFFNESS": bond.stiffness,
            "SHEAR_STIFFNESS": bond.stiffness,
            "PENALTY_STIFFNESS": bond.penalty / bond.stiffness if bond.contact else 1.0,
            "TENSILE_STRENGTH": bond.strength,
            "FRACTURE_ENERGY": bond.toughness - 0.5 * bond.strength * bond.g_peak,
            "BETA_EQSTRAIN_SHEAR_FACTOR": 0.0,
            "DAMAGE_EVOLUTION_LAW": 1,
            "THICKNESS": 1.0,
        },
        "held": [(one.node_n.tolist(), i) for one in mesh.supports for i in one.components],
        "loaded": [(one.node_n.tolist(), one.factor) for one in mesh.loaded],
        "opening": scene.load.opening[0],
        "steps": counted_steps(scene),
        "width": scene.specimen.width,
    }
    np.savez(
        folder / "mesh.npz", X_nI=mesh.X_nI, conn_ea=mesh.conn_ea, cohesive_ea=mesh.cohesive_ea, pair_kb=mesh.pair_kb
    )
    (folder / "problem.json").write_text(json.dumps(told))
