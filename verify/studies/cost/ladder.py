"""The meshes of the study: for every basis and degree a sequence with ever more elements in the process zone."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from iga.bases.names import BASES
from verify.methods.mesh_choice import size as size_now
from verify.methods.mesh_choice import spline_mesh
from verify.methods.names import METHODS
from verify.methods.plugins import plugins
from verify.methods.reference_mesh import reference_mesh
from verify.methods.zone_resolution import expected
from verify.runs.jobs import Job, left_out
from verify.scene.parse import parse_scene
from verify.scene.schema import Scene
from verify.support.refusal import NotRun


@dataclass(frozen=True)
class Ladder:
    """Constants of the runs of a family.

    ratio, rungs : ratio of the numbers of elements of successive meshes, and number of meshes
    steps : number of steps of the first runs, enough for the sharp peak of ``peel-120``
    few_steps : for every accuracy settings of the steps that are tried on meshes which may be the cheapest for it; both
        codes choose them. The number after "auto" is the allowed distance from the tangent
    other_steps : numbers of steps that are tried on the best meshes
    more_points : interface points per element beyond the degree, for the ``iga`` methods. They cost little: on
        ``dcb-czm1`` with 500 unknowns 5 points instead of 2 reduce the error of cubic NURBS from 0.43 to 0.17 %, of
        T-splines from 0.20 to 0.13 %, of Lagrange elements from 3.3 to 0.6 %. DOLFINx has three more, and is tried
        with one and with five
    beams : numbers of steps of beams, whose elements follow the process zone by themselves
    """

    ratio: float = 1.4
    rungs: int = 8
    steps: int | str = 80
    few_steps: Mapping[str, tuple[str, ...]] = field(
        default_factory=lambda: {
            "1%": ("auto-0.05", "auto-0.1"),
            "0.3%": ("auto-0.02", "auto-0.05"),
            "0.1%": ("auto", "auto-0.02"),
        }
    )
    other_steps: tuple[int | str, ...] = (40, 150)
    more_points: int = 2
    beams: tuple[int | str, ...] = (80, 40, 150)


LADDER = Ladder()


@dataclass(frozen=True)
class Family:
    """A method with a degree, and its sequence of meshes.

    ``first`` is the number of elements in the process zone on the coarsest mesh.
    """

    method: str  # name in the tables
    solver: str  # name for ``debond solve``
    degree: int
    first: float

    @property
    def adaptive(self) -> bool:
        """Whether the meshes follow the process zone."""
        return self.solver in BASES and self.method != self.solver

    @property
    def by_elements(self) -> bool:
        """Whether the table ``dolfinx`` sets the mesh."""
        return self.solver not in BASES

    @property
    def beam(self) -> bool:
        """Whether it has no mesh to choose, and an error of its theory."""
        return self.method in BEAM_ORDERS

    @property
    def name(self) -> str:
        return f"{self.method}-p{self.degree}" if self.degree and not self.adaptive else self.method


#: Method of a table -> order of the beam through the thickness.
BEAM_ORDERS = {"beam": 1, "beam-3": 3}
#: Steps as a scene has them.
OF_SCENE = "default"
#: Method of a table -> that of ``debond solve``: those of the bases, and those whose meshes follow the process zone.
BASIS_METHODS = {
    method: name for name, basis in BASES.items() for method in ((name, f"{name}-adaptive") if basis.local else (name,))
}
FAMILIES = (
    *(Family(method, name, *rung) for method, name in BASIS_METHODS.items() for rung in BASES[name].coarsest.items()),
    *(Family("dolfinx", "dolfinx", p, first) for p, first in ((1, 4.0), (2, 1.0), (3, 0.7), (4, 0.5))),
)
BEAM_FAMILIES = tuple(Family(name, "beam", 0, 0.0) for name in BEAM_ORDERS)


def of_plugins() -> Iterator[Family]:
    """A family for every degree in the attribute ``degrees`` of a plug-in: degree -> elements in the process zone on
    the coarsest mesh."""
    for name, plugin in plugins().items():
        try:
            degrees = getattr(plugin.load(), "degrees", {})
        except NotRun:
            continue
        yield from (Family(name, name, degree, first) for degree, first in degrees.items())


#: Other models of DOLFINx on a mesh: key of the table ``dolfinx``, and how much is added to what is chosen by default.
OTHER_MODELS = {
    "fewer-points": ("interface_points", -2),
    "more-points": ("interface_points", 2),
    "more-layers": ("layers", 1),
}


@dataclass(frozen=True)
class Try:
    """One run of the study: a mesh of a family, a setting of the steps, the number of the repetition.

    ``model`` is a key of `OTHER_MODELS`, or empty.
    """

    family: Family
    rung: int
    size: float  # unknowns, elements along the specimen or in a zone, as the scene sets its mesh
    steps: int | str
    repeat: int = 0
    model: str = ""

    @property
    def variant(self) -> str:
        size, model = (f"-{part}" if part else "" for part in (self.size and f"{self.size:.6g}", self.model))
        again = f"-again-{self.repeat}" if self.repeat else ""
        return f"cost/{self.family.name}{size}-{self.steps}-steps{model}{again}"

    def job(self, source: str, scene: Scene, given: Sequence[str] = ()) -> Job:
        """The job; ``given`` are the overrides of the whole study."""
        own = (*_overrides(self.family, scene, self.size, self.steps), *self._of_model(scene))
        return Job(source, scene, self.family.solver, self.variant, (*given, *own), repeat=self.repeat)

    def with_few_steps(self, level: str) -> Iterator[Try]:
        """The same mesh with the few steps that are tried for an accuracy."""
        if not self.family.beam and self.family.solver in METHODS:  # a plug-in takes a number of steps only
            yield from (replace(self, steps=few) for few in LADDER.few_steps[level])

    def with_other_steps(self, among: Sequence[int | str] | None = None) -> Iterator[Try]:
        """The same mesh with other settings of the steps."""
        if not self.family.beam:
            yield from (replace(self, steps=steps) for steps in among or LADDER.other_steps)

    def with_other_models(self) -> Iterator[Try]:
        """The same mesh of DOLFINx with other numbers of points on the bond and of layers."""
        if self.family.solver == "dolfinx":
            yield from (replace(self, model=model) for model in OTHER_MODELS)

    def _of_model(self, scene: Scene) -> tuple[str, ...]:
        if not self.model:
            return ()
        key, more = OTHER_MODELS[self.model]
        mesh = parse_scene(scene.model_dump(), _overrides(self.family, scene, self.size, self.steps))
        now = {"interface_points": self.family.degree + 3, "layers": reference_mesh(mesh).layers}[key]
        return (f"dolfinx.{key}={now + more}",)


def ladder(scene: Scene, family: Family, plan: Ladder | None = None) -> list[Try]:
    """The meshes of a family on a scene by a plan, coarse to fine; empty where no mesh is possible."""
    plan = plan or LADDER
    if family.beam:
        return [Try(family, rung, 0, steps) for rung, steps in enumerate(plan.beams)]
    each = size_of_an_element(scene, family)
    sizes = each * family.first * plan.ratio ** np.arange(plan.rungs) if np.isfinite(each) else np.zeros(0)
    whole = sizes if each == 1.0 else np.unique(np.rint(sizes))
    return [Try(family, rung, float(size), plan.steps) for rung, size in enumerate(whole)]


def ladders(
    source: str,
    scene: Scene,
    given: Sequence[str],
    families: Sequence[Family] | None = None,
    plan: Ladder | None = None,
) -> tuple[dict[Family, list[Try]], list[str]]:
    """The meshes of every family with at least one, and a sentence for every method that cannot solve the scene.

    Parameters
    ----------
    given : overrides of the whole study
    families, plan : default: all, by `LADDER`
    """
    found: dict[Family, list[Try]] = {}
    reasons: dict[str, str] = {}
    for family in families or (*FAMILIES, *of_plugins(), *BEAM_FAMILIES):
        if family.adaptive and not scene.specimen.symmetric:
            reasons.setdefault(family.method, "left out: only the mesh of a dcb follows the process zone")
            continue
        rungs = {one: left_out(one.job(source, scene, given)) for one in ladder(scene, family, plan)}
        possible = [one for one, why in rungs.items() if not why]
        if possible:
            found[family] = possible
        else:
            reasons.setdefault(family.method, next(iter(rungs.values()), "not run: no mesh is possible"))
    known = {family.method for family in found}
    return found, [f"{method}: {why}" for method, why in reasons.items() if method not in known]


def _overrides(family: Family, scene: Scene, size: float, steps: int | str) -> tuple[str, ...]:
    """Overrides of a mesh. With equal arms ``iga`` has fixed pairs of points like DOLFINx, so that models are equal."""
    asked, _, bend = str(steps).partition("-")
    paced = (f"discretization.steps={asked}", *((f"discretization.bend={bend}",) if bend else ()))
    if family.beam:
        order = BEAM_ORDERS[family.method]
        return (*(() if steps == OF_SCENE else paced), *((f"beam.order={order}",) if order > 1 else ()))
    along = replace(size_now(scene, not family.by_elements), value=size)
    if family.by_elements:
        return (*paced, f"dolfinx.degree={family.degree}", along.override)
    points = max(family.degree + LADDER.more_points, spline_mesh(scene).points)
    return (
        *paced,
        *(("effects.search=auto",) if scene.effects.search is True else ()),
        f"discretization.degree={family.degree}",
        along.override,
        f"discretization.interface_points={points}",
        *(("discretization.adaptive=true",) if family.adaptive else ()),
    )


def size_of_an_element(scene: Scene, family: Family) -> float:
    """Unknowns, or elements along the specimen, per element in the process zone; NaN without a mesh.

    Both are proportional. For an adaptive mesh it is the number of the corresponding fixed mesh.
    """
    now = size_now(scene, not family.by_elements)
    if now.key.endswith("in_a_zone"):
        return 1.0
    plain = replace(family, method=family.solver)
    given = parse_scene(scene.model_dump(), _overrides(plain, scene, now.value, LADDER.steps))
    return now.value / expected(given, "dolfinx" if family.by_elements else family.solver).elements
