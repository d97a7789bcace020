"""The converged curve with which every run is compared, its uncertainty, and the distance of another code."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import nan

import numpy as np

from verify.curves.convergence import GCI_SAFETY, assess
from verify.curves.of_run import cubics, dissipated, distance, peak_load
from verify.methods.dolfinx import dolfinx_installed
from verify.methods.reference_mesh import reference_mesh
from verify.result import Result
from verify.runs.jobs import Job, Outcome
from verify.scene.schema import Scene
from verify.studies.cost.ladder import Family, Try, size_of_an_element
from verify.studies.frame import failures


@dataclass(frozen=True)
class Meshes:
    """Meshes of the reference.

    zone, other_zone : elements in the process zone, of the reference and of the other code, which may have none; both
        have degree 3
    steps : setting of the steps
    caution : factor on the distance of the two finest meshes where no order is observed (Roache 1994)
    """

    zone: tuple[float, ...] = (4.0, 8.0, 16.0)
    other_zone: tuple[float, ...] = (2.5, 5.0)
    steps: int | str = 200
    caution: float = 3.0


MESHES = Meshes()

NO_OTHER_CODE = "No other code was at hand to hold it against."


@dataclass(frozen=True, eq=False)
class Reference:
    """The result on the finest of its meshes.

    uncertainty : relative, of curve, peak load and dissipated energy: grid convergence index of the meshes
    order : observed order of the curve, NaN if none is observed
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
        return {
            "sentence": self.sentence,
            "label": self.label,
            "dofs": self.result.dofs,
            "uncertainty": dict(self.uncertainty),
            "order": self.order,
            "other_code": self.other_label,
            "other_code_apart": self.apart,
            "other_code_uncertainty": self.other,
            "agrees": self.agrees,
            "other_code_faults": list(self.faults),
        }


def reference_jobs(
    source: str, scene: Scene, given: Sequence[str], meshes: Meshes | None = None
) -> tuple[tuple[Job, ...], tuple[Job, ...]]:
    """Runs of the reference, coarse to fine, and of the other code; the latter empty without DOLFINx."""
    meshes = meshes or MESHES
    one_arm = scene.specimen.symmetric and scene.discretization.mismatch == 1.0
    halved = ("effects.symmetry=true",) if one_arm else ()
    zone = meshes.other_zone if dolfinx_installed() else ()
    own = _jobs("nurbs", meshes.zone, meshes.steps, source, scene, (*given, *halved))
    return own, _jobs("dolfinx", zone, meshes.steps, source, scene, given)


def _jobs(
    method: str, zone: Sequence[float], steps: int | str, source: str, scene: Scene, given: Sequence[str]
) -> tuple[Job, ...]:
    family = Family(method, method, 3, 0.0)
    each = size_of_an_element(scene, family)
    tries = (Try(family, i, int(round(each * elements)), steps) for i, elements in enumerate(zone))
    jobs = (one.job(source, scene, given) for one in tries)
    return tuple(replace(job, variant=job.variant.replace("cost/", "reference/")) for job in jobs)


def reference(own: Sequence[Outcome], other: Sequence[Outcome]) -> Reference | None:
    """The reference of these runs, coarse to fine; None where one of ``own`` is not complete."""
    results, second = _complete(own), _complete(other)
    if not results:
        return None
    finest, h = results[-1], [1.0 / result.elements for result in results]
    order, index = _of_distances(h, [distance(cubics(result), finest) for result in results[:-1]])
    values = {"peak": [peak_load(r) for r in results], "energy": [dissipated(r) for r in results]}
    sure = {"curve": index} | {name: _index(h, found) for name, found in values.items()}
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


def _of_distances(h: Sequence[float], apart: Sequence[float]) -> tuple[float, float]:
    """Order and grid convergence index from the distances of two coarser meshes to the finest one.

    With errors e = C h^p of one shape the distances are e(h) - e(h_1), and their ratio determines p. From one distance
    alone no order follows.
    """
    if len(apart) < 2:
        return nan, MESHES.caution * apart[-1]
    orders = np.linspace(0.5, 8.0, 751)
    ratio = (h[0] ** orders - h[2] ** orders) / (h[1] ** orders - h[2] ** orders)
    wanted = apart[0] / apart[1] if apart[1] > 0.0 else np.inf
    if not ratio[0] <= wanted <= ratio[-1]:
        return nan, MESHES.caution * apart[1]
    p = float(np.interp(wanted, ratio, orders))
    return p, GCI_SAFETY * apart[1] / ((h[1] / h[2]) ** p - 1.0)


def _index(h: Sequence[float], values: Sequence[float]) -> float:
    """Grid convergence index of one number."""
    found = assess(h, values) if len(values) > 2 else None
    if found is not None and np.isfinite(found.gci) and found.asymptotic:
        return found.gci
    return MESHES.caution * max(abs(values[-1] - value) for value in values[:-1]) / abs(values[-1])
