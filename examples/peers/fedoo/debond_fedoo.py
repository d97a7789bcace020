"""A scene by fedoo: writes mesh and numbers, and reads the rows of `debond_fedoo_run`."""

import json
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from verify.export.mesh import scene_mesh
from verify.export.numbers import effects, law
from verify.methods import peers
from verify.result import Result, steps_from_rows
from verify.scene.materials import plane_compliance
from verify.scene.schema import counted_steps

#: Strength and toughness of faces that touch, over those of the bond.
OPEN = 1e-6
VARIABLES = ("DispX", "DispY")


def unsuitable(scene):
    """Why the solver is not made for a scene, or nothing."""
    asked, bond = effects(scene), scene.interface
    if asked["kinematics"] != "linear" or not asked["irreversible"]:
        return 'effects: kinematics must be "linear", and irreversible true'
    if bond.law != "bilinear":
        return 'interface.law: must be "bilinear"'
    if bond.slides and (bond.criterion, bond.exponent, bond.onset) != ("power", 2.0, "quadratic"):
        return "interface: must have the criterion power, the exponent 2 and the onset quadratic"
    for key in ("friction", "viscosity", "pressure_strength"):
        if getattr(bond, key):
            return f"interface.{key}: must be 0"
    return "" if scene.dolfinx.degree in ("auto", 1, 2) else "dolfinx.degree: must be 1 or 2"


def solve(scene, on_step):
    """Load over opening; ``[dolfinx]`` of the scene sets elements, layers and degree."""
    mesh, rows, why, started = scene_mesh(scene), [], "", 0.0

    def read(line):
        kind, _, text = line.partition(" ")
        if kind == "row":
            rows.append(json.loads(text))
            on_step(rows[-1])

    with TemporaryDirectory() as folder:
        write(scene, mesh, Path(folder))
        script = Path(__file__).with_name("debond_fedoo_run.py")
        try:
            started = peers.run("fedoo", [peers.known()["fedoo"].interpreter, script, folder], Path(folder), read)
        except RuntimeError as error:
            why = str(error)
    if not rows:
        raise RuntimeError(why or "fedoo has ended without a row")
    size = {"dofs": mesh.X_nI.size, "elements": len(mesh.conn_ea), "jit_seconds": started}
    return Result("fedoo", steps_from_rows(rows), f"stopped: {why}" if why else "complete", **size)


solve.unsuitable = unsuitable
#: Elements in the process zone on the coarsest mesh of `debond cost`, by the degree.
solve.degrees = {1: 4.0, 2: 1.0}


def write(scene, mesh, folder):
    """What the program reads: arrays of the mesh, and numbers."""
    i, bond, slides = scene.interface, law(scene), scene.specimen.slides

    def numbers(part):
        """Those of fedoo's law, with strength and toughness times a part."""
        shear = (i.shear_strength, i.shear_toughness, i.shear_stiffness) if i.slides else ()
        S, G, K = shear or (bond.strength, bond.toughness, bond.stiffness)
        return {
            "SImax": part * bond.strength,
            "GIc": part * bond.toughness,
            "KI": bond.stiffness,
            "SIImax": part * S,
            "GIIc": part * G,
            "KII": K,
        }

    def patch(*faces):
        """Node, variable and weight; of loads of rollers times their part."""
        parts = [(one, one.factor if slides and one in mesh.loaded else 1.0) for one in faces]
        return [
            (int(n), VARIABLES[one.component], float(part * w))
            for one, part in parts
            for n, w in zip(one.node_n, one.weight_n, strict=True)
        ]

    def facing(pair_kb):
        """(n, 4) lower side, upper side in the same order."""
        lower, upper = pair_kb.T
        return np.stack([lower[:-1], lower[1:], upper[:-1], upper[1:]], axis=1)

    def stiffness(material):
        c, found = np.linalg.inv(plane_compliance(material, scene.specimen.plane)), np.eye(6)
        found[:2, :2], found[3, 3] = c[:2, :2], c[2, 2]
        return found.tolist()

    # those of the crack end in the first pair of the bond
    arrays = {"bond": facing(mesh.pair_kb), "crack": facing(mesh.crack_kb)}
    names = dict.fromkeys(one.action for one in mesh.resting)
    first = mesh.loaded[0]
    # patches of rollers share a force, so that the sum of their parts is the opening; faces move by theirs
    loaded = [(patch(*mesh.loaded), 1.0)] if slides else [(patch(one), one.factor) for one in mesh.loaded]
    told = {
        "stiffness": [stiffness(one) for one in scene.materials],
        "bond": numbers(1.0),
        "crack": numbers(OPEN),
        "opening": list(scene.load.opening),
        "steps": counted_steps(scene),
        "held": [(one.node_n.tolist(), VARIABLES[i]) for one in mesh.supports for i in one.components],
        "resting": [patch(*(one for one in mesh.resting if one.action == name)) for name in names],
        "loaded": loaded,
        "pulled": first.node_n.tolist(),
        "scale": scene.specimen.width / (first.factor if slides else 1.0),
    }
    np.savez(folder / "mesh.npz", X_nI=mesh.X_nI, conn_ea=mesh.conn_ea, body_e=mesh.body_e, **arrays)
    (folder / "problem.json").write_text(json.dumps(told))
