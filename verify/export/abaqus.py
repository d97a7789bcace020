"""A scene as an Abaqus/Standard input file."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from verify.export.mesh import SceneMesh
from verify.export.numbers import effects, header, law, sliding
from verify.export.references import Place, Reference, equations, references
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

    A reference node has the mean displacement of a loaded face or a roller by an equation: its reaction is the load.
    """
    path.write_text("\n".join(_lines(scene, mesh)) + "\n", encoding="utf-8")


def _lines(scene: Scene, mesh: SceneMesh) -> Iterator[str]:
    yield "*HEADING"
    yield f"debond {scene.name}"
    yield from (f"** {name}: {text}" for name, text in header(scene, mesh).items())
    points = references(scene, mesh)
    held = {(int(node) + 1, i + 1) for part in mesh.supports for node in part.node_n for i in part.components}
    yield from _of_abaqus(scene, points[0])
    yield from _mesh(scene, mesh, points)
    yield from _sections(scene, mesh)
    yield from _materials(scene, mesh)
    yield from _touching(scene, mesh)
    yield from _equations(points, held)
    yield from _supports(mesh, points)
    yield from _spring(mesh)
    yield from _steps(scene, points)


def _of_abaqus(scene: Scene, loaded: Reference) -> Iterator[str]:
    bond = law(scene)
    scale = 1.0 / loaded.part
    yield f"** COH2D4 closes with the stiffness of the bond, {bond.stiffness:g}: debond does so as well with"
    yield f"**   --set interface.penalty={bond.stiffness:g}"
    yield "** history.csv is written by: abaqus python history.py JOB.odb"
    yield f"** load: RF2 of {loaded.name}; opening: {scale:g} times its U2. Held against debond, in this folder, by"
    yield f"**   debond verify {scene.name}.toml --with history.csv --opening U2 --load RF2 --opening-scale {scale:g}"


def _mesh(scene: Scene, mesh: SceneMesh, points: Sequence[Reference]) -> Iterator[str]:
    yield "*NODE, NSET=all"
    yield from (f"{n}, {_number(x)}, {_number(y)}" for n, (x, y) in enumerate(mesh.X_nI, 1))
    for one in points:
        x, y = mesh.X_nI[one.faces[0][1].node_n].mean(axis=0)
        yield f"{one.node}, {_number(x)}, {_number(y)}"
    solid, first = SOLIDS[scene.specimen.plane, mesh.degree], 1
    for b, name in enumerate(mesh.names):
        conn = mesh.conn_ea[mesh.body_e == b]
        yield f"*ELEMENT, TYPE={solid}, ELSET={name}"
        yield from _elements(conn, first)
        first += len(conn)
    yield "*ELEMENT, TYPE=COH2D4, ELSET=bond"
    yield from _elements(mesh.cohesive_ea, first)
    means = {one.name: np.array([one.node - 1]) for one in points}
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


def _touching(scene: Scene, mesh: SceneMesh) -> Iterator[str]:
    """The faces of the precrack, where they can touch. The lower and the upper side of a solid are S1 and S3."""
    if not mesh.crack_kb.size:
        return
    for b, (name, side) in enumerate(zip(mesh.names, (1, 3), strict=True)):
        ends = mesh.conn_ea[:, [side - 1, side % 4]]
        on_face = (mesh.body_e == b) & np.isin(ends, mesh.crack_kb[:, 1 - b]).all(axis=1)
        yield f"*ELSET, ELSET={name}_at_crack"
        yield from _wrapped([int(e) + 1 for e in np.flatnonzero(on_face)])
        yield f"*SURFACE, TYPE=ELEMENT, NAME={name}_crack_face"
        yield f"{name}_at_crack, S{side}"
    yield "*SURFACE INTERACTION, NAME=crack"
    yield f"{_number(scene.specimen.width)},"
    yield "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR"
    yield f"{_number(law(scene).penalty)},"
    if friction := scene.interface.friction:
        yield "*FRICTION"
        yield f"{_number(friction)},"
    yield "*CONTACT PAIR, INTERACTION=crack, TYPE=SURFACE TO SURFACE"
    yield ", ".join(f"{name}_crack_face" for name in mesh.names)


def _equations(references: Sequence[Reference], held: set[Place]) -> Iterator[str]:
    for one, terms in zip(references, equations(references, held), strict=True):
        yield "*EQUATION"
        yield str(len(terms) + 1)
        yield from (f"{node}, {i}, {_number(weight)}" for (node, i), weight in terms)
        yield f"{one.node}, 2, -1"


def _supports(mesh: SceneMesh, points: Sequence[Reference]) -> Iterator[str]:
    yield "*BOUNDARY"
    for support in mesh.supports:
        yield from (f"{support.name}, {i + 1}, {i + 1}" for i in support.components)
    yield from (f"{one.name}, 1, {1 if one.part else 2}" for one in points)


def _spring(mesh: SceneMesh) -> Iterator[str]:
    """What holds the rotation of a specimen whose loads balance each other, at the end without a support."""
    if not mesh.turning:
        return
    X_nI = mesh.X_nI
    node = int(np.argmin(np.linalg.norm(X_nI - [X_nI[:, 0].min(), 0.0], axis=1)))
    yield "** weak: it keeps the whole from turning, and bears next to nothing"
    yield "*ELEMENT, TYPE=SPRING1, ELSET=spring"
    yield f"{len(mesh.conn_ea) + len(mesh.cohesive_ea) + 1}, {node + 1}"
    yield "*SPRING, ELSET=spring"
    yield "2"
    yield f"{_number(mesh.turning / np.ptp(X_nI[:, 0]) ** 2)},"


def _steps(scene: Scene, points: Sequence[Reference]) -> Iterator[str]:
    programme = scene.load.opening
    way = sum(abs(b - a) for a, b in zip((0.0, *programme), programme, strict=False))
    finite = "YES" if effects(scene)["kinematics"] == "finite" else "NO"
    for i, (before, opening) in enumerate(zip((0.0, *programme), programme, strict=False), 1):
        part = min(1.0, way / abs(opening - before) / counted_steps(scene))
        yield f"*STEP, NAME=leg-{i}, NLGEOM={finite}, INC=100000"
        yield "*STATIC"
        yield f"{part:.6g}, 1., 1e-10, {part:.6g}"
        yield "*BOUNDARY"
        yield from (f"{one.name}, 2, 2, {_number(one.part * opening)}" for one in points if one.part)
        yield "*OUTPUT, FIELD"
        yield "*NODE OUTPUT"
        yield "U, RF"
        yield "*ELEMENT OUTPUT"
        yield "S, SDEG"
        yield "*OUTPUT, HISTORY, FREQUENCY=1"
        for one in points:
            yield f"*NODE OUTPUT, NSET={one.name}"
            yield "U2, RF2"
        yield "*END STEP"


def _wrapped(nodes: Sequence[int]) -> Iterable[str]:
    """Abaqus reads at most 16 entries a line."""
    return (", ".join(map(str, nodes[i : i + 16])) + "," for i in range(0, len(nodes), 16))


def _number(value: float) -> str:
    return f"{float(value):.12g}"
