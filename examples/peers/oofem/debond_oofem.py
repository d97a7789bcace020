"""A double cantilever beam by OOFEM: writes its input file, and reads the reactions of its output file."""

import re
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from verify.export.mesh import scene_mesh
from verify.export.numbers import effects, law
from verify.methods import peers
from verify.result import Result, steps_from_rows
from verify.scene.schema import counted_steps

SOLVE = """import oofem
print("ready", flush=True)
problem = oofem.InstanciateProblem(oofem.OOFEMTXTDataReader("scene.in"), oofem.problemMode.processor, 0, None, False)
problem.checkProblemConsistency()
problem.init()
problem.postInitialize()
problem.solveYourself()
problem.terminateAnalysis()
"""
HEAD = """scene.out
{name}
StaticStructural nsteps {steps} deltat 1.0 rtolf 1e-6 MaxIter 500 stiffmode 1 manrmsteps 1 nmodules 0
Domain 2dPlaneStress
OutputManager tstep_all dofman_output {{{watched}}}
ndofman {nodes} nelem {elements} ncrosssect {parts} nmat {parts} nbc {bcs} nic 0 nltf 1 nset {sets}
"""
#: Stiffness in opening of what resists closing alone, over that in closing.
OPEN = 1e-12
#: Its arc tangent between both leaves an open gap the traction kn / (pi SHARP).
SHARP = 1e12
#: Pairs of jump and damage between which OOFEM interpolates.
PAIRS = 4000
NUMBER = r"([-+\d.eE]+)"
STEP = re.compile(r"Output for time\s+" + NUMBER)
REACTION = re.compile(r"[Nn]ode\s+(\d+)\s+iDof\s+(\d+)\s+reaction\s+" + NUMBER)


def unsuitable(scene):
    """Why the solver is not made for a scene, or nothing."""
    asked = effects(scene)
    if asked["kinematics"] != "linear" or not asked["irreversible"]:
        return 'effects: kinematics must be "linear", and irreversible true'
    return peers.unless_plain_dcb(scene)


def solve(scene, on_step):
    """Load over opening; ``[dolfinx]`` of the scene sets elements, layers and degree."""
    mesh, why, started = scene_mesh(scene), "", 0.0
    with TemporaryDirectory() as place:
        folder = Path(place)
        pulled = write(scene, mesh, folder)
        (folder / "solve.py").write_text(SOLVE)
        try:
            started = peers.run("oofem", [peers.known()["oofem"].interpreter, "solve.py"], folder)
        except RuntimeError as error:
            why = str(error)
        loads = list(read(folder / "scene.out", pulled))
    if not loads:
        raise RuntimeError(why or "oofem wrote no reactions")
    openings = programme(scene)[1 : len(loads) + 1]
    rows = [{"opening": d, "load": scene.specimen.width * p} for d, p in zip(openings, loads, strict=True)]
    size = {"dofs": mesh.X_nI.size, "elements": len(mesh.conn_ea), "jit_seconds": started}
    return Result("oofem", steps_from_rows(rows), f"stopped: {why}" if why else "complete", **size)


solve.unsuitable = unsuitable
#: Elements in the process zone on the coarsest mesh of `debond cost`, by the degree.
solve.degrees = {1: 4.0, 2: 1.0}


def programme(scene):
    """The opening of every step, and zero before them."""
    turns = [0.0, *scene.load.opening]
    travel = np.abs(np.diff(turns))
    counts = np.maximum(np.rint(counted_steps(scene) * travel / travel.sum()), 1).astype(int)
    parts = [np.linspace(a, b, n + 1)[1:] for a, b, n in zip(turns, turns[1:], counts, strict=False)]
    return np.concatenate([[0.0], *parts])


