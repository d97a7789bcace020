"""Runs of the study: two codes on three meshes each, and one run for everything else that may change a value."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from verify.checks.proof import REFERENCE, SEARCHING
from verify.methods.mesh_choice import size, spline_mesh
from verify.methods.method import Unsuitable
from verify.methods.reference_mesh import reference_mesh
from verify.methods.second_meshes import through
from verify.methods.solve import prepare, require
from verify.runs.jobs import Job, left_out
from verify.scene.effects import simulated
from verify.scene.parse import SceneError
from verify.scene.schema import Scene
from verify.studies.validation.plan import LOAD_PLACES
from verify.support.programme import only_opens
from verify.support.refusal import Refusal


@dataclass(frozen=True)
class Resolution:
    """How fine the runs are; finer ones cost time and make uncertainties smaller.

    ratio : ratio of the element lengths of successive meshes, at least 1.3 (Celik et al. 2008, J. Fluids Eng. 130,
        078001)
    finer : elements of the finest mesh over those of the scene, as a power of ``ratio``. On the mesh of a scene the
        load oscillates by 1e-3 as the front passes from element to element; this falls faster than any order
    bend : `discretization.bend` of steps whose length the codes choose; a quarter of it halves the steps. 150 equal
        steps would leave errors up to 2e-3 of a load between them, a bend of 1e-3 errors of 1e-4 to 1e-3
    degree : least degree of the DOLFINx elements: the error of one quadratic element through a slender arm is larger
        than the uncertainties here
    parts : parts of the largest opening at which loads are certified by default
    """

    ratio: float = 1.4
    finer: Mapping[str, int] = field(default_factory=lambda: {SEARCHING: 2, REFERENCE: 1})
    bend: float = 2.5e-4
    degree: int = 3
    parts: tuple[float, ...] = (0.25, 0.5, 0.75, 1.0)


RESOLUTION = Resolution()


@dataclass(frozen=True)
class CodeRuns:
    """Runs of one code: three ``meshes``, finest first, and two variants of the finest.

    paced : with steps half as long
    layered : with more elements through the thickness; None where this cannot be run
    """

    meshes: tuple[Job, ...]
    paced: Job
    layered: Job | None


@dataclass(frozen=True)
class Plan:
    """Every run once.

    codes : runs by the name of the method; first the code that follows the surfaces
    matched : the finest mesh of the first code with pairs of points kept; None where the scene itself keeps its pairs,
        or this cannot be run
    places : other place of the load -> run of the first code, on its finest mesh
    at : openings of the certified loads
    left_out : a sentence for everything that is in no budget
    """

    codes: Mapping[str, CodeRuns]
    matched: Job | None
    places: Mapping[str, Job]
    at: tuple[float, ...]
    left_out: tuple[str, ...]

    @property
    def scene(self) -> Scene:
        return self.codes[SEARCHING].meshes[0].scene

    @property
    def jobs(self) -> list[Job]:
        runs = [job for one in self.codes.values() for job in (*one.meshes, one.paced, one.layered) if job]
        return list(dict.fromkeys([*runs, *([self.matched] if self.matched else []), *self.places.values()]))


def planned(source: str, scene: Scene, at: Sequence[float] = (), given: Sequence[str] = ()) -> Plan:
    """The runs of a scene; ``given`` are overrides that ``scene`` has and that every run repeats.

    Raises
    ------
    NotRun, Refusal : one of the codes cannot solve the scene, or its programme turns.
    """
    end = max(scene.load.opening)
    if not only_opens(scene.load.opening) or end <= 0.0:
        raise Refusal(f"load.opening: must only grow from 0 on for debond certify, got {list(scene.load.opening)}")
    if wrong := [one for one in at if not 0.0 < one <= end]:
        raise Refusal(f"--at: must be > 0 and <= {end:g}, the largest opening, got {wrong[0]:g}")
    for method in (SEARCHING, REFERENCE):
        require(prepare(scene, method))
    base = Job(source, scene, "", "certified", (*given, *_chosen(RESOLUTION.bend)), fields=False)
    codes = {SEARCHING: _of_nurbs(base, scene), REFERENCE: _of_dolfinx(base, scene)}
    finest = codes[SEARCHING].meshes[0]
    matched, remarks = _matched(finest, scene)
    remarks += [f"{name}: one layer of elements alone" for name, one in codes.items() if one.layered is None]
    tried = {place: _able(_varied(finest, f"at-{place}", f'load.at="{place}"')) for place in LOAD_PLACES}
    places = {place: job for place, job in tried.items() if job and place != scene.load.at}
    openings = tuple(at) or tuple(part * end for part in RESOLUTION.parts)
    return Plan(codes, matched, places, openings, tuple(remarks))


def _of_nurbs(base: Job, scene: Scene) -> CodeRuns:
    """Meshes by their unknowns, or by the elements in a zone."""
    name, finest = SEARCHING, size(scene, splines=True)
    code = replace(base, method=name)
    sizes = [finest.times(scale) for scale in _scales(name)]
    meshes = tuple(_checked(_varied(code, f"{name}-{n.value:.6g}", n.override)) for n in sizes)
    more = through(meshes[0].solved, spline_mesh(scene).layers + 1)
    paced = _varied(meshes[0], "steps", *_chosen(RESOLUTION.bend / 4.0))
    return CodeRuns(meshes, paced, _able(_varied(meshes[0], "layers", *more)))


def _of_dolfinx(base: Job, scene: Scene) -> CodeRuns:
    """Meshes by their number of elements along the specimen, at least cubic."""
    mesh, name = reference_mesh(scene), REFERENCE
    kept = f"dolfinx.degree={max(mesh.degree, RESOLUTION.degree)}", f"dolfinx.layers={mesh.layers}"
    code = replace(base, method=name, overrides=(*base.overrides, *kept))
    sizes = [size(scene, splines=False).times(scale) for scale in _scales(name)]
    meshes = tuple(_checked(_varied(code, f"{name}-{n.value:.6g}", n.override)) for n in sizes)
    paced = _varied(meshes[0], "steps", *_chosen(RESOLUTION.bend / 4.0))
    return CodeRuns(meshes, paced, _able(_varied(meshes[0], "layers", f"dolfinx.layers={2 * mesh.layers}")))


def _scales(code: str) -> list[float]:
    """Elements of the three meshes over those of the scene, finest first."""
    return [RESOLUTION.ratio ** (RESOLUTION.finer[code] - coarser) for coarser in range(3)]


def _chosen(bend: float) -> tuple[str, str]:
    return "discretization.steps=auto", f"discretization.bend={bend:g}"


def _matched(finest: Job, scene: Scene) -> tuple[Job | None, list[str]]:
    """The run with pairs of points kept, or a sentence where it is missing although DOLFINx, which keeps its pairs,
    solves another model than the scene."""
    if not simulated(scene)["search"]:
        return None, []
    found = _able(_varied(finest, "matched", "effects.search=false"))
    lacking = (
        "matched interface: DOLFINx keeps its pairs of points, and NURBS cannot here: what that changes is not known"
    )
    return found, [] if found else [lacking]


def _varied(job: Job, name: str, *overrides: str) -> Job:
    keys = {one.partition("=")[0] for one in overrides}
    kept = tuple(one for one in job.overrides if one.partition("=")[0].strip() not in keys)
    return replace(job, variant=f"{job.variant}-{name}", overrides=(*kept, *overrides))


def _able(job: Job) -> Job | None:
    """The job; None if it cannot be run."""
    try:
        return None if left_out(job) else job
    except SceneError:
        return None


def _checked(job: Job) -> Job:
    """The job of a mesh.

    Raises
    ------
    Unsuitable : its mesh is too coarse or too fine.
    """
    try:
        why = left_out(job)
    except SceneError as error:
        why = "; ".join(error.sentences)
    if why:
        raise Unsuitable(
            f"{job.overrides[-1].partition('=')[0]}: of the coarsest or finest mesh: {' '.join(why.split())}"
        )
    return job
