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
[Executioner]
  type = Transient
  solve_type = NEWTON
  petsc_options_iname = '-pc_type'
  petsc_options_value = 'lu'
  line_search = none
  nl_rel_tol = 1e-8
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
    if not effects(scene)["irreversible"]:
        return "effects.irreversible: must be true for MOOSE, whose law keeps its damage"
    if len(scene.specimen.loads if scene.specimen.slides else ()) > 1:
        return "specimen: must have one load for MOOSE, which moves the nodes of a load and knows no lever"
    return ""


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
    i, bond, slides, width = scene.interface, law(scene), scene.interface.slides, scene.specimen.width
    finite = effects(scene)["kinematics"] == "finite"
    mesh, crack_end = _joined(mesh, slides or finite)
    strengths = (i.strength, i.shear_strength) if slides else (i.strength, i.strength)
    toughnesses = (i.toughness, i.shear_toughness) if slides else (i.toughness, i.toughness)
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
        criterion="POWER_LAW" if slides and i.criterion == "power" else "BK",
        exponent=i.exponent if slides else 1.0,
        conditions="".join(_conditions(mesh)),
        pulled=first.name,
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
    turning by a finite angle.
    """
    pairs = np.concatenate([mesh.crack_kb[:-1], mesh.pair_kb]) if mesh.crack_kb.size else mesh.pair_kb
    whole = merged(replace(mesh, pair_kb=pairs, crack_kb=mesh.crack_kb[:0]))
    if middle:
        whole = replace(whole, loaded=_middles(whole.loaded), resting=_middles(whole.resting))
    return whole, float(mesh.X_nI[mesh.pair_kb[0, 0], 0])


def _middles(patches: Iterable[LoadedFace]) -> tuple[LoadedFace, ...]:
    return tuple(replace(one, node_n=one.node_n[[len(one.node_n) // 2]]) for one in patches)


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
