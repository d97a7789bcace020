"""A double cantilever beam by Akantu: writes the scene, and reads the rows of `debond_akantu_run`.

That runs in the environment of Akantu, in a process of its own for each solution, as Akantu reads its materials once a
process.
"""

import json
from pathlib import Path
from tempfile import TemporaryDirectory

import debond_akantu_run

from verify.export.groups import write_groups
from verify.export.mesh import merged, scene_mesh
from verify.export.numbers import effects, law
from verify.methods import peers
from verify.result import Result, steps_from_rows
from verify.scene.schema import counted_steps

MATERIALS = """
model solid_mechanics_model_cohesive [
  cohesive_inserter [
    cohesive_surfaces = [bond]
  ]
  material elastic [
    name = upper
    rho = 1
    E = {young!r}
    nu = {poisson!r}
    Plane_Stress = true
  ]
  material elastic [
    name = lower
    rho = 1
    E = {young!r}
    nu = {poisson!r}
    Plane_Stress = true
  ]
  material cohesive_bilinear [
    name = bond
    beta = 0
    sigma_c = {bond.strength!r}
    G_c = {bond.toughness!r}
    delta_0 = {bond.g_peak!r}
    penalty = {closed!r}
  ]
]
"""


def unsuitable(scene):
    """Why the solver is not made for a scene, or nothing."""
    asked = effects(scene)
    if asked["kinematics"] != "linear" or not asked["irreversible"]:
        return 'effects: kinematics must be "linear", and irreversible true'
    if sorted(set(scene.load.opening)) != list(scene.load.opening):
        return "load.opening: must only increase, as its tangent does not converge on unloading"
    return peers.unless_plain_dcb(scene)


def solve(scene, on_step):
    """Load over opening; ``[dolfinx]`` of the scene sets elements, layers and degree."""
    rows, end = [], {}

    def read(line):
        kind, _, text = line.partition(" ")
        if kind == "row":
            rows.append(json.loads(text))
            on_step(rows[-1])
        elif kind == "end":
            end.update(json.loads(text))

    with TemporaryDirectory() as folder:
        write(scene, Path(folder))
        started = peers.run(
            "akantu", [peers.known()["akantu"].interpreter, debond_akantu_run.__file__, folder], Path(folder), read
        )
    if not end:
        raise RuntimeError("akantu has ended without a result")
    return Result("akantu", steps_from_rows(rows), jit_seconds=started, **end)


solve.unsuitable = unsuitable
#: Elements in the process zone on the coarsest mesh of `debond cost`, by the degree.
solve.degrees = {1: 4.0, 2: 1.0}


def write(scene, folder):
    """The scene as Akantu reads it, and what its input has no words for."""
    mesh, bond, material = merged(scene_mesh(scene)), law(scene), scene.materials[0]
    closed = bond.penalty if bond.contact else bond.stiffness
    write_groups(mesh, "gmsh", folder / "mesh.msh")
    (folder / "material.dat").write_text(
        MATERIALS.format(young=material.young, poisson=material.poisson, bond=bond, closed=closed)
    )
    problem = {
        "degree": mesh.degree,
        "width": scene.specimen.width,
        "faces": [
            {"nodes": face.node_n.tolist(), "weights": face.weight_n.tolist(), "part": face.factor}
            for face in mesh.loaded
        ],
        "held": [mesh.X_nI[part.node_n[0]].tolist() for part in mesh.supports],
        "programme": list(scene.load.opening),
        "steps": counted_steps(scene),
    }
    (folder / "problem.json").write_text(json.dumps(problem))
