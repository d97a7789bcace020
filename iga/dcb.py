"""The double cantilever beam: two arms, one interface, opened at one end."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from iga.basis import BlockBasis, block_basis, chain_basis
from iga.bspline import open_knots
from iga.cohesive import BilinearLaw
from iga.extraction import Mesh
from iga.fields import snapshot
from iga.interface import Interface
from iga.lagrange import lagrange_rectangle
from iga.lumped import lumped
from iga.material import orthotropic
from iga.nurbs import nurbs_rectangle
from iga.observe import Arm, Specimen, mean_row, row
from iga.path import End, follow
from iga.quadrature import gauss, lobatto, square
from iga.surface import surface
from iga.system import Phase, Solid, System, joined, untimed

RULES = {"gauss": gauss, "lobatto": lobatto}

#: Elements before the crack tip only bend; they may be this much longer than those on the crack path.
COARSENING = 4.0

#: Stiffness of a tie that shall not give, relative to the modulus times the width.
RIGID = 1e3


@dataclass(frozen=True)
class Problem:
    """A double cantilever beam in plain numbers, any consistent units.

    X runs from 0 (loaded end) to ``length``, the interface lies on Y = 0 and is bonded from ``precrack`` on; each arm
    is ``arm_thickness`` thick. ``opening`` is the programme of separations of the loaded faces; ``symmetry`` models
    the upper arm alone against its mirror image. ``slave`` is the arm whose points are projected. ``dofs`` is the
    number aimed at, never exceeded.
    """

    length: float
    arm_thickness: float
    precrack: float
    E1: float
    E2: float
    G12: float
    nu12: float
    strength: float
    toughness: float
    ductility: float
    penalty: float
    opening: tuple[float, ...]
    width: float = 1.0
    plane: str = "stress"
    contact: bool = True
    irreversible: bool = True
    kinematics: str = "finite"
    symmetry: bool = False
    slave: str = "upper"
    basis: str = "nurbs"
    degree: int = 3
    dofs: int = 1956
    interface_rule: str = "gauss"
    interface_points: int = 2
    steps: int = 150
    snapshot_openings: tuple[float, ...] = ()


@dataclass(frozen=True)
class Solution:
    """What a run leaves: a row a converged step (see `iga.observe`), snapshots (see `iga.fields`), and how it ended."""

    rows: tuple[Mapping[str, float], ...]
    dofs: int
    elements: int
    rejected_steps: int
    status: str
    snapshots: tuple[Mapping[str, object], ...]


def arm_mesh(problem: Problem, bottom: float) -> Mesh:
    """One arm, one element thick, with its ``bottom`` at that Y: equal elements along the bond, longer ones before it.

    An element boundary lies at the end of the precrack. The model of one arm gets half of ``dofs``.

    Raises
    ------
    ValueError : ``dofs`` is too small for a mesh, or the basis is unknown.
    """
    p, spline = problem.degree, problem.basis == "nurbs"
    if not spline and problem.basis != "lagrange":
        raise ValueError(f'basis must be "nurbs" or "lagrange", got {problem.basis!r}')
    columns = problem.dofs // (4 * (p + 1))
    elements = columns - p if spline else (columns - 1) // p
    if elements < 2:
        least = 4 * (p + 1) * (p + 2 if spline else 2 * p + 1)
        raise ValueError(f"a {problem.basis} mesh of degree {p} needs at least {least} unknowns, got {problem.dofs}")
    breaks = graded_breaks(problem.length, problem.precrack, elements)
    through = bottom + problem.arm_thickness * np.linspace(0.0, 1.0, 2)
    return (
        nurbs_rectangle(open_knots(breaks, p), open_knots(through, p))
        if spline
        else lagrange_rectangle(breaks, through, p)
    )


def graded_breaks(length: float, precrack: float, elements: int) -> np.ndarray:
    """Element boundaries (elements + 1,): equal along the bond, equal and `COARSENING` times longer before it."""
    bond = length - precrack
    before = round(elements * precrack / (precrack + COARSENING * bond))
    before = min(max(before, 1), elements - 1)
    return np.concatenate(
        [np.linspace(0.0, precrack, before + 1)[:-1], np.linspace(precrack, length, elements - before + 1)]
    )


def build(problem: Problem, phase: Phase = untimed) -> Specimen:
    """Discrete system of a problem with all that is needed to read results from its states."""
    with phase("mesh"):
        bottoms = (0.0,) if problem.symmetry else (0.0, -problem.arm_thickness)
        meshes = tuple(arm_mesh(problem, bottom) for bottom in bottoms)
    with phase("basis"):
        first = np.cumsum([0] + [len(mesh.P_AI) for mesh in meshes])
        P_AI = np.concatenate([mesh.P_AI for mesh in meshes])
        D = orthotropic(problem.E1, problem.E2, problem.G12, problem.nu12, problem.plane)
        # a mirror image that is not modelled counts in the width, so that forces and energies are those of the whole
        copies = 2.0 if problem.symmetry else 1.0
        width = copies * problem.width
        # p points keep the order (Ciarlet 1978, sec. 4.1); on C^0 elements they would leave spurious modes
        along = max(problem.degree, 2) if problem.basis == "nurbs" else problem.degree + 1
        arms = tuple(_arm(mesh, start, D, width, along) for mesh, start in zip(meshes, first[:-1], strict=True))
        n_dof = 2 * len(P_AI)
        mean = [mean_row(arm.face, 1, n_dof) for arm in arms]
        load_d = 2.0 * mean[0] if problem.symmetry else mean[0] - mean[1]
        springs_rd, spring_r = _supports(problem, P_AI, first, arms)
        system = System(
            solids=joined([solid for arm in arms for solid in arm.solids]),
            interface=_interface(problem, meshes, first),
            kinematics=problem.kinematics,
            load_d=load_d,
            free_d=np.ones(n_dof, dtype=bool),
            x_d=np.repeat(P_AI[:, 0], 2),
            springs_rd=springs_rd,
            spring_r=spring_r,
        )
        probe = _points(problem, meshes, first, *lobatto(2), [0, -1])
    upper_is_slave = problem.symmetry or problem.slave == "upper"
    return Specimen(system, arms, meshes, problem.precrack, upper_is_slave, copies, probe)


def solve(
    problem: Problem, on_step: Callable[[Mapping[str, float]], None] | None = None, phase: Phase = untimed
) -> Solution:
    """Solve a double cantilever beam.

    Parameters
    ----------
    problem : the specimen, its law, programme and mesh.
    on_step : called with the row of every converged step, as it comes.
    phase : context manager that times "mesh", "basis", "assembly", "factor", "solve".

    Returns
    -------
    Solution; its ``status`` says whether the whole programme was run.

    Raises
    ------
    ValueError : a problem for which there is no mesh or no material.
    """
    specimen = build(problem, phase)
    rows: list[dict[str, float]] = []
    snapshots: list[dict[str, object]] = []
    wanted = sorted(problem.snapshot_openings)
    end = End("complete", 0)
    for item in follow(specimen.system, by_way_of(problem.opening, wanted), problem.steps, phase=phase):
        if isinstance(item, End):
            end = item
            continue
        rows.append(row(specimen, item))
        if on_step is not None:
            on_step(rows[-1])
        if wanted and item.opening >= wanted[0]:
            wanted = [opening for opening in wanted if opening > item.opening]
            snapshots.append(snapshot(specimen, item))
    dofs, elements = specimen.system.n_dof, sum(mesh.elements for mesh in specimen.meshes)
    return Solution(tuple(rows), dofs, elements, end.rejected, end.status, tuple(snapshots))


def by_way_of(programme: Sequence[float], stops: Sequence[float]) -> tuple[float, ...]:
    """The programme with a stop at each of ``stops`` (increasing) where it first comes by."""
    way, left, here = [], list(stops), 0.0
    for goal in programme:
        while left and here < left[0] < goal:
            way.append(left.pop(0))
        way.append(goal)
        here = goal
    return tuple(way)


def _arm(mesh: Mesh, first: int, D: np.ndarray, width: float, along: int) -> Arm:
    """Basis of one arm, numbered from ``first`` on; ``along`` x (p+1) Gauss points an element, p+1 on the face."""
    solids = []
    for block in mesh.blocks:
        rules = gauss(along), gauss(block.degrees[1] + 1)
        solids.append(Solid(_shifted(block_basis(mesh, block, *square(*rules), width), first), D))
    face = chain_basis(mesh, mesh.chains["left"], *gauss(max(block.degrees[1] for block in mesh.blocks) + 1))
    return Arm(tuple(solids), tuple(_shifted(basis, first) for basis in face), D)


def _shifted(basis: BlockBasis, first: int) -> BlockBasis:
    return replace(basis, conn_ea=basis.conn_ea + first)


def _supports(
    problem: Problem, P_AI: np.ndarray, first: np.ndarray, arms: tuple[Arm, ...]
) -> tuple[np.ndarray, np.ndarray]:
    """Rows (n_r, n_dof) of the displacements that are held, and by how stiff a spring (n_r,).

    The lower arm's corner of interface and far end is held in x and y, and how far the two loaded faces are out of line
    takes the rotation: the rigid motions of the whole, so that these springs carry no force. An interface without
    friction leaves free to slide one arm along the other, which is tied at these corners, too: the tie carries what
    the tractions of a bent interface amount to lengthwise and is as good as rigid. One arm alone is held in x.
    """
    n_dof = 2 * len(P_AI)
    corners = [
        start + int(np.argmin(np.linalg.norm(P_AI[start:end] - [problem.length, 0.0], axis=1)))
        for start, end in zip(first[:-1], first[1:], strict=True)
    ]
    x_rd = np.array([np.eye(1, n_dof, 2 * corner)[0] for corner in corners])
    soft = problem.E1 * problem.width * problem.arm_thickness / problem.length
    if len(arms) == 1:
        return x_rd, np.array([soft])
    y_d = np.eye(1, n_dof, 2 * corners[1] + 1)[0]
    aligned_d = mean_row(arms[0].face, 0, n_dof) - mean_row(arms[1].face, 0, n_dof)
    tie = RIGID * problem.E1 * problem.width
    return np.stack([x_rd[1], y_d, aligned_d, x_rd[0] - x_rd[1]]), np.array([soft, soft, soft, tie])


def _interface(problem: Problem, meshes: tuple[Mesh, ...], first: np.ndarray) -> Interface:
    if problem.interface_rule == "lumped":
        return lumped(_points(problem, meshes, first, *gauss(problem.degree + 1), slice(None)))
    xi, w = RULES[problem.interface_rule](problem.interface_points)
    return _points(problem, meshes, first, xi, w, slice(None))


def _points(
    problem: Problem,
    meshes: tuple[Mesh, ...],
    first: np.ndarray,
    xi: np.ndarray,
    w: np.ndarray,
    sides: slice | list[int],
) -> Interface:
    """Interface with the rule (xi, w) on the bonded ``sides`` of the slave; the whole other arm is master."""
    slave, master = (1, 0) if problem.slave == "lower" and not problem.symmetry else (0, 1)
    names = ("bottom", "top")
    P_AI = np.concatenate([mesh.P_AI for mesh in meshes])
    whole = surface(meshes[slave], meshes[slave].chains[names[slave]], int(first[slave]))
    (middle,) = whole.coefficients(np.arange(whole.sides), np.full(whole.sides, 0.5), 0)
    X_c = np.einsum("cb,cbi->ci", middle, whole.bezier_points(P_AI))[:, 0]
    c_q = np.repeat(np.flatnonzero(X_c > problem.precrack)[sides], len(xi))
    xi_q, w_q = (np.tile(v, len(c_q) // len(xi)) for v in (xi, w))
    r0, r1 = whole.coefficients(c_q, xi_q, 1)
    Q_qbi = whole.bezier_points(P_AI)[c_q]
    X_qi, tangent_qi = (np.einsum("qb,qbi->qi", r, Q_qbi) for r in (r0, r1))
    return Interface(
        N_qa=whole.functions(c_q, r0),
        conn_qa=whole.conn_ca[c_q],
        dA_q=np.linalg.norm(tangent_qi, axis=1) * w_q * problem.width,
        X_qi=X_qi,
        P_AI=P_AI,
        law=BilinearLaw(
            problem.strength,
            problem.toughness,
            problem.ductility,
            problem.penalty,
            problem.contact,
            problem.irreversible,
        ),
        master=None
        if problem.symmetry
        else surface(meshes[master], meshes[master].chains[names[master]], int(first[master])),
        mirror_i=np.array([0.0, 1.0]) if problem.symmetry else None,
        frozen=problem.kinematics == "linear",
    )
