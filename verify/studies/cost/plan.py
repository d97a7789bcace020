"""What is searched: accuracies, families, and the limits of the search."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from verify.studies.cost.grid import BEAM_FAMILIES, FAMILIES, GRID, OF_SCENE, Family, of_plugins
from verify.scene.schema import Scene

#: Accuracies for which the cheapest runs are found: curve errors by their text.
LEVELS: Mapping[str, float] = {"1%": 0.01, "0.3%": 0.003, "0.1%": 0.001}


@dataclass(frozen=True)
class Plan:
    """What is searched, and when the search is over; larger values cost time and find cheaper runs more reliably.

    aims : accuracies, keys of `LEVELS`
    families : default: all, those of plug-ins included
    peers : codes of others that take part
    steps : setting of the steps with which meshes are refined
    models : whether other models of DOLFINx are tried
    beams : numbers of steps of beams, whose elements follow the process zone by themselves
    zone, other_zone : elements in the process zone of the meshes of the reference, and of those of the other code,
        which may have none
    other_degree : degree of those of the other code; the reference itself has 3
    reference_steps : setting of the steps of the reference
    behind, patience, longest : no run is made from one that would take more than ``behind`` times as long as the
        cheapest of its method, ``patience`` times as long as the cheapest of all with a mesh (of a plug-in however
        long), or ``longest`` seconds
    pace : it would take its own time, times its error over the accuracy to this power: the error falls about as the
        third power of the unknowns, and time grows more slowly than they do
    near : from a run that misses an accuracy neighbours are tried where its error is at most ``near`` times that
    close, late, turns : what takes at most ``close`` times as long as the cheapest of its method for an accuracy, plus
        ``late`` seconds, is timed ``turns`` times more. On a busy machine single times are off by half: 0.36 to 0.63 s
        were measured for equal runs
    together : whether runs that come before these turns are done several at a time: their times are then less sure
    seconds : time after which no run is begun; a second call continues from the stored runs
    """

    aims: tuple[str, ...] = tuple(LEVELS)
    families: tuple[Family, ...] = ()
    peers: tuple[str, ...] = ()
    steps: int | str = GRID.equal
    models: bool = True
    beams: tuple[int | str, ...] = (80,)
    zone: tuple[float, ...] = (4.0, 8.0, 16.0)
    other_zone: tuple[float, ...] = (2.5, 5.0)
    other_degree: int = 3
    reference_steps: int | str = 200
    behind: float = 1.25
    patience: float = 5.0
    longest: float = 30.0
    pace: float = 0.25
    near: float = 1.25
    close: float = 1.1
    late: float = 0.02
    turns: int = 2
    together: bool = False
    seconds: float = 2000.0

    def of_families(self) -> tuple[Family, ...]:
        """The families, those of the beam last."""
        return (*(self.families or (*FAMILIES, *of_plugins(self.peers))), *BEAM_FAMILIES)


#: Of ``debond cost``.
WHOLE_STUDY = Plan()

#: Of a solid, of which a run takes minutes: the degrees that its two codes are used with. DOLFINx goes on to finer
#: meshes however long it takes beside NURBS, as that ratio is what is asked for.
OF_A_SOLID = Plan(
    aims=("1%", "0.3%"),
    families=(
        Family("nurbs", "nurbs", 2, 1.4),
        Family("nurbs", "nurbs", 3, 1.4),
        Family("dolfinx", "dolfinx", 2, 1.4),
    ),
    models=False,
    beams=(),
    zone=(3.0, 6.0, 12.0),
    other_degree=2,
    reference_steps=150,
    patience=100.0,
    longest=600.0,
    turns=1,
    seconds=5400.0,
)

def plan_of(scene: Scene, peers: tuple[str, ...] = ()) -> Plan:
    """The plan of ``debond cost`` on a scene, with codes of others."""
    if scene.specimen.plane == "solid":
        return replace(OF_A_SOLID, families=(*OF_A_SOLID.families, *of_plugins(peers)))
    return replace(WHOLE_STUDY, peers=peers)


#: Of a verification: of every method the degree that reaches 0.3 % first on ``dcb-czm1``; higher ones of DOLFINx would
#: be compiled first. A reference of steps "auto-0.002" is 0.02 % off there, and its uncertainty is 0.02 %. Beams are
#: those that the verification has run.
QUICK = Plan(
    aims=("0.3%",),
    families=(
        Family("nurbs", "nurbs", 2, 2.25),
        Family("tspline", "tspline", 3, 2.4),
        Family("lagrange", "lagrange", 2, 1.96),
        Family("dolfinx", "dolfinx", 2, 1.4),
    ),
    steps="auto-0.02",
    models=False,
    beams=(OF_SCENE,),
    zone=(3.0, 5.0, 8.0),
    other_zone=(),
    reference_steps="auto-0.002",
    near=1.05,
    turns=1,
    together=True,
    seconds=45.0,
)
