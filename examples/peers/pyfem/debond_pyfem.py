"""A double cantilever beam by PyFEM: writes its two input files, and reads the rows of `debond_pyfem_run`."""

import json
from pathlib import Path
from tempfile import TemporaryDirectory

import debond_pyfem_run

from verify.export.mesh import scene_mesh
from verify.export.numbers import effects, law
from verify.methods import peers
from verify.result import Result, steps_from_rows
from verify.scene.schema import counted_steps

INPUT = """input = "scene.dat";
Arm = {{ type = "SmallStrainContinuum"; material = {{ type = "PlaneStress"; E = {young!r}; nu = {poisson!r}; }}; }};
Bond = {{ type = "Interface"; material = {{ type = "ThoulessModeI"; Gc = {bond.toughness!r}; Tult = {bond.strength!r};
  d1d3 = {part!r}; d2d3 = {part!r}; }}; }};
solver = {{ type = "NonlinearSolver"; maxCycle = {steps}; tol = 1.e-6; iterMax = 25; }};
outputModules = [];
"""


def unsuitable(scene):
    """Why the solver is not made for a scene, or nothing."""
    if effects(scene)["kinematics"] != "linear":
        return 'effects.kinematics: must be "linear"'
    if len(scene.load.opening) > 1:
        return "only for arms that are pulled apart once"
    return peers.unless_plain_dcb(scene)


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
        try:
            started = peers.run(
                "pyfem", [peers.known()["pyfem"].interpreter, debond_pyfem_run.__file__, folder], Path(folder), read
            )
        except RuntimeError as error:
            why = str(error)
    if not rows:
        raise RuntimeError(why or "pyfem has ended without a row")
    status = "complete" if len(rows) == counted_steps(scene) else f"stopped: {why or 'pyfem has ended early'}"
    size = {"dofs": mesh.X_nI.size, "elements": len(mesh.conn_ea), "jit_seconds": started}
    return Result("pyfem", steps_from_rows(rows), status, **size)


solve.unsuitable = unsuitable
#: Elements in the process zone on the coarsest mesh of `debond cost`, by the degree.
solve.degrees = {1: 4.0, 2: 1.0}


def write(scene, mesh, folder):
    """Both files as PyFEM reads them, and what a row needs."""
    around = [0, 4, 1, 5, 2, 6, 3, 7] if mesh.degree == 2 else [0, 1, 2, 3]  # with the middles of sides in their places
    arms = [("Arm", nodes) for nodes in mesh.conn_ea[:, around]]
    bond = [("Bond", nodes) for nodes in mesh.cohesive_ea[:, [0, 1, 3, 2]]]
    steps, opening = counted_steps(scene), scene.load.opening[0]
    pulled = [(n, "v", face.factor * opening / steps) for face in mesh.loaded for n in face.node_n]
    held = [(n, "uv"[i], 0.0) for part in mesh.supports for i in part.components for n in part.node_n]
    lines = [
        "<Nodes>",
        *(f"  {n} {float(x)!r} {float(y)!r} ;" for n, (x, y) in enumerate(mesh.X_nI)),
        "</Nodes>",
        "<Elements>",
        *(f"  {e} '{kind}' {' '.join(map(str, nodes))} ;" for e, (kind, nodes) in enumerate([*arms, *bond])),
        "</Elements>",
        "<NodeConstraints>",
        *(f"  {component}[{n}] = {float(value)!r} ;" for n, component, value in [*pulled, *held]),
        "</NodeConstraints>",
        "<ExternalForces>",
        "</ExternalForces>",
    ]
    (folder / "scene.dat").write_text("\n".join(lines) + "\n")
    material, law_ = scene.materials[0], law(scene)
    numbers = {"young": material.young, "poisson": material.poisson, "bond": law_, "part": 1.0 / law_.ductility}
    (folder / "scene.pro").write_text(INPUT.format(**numbers, steps=steps))
    known = {"upper": mesh.loaded[0].node_n.tolist(), "width": scene.specimen.width, "step": opening / steps}
    (folder / "known.json").write_text(json.dumps(known))
