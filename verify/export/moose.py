"""A scene as a complete input of MOOSE: its mesh stands beside it as Exodus, the bond is split by MOOSE itself."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from verify.export.groups import write_groups
from verify.export.mesh import LoadedFace, SceneMesh, merged
from verify.export.numbers import effects, law
from verify.scene.materials import Material, plane_compliance
from verify.scene.schema import Scene, counted_steps
from verify.support.refusal import Refusal

#: Strength and toughness of the faces of the precrack over those of the bond: contact alone is left of the law.
OPEN = 1e-6

#: Newton's method without a line search, with a direct solver, in both inputs.
NEWTON = """[Executioner]
  type = Transient
  solve_type = NEWTON
  petsc_options_iname = '-pc_type'
  petsc_options_value = 'lu'
  line_search = none
"""

#: Body and side of the faces of bond and crack.
FACES = ((0, "bottom"), (1, "top"))

INPUT = """# {scene}: {units}, of the width {width:g}; mesh and sets from {mesh}.
# moose -i {name}.i -pc_type lu   writes {name}.csv: opening and load of every step
[Mesh]
  [file]
    type = FileMeshGenerator
    file = {mesh}
  []
  [split]
    type = BreakMeshByBlockGenerator
    input = file
  []
[]
[GlobalParams]
  displacements = 'disp_x disp_y'
[]
[Problem]
  extra_tag_vectors = 'reaction'
[]
[Physics/SolidMechanics/QuasiStatic/arms]
  strain = {strain}
  add_variables = true
  extra_vector_tags = reaction
[]
[Physics/SolidMechanics/CohesiveZone/bond]
  boundary = {boundary}
  strain = {strain}
[]
[Materials]
{materials}  [stress]
    type = {stress}
  []
  [strengths]
    type = GenericFunctionMaterial
    boundary = {boundary}
    prop_names = 'N S GI GII'
    prop_values = 'of_N of_S of_GI of_GII'
  []
  [law]
    type = BiLinearMixedModeTraction
    boundary = {boundary}
    penalty_stiffness = {stiffness!r}
    normal_strength = N
    shear_strength = S
    GI_c = GI
    GII_c = GII
    mixed_mode_criterion = {criterion}
    eta = {exponent!r}
  []
[]
[Functions]
{functions}[]
[BCs]
{conditions}[]
[AuxVariables]
  [force]
    order = {order}
  []
[]
[AuxKernels]
  [force]
    type = TagVectorAux
    variable = force
    v = disp_y
    vector_tag = reaction
  []
[]
[Postprocessors]
  [opening]
    type = FunctionValuePostprocessor
    function = opening
  []
  [sum]
    type = NodalSum
    variable = force
    boundary = {pulled}
    outputs = none
  []
  [load]
    type = ScalePostprocessor
    value = sum
    scaling_factor = {scale!r}
  []
[]
{newton}  nl_rel_tol = 1e-8
  nl_abs_tol = {residual!r}
  nl_max_its = 25
  end_time = 1
  dt = {dt!r}
  dtmin = {dtmin!r}
[]
[Outputs]
  [csv]
    type = CSV
    file_base = {name}
  []
