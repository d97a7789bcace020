"""The runs of the figures, and the runs on fine meshes for the converged curves."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

from verify.methods.dolfinx import dolfinx_installed
from verify.methods.mesh_choice import size
from verify.methods.reference_mesh import reference_mesh
from verify.runs.jobs import Job
from verify.scene.schema import Scene

#: The bases of the paper.
PAPER_BASES = ("tspline", "nurbs", "lagrange")

#: Packaged scenes of Figures 6 to 8, each with the name of its law in the paper.
PAPER_LAWS = {"dcb-czm1": "CZM 1", "dcb-czm2": "CZM 2"}

#: Packaged scenes of Figure 9, shortest bond first, and the scene with the moduli as printed in the paper.
BONDS, PRINTED = ("peel-60", "peel-80", "peel-100", "peel-120"), "peel-as-printed"

#: Interface points and penalty of Figures 6 and 7.
PAPER_POINTS, PAPER_PENALTY = 2, 1e5

#: Meshes of the converged curves without DOLFINx, by NURBS: unknowns for the beams, of which the modelled arm has half,
#: and multiples of the scene's unknowns for the strips.
FINE_BEAM, FINE_STRIP = (8000, 16_000), (2, 3)

#: Scene and penalty: each penalty has its own converged curve. None for strips, which have the penalty of the scene.
Problem = tuple[str, float | None]


@dataclass(frozen=True)
class Figures:
    """A group of figures: packaged scenes, and in words the meshes of the converged curves by method."""

    scenes: tuple[str, ...]
    fine: Mapping[str, str]


BEAMS = Figures(tuple(PAPER_LAWS), {"dolfinx": "cubic DOLFINx elements", "nurbs": "NURBS on one arm"})
STRIPS = Figures(BONDS, {"dolfinx": "quadratic DOLFINx elements", "nurbs": "NURBS"})


@dataclass(frozen=True)
class Case:
    """One run. 0 unknowns: the run of the packaged scene as in every verification, which all strips use."""

    basis: str
    scene: str
    dofs: int = 0
    points: int = PAPER_POINTS
    penalty: float = PAPER_PENALTY

    @property
    def of_the_paper(self) -> bool:
        """Whether the run belongs to Figures 6 and 7."""
        return (self.points, self.penalty) == (PAPER_POINTS, PAPER_PENALTY)

    @property
    def problem(self) -> Problem:
        return self.scene, self.penalty if self.dofs else None

    @property
    def overrides(self) -> tuple[str, ...]:
        own = {"discretization.dofs": self.dofs, "discretization.interface_points": self.points}
        sets = {**own, "interface.penalty": self.penalty} if self.dofs else {}
        return tuple(f"{key}={value!r}" for key, value in sets.items())

    @property
    def variant(self) -> str:
        """Folder of the run in the folder of its scene."""
        if not self.dofs:
            return self.basis
        return f"figures/{self.basis}-{self.dofs}-{self.points}-points-penalty-{self.penalty:g}"

    def job(self, scene: Scene) -> Job:
        return Job(self.scene, scene, self.basis, self.variant, self.overrides, fields=not self.dofs)


@dataclass(frozen=True)
class Plan:
    """Jobs of all cases, and for every problem those on two fine meshes, the coarser first."""

    figures: Figures
    scenes: Mapping[str, Scene]
    cases: tuple[tuple[Case, Job], ...]
    references: tuple[tuple[Problem, Job, Job], ...]

    @property
    def jobs(self) -> Iterator[Job]:
        yield from (job for _, *pair in self.references for job in pair)
        yield from (job for _, job in self.cases)


def beams(
    scenes: Sequence[tuple[str, Scene]],
    bases: Sequence[str] = PAPER_BASES,
    unknowns: Sequence[int] = (280, 1956),
    points: Sequence[int] = tuple(range(2, 9)),
    penalties: Sequence[float] = (1e3, PAPER_PENALTY),
) -> Plan:
    """Figures 6 to 8: all combinations for those of ``scenes`` (name, scene) that are in the paper."""
    known = {name: scene for name, scene in scenes if name in PAPER_LAWS}
    every = product(known, unknowns, penalties, points, bases)
    cases = [Case(basis, name, dofs, n, penalty) for name, dofs, penalty, n, basis in every]
    fine = tuple(((name, p), *_fine_beams(name, known[name], p)) for name, p in product(known, penalties))
    return Plan(BEAMS, known, tuple((case, case.job(known[case.scene])) for case in cases), fine)


def strips(scenes: Sequence[tuple[str, Scene]], bases: Sequence[str] = PAPER_BASES) -> Plan:
    """Figure 9: all bases for those of ``scenes`` (name, scene) that are in the paper."""
    given = dict(scenes)
    known = {bond: given[bond] for bond in BONDS if bond in given}
    cases = [Case(basis, bond) for bond, basis in product(known, bases)]
    fine = tuple(((bond, None), *_fine_strips(bond, scene)) for bond, scene in known.items())
    return Plan(STRIPS, known, tuple((case, case.job(known[case.scene])) for case in cases), fine)


def cubic(source: str, scene: Scene) -> Job:
    """DOLFINx with cubic elements on the mesh of the scene."""
    return Job(source, scene, "dolfinx", "dolfinx-p3", ("dolfinx.degree=3",))


def _fine_beams(source: str, scene: Scene, penalty: float) -> tuple[Job, Job]:
    def job(method: str, size: str, *mesh: str) -> Job:
        variant = f"figures/{method}-{size}-penalty-{penalty:g}"
        return Job(source, scene, method, variant, (f"interface.penalty={penalty!r}", *mesh), fields=False)

    if dolfinx_installed():
        n = round(size(scene, splines=False).value)
        coarse, fine = (job("dolfinx", f"p3-{m}", "dolfinx.degree=3", f"dolfinx.elements={m}") for m in (n, 2 * n))
        return (cubic(source, scene) if penalty == scene.interface.penalty else coarse), fine
    meshes = {f"one-arm-{dofs}": (f"discretization.dofs={dofs}", "effects.symmetry=true") for dofs in FINE_BEAM}
    coarse, fine = (job("nurbs", size, *mesh) for size, mesh in meshes.items())
    return coarse, fine


def _fine_strips(bond: str, scene: Scene) -> tuple[Job, Job]:
    if dolfinx_installed():
        n = 2 * round(size(scene, splines=False).value)
        variant = f"figures/dolfinx-p{reference_mesh(scene).degree}-{n}"
        finer = Job(bond, scene, "dolfinx", variant, (f"dolfinx.elements={n}",), fields=False)
        return Job(bond, scene, "dolfinx", "dolfinx"), finer
    sizes = [times * round(size(scene, splines=True).value) for times in FINE_STRIP]
    coarse, fine = (
        Job(bond, scene, "nurbs", f"figures/nurbs-{dofs}", (f"discretization.dofs={dofs}",), fields=False)
        for dofs in sizes
    )
    return coarse, fine
