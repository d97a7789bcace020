"""The record of a method, built in or plug-in, and a scene prepared for a method once per run."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import nan
from typing import Any

from verify.result import Result, Snapshot, steps_from_rows
from verify.scene import effects
from verify.scene.effects import Decision
from verify.scene.laws import PLAIN
from verify.scene.schema import Scene
from verify.support.refusal import Refusal
from verify.support.timing import Stopwatch, peak_memory_mb

OnStep = Callable[[Mapping[str, float]], None]

#: Called with the opening of every converged step and with a function that makes its frame, see `verify.fields.frames`.
OnFrame = Callable[[float, Callable[[], Mapping[str, Any] | None]], None]

#: Elements that a process zone needs at the least (Turon et al. 2007, sec. 2.2: three to five).
ENOUGH = 3


class Unsuitable(Refusal):
    """A method that cannot solve this scene on any machine."""


class Failure(Exception):
    """An error in a solver that is not a fault of debond; ``whose`` names its source."""

    def __init__(self, why: str, whose: str) -> None:
        super().__init__(why)
        self.whose = whose


@dataclass(frozen=True)
class Look:
    """How curves of a method are drawn.

    ``colours`` are those on a light and on a dark page, empty for the colour of the text; ``dashes`` are lengths on and
    off in points, none for a solid line; ``order`` is the drawing order (larger ones on top); ``place`` the position in
    tables and legends.
    """

    colours: tuple[str, str] | None = None
    width: float = 1.3
    dashes: tuple[float, ...] = (6.0, 1.5, 1.2, 1.5)
    alpha: float = 1.0
    order: float = 4.7
    place: int = 100


@dataclass(frozen=True)
class MeshFacts:
    """The mesh of a method as far as warnings and checks need it.

    ``element`` is the length of the longest element on the way of the crack, ``degree`` the lowest in any direction,
    ``layers`` the number of elements through an arm or strip; 0 for graded meshes, which have always resolved the
    thickness. ``across``: functions or nodes across the width of a solid, 1 in a plane.
    """

    element: float
    degree: int
    layers: int
    unknowns: int
    across: int = 1


@dataclass(frozen=True)
class Zone:
    """Estimates of the length of the process zone for slender arms and for the bulk, and the length of the elements
    along the interface, NaN without a mesh; how steeply the traction falls, see `process_zone.steepness`."""

    slender: float
    bulk: float
    element: float
    steepness: float = 1.0

    @property
    def length(self) -> float:
        """Length of the zone, from both estimates; it is shorter than either."""
        from verify.scene.process_zone import between  # imports NumPy

        return between(self.slender, self.bulk)

    @property
    def elements(self) -> float:
        """How many elements resolve the zone."""
        return self.resolving(self.length)

    def resolving(self, length: float) -> float:
        """How many elements resolve a zone of a length: fewer than span it where the traction falls steeply."""
        return length / self.element / float(self.steepness**0.5)

    @property
    def resolved(self) -> bool:
        """Whether enough elements resolve the zone; True without a mesh."""
        return not self.elements < ENOUGH


@dataclass(frozen=True, kw_only=True)
class Method:
    """A solver by its name.

    Parameters
    ----------
    label : its name in tables and legends
    what : what it is, in the words of the report
    solve : solves a prepared scene; methods without fields do not call ``on_frame``
    problem : the scene in the solver's terms, with the simulated effects. ValueError where the solver refuses them
    mesh : facts of the mesh made for a problem; None for a method without one. ValueError where none can be made
    require : raises `Unsuitable` or `NotRun` where the method cannot solve a prepared scene
    counts : why a scene with steps "auto" is solved with a fixed number of steps; empty where the path chooses them by
        accuracy; None for a method that cannot choose steps
    laws : names of the traction laws that it has
    fixed : effects that are fixed by the method, whatever a scene asks for
    modelled : the scene that its results are those of, where a number of it is beyond the method
    code : the program that it belongs to; methods of one program confirm each other less than others do
    packages : packages of the project whose source it runs
    with_dofs : whether ``discretization.dofs`` sets the size of its mesh
    takes_files : the mesh files of a scene that it solves on: "iga" (splines), "nodal" (elements of other programs)
    ranks : whether it runs on several MPI ranks
    lane : runs of one lane are done one after the other, unless it is empty
    is_limit : whether it is a limit that codes approach, and takes part in no comparison
    mesh_error : discretisation error of the load curve of a packaged scene; 0 where it is below the tolerances between
        codes
    equal_arms : whether two arms must be equal, where their bond opens alone
    solids : whether it solves specimens whose plane is "solid"
    place : position among the methods in messages; equal ones are sorted by name
    besides, per_step : seconds of a run without its steps, and seconds per step and thousand unknowns, see
        `verify.runs.estimate`
    """

    name: str
    label: str
    what: str
    solve: Callable[[Prepared, OnStep, OnFrame | None], Result]
    problem: Callable[[Scene, Mapping[str, Any]], Any] = lambda scene, effects: scene
    mesh: Callable[[Prepared], MeshFacts] | None = None
    require: Callable[[Prepared], None] = lambda prepared: None
    counts: Callable[[Prepared], str] | None = None
    laws: Callable[[], Sequence[str]] = lambda: (PLAIN,)
    fixed: Callable[[Scene], Mapping[str, Any]] = lambda scene: {}
    modelled: Callable[[Scene], Scene] = lambda scene: scene
    code: str
    packages: tuple[str, ...] = ()
    with_dofs: bool = False
    takes_files: tuple[str, ...] = ()
    ranks: bool = False
    lane: str = ""
    is_limit: bool = False
    mesh_error: float = 0.0
    equal_arms: bool = False
    solids: bool = False
    place: int = 1000
    besides: float = 2.0
    per_step: float = 0.03
    look: Look = Look()

    @property
    def has_mesh(self) -> bool:
        return self.mesh is not None


@dataclass(frozen=True)
class Prepared:
    """A scene for one method. Run, checks and summary share its parts; each is made once, when it is first needed."""

    scene: Scene
    method: Method
    revised: Callable[[Any], Any] = lambda problem: problem
    """What is solved in place of the problem that the scene states."""

    @cached_property
    def effects(self) -> Mapping[str, Any]:
        """The effects as the method simulates them."""
        return effects.simulated(self.scene, self.method.fixed(self.scene))

    @property
    def decisions(self) -> tuple[Decision, ...]:
        """The choice for every effect that is ``auto`` in the scene and not fixed by the method."""
        return effects.decided(self.scene, self.method.fixed(self.scene))

    @property
    def framed(self) -> bool:
        """Whether the bodies can be drawn in ParaView; solids of DOLFINx cannot."""
        return self.scene.specimen.plane != "solid" or self.method.code == "iga"

    @cached_property
    def counted(self) -> str:
        """Why the number of steps is fixed although the scene has steps "auto" and the method could choose them; else
        empty."""
        asked = self.scene.discretization.steps
        return self.method.counts(self) if self.method.counts is not None and asked == "auto" else ""

    @property
    def by_accuracy(self) -> bool:
        """Whether the path chooses its steps."""
        asked = self.scene.discretization.steps
        return self.method.counts is not None and asked == "auto" and not self.counted

    @cached_property
    def problem(self) -> Any:
        """The scene in the solver's own terms. Raises ValueError where the solver refuses them."""
        return self.revised(self.method.problem(self.scene, self.effects))

    @cached_property
    def mesh(self) -> MeshFacts | None:
        """Facts of the mesh; the solver makes it again in its own time. Raises ValueError where none can be made."""
        return self.method.mesh(self) if self.method.mesh is not None else None

    @cached_property
    def element(self) -> float:
        """Longest element along the bond, NaN for a method without a mesh, or where none can be made."""
        try:
            return nan if self.mesh is None else self.mesh.element
        except ValueError:
            return nan

    @cached_property
    def zone(self) -> Zone:
        """Length of the process zone as estimated before a run, and the length of the elements in it."""
        from verify.scene.process_zone import bulk_length, slender_length, steepness  # imports SciPy

        return Zone(slender_length(self.scene), bulk_length(self.scene), self.element, steepness(self.scene))


