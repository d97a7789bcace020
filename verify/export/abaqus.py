"""A scene as an Abaqus/Standard input file."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from verify.export.mesh import SceneMesh
from verify.export.numbers import effects, header, law, sliding
from verify.scene.materials import Isotropic, Material, plane_strain_constants
from verify.scene.schema import Scene, counted_steps
from verify.theory.law import Bilinear

#: Solid elements by plane and degree. Of degree 1 those with incompatible modes: fully integrated ones lock in bending,
#: by 20 % in one layer as long as it is thick.
SOLIDS = {("stress", 1): "CPS4I", ("strain", 1): "CPE4I", ("stress", 2): "CPS8", ("strain", 2): "CPE8"}

#: Sliding costs nothing in debond; of a stiffness of zero a solver would make a mechanism.
SLIDING = 1e-6

#: Strength against sliding over that against opening: mode I alone does damage.
BEYOND_DAMAGE = 1e6


def write_abaqus(scene: Scene, mesh: SceneMesh, path: Path) -> None:
    """Write ``path``: nodes, sets, solids, cohesive elements of no thickness, a step for every leg of the programme.

    A reference node for each loaded face has its mean displacement by an equation: its reaction is the load.
    """
    path.write_text("\n".join(_lines(scene, mesh)) + "\n", encoding="utf-8")


def reference_nodes(mesh: SceneMesh) -> dict[str, int]:
    """Number of the node that stands for each loaded face, by the name of its set."""
    return {f"{face.name}_mean": len(mesh.X_nI) + i for i, face in enumerate(mesh.loaded, 1)}


def _lines(scene: Scene, mesh: SceneMesh) -> Iterator[str]:
    yield "*HEADING"
    yield f"debond {scene.name}"
    yield from (f"** {name}: {text}" for name, text in header(scene, mesh).items())
    yield from _of_abaqus(scene, mesh)
    yield from _mesh(scene, mesh)
    yield from _sections(scene, mesh)
    yield from _materials(scene, mesh)
    yield from _means(mesh)
    yield from _supports(mesh)
    yield from _steps(scene, mesh)


def _of_abaqus(scene: Scene, mesh: SceneMesh) -> Iterator[str]:
    bond = law(scene)
    face = mesh.loaded[0]
    scale = 1.0 / face.factor
    yield f"** COH2D4 closes with the stiffness of the bond, {bond.stiffness:g}: debond does so as well with"
    yield f"**   --set interface.penalty={bond.stiffness:g}"
    yield "** history.csv is written by: abaqus python history.py JOB.odb"
    yield f"** load: RF2 of {face.name}_mean; opening: {scale:g} times its U2. Held against debond, in this folder, by"
    yield f"**   debond verify {scene.name}.toml --with history.csv --opening U2 --load RF2 --opening-scale {scale:g}"


def _mesh(scene: Scene, mesh: SceneMesh) -> Iterator[str]:
    yield "*NODE, NSET=all"
    yield from (f"{n}, {_number(x)}, {_number(y)}" for n, (x, y) in enumerate(mesh.X_nI, 1))
    for face, number in zip(mesh.loaded, reference_nodes(mesh).values(), strict=True):
        x, y = mesh.X_nI[face.node_n].mean(axis=0)
        yield f"{number}, {_number(x)}, {_number(y)}"
    solid, first = SOLIDS[scene.specimen.plane, mesh.degree], 1
    for b, name in enumerate(mesh.names):
        conn = mesh.conn_ea[mesh.body_e == b]
        yield f"*ELEMENT, TYPE={solid}, ELSET={name}"
        yield from _elements(conn, first)
        first += len(conn)
    yield "*ELEMENT, TYPE=COH2D4, ELSET=bond"
    yield from _elements(mesh.cohesive_ea, first)
    means = {name: np.array([number - 1]) for name, number in reference_nodes(mesh).items()}
    for name, nodes in (mesh.sets | means).items():
        yield f"*NSET, NSET={name}"
        yield from _wrapped((nodes + 1).tolist())


def _elements(conn_ea: np.ndarray, first: int) -> Iterator[str]:
    return (f"{e}, " + ", ".join(map(str, nodes + 1)) for e, nodes in enumerate(conn_ea, first))


def _sections(scene: Scene, mesh: SceneMesh) -> Iterator[str]:
    width = _number(scene.specimen.width)
    yield "*ORIENTATION, NAME=along, SYSTEM=RECTANGULAR"
    yield "1., 0., 0., 0., 1., 0."
    yield "3, 0."
    for name in mesh.names:
        yield f"*SOLID SECTION, ELSET={name}, MATERIAL={name}, ORIENTATION=along"
        yield f"{width},"
    yield "*COHESIVE SECTION, ELSET=bond, MATERIAL=bond, RESPONSE=TRACTION SEPARATION, THICKNESS=SPECIFIED"
    yield f"1., {width}"  # of thickness 1 the strain is the separation


def _materials(scene: Scene, mesh: SceneMesh) -> Iterator[str]:
    for name, material in zip(mesh.names, scene.materials, strict=True):
        yield f"*MATERIAL, NAME={name}"
        yield from _elastic(material, scene.specimen.plane)
    bond = law(scene)
    K, p = bond.stiffness, bond.strength
    yield "*MATERIAL, NAME=bond"
    yield "*ELASTIC, TYPE=TRACTION"
    if scene.interface.slides:
        yield from _sliding(sliding(scene), bond)
        return
    yield ", ".join(map(_number, (K, SLIDING * K, SLIDING * K)))
    yield "*DAMAGE INITIATION, CRITERION=MAXS"
    yield ", ".join(map(_number, (p, BEYOND_DAMAGE * p, BEYOND_DAMAGE * p)))
    yield "*DAMAGE EVOLUTION, TYPE=ENERGY, SOFTENING=LINEAR"
    yield f"{_number(bond.toughness)},"


def _sliding(shear: Mapping[str, Any], bond: Bilinear) -> Iterator[str]:
    """The law of opening and sliding; the onset of Turon et al., which Abaqus has not, is alike in pure modes."""
    t, toughness, stiffness = (shear[f"shear_{key}"] for key in ("strength", "toughness", "stiffness"))
    yield ", ".join(map(_number, (bond.stiffness, stiffness, stiffness)))
    if shear["onset"] == "turon":
        yield "** debond has the onset of Turon et al. (2006), which is that of QUADS in pure modes alone"
    beside = ("friction", "viscosity", "pressure_strength")
    yield from (f"** left out: interface.{key} = {shear[key]:g}" for key in beside if shear[key])
    yield "*DAMAGE INITIATION, CRITERION=QUADS"
    yield ", ".join(map(_number, (bond.strength, t, t)))
    mixed = {"bk": "BK", "power": "POWER LAW"}[shear["criterion"]]
    behavior = f"MIXED MODE BEHAVIOR={mixed}, POWER={_number(shear['exponent'])}"
    yield f"*DAMAGE EVOLUTION, TYPE=ENERGY, SOFTENING=LINEAR, {behavior}"
    yield ", ".join(map(_number, (bond.toughness, toughness, toughness)))


def _elastic(material: Material, plane: str) -> Iterator[str]:
    """In plane strain the third direction of an orthotropic body is like the second."""
    if isinstance(material, Isotropic):
        yield "*ELASTIC"
        yield f"{_number(material.young)}, {_number(material.poisson)}"
        return
    c = plane_strain_constants(material)
    E1, E2, G12, nu12 = (c[key] for key in ("E1", "E2", "G12", "nu12"))
    if plane == "stress":
        yield "*ELASTIC, TYPE=LAMINA"
        yield ", ".join(map(_number, (E1, E2, nu12, G12, G12, G12)))
    else:
        yield "*ELASTIC, TYPE=ENGINEERING CONSTANTS"
        yield ", ".join(map(_number, (E1, E2, c["E3"], nu12, c["nu13"], c["nu23"], G12, G12)))
        yield f"{_number(G12)},"


def _means(mesh: SceneMesh) -> Iterator[str]:
    """Mean displacement of each loaded face: the first term is eliminated, so the reference node comes last."""
    for face, number in zip(mesh.loaded, reference_nodes(mesh).values(), strict=True):
        terms = [(node + 1, weight) for node, weight in zip(face.node_n, face.weight_n, strict=True)]
        yield "*EQUATION"
        yield str(len(terms) + 1)
        yield from (f"{node}, 2, {_number(factor)}" for node, factor in [*terms, (number, -1.0)])


def _supports(mesh: SceneMesh) -> Iterator[str]:
    yield "*BOUNDARY"
    for support in mesh.supports:
        yield from (f"{support.name}, {i + 1}, {i + 1}" for i in support.components)
    yield from (f"{name}, 1, 1" for name in reference_nodes(mesh))


def _steps(scene: Scene, mesh: SceneMesh) -> Iterator[str]:
    programme = scene.load.opening
    way = sum(abs(b - a) for a, b in zip((0.0, *programme), programme, strict=False))
    finite = "YES" if effects(scene)["kinematics"] == "finite" else "NO"
    for i, (before, opening) in enumerate(zip((0.0, *programme), programme, strict=False), 1):
        part = min(1.0, way / abs(opening - before) / counted_steps(scene))
        yield f"*STEP, NAME=leg-{i}, NLGEOM={finite}, INC=100000"
        yield "*STATIC"
        yield f"{part:.6g}, 1., 1e-10, {part:.6g}"
        yield "*BOUNDARY"
        for face, name in zip(mesh.loaded, reference_nodes(mesh), strict=True):
            yield f"{name}, 2, 2, {_number(face.factor * opening)}"
        yield "*OUTPUT, FIELD"
        yield "*NODE OUTPUT"
        yield "U, RF"
        yield "*ELEMENT OUTPUT"
        yield "S, SDEG"
        yield "*OUTPUT, HISTORY, FREQUENCY=1"
        for name in reference_nodes(mesh):
            yield f"*NODE OUTPUT, NSET={name}"
            yield "U2, RF2"
        yield "*END STEP"


def _wrapped(nodes: Sequence[int]) -> Iterable[str]:
    """Abaqus reads at most 16 entries a line."""
    return (", ".join(map(str, nodes[i : i + 16])) + "," for i in range(0, len(nodes), 16))


def _number(value: float) -> str:
    return f"{float(value):.12g}"
