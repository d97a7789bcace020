"""What each effect changes and costs: the scene as it is, and for every effect the scene with that one switched."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import ClassVar

from verify.methods.solve import prepare, require
from verify.runs.jobs import Job, left_out
from verify.scene.parse import SceneError, parse_scene
from verify.scene.schema import Scene
from verify.studies import pairs
from verify.studies.pairs import Pair, Plan
from verify.support.refusal import Refusal


@dataclass(frozen=True)
class Switch:
    """One effect: its key in a ``table`` of the scene, its name, its two values, ``of_damage`` as in `Pair`."""

    key: str
    name: str
    on: str
    off: str
    table: str = "effects"
    of_damage: bool = False


SWITCHES = (
    Switch("kinematics", "finite kinematics", "finite", "linear"),
    Switch("contact", "contact", "true", "false"),
    Switch("irreversible", "irreversible damage", "true", "false", of_damage=True),
    Switch("symmetry", "symmetry", "true", "false"),
    Switch("search", "search for the other face", "true", "false"),
)

#: Effects of a bond that slides, with the coefficients that they have where the scene has none.
OF_SLIDING = (
    Switch("shear", "sliding", "true", "false"),
    Switch("friction", "friction", "0.3", "0.0", "interface"),
    Switch("viscosity", "viscosity", "0.01", "0.0", "interface", of_damage=True),
)


@dataclass(frozen=True)
class Study(pairs.Study):
    """A row for each effect: the run with it against that without it."""

    NAME: ClassVar[str] = "effects"

    title = "What each effect does"

    def about(self) -> dict[str, object]:
        return {
            "method": self.method,
            "simulated": prepare(self.scene, self.method).effects,
            "effects": {
                one.key if one.key != "plane" else one.name: asdict(one) | {"sentence": one.sentence}
                for one in self.rows
            },
        }


def planned(source: str, scene: Scene, method: str, given: Sequence[str] = ()) -> Plan:
    """The runs of a scene with one method; ``given`` are overrides that ``scene`` has and that every run repeats.

    Raises
    ------
    NotRun, Refusal : the method cannot solve the scene as it is.
    """
    require(prepare(scene, method))
    base = Job(source, scene, method, f"effects/{method}", tuple(given), fields=False)
    switched, reasons = dict[str, Pair](), []
    for switch in (*switches(scene), *of_width(scene)):
        try:
            switched[switch.name] = _pair(base, switch)
        except Refusal as error:
            reasons.append(f"{switch.name}: left out: {error}")
    if (solid := switched.get("width, solid")) is not None:
        switched[solid.name] = replace(solid, within=switched.get("width"))
    return Plan(base, tuple(switched.values()), tuple(reasons))


def switches(scene: Scene) -> tuple[Switch, ...]:
    """The effects of a scene: those of sliding only where its bond may, with coefficients of its own if it has any."""
    if not scene.interface.slides:
        return SWITCHES
    has = {key: str(value) for key in ("friction", "viscosity") if (value := getattr(scene.interface, key))}
    return (*SWITCHES, *(replace(switch, on=has.get(switch.key, switch.on)) for switch in OF_SLIDING))


def of_width(scene: Scene) -> tuple[Switch, ...]:
    """Plane strain against plane stress, and a solid against what the scene has; of a solid both planes.

    Prescribed displacements deform a solid with at least the energy of plane stress, whose stresses are possible in it,
    and at most with that of plane strain, whose displacements are (complementary and potential energy, Washizu 1975).
    While a crack grows its work is at most that of plane strain. On 21 solids of B/h = 0.3 to 40 its curve was as far
    from plane stress as 0.01 to 0.76 of what the planes are apart, and from plane strain as 0.31 to 1.09 of it. Its
    peak may be lower than both, where the front is curved.
    """
    plane = scene.specimen.plane
    if plane == "solid":
        return tuple(Switch("plane", f"width, {flat}", plane, flat, "specimen") for flat in ("stress", "strain"))
    return Switch("plane", "width", "strain", "stress", "specimen"), Switch(
        "plane", "width, solid", "solid", plane, "specimen"
    )


def _pair(base: Job, switch: Switch) -> Pair:
    """The scene as it is and the scene with one effect switched.

    Raises
    ------
    Refusal : the effect cannot be switched, with the reason.
    """
    now = _value(base.scene, base.method, switch)
    other = switch.off if now == switch.on else switch.on
    override = f"{switch.table}.{switch.key}={other}"
    try:
        switched = parse_scene(base.scene.model_dump(), [override])
    except SceneError as error:
        raise Refusal("; ".join(error.sentences)) from None
    if _value(switched, base.method, switch) == now:
        raise Refusal(f"{base.method} {'always' if now == switch.on else 'never'} has it")
    if switch.table == "interface" and not prepare(switched, base.method).effects["shear"]:
        raise Refusal("nothing slides")
    job = replace(base, variant=f"{base.variant}-{switch.key}-{other}", overrides=(*base.overrides, override))
    if why := left_out(job):
        raise Refusal(why)
    with_it, without = (base, job) if now == switch.on else (job, base)
    return Pair(switch.name, switch.key, switch.on, switch.off, with_it, without, now == switch.on, switch.of_damage)


def _value(scene: Scene, method: str, switch: Switch) -> str:
    """The value of the effect in a method's simulation, as in a scene file."""
    if switch.table != "effects":
        return str(getattr(getattr(scene, switch.table), switch.key))
    return str(prepare(scene, method).effects[switch.key]).lower()
