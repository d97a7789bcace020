"""A scene as an Abaqus/Standard input file."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

import numpy as np

from verify.export.mesh import SceneMesh
from verify.export.numbers import effects, header, law
from verify.export.references import Reference, equations, references
from verify.meshes.arms import corner_count
from verify.scene.materials import Isotropic, plane_strain_constants
from verify.scene.schema import Scene, counted_steps

#: Solid elements by their number of nodes. Those of degree 1 have incompatible modes: fully integrated ones lock in
#: bending, by 20 % in one layer as long as it is thick.
SOLIDS = {3: "3", 4: "4I", 6: "6", 8: "8"}
PLANES = {"stress": "CPS", "strain": "CPE"}

#: Sliding costs nothing in debond; of a stiffness of zero a solver would make a mechanism.
SLIDING = 1e-6

#: Strength against sliding over that against opening: mode I alone does damage.
BEYOND_DAMAGE = 1e6

_NOTES = """\
** COH2D4 closes with the stiffness of the bond, {stiffness:g}: debond does so as well with
**   --set interface.penalty={stiffness:g}
** history.csv is written by: abaqus python history.py JOB.odb
** load: RF2 of {loaded}; opening: {scale:g} times its U2. Held against debond, in this folder, by
**   debond verify {scene}.toml --with history.csv --opening U2 --load RF2 --opening-scale {scale:g}"""

_ALONG = """\
*ORIENTATION, NAME=along, SYSTEM=RECTANGULAR
1., 0., 0., 0., 1., 0.
3, 0."""

#: Of thickness 1 the strain of a cohesive element is the separation.
_BOND_SECTION = """\
*COHESIVE SECTION, ELSET=bond, MATERIAL=bond, RESPONSE=TRACTION SEPARATION, THICKNESS=SPECIFIED
1., {:.12g}"""

_OPENING_LAW = """\
*MATERIAL, NAME=bond
*ELASTIC, TYPE=TRACTION
{K:.12g}, {K_s:.12g}, {K_s:.12g}
*DAMAGE INITIATION, CRITERION=MAXS
{p:.12g}, {p_s:.12g}, {p_s:.12g}
*DAMAGE EVOLUTION, TYPE=ENERGY, SOFTENING=LINEAR
{G:.12g},"""

_SLIDING_LAW = """\
*MATERIAL, NAME=bond
*ELASTIC, TYPE=TRACTION
{K:.12g}, {i.shear_stiffness:.12g}, {i.shear_stiffness:.12g}{remarks}
*DAMAGE INITIATION, CRITERION=QUADS
{p:.12g}, {i.shear_strength:.12g}, {i.shear_strength:.12g}
*DAMAGE EVOLUTION, TYPE=ENERGY, SOFTENING=LINEAR, MIXED MODE BEHAVIOR={mixed}, POWER={i.exponent:.12g}
{G:.12g}, {i.shear_toughness:.12g}, {i.shear_toughness:.12g}"""

_LAMINA = """\
*ELASTIC, TYPE=LAMINA
{E1:.12g}, {E2:.12g}, {nu12:.12g}, {G12:.12g}, {G12:.12g}, {G12:.12g}"""

_SOLID_CONSTANTS = """\
*ELASTIC, TYPE=ENGINEERING CONSTANTS
{E1:.12g}, {E2:.12g}, {E3:.12g}, {nu12:.12g}, {nu13:.12g}, {nu23:.12g}, {G12:.12g}, {G12:.12g}
{G12:.12g},"""

_TOUCHING = """\
*SURFACE INTERACTION, NAME=crack
{width:.12g},
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR
{penalty:.12g},{friction}
*CONTACT PAIR, INTERACTION=crack, TYPE=SURFACE TO SURFACE
{names[0]}_crack_face, {names[1]}_crack_face"""

#: What holds the rotation of a specimen whose loads balance each other, at the end without a support.
_SPRING = """\
** weak: it keeps the whole from turning, and bears next to nothing
*ELEMENT, TYPE=SPRING1, ELSET=spring
{element}, {node}
*SPRING, ELSET=spring
2
{stiffness:.12g},"""

_STEP = """\
*STEP, NAME=leg-{leg}, NLGEOM={finite}, INC=100000
*STATIC
{part:.6g}, 1., 1e-10, {part:.6g}
*BOUNDARY
{moved}
*OUTPUT, FIELD
*NODE OUTPUT
U, RF
*ELEMENT OUTPUT
S, SDEG
*OUTPUT, HISTORY, FREQUENCY=1
{told}
*END STEP"""


def write_abaqus(scene: Scene, mesh: SceneMesh, path: Path) -> None:
    """Write ``path``, of a `numbered` mesh: nodes, sets, solids, cohesive elements without thickness, a step a leg.

    A reference node has the mean displacement of a loaded face or a roller by an equation: its reaction is the load.
    """
    path.write_text("\n".join(_lines(scene, mesh)) + "\n", encoding="utf-8")


def _lines(scene: Scene, mesh: SceneMesh) -> Iterator[str]:
    points, bond = references(scene, mesh), law(scene)
    yield f"*HEADING\ndebond {scene.name}"
    yield from (f"** {name}: {text}" for name, text in header(scene, mesh).items())
    scale = 1.0 / points[0].part
    yield _NOTES.format(stiffness=bond.stiffness, loaded=points[0].name, scale=scale, scene=scene.name)
    yield from _mesh(scene, mesh, points)
    yield _ALONG
    for name in mesh.names:
        yield f"*SOLID SECTION, ELSET={name}, MATERIAL={name}, ORIENTATION=along\n{scene.specimen.width:.12g},"
    yield _BOND_SECTION.format(scene.specimen.width)
    for name, material in zip(mesh.names, scene.materials, strict=True):
        yield f"*MATERIAL, NAME={name}"
        if isinstance(material, Isotropic):
            yield f"*ELASTIC\n{material.young:.12g}, {material.poisson:.12g}"
        else:  # in plane strain the third direction is like the second
            constants = _LAMINA if scene.specimen.plane == "stress" else _SOLID_CONSTANTS
            yield constants.format(**plane_strain_constants(material))
    yield _law(scene)
    yield from _touching(scene, mesh)
    held = {(int(node) + 1, i + 1) for part in mesh.supports for node in part.node_n for i in part.components}
    for one, terms in zip(points, equations(points, held), strict=True):
        yield f"*EQUATION\n{len(terms) + 1}"
        yield from (f"{node}, {i}, {weight:.12g}" for (node, i), weight in terms)
        yield f"{one.node}, 2, -1"
    yield "*BOUNDARY"
    yield from (f"{support.name}, {i + 1}, {i + 1}" for support in mesh.supports for i in support.components)
    yield from (f"{one.name}, 1, {1 if one.part else 2}" for one in points)
    if mesh.turning:
        X_nI = mesh.X_nI
        node = int(mesh.number_n[np.argmin(np.linalg.norm(X_nI - [X_nI[:, 0].min(), 0.0], axis=1))])
        element = int(mesh.number_e.max()) + len(mesh.cohesive_ea) + 1
        yield _SPRING.format(element=element, node=node, stiffness=mesh.turning / np.ptp(X_nI[:, 0]) ** 2)
    yield from _steps(scene, points)


def _mesh(scene: Scene, mesh: SceneMesh, points: Sequence[Reference]) -> Iterator[str]:
    yield "*NODE, NSET=all"
    yield from (f"{n}, {x:.12g}, {y:.12g}" for n, (x, y) in zip(mesh.number_n, mesh.X_nI, strict=True))
    for one in points:
        x, y = mesh.at(one.faces[0][1].node_n).mean(axis=0)
        yield f"{one.node}, {x:.12g}, {y:.12g}"
    solid = PLANES[scene.specimen.plane] + SOLIDS[mesh.conn_ea.shape[1]]
    bodies = ((name, mesh.body_e == b) for b, name in enumerate(mesh.names))
    parts = [(solid, name, mesh.number_e[here], mesh.conn_ea[here]) for name, here in bodies]
    of_bond = mesh.number_e.max() + 1 + np.arange(len(mesh.cohesive_ea))
    for kind, name, numbers, conn in (*parts, ("COH2D4", "bond", of_bond, mesh.cohesive_ea)):
        yield f"*ELEMENT, TYPE={kind}, ELSET={name}"
        yield from (f"{e}, " + ", ".join(map(str, nodes + 1)) for e, nodes in zip(numbers, conn, strict=True))
    means = {one.name: np.array([one.node - 1]) for one in points}
    for name, nodes in (mesh.sets | means).items():
        yield f"*NSET, NSET={name}"
        yield from _wrapped(nodes)


def _law(scene: Scene) -> str:
    """The law of the bond; the onset of Turon et al., which Abaqus has not, is alike in pure modes."""
    bond, i = law(scene), scene.interface
    known = {"K": bond.stiffness, "p": bond.strength, "G": bond.toughness}
    if not i.slides:
        return _OPENING_LAW.format(**known, K_s=SLIDING * bond.stiffness, p_s=BEYOND_DAMAGE * bond.strength)
    onset = "** debond has the onset of Turon et al. (2006), which is that of QUADS in pure modes alone"
    left_out = {key: getattr(i, key) for key in ("friction", "viscosity", "pressure_strength")}
    remarks = [onset] if i.onset == "turon" else []
    remarks += [f"** left out: interface.{key} = {value:g}" for key, value in left_out.items() if value]
    mixed = {"bk": "BK", "power": "POWER LAW"}[i.criterion]
    return _SLIDING_LAW.format(**known, i=i, mixed=mixed, remarks="".join(f"\n{remark}" for remark in remarks))


def _touching(scene: Scene, mesh: SceneMesh) -> Iterator[str]:
    """The faces of the precrack, where they can touch. Side i of a solid, from its corner i on, is Si."""
    if not mesh.crack_kb.size:
        return
    corner_ea = mesh.conn_ea[:, : corner_count(mesh.conn_ea)]
    for b, name in enumerate(mesh.names):
        on_ea = (mesh.body_e == b)[:, None] & np.isin(corner_ea, mesh.crack_kb[:, 1 - b])
        faces: list[str] = []
        for i, on_e in enumerate((on_ea & np.roll(on_ea, -1, axis=1)).T, 1):
            if on_e.any():
                elements = f"{name}_at_crack" + f"_{i}" * bool(faces)
                faces.append(f"{elements}, S{i}")
                yield f"*ELSET, ELSET={elements}"
                yield from _wrapped(mesh.number_e[on_e] - 1)
        yield from (f"*SURFACE, TYPE=ELEMENT, NAME={name}_crack_face", *faces)
    friction = f"\n*FRICTION\n{scene.interface.friction:.12g}," if scene.interface.friction else ""
    width, penalty = scene.specimen.width, law(scene).penalty
    yield _TOUCHING.format(width=width, penalty=penalty, friction=friction, names=mesh.names)


def _steps(scene: Scene, points: Sequence[Reference]) -> Iterator[str]:
    legs = list(zip((0.0, *scene.load.opening), scene.load.opening, strict=False))
    way = sum(abs(b - a) for a, b in legs)
    for leg, (before, opening) in enumerate(legs, 1):
        yield _STEP.format(
            leg=leg,
            finite="YES" if effects(scene)["kinematics"] == "finite" else "NO",
            part=min(1.0, way / abs(opening - before) / counted_steps(scene)),
            moved="\n".join(f"{one.name}, 2, 2, {one.part * opening:.12g}" for one in points if one.part),
            told="\n".join(f"*NODE OUTPUT, NSET={one.name}\nU2, RF2" for one in points),
        )


def _wrapped(number_n: np.ndarray) -> Iterable[str]:
    """Numbers of nodes or elements from 1 on; Abaqus reads at most 16 entries a line."""
    parts = (number_n[i : i + 16] + 1 for i in range(0, len(number_n), 16))
    return (", ".join(map(str, part)) + "," for part in parts)