[]
"""


def refused(scene: Scene) -> str:
    """Why MOOSE is not given a scene, or nothing."""
    bond, body = scene.interface, scene.specimen
    if not effects(scene)["irreversible"]:
        return "effects.irreversible: must be true for MOOSE, whose law keeps its damage"
    if body.slides and (len(body.loads) > 1 or body.loads[0].couple):
        return "specimen: must have one force for MOOSE, which moves the nodes of a load and knows no lever or couple"
    if any((one.body, one.side) in FACES for one in body.patches):
        return "specimen: must have no support on a face of the crack for MOOSE, in whose split mesh both arms have it"
    for key in ("friction", "viscosity", "pressure_strength"):
        if getattr(bond, key):
            return f"interface.{key}: must be 0 for MOOSE, got {getattr(bond, key):g}"
    stiffness = law(scene).stiffness
    if bond.slides and abs((bond.shear_stiffness or stiffness) / stiffness - 1.0) > 1e-6:
        return f"interface.shear_stiffness: must be {stiffness:.6g} for MOOSE, which has one stiffness"
    return ""


def remarks(scene: Scene) -> list[str]:
    """What the law of MOOSE has that the scene has not."""
    bond, said = law(scene), []
    if bond.contact and abs(bond.penalty / bond.stiffness - 1.0) > 1e-6:
        stiff = f"{bond.stiffness:g}"
        said.append(f"MOOSE closes a gap with the stiffness of the bond: --set interface.penalty={stiff} judges it so")
    if scene.specimen.slides and scene.interface.onset != "quadratic":
        said.append('the onset of MOOSE is the quadratic one: --set interface.onset="quadratic" judges it so')
    return said


def write_moose(scene: Scene, mesh: SceneMesh, path: Path, steps: int | None = None) -> None:
    """Write the input ``path`` and, beside it, the mesh.

    Plane stress and plane strain are both the plane strain of a material with the stiffness of the plane, in the
    directions 1, 2 and 12. MOOSE has no mean of several nodes: patches of loads and supports move by their middle
    nodes, and so do faces that turn by a finite angle. The faces of the precrack are split as those of the bond, with a
    law that is as good as broken.

    Parameters
    ----------
    steps : default: those of the scene

    Raises
    ------
    Refusal : an effect or a load that MOOSE does not have.
    """
    if why := refused(scene):
        raise Refusal(why)
    i, bond, both, width = scene.interface, law(scene), scene.interface.slides, scene.specimen.width
    slides = scene.specimen.slides  # where loads are shares of a force, and not of the opening
    finite = effects(scene)["kinematics"] == "finite"
    mesh, crack_end = _joined(mesh, slides or finite)
    strengths = (i.strength, i.shear_strength) if both else (i.strength, i.strength)
    toughnesses = (i.toughness, i.shear_toughness) if both else (i.toughness, i.toughness)
    travel = np.abs(np.diff([0.0, *scene.load.opening])).cumsum()
    first, dt = mesh.loaded[0], 1.0 / (steps or counted_steps(scene))
    way = {
        "type": "PiecewiseLinear",
        "x": _words([0.0, *(travel / travel[-1])]),
        "y": _words([0.0, *scene.load.opening]),
    }
    parts = {"opening": 1.0} | {one.name: 1.0 / one.factor if slides else one.factor for one in mesh.loaded}
    moved = [block(name, **way, scale_factor=repr(part)) for name, part in parts.items()]
    numbers = zip(("N", "S", "GI", "GII"), (*strengths, *toughnesses), strict=True)
    of_crack = [
        block(f"of_{name}", type="ParsedFunction", expression=f"'if(x < {crack_end!r}, {OPEN!r}, 1) * {value!r}'")
        for name, value in numbers
    ]
    text = INPUT.format(
        scene=scene.name,
        units=scene.units,
        width=width,
        order=("FIRST", "SECOND")[mesh.degree - 1],
        mesh=path.with_suffix(".e").name,
        name=path.stem,
        strain="FINITE" if finite else "SMALL",
        stress="ComputeFiniteStrainElasticStress" if finite else "ComputeLinearElasticStress",
        boundary="_".join(mesh.names),
        materials="".join(
            block(
                name,
                type="ComputeElasticityTensor",
                block=name,
                fill_method="symmetric9",
                C_ijkl=_stiffness(one, scene),
            )
            for name, one in zip(mesh.names, scene.materials, strict=True)
        ),
        functions="".join([*moved, *of_crack]),
        stiffness=bond.stiffness,
        criterion="POWER_LAW" if both and i.criterion == "power" else "BK",
        exponent=i.exponent if both else 1.0,
        conditions="".join(_conditions(mesh)),
        pulled=first.name,
        newton=NEWTON,
        scale=width / (first.factor if slides else 1.0),
        residual=1e-10 * i.strength * float(np.ptp(mesh.X_nI[:, 0])),
        dt=dt,
        dtmin=dt / 2**7,
    )
    write_groups(mesh, "exodus", path.with_suffix(".e"))
    path.write_text(text)


def _joined(mesh: SceneMesh, middle: bool) -> tuple[SceneMesh, float]:
    """The conforming mesh, joined along the precrack too where its faces can touch, and the end of the precrack.

    ``middle``: whether loads and supports act on middle nodes: one height for all nodes of a face would keep it from
    turning by a finite angle. What is split has every node of its sets in both bodies, so that a load or a support on
    the joined faces goes to the next node inside of its body.
    """
    pairs = np.concatenate([mesh.crack_kb[:-1], mesh.pair_kb]) if mesh.crack_kb.size else mesh.pair_kb
    inside = _inside(mesh, pairs)
    if middle:
        mesh = replace(mesh, loaded=_middles(mesh.loaded, inside), resting=_middles(mesh.resting, inside))
    mesh = replace(mesh, supports=tuple(replace(one, node_n=inside[one.node_n]) for one in mesh.supports))
    return merged(replace(mesh, pair_kb=pairs, crack_kb=mesh.crack_kb[:0])), float(mesh.X_nI[mesh.pair_kb[0, 0], 0])


def _middles(patches: Iterable[LoadedFace], inside: np.ndarray) -> tuple[LoadedFace, ...]:
    return tuple(replace(one, node_n=inside[one.node_n[[len(one.node_n) // 2]]]) for one in patches)


def _inside(mesh: SceneMesh, pairs: np.ndarray) -> np.ndarray:
    """(n,) every node itself, but of a node on the joined faces the nearest one of its body off them, at the same x."""
    found, on_faces = np.arange(len(mesh.X_nI)), np.zeros(len(mesh.X_nI), dtype=bool)
    on_faces[pairs] = True
    faces = np.concatenate([part.node_n for part in (*mesh.loaded, *mesh.resting)])
    used = np.concatenate([faces, *(part.node_n for part in mesh.supports)])
    for body in (0, 1):
        own = np.unique(mesh.conn_ea[mesh.body_e == body])
        off = own[~on_faces[own]]
        for node in np.intersect1d(used, own[on_faces[own]]):
            beside, away = np.abs(mesh.X_nI[off] - mesh.X_nI[node]).T
            found[node] = off[np.lexsort((away, (beside / np.ptp(mesh.X_nI[:, 0])).round(9)))[0]]
    return found


def _stiffness(material: Material, scene: Scene) -> str:
    """C1111 C1122 C1133 C2222 C2233 C3333 C2323 C1313 C1212, of which the plane has four."""
    c = np.linalg.inv(plane_compliance(material, scene.specimen.plane))
    return _words([c[0, 0], c[0, 1], 0.0, c[1, 1], 0.0, c[1, 1], c[2, 2], c[2, 2], c[2, 2]])


def _conditions(mesh: SceneMesh) -> Iterator[str]:
    """Loaded nodes follow their functions, supported and held ones stay."""
    for face in mesh.loaded:
        yield block(face.name, type="FunctionDirichletBC", variable="disp_y", boundary=face.name, function=face.name)
    held = [(one, (1,)) for one in mesh.resting] + [(one, one.components) for one in mesh.supports]
    for one, components in held:
        for component in components:
            axis = "xy"[component]
            yield block(f"{one.name}_{axis}", type="DirichletBC", variable=f"disp_{axis}", boundary=one.name, value="0")


def block(name: str, **keys: str) -> str:
    """An inner block of an input."""
    return "".join([f"  [{name}]\n", *(f"    {key} = {value}\n" for key, value in keys.items()), "  []\n"])


def _words(numbers: Iterable[float]) -> str:
    return "'" + " ".join(repr(float(number)) for number in numbers) + "'"
