"""The converged curve with which every run is compared, its uncertainty, and the distance of another code."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import nan

import numpy as np

from verify.curves.convergence import mesh_error
from verify.curves.of_run import cubics, dissipated, distance, peak_load
from verify.methods.dolfinx import dolfinx_installed
from verify.methods.reference_mesh import reference_mesh
from verify.result import Result
from verify.runs.jobs import Job, Outcome
from verify.scene.schema import Scene
from verify.studies.cost.grid import Family, Try, size_of_an_element
from verify.studies.cost.plan import WHOLE_STUDY, Plan
from verify.studies.frame import failures

NO_OTHER_CODE = "No other code was at hand to hold it against."


@dataclass(frozen=True, eq=False)
class Reference:
    """The result on the finest of its meshes.

    uncertainty : relative, of curve, peak load and dissipated energy, by `verify.curves.convergence.mesh_error`; the
        values of the curve are 1 plus the distances from the finest
    order : observed order of the curve, NaN where the meshes are not in the asymptotic range
    apart : relative L2 distance of the other code's finest curve, NaN without another code
    other : uncertainty of that curve
    faults : a sentence for every run of the other code that was made and gives no number
    """

    label: str
    result: Result
    uncertainty: Mapping[str, float]
    order: float
    other_label: str = ""
    apart: float = nan
    other: float = nan
    faults: tuple[str, ...] = ()

    @property
    def agrees(self) -> bool:
        """Whether the other code is within the two uncertainties."""
        return self.apart <= self.uncertainty["curve"] + self.other

    @property
    def sentence(self) -> str:
        """The reference and its uncertainty in words."""
        sure = ", ".join(f"{name} {value:.3%}" for name, value in self.uncertainty.items())
        order = f"observed order {self.order:.1f}" if np.isfinite(self.order) else "no order observed"
        text = f"Reference: {self.label}, {self.result.dofs} unknowns; uncertainty (GCI): {sure}; {order}."
        if not np.isfinite(self.apart):
            why = f"The other code gives no number: {'; '.join(self.faults)}." if self.faults else NO_OTHER_CODE
            return f"{text} {why}"
        within = "within" if self.agrees else "not within"
        return (
            f"{text} {self.other_label} is {self.apart:.3%} away, {within} the two uncertainties "
            f"({self.uncertainty['curve']:.3%} and {self.other:.3%})."
        )

    def summary(self) -> dict[str, object]:
        """The entry ``reference`` of ``cost.json``."""
        own = {key: getattr(self, key) for key in ("sentence", "label", "uncertainty", "order", "agrees")}
        other = {f"other_code{key}": value for key, value in (
            ("", self.other_label), ("_apart", self.apart), ("_uncertainty", self.other), ("_faults", list(self.faults))
        )}  # fmt: skip
        return own | other | {"dofs": self.result.dofs}


def reference_jobs(
    source: str, scene: Scene, given: Sequence[str], plan: Plan = WHOLE_STUDY
) -> tuple[tuple[Job, ...], tuple[Job, ...]]:
    """Runs of the reference, coarse to fine, and of the other code; the latter empty without DOLFINx."""
    one_arm = scene.specimen.symmetric and scene.discretization.mismatch == 1.0
    halved = ("effects.symmetry=true",) if one_arm else ()

    def jobs(method: str, degree: int, zone: Sequence[float], *more: str) -> tuple[Job, ...]:
        family = Family(method, method, degree, 0.0)
        each = size_of_an_element(scene, family)
        tries = (Try(family, int(round(each * elements)), plan.reference_steps) for elements in zone)
        found = (one.job(source, scene, (*given, *more)) for one in tries)
        return tuple(replace(job, variant=job.variant.replace("cost/", "reference/")) for job in found)

    other = jobs("dolfinx", plan.other_degree, plan.other_zone if dolfinx_installed() else ())
    return jobs("nurbs", 3, plan.zone, *halved), other


def reference(own: Sequence[Outcome], other: Sequence[Outcome]) -> Reference | None:
    """The reference of these runs, coarse to fine; None where one of ``own`` is not complete."""
    results, second = _complete(own), _complete(other)
    if not results:
        return None
    finest, h = results[-1], [1.0 / result.elements for result in results]
    values = {
        "curve": [1.0 + distance(cubics(result), finest) for result in results[:-1]] + [1.0],
        "peak": [peak_load(result) for result in results],
        "energy": [dissipated(result) for result in results],
    }
    found = {name: mesh_error(h, known) for name, known in values.items()}
    sure = {name: found[name].index / abs(known[-1]) for name, known in values.items()}
    order = found["curve"].order
    label = "cubic NURBS" + (", one arm" if finest.method == "nurbs" and "symmetry" in str(own[-1].job) else "")
    if not second:
        done = [outcome for outcome in other if outcome.result is not None or outcome.failed]
        return Reference(label, finest, sure, order, faults=failures(done))
    coarse, fine = second[0], second[-1]
    other_label = f"DOLFINx of degree {reference_mesh(other[-1].job.solved).degree} with {fine.dofs} unknowns"
    apart, unsure = distance(cubics(fine), finest), distance(cubics(coarse), fine)
    return Reference(label, finest, sure, order, other_label, apart, unsure)


def _complete(outcomes: Sequence[Outcome]) -> list[Result]:
    """The results if every run gives a number, else empty."""
    return [] if failures(outcomes) else [outcome.result for outcome in outcomes if outcome.result is not None]
