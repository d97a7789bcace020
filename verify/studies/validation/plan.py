"""Runs of the study: the scene, coarser meshes, every uncertain number smaller and larger, other places of the load."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

from verify.methods.mesh_choice import size
from verify.methods.method import Prepared
from verify.methods.solve import prepare, require
from verify.runs.jobs import Job, left_out
from verify.scene import toml
from verify.scene.parse import SceneError
from verify.scene.schema import Scene
from verify.scene.stated.uncertainty import number_at, scaled
from verify.studies.validation.statement import LEAST_STEP, Known
from verify.support.refusal import Refusal

#: Ratio of the element lengths of successive meshes: the least that Celik et al. (2008) require, as coarser meshes may
#: not resolve the process zone.
MESH_RATIO = 1.3

#: Places of the load on the end face (`verify.scene.schema.Load`).
LOAD_PLACES = ("face", "node", "hinge")


@dataclass(frozen=True)
class Plan:
    """Every run once.

    meshes : the scene as it is, then coarser meshes; only the scene for a method without a mesh
    inputs : dotted key -> its relative step, and the runs with it smaller and larger
    places : place of the load -> run, that of the scene included; empty where only one place is possible
    known : the uncertainties
    left_out : a sentence for everything that is not in the budget
    """

    meshes: tuple[Job, ...]
    inputs: Mapping[str, tuple[float, Job, Job]]
    places: Mapping[str, Job]
    known: Known
    left_out: tuple[str, ...]

    @property
    def base(self) -> Job:
        return self.meshes[0]

    @property
    def jobs(self) -> list[Job]:
        moved = (job for _, *pair in self.inputs.values() for job in pair)
        return list(dict.fromkeys((*self.meshes, *moved, *self.places.values())))


def planned(source: str, scene: Scene, method: str, given: Sequence[str] = ()) -> Plan:
    """The runs of a scene with one method; ``given`` are overrides that ``scene`` has and that every run repeats.

    Raises
    ------
    NotRun, Refusal : the method cannot solve the scene, or not with an input smaller or larger.
    """
    if max(scene.load.opening) <= 0.0:
        raise Refusal(f"load.opening: must go above 0 for debond validate, got {list(scene.load.opening)}")
    prepared = prepare(scene, method)
    require(prepared)
    base = Job(source, scene, method, f"validation/{method}", (*given, *_held(prepared, given)), fields=False)
    numbers = scene.uncertainty
    places, why = _places(base, prepared.method.has_mesh) if numbers.introduction else ({}, "")
    remarks = [why] if why else []
    meshes = (base, *_coarser(base, prepared))
    if len(meshes) == 1:
        remarks.append(f"mesh: the method {method} has none to refine, so that u_num is taken as 0")
    if not numbers.inputs:
        remarks.append("inputs: [uncertainty] of the scene states none, so that their part of u_input is 0")
    if not any(numbers.data.values()):
        remarks.append("data: [uncertainty] states neither data.load nor data.opening, so that u_D is 0")
    inputs = {key: _moved(base, key, stated) for key, stated in numbers.inputs.items()}
    return Plan(meshes, inputs, places, Known(numbers.inputs, numbers.data), tuple(remarks))


def _held(prepared: Prepared, given: Sequence[str]) -> list[str]:
    """Overrides that keep everything but an input as it is, and choose steps by accuracy unless overrides set them.

    They fix the stiffness of the contact, whose default depends on inputs, and effects that are "auto", which might
    change with an input.
    """
    scene = prepared.scene
    held = [f"interface.penalty={scene.interface.penalty!r}"]
    held += [f"effects.{one.key}={toml.value(one.value)}" for one in prepared.decisions]
    if prepared.method.with_dofs and not any(one.startswith("discretization.steps") for one in given):
        held.append("discretization.steps=auto")
    return held


def _coarser(base: Job, prepared: Prepared) -> list[Job]:
    """Two coarser meshes of the same kind; none for a method without one, or a mesh that is given."""
    if not prepared.method.has_mesh:
        return []
    finest = size(prepared.scene, prepared.method.with_dofs)
    sizes = (finest.times(1.0 / MESH_RATIO), finest.times(1.0 / MESH_RATIO**2))
    return [
        _checked(_varied(base, f"mesh-{n.value:.4g}", n.override), f"{n.key}: must be larger for coarser meshes")
        for n in sizes
    ]


def _moved(base: Job, key: str, stated: float) -> tuple[float, Job, Job]:
    """The relative step of an input, one stated uncertainty, and the runs with it smaller and larger."""
    step, scene = max(stated, LEAST_STEP), base.scene
    value = number_at(scene, key)
    if value is None:
        raise Refusal(f"uncertainty.{key}: must be that of a number of the scene")
    names = {"smaller": 1.0 - step, "larger": 1.0 + step}
    low, high = (
        _checked(_varied(base, f"{key}-{name}", f"{key}={scaled(value, factor)}"), f"uncertainty.{key}")
        for name, factor in names.items()
    )
    return step, low, high


def _places(base: Job, meshed: bool) -> tuple[dict[str, Job], str]:
    """Runs with the load at every place that method and specimen allow, or why there is only one place."""
    one_place = f"load introduction: {base.method} has one place of the load in this scene, which is not in the budget"
    if not meshed:
        return {}, one_place
    found: dict[str, Job] = {base.scene.load.at: base}
    for place in LOAD_PLACES:
        if place not in found:
            with suppress(Refusal):
                found[place] = _checked(_varied(base, f"load-at-{place}", f"load.at={place}"), "load.at")
    return (found, "") if len(found) > 1 else ({}, one_place)


def _varied(base: Job, name: str, override: str) -> Job:
    key = override.partition("=")[0]
    kept = tuple(one for one in base.overrides if one.partition("=")[0].strip() != key)
    return replace(base, variant=f"{base.variant}-{name}", overrides=(*kept, override))


def _checked(job: Job, what: str) -> Job:
    """The job, if it can be run.

    Raises
    ------
    Refusal : beginning with ``what``.
    """
    try:
        why = left_out(job)
    except SceneError as error:
        why = "; ".join(error.sentences)
    if why:
        raise Refusal(f"{what}: {' '.join(why.split())}")
    return job