def write(scene, mesh, folder):
    """Both files as OOFEM reads them; returns the numbers of the loaded nodes of the upper arm.

    Nodes are numbered along the specimen, as its matrix is a skyline.
    """
    number = np.empty(len(mesh.X_nI), dtype=int)
    number[np.lexsort(mesh.X_nI.T[::-1])] = np.arange(1, len(mesh.X_nI) + 1)
    bond, material, openings = law(scene), scene.materials[0], programme(scene)
    kind = ("PlaneStress2d", "QPlaneStress2d")[mesh.degree - 1]
    around = number[mesh.cohesive_ea[:, [0, 1, 3, 2]]]
    elements = [f"{kind} {e} nodes {conn.size} {words(number[conn])}" for e, conn in enumerate(mesh.conn_ea, 1)]
    first = len(elements) + 1
    elements += [f"IntElLine1 {e} nodes 4 {words(nodes)}" for e, nodes in enumerate(around, first)]
    last, extra = len(elements), bond.penalty - bond.stiffness if bond.contact else 0.0
    if extra > 0.0:  # beside each of the bond one that resists closing alone
        elements += [f"IntElLine1 {e} nodes 4 {words(nodes)}" for e, nodes in enumerate(around, last + 1)]
    held = [(number[part.node_n], tuple(i + 1 for i in part.components), 0.0) for part in mesh.supports]
    held += [(number[face.node_n], (2,), face.factor) for face in mesh.loaded]
    sets = [f"Set 1 elementranges {{(1 {first - 1})}}", f"Set 2 elementranges {{({first} {last})}}"]
    contact = []
    if extra > 0.0:
        sets.append(f"Set 3 elementranges {{({last + 1} {len(elements)})}}")
        contact = [
            "InterfaceCS 3 thickness 1.0 material 3 set 3",
            f"CohInt 3 kn {extra!r} ks {extra * OPEN!r} stiffCoeffKn {OPEN!r} smoothMag {SHARP!r}",
        ]
    others = len(sets)
    conditions = []
    for k, (nodes, components, value) in enumerate(held, 1):
        sets.append(f"Set {k + others} nodes {nodes.size} {words(nodes)}")
        n = len(components)
        moved = f"dofs {n} {words(components)} values {n} {words([value] * n)}"
        conditions.append(f"BoundaryCondition {k} loadTimeFunction 1 {moved} set {k + others}")
    pulled = number[mesh.loaded[0].node_n]
    head = HEAD.format(
        name=scene.name, steps=len(openings) - 1, watched=words(pulled), nodes=len(number), elements=len(elements),
        bcs=len(held), sets=len(sets), parts=others,
    )  # fmt: skip
    nodes = [f"node {number[n]} coords 3 {x!r} {y!r} 0.0" for n, (x, y) in enumerate(mesh.X_nI.tolist())]
    lines = [
        *sorted(nodes, key=lambda line: int(line.split()[1])),
        *elements,
        "SimpleCS 1 thick 1.0 material 1 set 1",
        "InterfaceCS 2 thickness 1.0 material 2 set 2",
        *contact[:1],
        f"IsoLE 1 d 0.0 E {material.young!r} n {material.poisson!r} tAlpha 0.0",
        f"IntMatIsoDamageTable 2 kn {bond.stiffness!r} ks {bond.stiffness!r} ft {bond.strength!r} "
        'tablename "law.txt" maxomega 0.999999',
        *contact[1:],
        *conditions,
        f"PiecewiseLinFunction 1 t {len(openings)} {words(range(len(openings)))} "
        f"f(t) {len(openings)} {words(openings)}",
        *sets,
    ]
    (folder / "scene.in").write_text(head + "\n".join(lines) + "\n")
    jump = np.geomspace(bond.g_peak, bond.g_open, PAIRS + 1)
    damage = 1.0 - (bond.g_open - jump) / (bond.g_open - bond.g_peak) * bond.g_peak / jump
    pairs = [f"{g!r} {d!r}" for g, d in zip((jump - jump[0]).tolist(), damage.tolist(), strict=True)][1:]
    (folder / "law.txt").write_text("\n".join([str(len(pairs)), *pairs]) + "\n")
    return pulled


def read(path, pulled):
    """The force on the loaded nodes of every step, none where nothing was written."""
    if not path.exists():
        return
    for part in STEP.split(path.read_text(errors="replace"))[2::2]:
        found = [float(f) for node, dof, f in REACTION.findall(part) if int(node) in pulled and dof == "2"]
        if found:
            yield sum(found)


def words(numbers):
    return " ".join(str(number) for number in (numbers.tolist() if isinstance(numbers, np.ndarray) else numbers))
