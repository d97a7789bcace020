"""The runs behind Figures 6, 7 and 8, and the fine ones that they are held against."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

from verify.methods.dolfinx import dolfinx_installed
from verify.methods.names import WITH_DOFS
from verify.runs.jobs import Job
from verify.scene.schema import Scene

#: Packaged scene -> its law, as the paper calls it.
LAWS = {"dcb-czm1": "CZM 1", "dcb-czm2": "CZM 2"}

#: Points and penalty of Figures 6 and 7.
PAPER_POINTS, PAPER_PENALTY = 2, 1e5

#: Unknowns of the NURBS meshes that stand in where DOLFINx is missing; one arm has half of them.
STAND_IN = (8000, 16_000)


#: A law and a penalty: a soft contact is another problem, with a converged curve of its own.
Problem = tuple[str, float]


@dataclass(frozen=True)
class Case:
    """One run of the figures; ``law`` is the name of its packaged scene, ``dofs`` the unknowns that it aims at."""

    basis: str
    law: str
    dofs: int
    points: int = PAPER_POINTS
    penalty: float = PAPER_PENALTY

    @property
    def of_the_paper(self) -> bool:
        """Whether it belongs to Figures 6 and 7."""
        return (self.points, self.penalty) == (PAPER_POINTS, PAPER_PENALTY)

    @property
    def problem(self) -> Problem:
        """What it solves, however well."""
        return self.law, self.penalty

    @property
    def overrides(self) -> tuple[str, ...]:
        return (
            f"discretization.dofs={self.dofs}",
            f"discretization.interface_points={self.points}",
            f"interface.penalty={self.penalty!r}",
        )

    @property
    def variant(self) -> str:
        """Folder of the run in that of its scene."""
        return f"figures/{self.basis}-{self.dofs}-{self.points}-points-penalty-{self.penalty:g}"

    def job(self, scene: Scene) -> Job:
        return Job(self.law, scene, self.basis, self.variant, self.overrides, fields=False)


@dataclass(frozen=True)
class Plan:
    """Jobs of all cases, and for every problem among them those of two fine meshes, the coarser first."""

    scenes: tuple[tuple[str, Scene], ...]
    cases: tuple[tuple[Case, Job], ...]
    references: tuple[tuple[Problem, Job, Job], ...]

    @property
    def jobs(self) -> Iterator[Job]:
        yield from (job for _, *pair in self.references for job in pair)
        yield from (job for _, job in self.cases)


def planned(
    scenes: Sequence[tuple[str, Scene]],
    bases: Sequence[str] = WITH_DOFS,
    unknowns: Sequence[int] = (280, 1956),
    points: Sequence[int] = tuple(range(2, 9)),
    penalties: Sequence[float] = (1e3, 1e5),
) -> Plan:
    """All combinations on those of ``scenes`` (each with the name that it was loaded by) that are the paper's."""
    known = tuple((source, scene) for source, scene in scenes if source in LAWS)
    cases = tuple(
        (case, case.job(scene))
        for source, scene in known
        for dofs, penalty, n, basis in product(unknowns, penalties, points, bases)
        for case in [Case(basis, source, dofs, n, penalty)]
    )
    problems = tuple(
        ((source, penalty), *references(source, scene, penalty)) for source, scene in known for penalty in penalties
    )
    return Plan(known, cases, problems)


def references(source: str, scene: Scene, penalty: float) -> tuple[Job, Job]:
    """Two fine runs, the finer one last: DOLFINx with cubic elements, or else NURBS on one arm."""
    given = f"interface.penalty={penalty!r}"

    def job(method: str, size: str, *overrides: str) -> Job:
        return Job(source, scene, method, f"figures/{method}-{size}-penalty-{penalty:g}", overrides, fields=False)

    if dolfinx_installed():
        n = scene.dolfinx.elements
        own = cubic(source, scene) if penalty == scene.interface.penalty else None
        coarse, fine = (
            job("dolfinx", f"p3-{m}", given, "dolfinx.degree=3", f"dolfinx.elements={m}") for m in (n, 2 * n)
        )
        return own or coarse, fine
    coarse, fine = (
        job("nurbs", f"one-arm-{dofs}", given, f"discretization.dofs={dofs}", "effects.symmetry=true")
        for dofs in STAND_IN
    )
    return coarse, fine


def cubic(source: str, scene: Scene) -> Job:
    """DOLFINx with cubic elements on the scene's own mesh."""
    return Job(source, scene, "dolfinx", "dolfinx-p3", ("dolfinx.degree=3",))