def require_beams(prepared: Prepared) -> None:
    """Raise Unsuitable where the model of two beams does not apply: the scene has viscosity, or unequal arms without a
    bond that slides."""
    scene, name = prepared.scene, prepared.method.name
    sizes = set(zip(scene.specimen.thicknesses, scene.materials, strict=False))
    if scene.specimen.slides and not prepared.effects["shear"] and len(sizes) > 1:
        raise Unsuitable(f"effects.shear: must be true for {name}, with arms that differ, got false")
    if prepared.effects["shear"] and scene.interface.viscosity:
        raise Unsuitable(f"interface.viscosity: must be 0 for {name}, got {scene.interface.viscosity:g}")


def result_of(name: str, solution: Any, watch: Stopwatch) -> Result:
    """The result from the solution of a solver: rows and status, and, where the solution has them, rejected_steps,
    snapshots, dofs, elements, ending, condition and nonzeros."""
    names = ("ending", "counted_steps", "condition", "dofs", "elements", "rejected_steps", "nonzeros")
    return Result(
        method=name,
        steps=steps_from_rows(solution.rows),
        status=solution.status,
        snapshots=tuple(
            Snapshot(**(fields if isinstance(fields, Mapping) else vars(fields)))
            for fields in getattr(solution, "snapshots", ())
        ),
        seconds=watch.seconds(),
        peak_memory_mb=peak_memory_mb(),
        jit_seconds=watch.compile,
        **{key: getattr(solution, key) for key in names if hasattr(solution, key)},
    )
