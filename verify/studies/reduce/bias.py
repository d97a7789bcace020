"""Whether a reduction gives back the toughness that went into a run."""

from __future__ import annotations

from dataclasses import dataclass
from math import nan

from verify.reduction.coupon import REDUCED, coupon
from verify.reduction.data import of_steps
from verify.reduction.reduce import Reduced, Reduction, reduce
from verify.reduction.scheme import Settings
from verify.result import Result
from verify.scene.bond.mixed import mixed_bond
from verify.scene.schema import Scene
from verify.studies.reduce.source import OF_RUNS, Given
from verify.support.refusal import Refusal

#: Part of sliding in kinds where it is known whatever the crack length is.
_SLIDING = {"dcb": 0.0, "enf": 1.0, "els": 1.0, "4enf": 1.0}


@dataclass(frozen=True)
class Bias:
    """Toughness of the scene at the mode ratio of a scheme, and G over it, minus 1, at initiation and on growth."""

    scheme: Reduced
    known: float
    propagation: float
    nonlinear: float
    five: float


def biases(found: Reduction, scene: Scene) -> tuple[Bias, ...]:
    """One for each scheme that gives something; none of an adcb, whose mode ratio beams do not know."""
    by_compliance = next((one.mixture for one in found.schemes if one.name == "CBBM"), nan)
    ratio = _SLIDING.get(found.coupon.kind, by_compliance)
    if ratio != ratio or not found.schemes:
        return ()
    bond = mixed_bond(scene)
    known = scene.interface.toughness if bond is None else float(bond.critical(ratio))
    return tuple(
        Bias(
            one,
            known,
            one.propagation.value / known - 1.0,
            one.initiation["NL"].value / known - 1.0,
            one.initiation["5%/max"].value / known - 1.0,
        )
        for one in found.schemes
        if not one.missing
    )


def of_run(scene: Scene, result: Result, source: str = "run") -> Reduction | None:
    """The reduction of a run, as of a test without toe and noise; None where there is none of this specimen.

    A programme that turns is left out.
    """
    whole = len({column.size for column in result.steps.values()}) == 1
    if scene.specimen.kind not in REDUCED or len(scene.load.opening) > 1 or not (result.complete and whole):
        return None
    try:
        specimen = coupon(scene)
        given = Given(of_steps(source, result.steps, specimen), scene, specimen, True)
        return reduce(given.measured, specimen, given.settings(Settings(), OF_RUNS))
    except Refusal:
        return None
