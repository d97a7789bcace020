"""Runs of the study: the scene without viscosity, and with increasing viscosities."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from verify.methods.method import Unsuitable
from verify.methods.solve import prepare, require
from verify.runs.jobs import Job, left_out
from verify.scene import toml
from verify.scene.parse import parse_scene
from verify.scene.schema import Scene
from verify.studies.frame import repeated
from verify.support.refusal import Refusal

#: Viscosities, as parts of the duration of the programme.
VISCOSITIES = (1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 1e-1)

#: Every run is repeated this many times for its wall time, alone on the machine.
REPEATS = 2


@dataclass(frozen=True)
class Plan:
    """The run without viscosity, and those with the `VISCOSITIES`."""

    exact: Job
    viscous: tuple[Job, ...]

    @property
    def jobs(self) -> list[Job]:
        """Every run once."""
        return [self.exact, *self.viscous]

    @property
    def timed(self) -> list[Job]:
        """The runs that are repeated for their wall times."""
        return repeated(self.jobs, range(1, REPEATS + 1))


def planned(source: str, scene: Scene, method: str, given: Sequence[str] = ()) -> Plan:
    """The runs of a scene with one method, all with the effects of the viscous one.

    Raises
    ------
    NotRun, Refusal : the scene has no law of sliding, or the method cannot solve it with viscosity.
    """
    if not scene.interface.slides:
        raise Refusal(
            "interface.shear_strength, shear_toughness: must be given, as only a law of sliding has viscosity"
        )
    first = prepare(parse_scene(scene.model_dump(), [_viscosity(VISCOSITIES[0])]), method)
    require(first)
    fixed = tuple(f"effects.{one.key}={toml.value(one.value)}" for one in first.decisions)
    exact = Job(source, scene, method, f"viscosity/{method}", (*given, *fixed, _viscosity(0.0)), fields=False)
    viscous = tuple(
        replace(exact, variant=f"{exact.variant}-{v:g}", overrides=(*exact.overrides[:-1], _viscosity(v)))
        for v in VISCOSITIES
    )
    for job in (exact, viscous[0]):
        if why := left_out(job):
            raise Unsuitable(why)
    return Plan(exact, viscous)


def _viscosity(value: float) -> str:
    return f"interface.viscosity={value:g}"
