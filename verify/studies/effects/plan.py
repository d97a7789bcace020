"""Which runs tell what effects do: the scene as it is, and once for every effect with that one switched."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from verify.methods.solve import prepare
from verify.runs.jobs import Job, left_out
from verify.scene.parse import SceneError, parse_scene
from verify.scene.schema import Scene
from verify.studies.frame import repeated
from verify.support.refusal import Refusal

#: A run is made once for its curve and so many times for its time, alone.
TIMES = 3


@dataclass(frozen=True)
class Switch:
    """One effect: its key in ``[effects]``, what it is called, and its two values."""

    key: str
    name: str
    on: str
    off: str

    def __str__(self) -> str:
        return self.name


SWITCHES = (
    Switch("kinematics", "finite kinematics", "finite", "linear"),
    Switch("contact", "contact", "true", "false"),
    Switch("irreversible", "irreversible damage", "true", "false"),
    Switch("symmetry", "symmetry", "true", "false"),
    Switch("search", "search for the other face", "true", "false"),
)


@dataclass(frozen=True)
class Pair:
    """Two runs that differ by one effect; one of them is the scene as it is."""

    switch: Switch
    with_it: Job
    without: Job


@dataclass(frozen=True)
class Plan:
    """The scene as it is, a pair for every effect that it admits, and a sentence for every other one."""

    base: Job
    pairs: tuple[Pair, ...]
    left_out: tuple[str, ...]

    @property
    def jobs(self) -> list[Job]:
        """Every run once."""
        return list(dict.fromkeys((self.base, *(job for pair in self.pairs for job in (pair.with_it, pair.without)))))

    @property
    def timed(self) -> list[Job]:
        """The runs that are made for their times."""
        return repeated(self.jobs, range(1, TIMES + 1))


def planned(source: str, scene: Scene, method: str, given: Sequence[str] = ()) -> Plan:
    """The runs of a scene by one method; ``given`` are the overrides that all of them have.

    Raises
    ------
    NotRun, Refusal : the method cannot solve the scene as it is.
    """
    base = Job(source, scene, method, f"effects/{method}", tuple(given), fields=False)
    pairs, reasons = [], []
    for switch in SWITCHES:
        try:
            pairs.append(_pair(base, switch))
        except Refusal as error:
            reasons.append(f"{switch}: left out: {error}")
    return Plan(base, tuple(pairs), tuple(reasons))


def _pair(base: Job, switch: Switch) -> Pair:
    """The scene as it is beside the same with one effect switched; Refusal, with the reason, where that cannot be."""
    now = _value(base.scene, base.method, switch)
    other = switch.off if now == switch.on else switch.on
    override = f"effects.{switch.key}={other}"
    try:
        switched = parse_scene(base.scene.model_dump(), [override])
    except SceneError as error:
        raise Refusal("; ".join(error.sentences)) from None
    if _value(switched, base.method, switch) == now:
        raise Refusal(f"{base.method} {'always' if now == switch.on else 'never'} has it")
    job = replace(base, variant=f"{base.variant}-{switch.key}-{other}", overrides=(*base.overrides, override))
    if why := left_out(job):
        raise Refusal(why)
    return Pair(switch, base, job) if now == switch.on else Pair(switch, job, base)


def _value(scene: Scene, method: str, switch: Switch) -> str:
    """What a method makes of the effect, as the scene file would write it."""
    return str(prepare(scene, method).effects[switch.key]).lower()
