"""Figure 9: a strip peeled off a substrate with four lengths of the bond, by three bases with equal unknowns.

The runs of the bases are those that `debond verify` makes of these scenes anyway.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import nan

import numpy as np

from verify.checks.mechanics.j_integral import j_deviation
from verify.checks.mechanics.peel_growth import growing, growth_angle
from verify.curves.curve import PROPAGATION, Curve, load_at, peak
from verify.methods import zone_resolution
from verify.methods.dolfinx import dolfinx_installed
from verify.methods.names import WITH_DOFS
from verify.methods.reference_mesh import reference_mesh
from verify.result import Result
from verify.runs.jobs import Job, Outcome
from verify.scene.load import load_scene
from verify.scene.schema import Scene
from verify.studies.paper.study import Trial, Trials, left_out, limit, reference, trial

#: Packaged scenes, the shortest bond first.
BONDS = ("peel-60", "peel-80", "peel-100", "peel-120")

#: The scene with the moduli as they are printed.
PRINTED = "peel-as-printed"

#: Unknowns of the NURBS meshes that stand in where DOLFINx is missing, over those of the scene.
STAND_IN = (2, 3)

REFERENCES = {"dolfinx": "quadratic DOLFINx elements", "nurbs": "NURBS"}


@dataclass(frozen=True)
class PeelCase:
    """One run of the figure; ``bond`` is the name of its packaged scene."""

    basis: str
    bond: str

    @property
    def problem(self) -> str:
        """What it solves, however well."""
        return self.bond

    def job(self, scene: Scene) -> Job:
        """The run of the basis that every verification of the scene has."""
        return Job(self.bond, scene, self.basis, self.basis)


@dataclass(frozen=True)
class PeelPlan:
    """Jobs of all cases, and for every bond those of two fine meshes, the coarser first."""

    scenes: tuple[tuple[str, Scene], ...]
    cases: tuple[tuple[PeelCase, Job], ...]
    references: tuple[tuple[str, Job, Job], ...]

    @property
    def jobs(self) -> Iterator[Job]:
        yield from (job for _, *pair in self.references for job in pair)
        yield from (job for _, job in self.cases)


@dataclass(frozen=True, eq=False)
class PeelStudy(Trials):
    """The runs of Figure 9.

    zones : elements that span the process zone, as it was measured, by basis and bond
    printed : and as it is expected with the printed moduli, by basis
    """

    zones: Mapping[tuple[str, str], float]
    printed: Mapping[str, float]

    @property
    def left_out(self) -> str:
        """Why there is nothing in it, where there is nothing."""
        return left_out(self, BONDS)

    def length(self, bond: str) -> float:
        return self.scenes[bond].specimen.bond_length


def planned(scenes: Sequence[tuple[str, Scene]], bases: Sequence[str] = WITH_DOFS) -> PeelPlan:
    """Those of ``scenes`` (each with the name that it was loaded by) that are the paper's, by all bases."""
    given = dict(scenes)
    known = tuple((bond, given[bond]) for bond in BONDS if bond in given)
    cases = tuple((case, case.job(scene)) for bond, scene in known for case in (PeelCase(b, bond) for b in bases))
    return PeelPlan(known, cases, tuple((bond, *references(bond, scene)) for bond, scene in known))


def references(bond: str, scene: Scene) -> tuple[Job, Job]:
    """DOLFINx as the scene has it and with elements of half the length, or else NURBS with more unknowns."""
    if dolfinx_installed():
        n, variant = 2 * scene.dolfinx.elements, "figures/dolfinx-p{}-{}"
        fine = variant.format(reference_mesh(scene).degree, n)
        finer = Job(bond, scene, "dolfinx", fine, (f"dolfinx.elements={n}",), fields=False)
        return Job(bond, scene, "dolfinx", "dolfinx"), finer
    sizes = (times * scene.discretization.dofs for times in STAND_IN)
    coarse, fine = (
        Job(bond, scene, "nurbs", f"figures/nurbs-{dofs}", (f"discretization.dofs={dofs}",), fields=False)
        for dofs in sizes
    )
    return coarse, fine


def measured(plan: PeelPlan, outcomes: Mapping[Job, Outcome]) -> PeelStudy:
    """The study of a plan whose jobs are done."""
    scenes = dict(plan.scenes)
    found = {bond: reference(outcomes[coarse], outcomes[fine], REFERENCES) for bond, coarse, fine in plan.references}
    known = {bond: one for bond, one in found.items() if one is not None}
    trials = tuple(trial(case, outcomes[job], known.get(case.bond)) for case, job in plan.cases)
    zones = {(t.case.basis, t.case.bond): zone(scenes[t.case.bond], t) for t in trials}
    bases = dict.fromkeys(case.basis for case, _ in plan.cases)
    printed = {basis: zone_resolution.expected(load_scene(PRINTED), basis).elements for basis in bases}
    return PeelStudy(scenes, trials, known, {bond: limit(scene) for bond, scene in scenes.items()}, zones, printed)


def zone(scene: Scene, found: Trial) -> float:
    """Elements in the process zone as the run has it; NaN without one."""
    if not found.complete:
        return nan
    return zone_resolution.measured(found.result) / zone_resolution.element_length(scene, found.case.basis)


def branch_distance(one: Curve, other: Curve) -> float:
    """Relative L2 distance of two curves where both are on their propagation branch; NaN where that is nowhere."""
    begin = PROPAGATION * max(peak(one)[0], peak(other)[0])
    end = min(float(np.max(one[0])), float(np.max(other[0])))
    if not end > begin:
        return nan
    grid = np.linspace(begin, end, 401)[:-1]
    wanted = load_at(other, grid)
    return float(np.sqrt(np.sum((load_at(one, grid) - wanted) ** 2) / np.sum(wanted**2)))


def identities(scene: Scene, result: Result) -> dict[str, float]:
    """While the crack grows: deviation of J, the least load over G_Ic w, and load sin(theta) over it in the end."""
    j, angle, steady = j_deviation(scene, result.steps), growth_angle(scene, result.steps), growing(scene, result.steps)
    least = float(np.min(result.load[steady])) if steady.any() else nan
    return {
        "j": nan if j is None else j,
        "load": least / (scene.interface.toughness * scene.specimen.width),
        "angle": nan if angle is None else 1.0 + angle,
    }


def runs(study: PeelStudy) -> Iterator[tuple[str, str, Result]]:
    """Name, bond and result of every complete run, the converged ones last."""
    for t in study.trials:
        if t.complete:
            yield t.case.basis, t.case.bond, t.result
    for bond, known in study.references.items():
        yield "converged", bond, known.result
