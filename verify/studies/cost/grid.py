"""The grid of the study: for every basis and degree meshes with ever more elements in the process zone, times settings
of the steps, and what is a neighbour of a run in it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from iga.bases.names import BASES
from verify.methods.mesh_choice import size as size_now
from verify.methods.mesh_choice import spline_mesh
from verify.methods.names import METHODS
from verify.methods.plugins import loaded
from verify.methods.reference_mesh import reference_mesh
from verify.methods.zone_resolution import expected
from verify.runs.jobs import Job
from verify.scene.parse import parse_scene
from verify.scene.schema import Scene


@dataclass(frozen=True)
class Grid:
    """Constants of the meshes and steps of a family.

    ratio, meshes : ratio of the elements in a process zone of successive meshes, whose root is that of neighbours, and
        number of meshes, without those between
    equal : number of steps of the first runs, enough for the sharp peak of ``peel-120``
    steps : settings of the steps, from many to few. Both codes choose those that begin with "auto"; the number after it
        is the allowed distance from the tangent
    leaves : least error that this distance leaves, as a part of it
    more_points : interface points per element beyond the degree, for the ``iga`` methods. They cost little: on
        ``dcb-czm1`` with 500 unknowns 5 points instead of 2 reduce the error of cubic NURBS from 0.43 to 0.17 %, of
        T-splines from 0.20 to 0.13 %, of Lagrange elements from 3.3 to 0.6 %. DOLFINx has three more, and is tried
        with one and with five
    """

    ratio: float = 1.4
    meshes: int = 8
    equal: int = 80
    steps: tuple[int | str, ...] = (80, 40, "auto", "auto-0.02", "auto-0.05", "auto-0.1")
    leaves: float = 0.05
    more_points: int = 2


GRID = Grid()


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


def of_plugins(peers: Sequence[str] = ()) -> Iterator[Family]:
    """A family for every degree in the attribute ``degrees`` of a plug-in, or of a peer that is named: degree ->
    elements in the process zone on the coarsest mesh."""
    for name, solver in loaded(peers):
        degrees = getattr(solver, "degrees", {})
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
        own = _overrides(self.family, scene, self.size, self.steps)
        if self.model:
            key, more = OTHER_MODELS[self.model]
            layers = reference_mesh(parse_scene(scene.model_dump(), own)).layers
            own += (f"dolfinx.{key}={more + (self.family.degree + 3 if key == 'interface_points' else layers)}",)
        return Job(source, scene, self.family.solver, self.variant, (*given, *own), repeat=self.repeat)


@dataclass(frozen=True)
class Meshes:
    """The meshes of a family by their sizes, coarse to fine; every other one lies between two meshes."""

    family: Family
    sizes: tuple[float, ...]

    def other(self, one: Try, more: int) -> list[Try]:
        """The run on the mesh that is so many places finer, or coarser; empty beyond the ends."""
        at = self.sizes.index(one.size) + more
        return [replace(one, size=self.sizes[at])] if 0 <= at < len(self.sizes) else []

    @property
    def settings(self) -> tuple[int | str, ...]:
        """Of the steps, many to few; a plug-in takes a number only."""
        return tuple(steps for steps in GRID.steps if self.family.solver in METHODS or isinstance(steps, int))

    def more_steps(self, one: Try) -> list[Try]:
        """The run with the next more steps."""
        at = self.settings.index(one.steps)
        return [replace(one, steps=steps) for steps in self.settings[max(at - 1, 0) : at]]

    def few_steps(self, one: Try, error: float) -> list[Try]:
        """The run with the two settings of fewest steps that may reach an error."""
        return [replace(one, steps=steps) for steps in self.settings if may_reach(steps, error)][-2:]

    def other_models(self, one: Try) -> list[Try]:
        """Of DOLFINx: fewer points, or more points and layers on the next coarser mesh."""
        if one.family.solver != "dolfinx" or one.model:
            return []
        coarser = [
            replace(mesh, model=model) for mesh in self.other(one, -1) for model in ("more-points", "more-layers")
        ]
        return [replace(one, model="fewer-points"), *coarser]


def may_reach(steps: int | str, error: float) -> bool:
    """Whether steps that are chosen leave no more than an error; any number of them may."""
    return GRID.leaves * float(str(steps).partition("-")[2] or 0.0) <= error


def meshes(scene: Scene, family: Family) -> Meshes:
    """The meshes of a family on a scene; none where no mesh is possible."""
    if family.beam:
        return Meshes(family, (0.0,))
    each = size_of_an_element(scene, family)
    finer = GRID.ratio ** (0.5 * np.arange(2 * GRID.meshes - 1))
    sizes = each * family.first * finer if np.isfinite(each) else np.zeros(0)
    whole = sizes if each == 1.0 else np.unique(np.rint(sizes))
    return Meshes(family, tuple(map(float, whole)))


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
    points = max(family.degree + GRID.more_points, spline_mesh(scene).points)
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
    given = parse_scene(scene.model_dump(), _overrides(plain, scene, now.value, GRID.equal))
    return now.value / expected(given, "dolfinx" if family.by_elements else family.solver).elements
